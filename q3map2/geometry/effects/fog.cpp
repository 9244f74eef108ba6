// GPL-2.0-or-later. Fog volumes: cuts of faces and patches at their borders, fog numbers, and the fog hull.
#include "q3map2/geometry/effects/fog.h"

#include "common/error.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/geometry/faces/face_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace q3 {

// ---- Patches cut by a plane ----

namespace {

/// Control points of a patch.
struct ControlGrid {
    int width = 0, height = 0;
    std::vector<DrawVert> verts;
    const DrawVert &At(int column, int row) const { return verts[std::size_t(row * width + column)]; }
};

/// Turned by 90 degrees: rows become columns, and the front side stays the front.
ControlGrid Turned(const ControlGrid &grid) {
    ControlGrid turned{grid.height, grid.width, {}};
    for (int row = 0; row < turned.height; ++row)
        for (int column = 0; column < turned.width; ++column)
            turned.verts.push_back(grid.At(grid.width - 1 - row, column));
    return turned;
}

ControlGrid TurnedBack(const ControlGrid &grid) {
    return Turned(Turned(Turned(grid)));
}

/// Index of the column after which every row crosses the plane. -1: rows cross it elsewhere, never or repeatedly.
int CrossingColumn(const ControlGrid &grid, const Plane &plane, double epsilon) {
    int found = -1;
    for (int row = 0; row < grid.height; ++row) {
        int crossing = -1;
        for (int column = 0; column + 1 < grid.width; ++column) {
            const bool a = plane.Distance(Vec3d(grid.At(column, row).xyz)) > epsilon;
            const bool b = plane.Distance(Vec3d(grid.At(column + 1, row).xyz)) > epsilon;
            if (a == b)
                continue;
            if (crossing >= 0)
                return -1;
            crossing = column;
        }
        if (crossing < 0 || (found >= 0 && crossing != found))
            return -1;
        found = crossing;
    }
    return found;
}

/// Linear interpolation from a (t = 0) to b (t = 1).
DrawVert Between(const DrawVert &a, const DrawVert &b, double t) {
    DrawVert v = a;
    v.xyz = Vec3f(Vec3d(a.xyz) + (Vec3d(b.xyz) - Vec3d(a.xyz)) * t);
    const Vec3f normal = Normalize(Vec3f(Vec3d(a.normal) + (Vec3d(b.normal) - Vec3d(a.normal)) * t));
    v.normal = normal == Vec3f{} ? a.normal : normal;
    for (std::size_t i = 0; i < 2; ++i)
        v.st[i] = float(double(a.st[i]) + (double(b.st[i]) - double(a.st[i])) * t);
    for (std::size_t i = 0; i < 4; ++i)
        v.color[i] = std::uint8_t(std::lround(a.color[i] + (b.color[i] - a.color[i]) * t));
    return v;
}

std::vector<DrawVert> CrossingVerts(const ControlGrid &grid, int column, const Plane &plane) {
    std::vector<DrawVert> verts;
    for (int row = 0; row < grid.height; ++row) {
        const DrawVert &a = grid.At(column, row), &b = grid.At(column + 1, row);
        const double da = plane.Distance(Vec3d(a.xyz)), db = plane.Distance(Vec3d(b.xyz));
        verts.push_back(Between(a, b, std::clamp(da / (da - db), 0., 1.)));
    }
    return verts;
}

/// Columns from..to plus, at the cut end, one or two columns on the plane, whichever makes the width odd. No part is
/// wider than the whole, whose width is odd, because at least one of its columns is left out.
ControlGrid Part(const ControlGrid &grid, int from, int to, const std::vector<DrawVert> &crossing) {
    const int copies = (to - from + 1) % 2 == 0 ? 1 : 2;
    ControlGrid part{to - from + 1 + copies, grid.height, {}};
    for (int row = 0; row < grid.height; ++row) {
        if (from > 0)
            part.verts.insert(part.verts.end(), std::size_t(copies), crossing[std::size_t(row)]);
        for (int column = from; column <= to; ++column)
            part.verts.push_back(grid.At(column, row));
        if (from == 0)
            part.verts.insert(part.verts.end(), std::size_t(copies), crossing[std::size_t(row)]);
    }
    return part;
}

DrawSurface WithGrid(DrawSurface surface, ControlGrid grid) {
    surface.width = grid.width, surface.height = grid.height;
    surface.verts = std::move(grid.verts);
    surface.bounds = {};
    for (const DrawVert &vert : surface.verts)
        surface.bounds.Add(vert.xyz);
    return surface;
}

} // namespace

