// GPL-2.0-or-later. What casts shadows, as triangles by kind.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/scene/light_hull.h"
#include "q3map2/light/scene/surface_table.h"

#include <array>
#include <vector>

namespace q3 {

/// Kinds of shadow casters: rays of different passes meet different ones.
enum GeometryId : unsigned {
    kSolids,
    kSurfaces, ///< that no solid covers: the hull blocks the same rays as those on faces of solids
    kPatches,
    kSkies,
    kFilters,
    kFilterPatches,
    kLegacySolids,    ///< for the legacy grid
    kLegacySurfaces,  ///< for the legacy grid: those that kLegacySolids do not cover
    kBlockerSolids,   ///< for dirt and floodlight on surfaces
    kBlockerSurfaces, ///< for those too: those that kBlockerSolids do not cover
    kGeometries
};

/// Triangles of one kind with what a hit needs to know.
struct Triangles {
    std::vector<float> corners;           // 9 a triangle
    std::vector<int> surface;             // draw surface of each triangle
    std::vector<std::array<float, 6>> st; // texture coordinates of the corners; of surfaces only

    void Add(const Vec3f &a, const Vec3f &b, const Vec3f &c, int surfaceNumber) {
        corners.insert(corners.end(), {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z});
        surface.push_back(surfaceNumber);
    }
    std::size_t Count() const { return surface.size(); }
    TriangleCorners Corners(std::size_t i) const {
        const float *c = corners.data() + 9 * i;
        return {{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}}};
    }
    /// Appends one of `from`.
    void Copy(const Triangles &from, std::size_t i) {
        corners.insert(corners.end(), from.corners.begin() + std::ptrdiff_t(9 * i),
                       from.corners.begin() + std::ptrdiff_t(9 * i + 9));
        surface.push_back(from.surface[i]);
        st.push_back(from.st[i]);
    }
};

using TrianglesByKind = std::array<Triangles, kGeometries>;

/// All that shadows receivers of group 1, but for kBlockerSolids and kBlockerSurfaces.
TrianglesByKind ShadowCasters(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options);
/// Adds the surfaces that shadow receivers of that group; all of the world's to kSurfaces, covered or not.
void AddSurfaces(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, int receiveShadows,
                 TrianglesByKind &triangles);
/// Adds the hull of solid leafs.
void AddSolids(const Bsp &bsp, std::vector<bool> solidLeafs, Triangles &triangles);
/// Sets kBlockerSolids and kBlockerSurfaces.
void AddBlockers(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, TrianglesByKind &triangles);
/// Solid leafs as the established program sees them: without those that surfaces sunk into walls have opened. A surface
/// reaches into a leaf by more than epsilon, in game units; kLegacySolids or kBlockerSolids.
std::vector<bool> LegacySolidLeafs(const Bsp &bsp, const TrianglesByKind &triangles, double epsilon);
/// Found by comparing with what that program stores: one value for both makes one of them differ.
inline constexpr double kLegacyGridEpsilon = 0.25, kBlockerEpsilon = 0.05;

} // namespace q3
