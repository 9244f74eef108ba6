// GPL-2.0-or-later. Chains of portals that a search has followed, so that it leaves out those that can add nothing.
#pragma once

#include "q3map2/vis/chain_link.h"

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace q3 {

/// The edges of a convex winding as half-planes in two coordinates of its plane.
class WindingOutline {
  public:
    WindingOutline(const WindingView &winding, const Vec3f &normal) : axes_(AxesOf(normal)) {
        const float *const u = Coordinates(winding, 0), *const v = Coordinates(winding, 1);
        const auto after = [&](int i) { return i + 1 == winding.count ? 0 : i + 1; };
        float twiceArea = 0;
        for (int i = 0; i < winding.count; ++i)
            twiceArea += u[i] * v[after(i)] - u[after(i)] * v[i];
        const float turn = twiceArea < 0 ? -1.0f : 1.0f;
        for (int i = 0; i < winding.count; ++i) {
            const float du = u[after(i)] - u[i], dv = v[after(i)] - v[i], length = std::sqrt(du * du + dv * dv);
            if (length < kSlack)
                continue;
            const float a = turn * dv / length, b = -turn * du / length;
            edges_.push_back({a, b, a * u[i] + b * v[i]});
        }
    }
    /// Whether all points of a winding in the same plane are inside, up to kSlack.
    bool Contains(const WindingView &winding) const {
        const float *const u = Coordinates(winding, 0), *const v = Coordinates(winding, 1);
        for (const Edge &edge : edges_)
            for (int i = 0; i < winding.count; ++i)
                if (edge.a * u[i] + edge.b * v[i] - edge.c > kSlack)
                    return false;
        return true;
    }

    /// In memory, besides this object.
    std::size_t Bytes() const { return edges_.size() * sizeof(Edge); }

  private:
    /// Game units: for rounding, and much less than the kOnEpsilon of clipping.
    static constexpr float kSlack = 0.01f;
    /// Inside are the points with a u + b v <= c.
    struct Edge {
        float a, b, c;
    };

    /// The two axes other than that of the largest component of a normal.
    static std::array<int, 2> AxesOf(const Vec3f &normal) {
        const float x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
        if (x >= y && x >= z)
            return {1, 2};
        return y >= z ? std::array{0, 2} : std::array{0, 1};
    }
    const float *Coordinates(const WindingView &winding, std::size_t which) const {
        return std::array{winding.x, winding.y, winding.z}[std::size_t(axes_[which])];
    }

    std::array<int, 2> axes_;
    std::vector<Edge> edges_;
};

/// The chains that a search from one portal has followed. The portals that a chain still adds depend on its last
/// portal, on the clipped windings of its first and last portal, and on which unseen portals it may see. A chain is
/// covered by one before it if they have the same last portal, and the windings and the set of portals of that one
/// contain its own: what it would add is seen already, or will be. Without this, the number of chains through a row of
/// rooms is exponential in the number of rooms, since each room can be crossed in several ways.
class ExploredChains {
  public:
    void Clear() { byColumn_.clear(), words_ = 0; }

    /// Whether a chain before this one, from portal `first` to portal `last`, covers it; if none does, it is kept, to
    /// be followed next. `seen`: portals seen so far. blockWords: words of a block of rows.
    bool Covers(const ChainLink &link, const FlowPortal &first, const FlowPortal &last, const BitWord *seen,
                std::size_t blockWords) {
        Chains &chains = byColumn_[last.column];
        for (const Chain &chain : chains.kept)
            if (chain.HasUnseenOf(link, seen, blockWords) && chain.pass.Contains(link.pass) &&
                chain.source.Contains(link.source))
                return true;
        Chain added{WindingOutline(link.source, first.plane.normal),
                    WindingOutline(link.pass, last.plane.normal),
                    link.unseenBlocks,
                    {}};
        link.unseenBlocks.ForEach([&](std::size_t block) {
            for (std::size_t i = blockWords * block; i < blockWords * (block + 1); ++i)
                added.unseen.push_back(link.mightSee[i] & ~seen[i]);
        });
        Keep(std::move(added), chains);
        return false;
    }

  private:
    static constexpr std::size_t kMostOfPortal = 8;                 ///< chains that are kept of a portal
    static constexpr std::size_t kMostWords = std::size_t(1) << 22; ///< of all: 32 MB for a worker

    struct Chain {
        WindingOutline source, pass;
        BlockSet blocks;             ///< those that hold unseen portals
        std::vector<BitWord> unseen; ///< the words of `blocks`: unseen portals that it may see

        /// That it takes in memory.
        std::size_t Words() const {
            return unseen.size() + (sizeof(Chain) + source.Bytes() + pass.Bytes()) / sizeof(BitWord);
        }

        /// Whether it may see all unseen portals that a link may see.
        bool HasUnseenOf(const ChainLink &link, const BitWord *seen, std::size_t blockWords) const {
            if ((blocks & link.unseenBlocks) != link.unseenBlocks)
                return false;
            return !link.unseenBlocks.Any([&](std::size_t block) {
                const BitWord *const own = &unseen[blockWords * blocks.CountBelow(block)];
                BitWord others = 0;
                for (std::size_t i = 0; i < blockWords; ++i)
                    others |= link.mightSee[blockWords * block + i] & ~seen[blockWords * block + i] & ~own[i];
                return others != 0;
            });
        }
    };
    struct Chains {
        std::vector<Chain> kept;
        std::size_t next = 0; ///< the oldest, once there are kMostOfPortal
    };

    /// In the place of the oldest one if there are too many; not at all if it takes too much memory.
    void Keep(Chain added, Chains &chains) {
        const bool isFull = chains.kept.size() == kMostOfPortal;
        const std::size_t words = words_ + added.Words() - (isFull ? chains.kept[chains.next].Words() : 0);
        if (words > kMostWords)
            return;
        words_ = words;
        if (!isFull) {
            chains.kept.push_back(std::move(added));
            return;
        }
        chains.kept[chains.next] = std::move(added);
        chains.next = (chains.next + 1) % kMostOfPortal;
    }

    std::unordered_map<std::uint32_t, Chains> byColumn_; ///< by the column of the last portal
    std::size_t words_ = 0;                              ///< of all chains
};

} // namespace q3
