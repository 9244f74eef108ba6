// GPL-2.0-or-later. Chains of portals that a search follows, so that it leaves out others that can add nothing.
#pragma once

#include "q3map2/vis/chain_link.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace q3 {

/// The edges of a convex winding as half-planes in two coordinates of its plane.
class WindingOutline {
  public:
    WindingOutline(const WindingView &winding, const Vec3f &normal) : axes_(AxesOf(normal)) {
        const float *const u = Coordinates(winding, 0), *const v = Coordinates(winding, 1);
        const auto after = [&](int i) { return i + 1 == winding.count ? 0 : i + 1; };
        float twiceArea = 0; // relative to point 0: products of large coordinates would lose the area of slivers
        for (int i = 1; i + 1 < winding.count; ++i)
            twiceArea += (u[i] - u[0]) * (v[i + 1] - v[0]) - (u[i + 1] - u[0]) * (v[i] - v[0]);
        edges_.reserve(std::size_t(winding.count));
        const float turn = twiceArea < 0 ? -1.0f : 1.0f;
        for (int i = 0; i < winding.count; ++i) {
            const float du = u[after(i)] - u[i], dv = v[after(i)] - v[i], length = std::sqrt(du * du + dv * dv);
            if (length == 0) // the same point twice
                continue;
            edges_.push_back({u[i], v[i], turn * dv / length, -turn * du / length});
        }
    }
    /// Whether all points of a winding in the same plane are inside, up to kSlack.
    bool Contains(const WindingView &winding) const {
        const float *const u = Coordinates(winding, 0), *const v = Coordinates(winding, 1);
        for (const Edge &edge : edges_)
            for (int i = 0; i < winding.count; ++i)
                if (edge.a * (u[i] - edge.u) + edge.b * (v[i] - edge.v) > kSlack)
                    return false;
        return true;
    }

    /// In memory, besides this object.
    std::size_t Bytes() const { return edges_.size() * sizeof(Edge); }

  private:
    /// Game units in the projection: for rounding, and much less than the kOnEpsilon of clipping.
    static constexpr float kSlack = 0.01f;
    /// A point (u, v) of the edge, and its unit normal (a, b), which points out of the winding.
    struct Edge {
        float u, v, a, b;
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

/// Chains that a search from one portal follows. The portals that a chain still adds depend on its last portal, on the
/// clipped windings of its first and last portal, and on the portals that it may see. A chain is covered by a kept one
/// if they have the same last portal, and the windings and the set of portals of the kept one contain its own: what it
/// would add, the kept one adds. These are all portals that it may see, not only those not seen yet, since the way to
/// an unseen portal leads through seen ones. Kept chains are always followed to the end, so it does not matter whether
/// that has happened yet. Without this, the number of chains through a row of rooms is exponential in the number of
/// rooms, since each room can be crossed in several ways.
class ExploredChains {
  public:
    void Clear() { byColumn_.clear(), words_ = 0; }

    /// Whether a kept chain covers this one, which ends at portal `last`. blockWords: words of a block of rows.
    bool Covers(const ChainLink &link, const FlowPortal &last, std::size_t blockWords) const {
        const auto found = byColumn_.find(last.column);
        return found != byColumn_.end() && std::ranges::any_of(found->second.kept, [&](const Chain &chain) {
                   return chain.MaySeeAllOf(link, blockWords) && chain.pass.Contains(link.pass) &&
                          chain.source.Contains(link.source);
               });
    }
    /// Keeps a chain from portal `first` to portal `last` that is about to be followed. It replaces the oldest of
    /// kMostPerPortal with this last portal. Beyond kMostWords nothing is kept.
    void Keep(const ChainLink &link, const FlowPortal &first, const FlowPortal &last, std::size_t blockWords) {
        Chain added{WindingOutline(link.source, first.plane.normal),
                    WindingOutline(link.pass, last.plane.normal),
                    link.blocks,
                    {}};
        added.mightSee.reserve(blockWords * link.blocks.Size());
        link.blocks.ForEach([&](std::size_t block) {
            const auto begin = link.mightSee.begin() + std::ptrdiff_t(blockWords * block);
            added.mightSee.insert(added.mightSee.end(), begin, begin + std::ptrdiff_t(blockWords));
        });
        Chains &chains = byColumn_[last.column];
        const bool isFull = chains.kept.size() == kMostPerPortal;
        const std::size_t words = words_ + added.Words() - (isFull ? chains.kept[chains.oldest].Words() : 0);
        if (words > kMostWords)
            return;
        words_ = words;
        if (!isFull) {
            chains.kept.push_back(std::move(added));
            return;
        }
        chains.kept[chains.oldest] = std::move(added);
        chains.oldest = (chains.oldest + 1) % kMostPerPortal;
    }

  private:
    static constexpr std::size_t kMostPerPortal = 8;                ///< chains with the same last portal
    static constexpr std::size_t kMostWords = std::size_t(1) << 22; ///< of all chains: 32 MB for a worker

    struct Chain {
        WindingOutline source, pass;
        BlockSet blocks;               ///< those of mightSee
        std::vector<BitWord> mightSee; ///< the words of `blocks`: portals that it may see

        /// Its size in memory, in words.
        std::size_t Words() const {
            return mightSee.size() + (sizeof(Chain) + source.Bytes() + pass.Bytes()) / sizeof(BitWord);
        }
        /// Whether it may see all portals that a link may see.
        bool MaySeeAllOf(const ChainLink &link, std::size_t blockWords) const {
            if ((blocks & link.blocks) != link.blocks)
                return false;
            return !link.blocks.Any([&](std::size_t block) {
                const BitWord *const own = &mightSee[blockWords * blocks.CountBelow(block)];
                BitWord others = 0;
                for (std::size_t i = 0; i < blockWords; ++i)
                    others |= link.mightSee[blockWords * block + i] & ~own[i];
                return others != 0;
            });
        }
    };
    struct Chains {
        std::vector<Chain> kept;
        std::size_t oldest = 0; ///< once there are kMostPerPortal
    };

    std::unordered_map<std::uint32_t, Chains> byColumn_; ///< by the column of the last portal
    std::size_t words_ = 0;                              ///< of all chains
};

} // namespace q3