PatchCut CutPatchSurface(const DrawSurface &surface, const Plane &plane, double epsilon) {
    bool anyFront = false, anyBack = false;
    for (const DrawVert &vert : surface.verts) {
        const double d = plane.Distance(Vec3d(vert.xyz));
        anyFront |= d > epsilon, anyBack |= d < -epsilon;
    }
    if (!anyBack)
        return {PatchCut::Outside, {}, {}};
    if (!anyFront)
        return {PatchCut::Inside, {}, {}};
    ControlGrid grid{surface.width, surface.height, surface.verts};
    int column = CrossingColumn(grid, plane, epsilon);
    const bool turned = column < 0;
    if (turned) {
        grid = Turned(grid);
        column = CrossingColumn(grid, plane, epsilon);
    }
    if (column < 0)
        return {PatchCut::Impossible, {}, {}};
    const std::vector<DrawVert> crossing = CrossingVerts(grid, column, plane);
    ControlGrid low = Part(grid, 0, column, crossing), high = Part(grid, column + 1, grid.width - 1, crossing);
    const bool lowIsFront = plane.Distance(Vec3d(grid.At(0, 0).xyz)) > epsilon;
    if (turned)
        low = TurnedBack(low), high = TurnedBack(high);
    DrawSurface lowSurface = WithGrid(surface, std::move(low)), highSurface = WithGrid(surface, std::move(high));
    if (lowIsFront)
        return {PatchCut::Cut, std::move(highSurface), std::move(lowSurface)};
    return {PatchCut::Cut, std::move(lowSurface), std::move(highSurface)};
}

// ---- Fogs of the map, and the surfaces in them ----

namespace {

constexpr double kFogEpsilon = 0.1; ///< tolerance of points on a border, game units
/// Model surfaces are in a fog if they overlap its box, this much larger on each side, by at least kMinFogOverlap on
/// each axis. Game units.
constexpr double kFogMargin = 1, kMinFogOverlap = 1;

/// Index of the side whose normal is most opposite to `direction`; -1: none.
int SideAgainst(const Brush &brush, const PlaneTable &planes, const Vec3f &direction) {
    int best = -1;
    double least = 0;
    for (std::size_t i = 0; i < brush.sides.size(); ++i) {
        const BrushSide &side = brush.sides[i];
        if (side.bevel || side.planeNum < 0)
            continue;
        const double d = Dot(planes[side.planeNum].normal, Vec3d(direction));
        if (d < least)
            best = int(i), least = d;
    }
    return best;
}

Boundsf BoundsOf(const DrawSurface &surface) {
    Boundsf bounds;
    for (const DrawVert &vert : surface.verts)
        bounds.Add(vert.xyz);
    return bounds;
}

struct FogCounts {
    int polygons = 0; ///< parts of faces outside a fog
    int patches = 0;  ///< cuts of patches
    int fogged = 0;   ///< surfaces in a fog
};

/// Cuts the surfaces of the world at one fog brush and sets fogNum of the parts inside.
class WorldFogger {
  public:
    WorldFogger(Map &map, Geometry &geometry, PlaneTable &planes, const BspContext &context)
        : map_(map), geometry_(geometry), planes_(planes), context_(context) {}

    void Apply(int fogNum, const MapFog &fog) {
        const std::size_t count = geometry_.surfaces.size();
        const Brush *brush =
            fog.brush < 0 ? nullptr : &map_.entities[std::size_t(fog.entity)].brushes[std::size_t(fog.brush)];
        for (std::size_t i = 0; i < count; ++i) {
            const DrawSurface &surface = geometry_.surfaces[i];
            if (surface.Empty() || surface.shader == nullptr || surface.shader->geometry.noFog)
                continue;
            const bool inside = brush == nullptr ? surface.fogNum < 0
                                                 : BoundsOf(surface).Touches(brush->bounds) && KeepInside(i, *brush);
            if (inside) {
                geometry_.surfaces[i].fogNum = fogNum;
                ++counts.fogged;
            }
        }
    }

