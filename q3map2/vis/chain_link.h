// GPL-2.0-or-later. Chains of portals in the portal flow: clipped windings, separators and what may be seen through
// them.
#pragma once

#include "q3map2/vis/sparse_bits.h"
#include "q3map2/vis/vis_map.h"
#include "q3map2/vis/vis_winding.h"

#include <span>
#include <vector>

namespace q3 {

inline constexpr int kMaxSeparators = 32; ///< per list; with fewer planes less is clipped, which is safe

/// Separating planes that bound the region seen from one winding through another.
struct Separators {
    VisPlane planes[kMaxSeparators];
    int count = 0;

    /// Whether the list has this plane, up to rounding. Two parallel edges give the same plane twice.
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

/// A chain of portals that ends here: the clipped windings of its first and last portal, and the portals that may
/// follow.
struct ChainLink {
    explicit ChainLink(std::size_t words) : mightSee(words) {}

    std::vector<BitWord> mightSee;   ///< portals that may be seen through the chain; only `blocks` are to be read
    BlockSet blocks;                 ///< blocks of mightSee (SparseBits) that hold bits
    BlockSet unseenBlocks;           ///< those of them that may hold portals not seen yet
    std::size_t lastPortal = 0;      ///< the last portal of the chain
    std::span<const int> candidates; ///< portals that lead out of the leaf behind lastPortal
    std::size_t nextCandidate = 0;   ///< index in `candidates` of the portal to try next
    int length = 1;                  ///< number of portals of the chain
    WindingView source, pass;        ///< clipped windings of the first and of the last portal
    WindingBuffer sourceBuffers[2], passBuffers[2]; ///< storage of `source` and `pass`, by turns
    Separators separators[2];                       ///< source against pass, pass against source

    /// Whether the whole portal is behind one of the separators.
    bool Hides(const FlowPortal &portal) const {
        for (const Separators &list : separators)
            for (int i = 0; i < list.count; ++i) {
                const float d = list.planes[i].Distance(portal.center);
                if (d > portal.radius)
                    continue;
                if (d < -portal.radius)
                    return true;
                const PointDistances distances(portal.winding, list.planes[i]);
                if (distances.max < kOnEpsilon && distances.min <= -kOnEpsilon)
                    return true;
            }
        return false;
    }
    /// Whether the chain has a last portal other than its first.
    bool HasPass() const { return length > 1; }
    /// Clip the last portal (pass) or the first (source) to the front of a plane. False: nothing is left.
    bool ClipPass(const VisPlane &plane) { return Clip(pass, passBuffers, plane); }
    bool ClipSource(const VisPlane &plane) { return Clip(source, sourceBuffers, plane); }
    /// Makes the separators of the clipped windings. Arguments: normals of the first and of the last portal.
    void MakeSeparators(const Vec3f &sourceNormal, const Vec3f &passNormal) {
        separators[0].count = TangentPlanes(source, sourceNormal, pass, NormalSide::Front, separators[0].planes);
        VisPlane found[kMaxSeparators];
        const int count = TangentPlanes(pass, passNormal, source, NormalSide::Behind, found);
        separators[1].count = 0;
        for (int i = 0; i < count; ++i) {
            const VisPlane plane = found[i].Flipped();
            if (!separators[0].Has(plane))
                separators[1].planes[separators[1].count++] = plane;
        }
    }

  private:
    /// Clips into the buffer that the winding does not view.
    static bool Clip(WindingView &winding, WindingBuffer (&buffers)[2], const VisPlane &plane) {
        return ChopInFront(winding, plane, buffers[winding.x == buffers[0].x ? 1 : 0]);
    }
};

} // namespace q3
