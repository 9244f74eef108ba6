// GPL-2.0-or-later. Shadow casters as triangles by kind: the closed surface of everything solid, surfaces, static
// props.
#include "q3map2/light/scene/shadow_casters.h"

#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

// ---- The closed surface of everything solid, from the BSP tree ----

namespace {

/// Half the side of the square in a node's plane that clipping starts from. Game units; engines' worlds end at 131072.
constexpr double kWorldHalfSize = 262144;
/// Corners within this distance of a plane count as on it. Game units; below the 1/8 that editors snap to.
constexpr double kClipEpsilon = 0.01;
/// Polygons grow by this much in their plane, so that rays cannot pass between them. Game units; a quarter of what
/// points of the grid keep clear of solids.
constexpr double kOverlap = 0.03;
/// Smaller polygons are rounding noise. Square units.
constexpr double kMinArea = 0.01;

Plane PlaneOf(const Bsp &bsp, const bspNode_t &node) {
    const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
    return {Vec3d(plane.normal), double(plane.dist)};
}

void Grow(Winding<double> &w) {
    const Vec3d normal = Normalize(WindingAreaVector(w));
    Winding<double> grown = w;
    const auto outward = [&](std::size_t i) { return Normalize(Cross(w[(i + 1) % w.size()] - w[i], normal)); };
    for (std::size_t i = 0; i < w.size(); ++i)
        grown[i] += (outward(i) + outward((i + w.size() - 1) % w.size())) * kOverlap;
    w = std::move(grown);
}

} // namespace

std::vector<bool> SolidLeafs(const Bsp &bsp) {
    std::vector<bool> solid(bsp.leafs.size());
    for (std::size_t i = 0; i < solid.size(); ++i)
        solid[i] = bsp.leafs[i].cluster < 0;
    return solid;
}

void CountTriangles(TreeWalk<double> &tree, const TriangleCorners &triangle, double epsilon, std::vector<int> &counts) {
    const Vec3d facing = -WindingAreaVector(triangle); // clockwise seen from the front
    tree.Walk(
        tree.Root(), triangle, epsilon,
        [&](const bspPlane_t &plane) {
            return Dot(facing, Vec3d(plane.normal)) > 0 ? CoplanarSide::Front : CoplanarSide::Back;
        },
        [&](const Winding<double> &piece, std::size_t leaf) {
            counts[leaf] += int(piece.size()) - 2;
            return true;
        });
}

bool SolidBehind(TreeWalk<double> &tree, const TriangleCorners &triangle, const std::vector<bool> &solidLeafs,
                 const std::vector<bool> &secondSolidLeafs, bool &solidInSecond) {
    const Vec3d facing = -WindingAreaVector(triangle);
    solidInSecond = true;
    return tree.Walk(
        tree.Root(), triangle, kClipEpsilon,
        [&](const bspPlane_t &plane) {
            return Dot(facing, Vec3d(plane.normal)) > 0 ? CoplanarSide::Back : CoplanarSide::Front;
        },
        [&](const Winding<double> &, std::size_t leaf) {
            solidInSecond = solidInSecond && secondSolidLeafs[leaf];
            return bool(solidLeafs[leaf]);
        });
}

namespace {

/// Adds the faces of hulls, node by node: they lie in the planes of nodes.
class HullFaces {
  public:
    HullFaces(const Bsp &bsp, std::span<SolidHull> hulls);
    /// Adds the faces in the plane of one node.
    void Add(int node);

  private:
    bool ClipToNode(int number, Winding<double> &w);
    void Keep(Winding<double> &piece, std::size_t frontLeaf, std::size_t backLeaf);