    FogCounts counts;

  private:
    /// Cuts the surface at the sides of the brush; the part inside keeps the number. False: nothing of it is inside.
    bool KeepInside(std::size_t number, const Brush &brush) {
        switch (geometry_.surfaces[number].kind) {
        case SurfaceKind::Face:
            return CutFace(number, brush);
        case SurfaceKind::Patch:
            return CutPatch(number, brush);
        case SurfaceKind::Triangles:
        case SurfaceKind::ForcedMeta:
        case SurfaceKind::Meta:
            return true;
        default:
            return false;
        }
    }

    /// Appends a face of the same brush side as surface `number` and returns its index.
    std::size_t AppendFragment(std::size_t number, const Polygon &w) {
        const DrawSurface original = geometry_.surfaces[number];
        const std::size_t made =
            std::size_t(MakeFaceSurface(map_.World(), original.brush, original.side, w, geometry_, planes_, context_));
        DrawSurface &fragment = geometry_.surfaces[made];
        fragment.fogNum = original.fogNum;
        fragment.shader = original.shader;
        if (fragment.planeNum != original.planeNum) { // back face of a fog brush side
            fragment.planeNum = original.planeNum;
            for (DrawVert &vert : fragment.verts)
                vert.normal = original.verts.front().normal;
        }
        return made;
    }

    bool CutFace(std::size_t number, const Brush &brush) {
        Polygon inside, front, back;
        for (const DrawVert &vert : geometry_.surfaces[number].verts)
            inside.push_back(vert.xyz);
        const int planeNum = geometry_.surfaces[number].planeNum;
        std::vector<Polygon> outside;
        for (const BrushSide &side : brush.sides) {
            // A face in the plane of a side is inside if it faces into the brush, else outside.
            if (side.planeNum < 0 || (planeNum >= 0 && side.planeNum == OppositePlane(planeNum)))
                continue;
            if (side.planeNum == planeNum)
                return false;
            ClipPolygon(inside, planes_[side.planeNum], kFogEpsilon, front, back);
            if (back.empty())
                return false;
            if (!front.empty())
                outside.push_back(front);
            inside = back;
        }
        if (outside.empty() || geometry_.surfaces[number].brush < 0)
            return true;
        for (const Polygon &w : outside)
            AppendFragment(number, w);
        counts.polygons += int(outside.size());
        const std::size_t rest = AppendFragment(number, inside);
        geometry_.surfaces[number] = std::move(geometry_.surfaces[rest]);
        geometry_.surfaces.pop_back();
        return true;
    }

    /// Cuts the patch at the bottom and the top of the brush only.
    bool CutPatch(std::size_t number, const Brush &brush) {
        constexpr std::size_t kBottom = 4, kTop = 5; // numbers of sides, see Brush
        for (std::size_t i = kBottom; i <= kTop && i < brush.sides.size(); ++i) {
            if (brush.sides[i].planeNum < 0)
                continue;
            auto cut = CutPatchSurface(geometry_.surfaces[number], planes_[brush.sides[i].planeNum], kFogEpsilon);
            if (cut.result == PatchCut::Outside)
                return false;
            if (cut.result == PatchCut::Impossible) {
                const DrawSurface &surface = geometry_.surfaces[number];
                context_.WarnAt("patch not cut by fog", surface.settings.entity, surface.primitive,
                                fmt::format("a patch of {} crosses the border of a fog more than once, or slanted to "
                                            "its rows and columns; it stays whole and without that fog",
                                            surface.shader->name));
                return false;
            }
            if (cut.result == PatchCut::Cut) {
                geometry_.surfaces[number] = std::move(cut.inside);
                geometry_.surfaces.push_back(std::move(cut.outside));
                ++counts.patches;
            }
        }
        return true;
    }

    Map &map_;
    Geometry &geometry_;
    PlaneTable &planes_;
    const BspContext &context_;
};

} // namespace

