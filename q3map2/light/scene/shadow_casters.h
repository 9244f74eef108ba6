// GPL-2.0-or-later. Shadow casters as triangles by kind: the closed surface of everything solid, surfaces, static
// props.
#pragma once

#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/scene/open_parts.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/shader/shader_table.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Corners of a triangle. Game units.
using TriangleCorners = std::array<Vec3d, 3>;

/// By leaf: whether it is solid.
std::vector<bool> SolidLeafs(const Bsp &bsp);

/// Polygons between solid and open leafs: everything that blocks light as a volume, as a closed surface. They overlap
/// slightly, so that no ray slips through where they meet.
struct SolidHull {
    std::vector<bool> solidLeafs; ///< by leaf: whether it counts as solid
    std::vector<Winding<double>> faces;
};
/// Sets the faces of several hulls of one map. Iterative; time grows with nodes times depth.
void SolidHulls(const Bsp &bsp, std::span<SolidHull> hulls);

/// Cuts the triangle by the tree and adds to each leaf's count the number of triangles that its piece there makes. A
/// triangle within epsilon (game units) of a node's plane goes to the side that it faces.
void CountTriangles(TreeWalk<double> &tree, const TriangleCorners &triangle, double epsilon, std::vector<int> &counts);
/// Whether all leafs right behind the triangle are solid. solidInSecond: whether they are so in secondSolidLeafs too;
/// valid if the result is true.
bool SolidBehind(TreeWalk<double> &tree, const TriangleCorners &triangle, const std::vector<bool> &solidLeafs,
                 const std::vector<bool> &secondSolidLeafs, bool &solidInSecond);

/// Triangles of a static prop with one shader, in the world. Its surface number among shadow casters is the number of
/// draw surfaces plus its index in PropShadows::casters.
struct PropCaster {
    int prop = 0;                       ///< number of the prop, for RayPacket::ignoredProp
    const ShaderInfo *shader = nullptr; ///< null: the box of a prop
    bool seeThrough = false;            ///< by the texels of the shader's image
    int castShadows = 1;                ///< shadow group; 0 casts none
    std::vector<std::array<Vec3f, 3>> corners;
    std::vector<std::array<float, 6>> st; ///< of corners
};

/// What static props mean for shadows.
struct PropShadows {
    std::vector<PropCaster> casters;
    std::vector<int> receiveShadows; ///< shadow groups of the props that are lit
};

/// Kinds of shadow casters: rays of different passes meet different ones.
enum GeometryId : unsigned {
    kSolids,   ///< the hull of solid leafs
    kSurfaces, ///< surfaces that no solid covers; on faces of solids the hull blocks the same rays
    kPatches,  ///< curved surfaces
    kSkies,
    kFilters,         ///< see-through surfaces and static props
    kFilterPatches,   ///< see-through curved surfaces
    kLegacySolids,    ///< for the legacy grid
    kLegacySurfaces,  ///< for the legacy grid: surfaces that kLegacySolids do not cover
    kBlockerSolids,   ///< for dirt and floodlight on surfaces
    kBlockerSurfaces, ///< for dirt and floodlight too: surfaces that kBlockerSolids do not cover
    kProps,           ///< opaque static props
    kGeometries       ///< number of kinds
};

/// Triangles of one kind with the data that hits need.
struct Triangles {
    std::vector<float> corners; // 9 a triangle
    std::vector<int> surface;   // draw surface of each triangle, or surface number of a PropCaster; -1: a solid
    std::vector<std::array<float, 6>> st; // texture coordinates of the corners; empty for solids

    void Add(const Vec3f &a, const Vec3f &b, const Vec3f &c, int surfaceNumber) {
        corners.insert(corners.end(), {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z});
        surface.push_back(surfaceNumber);
    }
    std::size_t Count() const { return surface.size(); }
    TriangleCorners Corners(std::size_t i) const {
        const float *c = corners.data() + 9 * i;
        return {{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}}};
    }
    /// Appends triangle i of `from`.
    void Copy(const Triangles &from, std::size_t i) {
        corners.insert(corners.end(), from.corners.begin() + std::ptrdiff_t(9 * i),
                       from.corners.begin() + std::ptrdiff_t(9 * i + 9));
        surface.push_back(from.surface[i]);
        st.push_back(from.st[i]);
    }
};

using TrianglesByKind = std::array<Triangles, kGeometries>;

/// All shadow casters for receivers of group 1, except kBlockerSolids and kBlockerSurfaces.
TrianglesByKind ShadowCasters(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options);
/// Adds the surfaces that shadow receivers of that group; opaque ones to kSurfaces, also where a solid covers them.
void AddSurfaces(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, int receiveShadows,
                 TrianglesByKind &triangles);
/// Whether AddProps adds see-through props.
enum class SeeThroughProps { LeaveOut, Add };
/// Adds the static props that shadow receivers of that group, opaque ones to `opaque`; see-through ones
/// to kFilters, or nowhere. firstSurface: number of draw surfaces.
void AddProps(const PropShadows &props, int firstSurface, int receiveShadows, GeometryId opaque,
              SeeThroughProps seeThrough, TrianglesByKind &triangles);
/// Adds the hull of solid leafs.
void AddSolids(const Bsp &bsp, std::vector<bool> solidLeafs, Triangles &triangles);
/// Sets kBlockerSolids and kBlockerSurfaces.
void AddBlockers(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, TrianglesByKind &triangles);
/// Solid leafs as NetRadiant's q3map2 sees them: large leafs that several surfaces reach into do not count. Only
/// surfaces that reach in by more than epsilon (game units) count.
std::vector<bool> LegacySolidLeafs(const Bsp &bsp, const TrianglesByKind &triangles, double epsilon);
/// Epsilons of kLegacySolids and kBlockerSolids, fitted to the output of that program: no single value reproduces both.
inline constexpr double kLegacyGridEpsilon = 0.25, kBlockerEpsilon = 0.05;

} // namespace q3