    const Bsp &bsp_;
    std::span<SolidHull> hulls_;
    std::vector<int> parents_; // by node; -1: none
    TreeWalk<double> front_, back_;
    WindingCutter<double> cutter_;
    Winding<double> part_;
};

HullFaces::HullFaces(const Bsp &bsp, std::span<SolidHull> hulls)
    : bsp_(bsp), hulls_(hulls), parents_(bsp.nodes.size(), -1), front_(bsp), back_(bsp) {
    for (std::size_t i = 0; i < bsp.nodes.size(); ++i)
        for (const int child : bsp.nodes[i].children)
            if (child >= 0)
                parents_[std::size_t(child)] = int(i);
}

/// Clips the polygon by the planes of all ancestors of the node, to the node's region. False when nothing is left.
bool HullFaces::ClipToNode(int number, Winding<double> &w) {
    for (int child = number, up = parents_[std::size_t(number)]; up >= 0; child = up, up = parents_[std::size_t(up)]) {
        const bspNode_t &node = bsp_.nodes[std::size_t(up)];
        const Plane plane = PlaneOf(bsp_, node);
        cutter_.Classify(w, plane.normal, plane.dist, kClipEpsilon);
        const bool inFront = cutter_.AnyFront() || !cutter_.AnyBack(); // in the plane: in front
        if (node.children[0] == child ? !inFront : !cutter_.AnyBack())
            return false;
        if (!cutter_.AnyFront() || !cutter_.AnyBack())
            continue;
        if (node.children[0] == child)
            cutter_.Front(w, part_);
        else
            cutter_.Back(w, part_);
        std::swap(w, part_);
        if (w.empty())
            return false;
    }
    return true;
}

void HullFaces::Keep(Winding<double> &piece, std::size_t frontLeaf, std::size_t backLeaf) {
    const auto between = [&](const SolidHull &hull) { return hull.solidLeafs[frontLeaf] != hull.solidLeafs[backLeaf]; };
    if (std::none_of(hulls_.begin(), hulls_.end(), between) || WindingArea(piece) < kMinArea)
        return;
    Grow(piece);
    for (SolidHull &hull : hulls_)
        if (between(hull))
            hull.faces.push_back(piece);
}

void HullFaces::Add(int node) {
    Winding<double> w = WindingInPlane(PlaneOf(bsp_, bsp_.nodes[std::size_t(node)]), kWorldHalfSize);
    if (!ClipToNode(node, w))
        return;
    const auto toFront = [](const bspPlane_t &) { return CoplanarSide::Front; };
    const auto &children = bsp_.nodes[std::size_t(node)].children;
    front_.Walk(children[0], w, kClipEpsilon, toFront, [&](const Winding<double> &piece, std::size_t frontLeaf) {
        return back_.Walk(children[1], piece, kClipEpsilon, toFront, [&](Winding<double> &small, std::size_t backLeaf) {
            Keep(small, frontLeaf, backLeaf);
            return true;
        });
    });
}

} // namespace

void SolidHulls(const Bsp &bsp, std::span<SolidHull> hulls) {
    HullFaces faces(bsp, hulls);
    for (std::size_t i = 0; i < bsp.nodes.size(); ++i)
        faces.Add(int(i));
}

// ---- Shadow casters as triangles by kind ----