std::vector<MapFog> CollectFogs(const Map &map, const BspContext &context, int &defaultFog) {
    std::vector<MapFog> fogs;
    defaultFog = -1;
    if (context.options.noFog || map.entities.empty())
        return fogs;
    for (std::size_t e = 0; e < map.entities.size(); ++e) {
        const auto &brushes = map.entities[e].brushes;
        for (std::size_t b = 0; b < brushes.size(); ++b) {
            const ShaderInfo *shader = brushes[b].contentShader;
            if (shader == nullptr || !shader->geometry.hasFogParms)
                continue;
            const auto &direction = shader->geometry.fogDir;
            fogs.push_back({shader, int(e), int(b), direction ? SideAgainst(brushes[b], map.planes, *direction) : -1});
        }
    }
    if (const std::string_view name = keys::kFog.Text(map.entities.front().pairs); !name.empty()) {
        const ShaderInfo &shader = context.shaders.Get(name);
        if (!shader.geometry.hasFogParms)
            throw Error(
                "{}: the global fog {} of the world's \"_fog\" key is not a fog: expected a shader with fogparms",
                map.name, name);
        defaultFog = int(fogs.size());
        fogs.push_back({&shader, -1, -1, -1});
    }
    return fogs;
}

void FogWorldSurfaces(Map &map, Geometry &geometry, PlaneTable &planes, const BspContext &context) {
    WorldFogger fogger(map, geometry, planes, context);
    for (std::size_t i = 0; i < geometry.fogs.size(); ++i)
        fogger.Apply(int(i), MapFog(geometry.fogs[i]));
    context.log.VerboseCount(fogger.counts.polygons, "fog polygon fragments");
    context.log.VerboseCount(fogger.counts.patches, "fog patch fragments");
    context.log.VerboseCount(fogger.counts.fogged, "fogged drawsurfs");
}

int FogOfModelSurface(const DrawSurface &surface, const Vec3f &origin, const Map &map, const Geometry &geometry) {
    int best = geometry.defaultFog;
    double most = 0;
    const Boundsf bounds = BoundsOf(surface);
    for (std::size_t i = 0; i < geometry.fogs.size(); ++i) {
        const MapFog &fog = geometry.fogs[i];
        if (fog.brush < 0)
            continue;
        const Boundsf &box = map.entities[std::size_t(fog.entity)].brushes[std::size_t(fog.brush)].bounds;
        double overlap = 1; // volume, cubic game units
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double low = std::max(double(bounds.mins[axis] + origin[axis]), double(box.mins[axis]) - kFogMargin);
            const double high = std::min(double(bounds.maxs[axis] + origin[axis]), double(box.maxs[axis]) + kFogMargin);
            overlap *= high - low >= kMinFogOverlap ? high - low : 0;
        }
        if (overlap > most)
            best = int(i), most = overlap;
    }
    return best;
}

// ---- The fog hull: a box around the map (world key _foghull) ----

namespace {

constexpr float kFogHullDistance = 128; ///< between the map and the box, game units

} // namespace

void MakeFogHull(const Map &map, Geometry &geometry, const BspContext &context) {
    const std::string_view name = keys::kFogHull.Text(map.entities.front().pairs);
    if (name.empty())
        return;
    Boundsf bounds;
    for (const Brush &brush : map.entities.front().brushes)
        bounds.Add(brush.bounds);
    if (bounds.Empty())
        return;
    DrawSurface hull;
    hull.kind = SurfaceKind::FogHull;
    hull.shader = &context.shaders.Get("textures/" + std::string(name));
    hull.fogNum = geometry.defaultFog;
    const Vec3f border{kFogHullDistance, kFogHullDistance, kFogHullDistance};
    const std::array<Vec3f, 2> corners{bounds.mins - border, bounds.maxs + border};
    const Vec3f center = bounds.Center();
    for (std::size_t i = 0; i < 8; ++i) {
        DrawVert vert;
        vert.xyz = {corners[i & 1].x, corners[i >> 1 & 1].y, corners[i >> 2 & 1].z};
        vert.normal = Normalize(center - vert.xyz);
        hull.bounds.Add(vert.xyz);
        hull.verts.push_back(vert);
    }
    // Two triangles a face, which face inwards; corner i has its bits x, y, z set at maxs.
    hull.indexes = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    geometry.surfaces.push_back(std::move(hull));
}

} // namespace q3
