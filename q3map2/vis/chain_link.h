// GPL-2.0-or-later. A portal of a chain, as the portal flow follows it. Internal to the folder.
#pragma once

#include "q3map2/vis/separators.h"
#include "q3map2/vis/vis_map.h"

#include <span>
#include <vector>

namespace q3 {

inline constexpr int kMaxSeparators = 32; ///< of each kind; more cut a little less

/// Planes that bound what can be seen from one winding through another.
struct Separators {
    VisPlane planes[kMaxSeparators];
    int count = 0;

    /// Whether nearly the same plane is there: parallel edges give one twice.
    bool Has(const VisPlane &plane) const {
        constexpr float kSameDirection = 1e-5f, kSameDistance = 0.01f;
        for (int i = 0; i < count; ++i) {
            const Vec3f turn = planes[i].normal - plane.normal;
            if (std::abs(turn.x) < kSameDirection && std::abs(turn.y) < kSameDirection &&
                std::abs(turn.z) < kSameDirection && std::abs(planes[i].dist - plane.dist) < kSameDistance)
                return true;
        }
        return false;
    }
};

/// One portal of a chain: what is left of the first and the last portal, and which portals may follow.
struct ChainLink {
    explicit ChainLink(std::size_t words) : storage(words), newStorage(words), might(storage.data()) {}

    std::vector<BitWord> storage;
    std::vector<std::uint32_t> newStorage;
    const BitWord *might;                    ///< portals that may be seen through the chain
    std::size_t low = 0, high = 0;           ///< words of `might` that are not all zero, and nothing outside is read
    std::span<const std::uint32_t> newWords; ///< words of it that may hold portals not seen yet
    std::size_t entry = 0;                   ///< the last portal of the chain
    std::span<const int> after;              ///< portals that could follow
    std::size_t place = 0;                   ///< the next of them
    int length = 1;                          ///< portals of the chain
    WindingView source, pass;                ///< what is left of the first portal and of the last
    WindingBuffer sourceBuffers[2], passBuffers[2];
    Separators separators[2]; ///< source against pass, pass against source

    /// Whether nothing of a portal is in front of all separators, as far as each of them tells.
    bool Hides(const FlowPortal &portal) const {
        for (const Separators &list : separators)
            for (int i = 0; i < list.count; ++i) {
                const float d = list.planes[i].Distance(portal.centre);
                if (d > portal.radius)
                    continue;
                if (d < -portal.radius)
                    return true;
                const PointDistances distances(portal.winding, list.planes[i]);
                if (distances.greatest < kOnEpsilon && distances.least <= -kOnEpsilon)
                    return true;
            }
        return false;
    }
    bool MaySee(std::size_t q) const { return q >> 6 >= low && q >> 6 < high && TestBit(might, q); }
    bool HasPass() const { return length > 1; }
    /// Cuts what is left of the last portal, or of the first, by a plane. False: nothing is left.
    bool CutPass(const VisPlane &plane) { return Cut(pass, passBuffers, plane); }
    bool CutSource(const VisPlane &plane) { return Cut(source, sourceBuffers, plane); }
    /// Normals are those of the first and of the last portal.
    void MakeSeparators(const Vec3f &sourceNormal, const Vec3f &passNormal) {
        separators[0].count = TangentPlanes(source, sourceNormal, pass, false, separators[0].planes);
        VisPlane found[kMaxSeparators];
        const int count = TangentPlanes(pass, passNormal, source, true, found);
        separators[1].count = 0;
        for (int i = 0; i < count; ++i) {
            const VisPlane plane = found[i].Flipped();
            if (!separators[0].Has(plane))
                separators[1].planes[separators[1].count++] = plane;
        }
    }

  private:
    /// In the buffer that the winding is not in.
    static bool Cut(WindingView &winding, WindingBuffer (&buffers)[2], const VisPlane &plane) {
        return ChopInFront(winding, plane, buffers[winding.x == buffers[0].x ? 1 : 0]);
    }
};

} // namespace q3