namespace {

/// Skies stand this far in front of their brushes, so that rays meet them before the solid behind. Game units.
constexpr float kSkyLift = 1.0f / 16;
/// In NetRadiant's q3map2 a solid leaf longer than kLostLeafSize on an axis stops being solid if at least
/// kLostLeafTriangles triangles reach into it.
constexpr int kLostLeafSize = 32, kLostLeafTriangles = 5;

/// Whether casters of group c = castShadows shadow receivers of group r = receiveShadows:
///
///     r = 1: c > 0;  r > 1: c = 1 or |c| = r;  r <= 0: c != 0 and |c| = -r
bool Shadows(int castShadows, int receiveShadows) {
    if (receiveShadows == 1)
        return castShadows > 0;
    if (receiveShadows > 1)
        return castShadows == 1 || std::abs(castShadows) == receiveShadows;
    return castShadows != 0 && std::abs(castShadows) == -receiveShadows;
}

bool CastsShadow(const SurfaceEntry &entry, const bspShader_t &record, std::uint32_t noDrawBit, int receiveShadows) {
    const std::uint32_t flags = entry.shader->compileFlags;
    const bool seeThrough = (flags & (C_ALPHASHADOW | C_LIGHTFILTER)) != 0;
    return Shadows(entry.castShadows, receiveShadows) && !entry.skyBoxCopy && (flags & C_NODRAW) == 0 &&
           ((flags & C_TRANSLUCENT) == 0 || seeThrough) && (record.surfaceFlags & noDrawBit) == 0;
}

GeometryId KindOf(const ShaderInfo &shader, bool patch) {
    if ((shader.compileFlags & C_SKY) != 0)
        return kSkies;
    const bool filter = (shader.compileFlags & (C_ALPHASHADOW | C_LIGHTFILTER)) != 0 && shader.imageFound;
    return filter ? (patch ? kFilterPatches : kFilters) : (patch ? kPatches : kSurfaces);
}

struct Corner {
    Vec3f xyz;
    std::array<float, 2> st;
};

void AddTriangle(Triangles &triangles, bool sky, int surface, const Corner &a, const Corner &b, const Corner &c) {
    Vec3f lift;
    if (sky)
        lift = Normalize(Cross(c.xyz - a.xyz, b.xyz - a.xyz)) * kSkyLift;
    triangles.Add(a.xyz + lift, b.xyz + lift, c.xyz + lift, surface);
    triangles.st.push_back({a.st[0], a.st[1], b.st[0], b.st[1], c.st[0], c.st[1]});
}

void AddSurface(const Bsp &bsp, int number, const SurfaceEntry &entry, TrianglesByKind &triangles) {
    const bspDrawSurface_t &surface = bsp.drawSurfaces[std::size_t(number)];
    const bool patch = surface.surfaceType == MST_PATCH;
    const GeometryId kind = KindOf(*entry.shader, patch);
    const bool sky = kind == kSkies;
    if (patch) {
        const Mesh mesh = TessellatePatch(bsp, surface, entry.longestCurve);
        const auto corner = [&](const MeshVert &v) { return Corner{v.xyz + entry.origin, v.st}; };
        for (int y = 0; y + 1 < mesh.height; ++y)
            for (int x = 0; x + 1 < mesh.width; ++x) {
                const auto q = MeshQuad(mesh, x, y);
                AddTriangle(triangles[kind], sky, number, corner(q[0]), corner(q[1]), corner(q[2]));
                AddTriangle(triangles[kind], sky, number, corner(q[0]), corner(q[2]), corner(q[3]));
            }
        return;
    }
    if (surface.surfaceType != MST_PLANAR && surface.surfaceType != MST_TRIANGLE_SOUP)
        return;
    for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
        std::array<Corner, 3> c;
        for (int k = 0; k < 3; ++k) {
            const int index = bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)];
            const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + index)];
            c[std::size_t(k)] = {Vec3f(v.xyz) + entry.origin, v.st};
        }
        AddTriangle(triangles[kind], sky, number, c[0], c[1], c[2]);
    }
}

} // namespace

void AddSurfaces(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, int receiveShadows,
                 TrianglesByKind &triangles) {
    for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i) {
        const bool sky = (table[i].shader->compileFlags & C_SKY) != 0;
        const bspDrawSurface_t &surface = bsp.drawSurfaces[i];
        const bspShader_t &record = bsp.shaders[std::size_t(surface.shaderNum)];
        const bool patch = surface.surfaceType == MST_PATCH;
        if (!CastsShadow(table[i], record, options.noDrawSurfaceFlags, receiveShadows) ||
            (patch && !options.patchShadows) || (options.structuralShadowsOnly && !sky))
            continue;
        AddSurface(bsp, int(i), table[i], triangles);
    }
}

namespace {

void AddFaces(const std::vector<Winding<double>> &faces, Triangles &triangles) {
    for (const Winding<double> &w : faces)
        for (std::size_t i = 2; i < w.size(); ++i)
            triangles.Add(Vec3f(w[0]), Vec3f(w[i - 1]), Vec3f(w[i]), -1);
}

/// Most surfaces lie on faces of solids, whose hull blocks the same rays. Removes these from kSurfaces, and sets
/// kLegacySurfaces to those that kLegacySolids do not cover.
void RemoveCovered(const Bsp &bsp, const std::vector<bool> &solidLeafs, const std::vector<bool> &legacySolidLeafs,
                   TrianglesByKind &triangles) {
    const Triangles opaque = std::exchange(triangles[kSurfaces], {});
    TreeWalk<double> tree(bsp);
    for (std::size_t i = 0; i < opaque.Count(); ++i) {
        bool legacy = false;
        const bool covered = SolidBehind(tree, opaque.Corners(i), solidLeafs, legacySolidLeafs, legacy);
        if (!covered)
            triangles[kSurfaces].Copy(opaque, i);
        if (!covered || !legacy)
            triangles[kLegacySurfaces].Copy(opaque, i);
    }
}

} // namespace

void AddProps(const PropShadows &props, int firstSurface, int receiveShadows, GeometryId opaque,
              SeeThroughProps seeThrough, TrianglesByKind &triangles) {
    for (std::size_t i = 0; i < props.casters.size(); ++i) {
        const PropCaster &caster = props.casters[i];
        if (!Shadows(caster.castShadows, receiveShadows) ||
            (caster.seeThrough && seeThrough == SeeThroughProps::LeaveOut))
            continue;
        Triangles &to = triangles[caster.seeThrough ? kFilters : opaque];
        for (std::size_t t = 0; t < caster.corners.size(); ++t) {
            const auto &[a, b, c] = caster.corners[t];
            to.Add(a, b, c, firstSurface + int(i));
            to.st.push_back(caster.st[t]);
        }
    }
}

void AddSolids(const Bsp &bsp, std::vector<bool> solidLeafs, Triangles &triangles) {
    SolidHull hull{std::move(solidLeafs), {}};
    SolidHulls(bsp, {&hull, 1});
    AddFaces(hull.faces, triangles);
}

TrianglesByKind ShadowCasters(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options) {
    TrianglesByKind triangles;
    AddSurfaces(bsp, table, options, 1, triangles);
    std::array<SolidHull, 2> hulls{{{SolidLeafs(bsp), {}}, {LegacySolidLeafs(bsp, triangles, kLegacyGridEpsilon), {}}}};
    SolidHulls(bsp, hulls);
    AddFaces(hulls[0].faces, triangles[kSolids]);
    AddFaces(hulls[1].faces, triangles[kLegacySolids]);
    RemoveCovered(bsp, hulls[0].solidLeafs, hulls[1].solidLeafs, triangles);
    return triangles;
}

void AddBlockers(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, TrianglesByKind &triangles) {
    TrianglesByKind unsorted;
    AddSurfaces(bsp, table, options, 1, unsorted);
    const std::vector<bool> solidLeafs = LegacySolidLeafs(bsp, unsorted, kBlockerEpsilon);
    AddSolids(bsp, solidLeafs, triangles[kBlockerSolids]);
    TreeWalk<double> tree(bsp);
    bool same = true;
    for (std::size_t i = 0; i < unsorted[kSurfaces].Count(); ++i)
        if (!SolidBehind(tree, unsorted[kSurfaces].Corners(i), solidLeafs, solidLeafs, same))
            triangles[kBlockerSurfaces].Copy(unsorted[kSurfaces], i);
}

std::vector<bool> LegacySolidLeafs(const Bsp &bsp, const TrianglesByKind &triangles, double epsilon) {
    std::vector<int> counts(bsp.leafs.size());
    TreeWalk<double> tree(bsp);
    for (const GeometryId id : {kSurfaces, kPatches, kSkies, kFilters, kFilterPatches})
        for (std::size_t i = 0; i < triangles[id].Count(); ++i)
            CountTriangles(tree, triangles[id].Corners(i), epsilon, counts);
    std::vector<bool> solid = SolidLeafs(bsp);
    for (std::size_t i = 0; i < solid.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (counts[i] >= kLostLeafTriangles &&
                std::int64_t(bsp.leafs[i].maxs[axis]) - bsp.leafs[i].mins[axis] > kLostLeafSize)
                solid[i] = false;
    return solid;
}

} // namespace q3
