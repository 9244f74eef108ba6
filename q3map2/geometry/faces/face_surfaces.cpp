// GPL-2.0-or-later. Draw surfaces of brush sides and patches: cut by a grid, and triangulated.
#include "q3map2/geometry/faces/face_surfaces.h"

#include "q3map2/map/map_patch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace q3 {

// ---- Faces cut by a world-aligned grid (tessSize) ----

namespace {

constexpr double kOnEpsilon = 0.1; ///< game units

/// The lowest grid plane that cuts the polygon, with more than kOnEpsilon of it on both sides.
std::optional<Plane> GridPlane(const Polygon &w, double size) {
    const Boundsf bounds = WindingBounds(w);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double lo = std::floor((double(bounds.mins[axis]) + kOnEpsilon) / size) * size;
        const double hi = std::ceil((double(bounds.maxs[axis]) - kOnEpsilon) / size) * size;
        if (hi - lo > size) {
            Plane plane;
            plane.normal[axis] = 1;
            plane.dist = lo + size;
            return plane;
        }
    }
    return {};
}

/// Pieces of w, none larger than a cell of the grid.
std::vector<Polygon> GridPieces(Polygon w, double size, const DrawSurface &surface, const BspContext &context) {
    const int limit = context.options.maxDrawSurfaces;
    std::vector<Polygon> pieces, pending{std::move(w)};
    while (!pending.empty()) {
        const Polygon piece = std::move(pending.back());
        pending.pop_back();
        const std::optional<Plane> plane = GridPlane(piece, size);
        if (!plane) {
            pieces.push_back(piece);
            if (int(pieces.size()) > limit)
                context.FailAt(surface.settings.entity, surface.primitive,
                               fmt::format("shader {}: tessSize {} cuts a face into more than {} pieces, expected a "
                                           "larger size or -maxmapdrawsurfs",
                                           surface.shader->name, int(size), limit));
            continue;
        }
        Polygon front, back;
        ClipPolygonKeepOn(piece, *plane, kOnEpsilon, front, back);
        if (back.size() >= 3)
            pending.push_back(std::move(back));
        if (front.size() >= 3)
            pending.push_back(std::move(front));
    }
    return pieces;
}

bool HasTessSize(const DrawSurface &surface) {
    return surface.kind == SurfaceKind::Face && !surface.Empty() && surface.brush >= 0 &&
           surface.shader->geometry.tessSize >= 1 && (surface.shader->compileFlags & C_SKY) == 0;
}

} // namespace

void SubdivideFaces(MapEntity &entity, Geometry &geometry, std::size_t first, const PlaneTable &planes,
                    const BspContext &context) {
    if (context.options.noSubdivide)
        return;
    const std::size_t last = geometry.surfaces.size();
    for (std::size_t i = first; i < last; ++i) {
        if (!HasTessSize(geometry.surfaces[i]))
            continue;
        const DrawSurface surface = geometry.surfaces[i];
        Polygon w;
        for (const DrawVert &v : surface.verts)
            w.push_back(v.xyz);
        const std::vector<Polygon> pieces = GridPieces(w, double(surface.shader->geometry.tessSize), surface, context);
        if (pieces.size() < 2)
            continue;
        geometry.surfaces[i].verts.clear();
        for (const Polygon &piece : pieces) {
            const int number = MakeFaceSurface(entity, surface.brush, surface.side, piece, geometry, planes, context);
            geometry.surfaces[std::size_t(number)].fogNum = surface.fogNum;
            entity.brushes[std::size_t(surface.brush)].sides[std::size_t(surface.side)].surface = number;
        }
    }
}

// ---- Draw surfaces of brush sides ----

namespace {

/// The nearest multiple of 1/8 game unit.
float Snapped(float coordinate) {
    return float(std::floor(8.0 * double(coordinate) + 0.5) / 8);
}

/// Computed in float like NetRadiant's q3map2, so that coordinates at a whole number round as they do there.
std::array<float, 2> TextureCoordinates(const BrushSide &side, const Vec3f &p) {
    std::array<float, 2> st{};
    for (std::size_t i = 0; i < 2; ++i) {
        const std::array<double, 4> &v = side.texture.vecs[i];
        st[i] = float(v[0]) * p.x + float(v[1]) * p.y + float(v[2]) * p.z + float(v[3]);
    }
    return st;
}

/// Texture coordinates of all vertices under -flat: the corner between the last texel of the image and the one before.
std::array<float, 2> FlatCoordinates(const ShaderInfo &shader) {
    return {1 - 1 / float(shader.geometry.textureWidth), 1 - 1 / float(shader.geometry.textureHeight)};
}

/// Whether `w` is the back face of a fog brush side. Fog brushes get back faces because they are seen from inside too.
bool IsBackFace(const BrushSide &side, const Polygon &w, const PlaneTable &planes) {
    return (side.shader->compileFlags & C_FOG) != 0 && Dot(WindingAreaVector(w), planes[side.planeNum].normal) > 0;
}

bool MakesSurface(const BrushSide &side) {
    if (side.shader == nullptr || side.culled || side.visibleHull.size() < 3)
        return false;
    const ShaderInfo &shader = *side.shader;
    return (shader.compileFlags & C_NODRAW) == 0 || shader.geometry.indexed || (shader.compileFlags & C_FOG) != 0;
}

} // namespace

int MakeFaceSurface(const MapEntity &entity, int brush, int side, const Polygon &w, Geometry &geometry,
                    const PlaneTable &planes, const BspContext &context) {
    const Brush &solid = entity.brushes[std::size_t(brush)];
    const BrushSide &from = solid.sides[std::size_t(side)];
    DrawSurface surface;
    surface.kind = SurfaceKind::Face;
    surface.shader = from.shader;
    surface.settings = solid.settings;
    surface.brush = brush, surface.side = side, surface.primitive = solid.primitive;
    surface.planeNum = IsBackFace(from, w, planes) ? OppositePlane(from.planeNum) : from.planeNum;
    surface.planar = true;
    const Vec3f normal(planes[surface.planeNum].normal);
    for (const Vec3f &p : w) {
        DrawVert vert;
        for (std::size_t i = 0; i < 3; ++i)
            vert.xyz[i] = context.options.snapVertices ? Snapped(p[i]) : p[i];
        vert.normal = normal;
        vert.st = context.options.flat ? FlatCoordinates(*from.shader)
                                       : TextureCoordinates(from, vert.xyz + solid.textureOrigin);
        surface.bounds.Add(vert.xyz);
        surface.verts.push_back(vert);
    }
    geometry.surfaces.push_back(std::move(surface));
    return int(geometry.surfaces.size()) - 1;
}

void MakeFaceSurfaces(MapEntity &entity, Geometry &geometry, const PlaneTable &planes, const BspContext &context,
                      const SideParts &parts) {
    for (std::size_t b = 0; b < entity.brushes.size(); ++b)
        for (std::size_t s = 0; s < entity.brushes[b].sides.size(); ++s) {
            BrushSide &side = entity.brushes[b].sides[s];
            if (!MakesSurface(side))
                continue;
            const bool isUnclipped = side.shader->autosprite || side.shader->geometry.noClip;
            if (const auto found = parts.find(&side); !isUnclipped && found != parts.end()) {
                for (const Polygon &part : found->second)
                    side.surface = MakeFaceSurface(entity, int(b), int(s), part, geometry, planes, context);
                continue;
            }
            const Polygon &w = isUnclipped ? side.winding : side.visibleHull;
            side.surface = MakeFaceSurface(entity, int(b), int(s), w, geometry, planes, context);
            if ((side.shader->compileFlags & C_FOG) != 0)
                side.surface = MakeFaceSurface(entity, int(b), int(s), Reversed(w), geometry, planes, context);
        }
}

// ---- Triangulation of polygons ----

namespace {

constexpr double kMinSineSquared = 1e-5; ///< of the smallest angle, which is then at least 0.18 degrees
constexpr double kMinTwiceArea = 1;      ///< square game units
/// The search for triangles of greatest area grows with the cube of the number of corners.
constexpr std::size_t kMaxAreaCorners = 340;
constexpr int kMaxAreaTries = 8; ///< each with half the weight of the perimeter

using Verts = std::vector<DrawVert>;
using Indexes = std::vector<int>;

const DrawVert &At(const Verts &verts, int i) {
    const int n = int(verts.size());
    return verts[std::size_t((i % n + n) % n)];
}

Vec3d Position(const Verts &verts, int i) {
    return Vec3d(At(verts, i).xyz);
}

double TwiceArea(const Vec3d &a, const Vec3d &b, const Vec3d &c) {
    return Length(Cross(b - a, c - a));
}

/// Whether the triangle is neither a sliver nor tiny. Those show cracks when drawn.
bool IsSound(const Vec3d &a, const Vec3d &b, const Vec3d &c) {
    const double twiceArea = TwiceArea(a, b, c);
    std::array<double, 3> squares{Dot(b - a, b - a), Dot(c - b, c - b), Dot(a - c, a - c)};
    std::ranges::sort(squares);
    // The smallest angle lies between the two longest edges: sine = 2 area / (their product).
    return twiceArea > kMinTwiceArea && twiceArea * twiceArea > kMinSineSquared * squares[1] * squares[2];
}

/// A triangle strip that alternates between the two sides of a start vertex, but prefers the side whose next vertex was
/// inserted by T-junction repair. Empty if a triangle is not sound.
std::optional<Indexes> StripFrom(const Verts &verts, int start) {
    const int n = int(verts.size());
    const auto wrap = [n](int i) { return (i % n + n) % n; };
    Indexes indexes;
    // i runs forwards and j backwards from the start until they meet. Each step moves one of them from k onwards and
    // makes the triangle i, j, k.
    int i = start % n, j = wrap(start - 1);
    bool movesBack = false; // j moved last
    while (true) {
        const bool ifAlternates = At(verts, movesBack ? i + 1 : j - 1).inserted;
        const bool ifStays = At(verts, movesBack ? j - 1 : i + 1).inserted;
        if (ifAlternates >= ifStays)
            movesBack = !movesBack;
        const int k = movesBack ? j : i;
        (movesBack ? j : i) = wrap(movesBack ? j - 1 : i + 1);
        if (i == j)
            return indexes;
        if (!IsSound(Position(verts, i), Position(verts, j), Position(verts, k)))
            return {};
        indexes.insert(indexes.end(), {i, j, k});
    }
}

/// The strip from the first vertex, by x, y and z, that has one of sound triangles; empty if none has.
std::optional<Indexes> Strip(const DrawSurface &surface) {
    const auto order = [](const DrawVert &v) { return std::tuple(v.xyz.x, v.xyz.y, v.xyz.z); };
    const int n = int(surface.verts.size());
    const int first = surface.shader->autosprite
                          ? 0
                          : int(std::ranges::min_element(surface.verts, {}, order) - surface.verts.begin());
    for (int i = 0; i < n; ++i)
        if (std::optional<Indexes> indexes = StripFrom(surface.verts, first + i))
            return indexes;
    return {};
}

/// Inserts a vertex in the middle and a fan of triangles around it.
void MakeFan(DrawSurface &surface) {
    const int n = int(surface.verts.size());
    Vec3d xyz, normal;
    std::array<double, 2> st{};
    std::array<double, 4> color{};
    for (const DrawVert &v : surface.verts) {
        xyz += Vec3d(v.xyz), normal += Vec3d(v.normal);
        for (std::size_t i = 0; i < 2; ++i)
            st[i] += double(v.st[i]);
        for (std::size_t i = 0; i < 4; ++i)
            color[i] += v.color[i];
    }
    DrawVert middle;
    middle.xyz = Vec3f(xyz / n), middle.normal = Vec3f(Normalize(normal));
    for (std::size_t i = 0; i < 2; ++i)
        middle.st[i] = float(st[i] / n);
    for (std::size_t i = 0; i < 4; ++i)
        middle.color[i] = std::uint8_t(color[i] / n);
    surface.verts.insert(surface.verts.begin(), middle);
    surface.indexes.clear();
    for (int i = 0; i < n; ++i)
        surface.indexes.insert(surface.indexes.end(), {0, i == 0 ? n : i, i + 1});
}

/// Splits the polygon of the vertices first..last: appends the best triangle on the edge first-last, then splits the
/// rest on either side of it. Best: greatest area - perimeterWeight * perimeter. False if no sound triangle is left.
bool LargestTriangles(const Verts &verts, int first, int last, double perimeterWeight, Indexes &indexes) {
    if (last - first < 2)
        return true;
    std::array<int, 3> best{};
    double bestValue = 0;
    bool found = false;
    // The third corner k divides the rest of the polygon in two.
    for (int k = first + 1; k < last; ++k) {
        const Vec3d a = Position(verts, first), b = Position(verts, k), c = Position(verts, last);
        if (!IsSound(a, b, c))
            continue;
        const double value = TwiceArea(a, b, c) / 2 - perimeterWeight * (Length(b - a) + Length(c - b) + Length(a - c));
        if (!found || value > bestValue)
            best = {first, k, last}, bestValue = value, found = true;
    }
    if (!found)
        return false;
    indexes.insert(indexes.end(), best.begin(), best.end());
    return LargestTriangles(verts, first, best[1], perimeterWeight, indexes) &&
           LargestTriangles(verts, best[1], last, perimeterWeight, indexes);
}

/// Splits off the best triangle of the polygon (see LargestTriangles), then those of the three remaining parts.
/// Repeated with half the weight of the perimeter until all triangles are sound; empty if that fails.
std::optional<Indexes> MaxArea(const Verts &verts) {
    const int n = int(verts.size());
    double perimeterWeight = 2; // game units
    for (int attempt = 0; attempt < kMaxAreaTries; ++attempt, perimeterWeight /= 2) {
        std::array<int, 3> best{}; // best[2] is 0 as long as none is found
        double bestValue = 0;
        for (int i = 0; i < n; ++i)
            for (int j = i + 1; j < n; ++j)
                for (int k = j + 1; k < n; ++k) {
                    const Vec3d a = Position(verts, i), b = Position(verts, j), c = Position(verts, k);
                    const double value =
                        TwiceArea(a, b, c) / 2 - perimeterWeight * (Length(b - a) + Length(c - b) + Length(a - c));
                    if (IsSound(a, b, c) && (best[2] == 0 || value > bestValue))
                        best = {i, j, k}, bestValue = value;
                }
        if (best[2] == 0)
            return {};
        Indexes indexes(best.begin(), best.end());
        if (LargestTriangles(verts, best[0], best[1], perimeterWeight, indexes) &&
            LargestTriangles(verts, best[1], best[2], perimeterWeight, indexes) &&
            LargestTriangles(verts, best[2], best[0] + n, perimeterWeight, indexes)) {
            for (int &i : indexes)
                i %= n;
            return indexes;
        }
    }
    return {};
}

} // namespace

void TriangulateFace(DrawSurface &surface, const BspContext &context) {
    surface.indexes.clear();
    const std::size_t n = surface.verts.size();
    if (n < 3)
        return;
    if (surface.shader->autosprite && n > std::size_t(context.options.maxVertexLitVerts))
        context.FailAt(surface.settings.entity, surface.primitive,
                       fmt::format("a face of the sprite shader {} has {} corners, expected at most {}",
                                   surface.shader->name, n, context.options.maxVertexLitVerts));
    if (n == 3) {
        surface.indexes = {0, 1, 2};
        return;
    }
    std::optional<Indexes> indexes;
    if (context.options.maxArea && n <= kMaxAreaCorners)
        indexes = MaxArea(surface.verts);
    if (!indexes)
        indexes = Strip(surface);
    if (indexes)
        surface.indexes = std::move(*indexes);
    else
        MakeFan(surface);
}

// ---- Draw surfaces of patches ----

namespace {

constexpr double kEqualEpsilon = 0.001; ///< game units, and components of normals

bool AreEqual(const Vec3f &a, const Vec3f &b) {
    const Vec3d d = Vec3d(a) - Vec3d(b);
    return std::abs(d.x) <= kEqualEpsilon && std::abs(d.y) <= kEqualEpsilon && std::abs(d.z) <= kEqualEpsilon;
}

/// Gives a flat patch a plane number, and the plane's normal at all vertices.
void FlattenPatch(DrawSurface &surface, PlaneTable &planes) {
    const DrawVert &first = surface.verts.front();
    const Vec3d normal(first.normal), origin(first.xyz);
    surface.planar = std::ranges::all_of(surface.verts, [&](const DrawVert &v) {
        return AreEqual(v.normal, first.normal) && std::abs(Dot(Vec3d(v.xyz) - origin, normal)) <= kEqualEpsilon;
    });
    if (!surface.planar)
        return;
    const std::array<Vec3d, 1> point{origin};
    surface.planeNum = planes.Find(normal, Dot(normal, origin), point);
    surface.planar = surface.planeNum >= 0;
    if (!surface.planar)
        return;
    surface.lightmapVecs[2] = Vec3f(planes[surface.planeNum].normal);
    for (DrawVert &v : surface.verts)
        v.normal = surface.lightmapVecs[2];
}

/// `offset`: from vertices to where they are in the map source, as for faces of brushes.
void SetTextureCoordinates(DrawSurface &surface, const Vec3f &offset, const BspOptions &options) {
    const GeometryDirectives &shader = surface.shader->geometry;
    for (DrawVert &v : surface.verts) {
        if (shader.hasTexGen)
            v.st = {Dot(shader.texGen[0], v.xyz + offset), Dot(shader.texGen[1], v.xyz + offset)};
        if (options.flat)
            v.st = FlatCoordinates(*surface.shader);
    }
}

} // namespace

void MakePatchSurfaces(MapEntity &entity, Geometry &geometry, PlaneTable &planes, const BspContext &context) {
    for (std::size_t i = 0; i < entity.patches.size(); ++i) {
        Patch &patch = entity.patches[i];
        if (patch.verts.empty())
            continue;
        SetPatchNormals(patch);
        DrawSurface surface;
        surface.kind = SurfaceKind::Patch;
        surface.shader = patch.shader;
        surface.settings = patch.settings;
        surface.patch = int(i), surface.primitive = patch.primitive;
        surface.width = patch.width, surface.height = patch.height;
        surface.longestCurve = patch.longestCurve;
        surface.verts = patch.verts;
        surface.lightmapVecs = {patch.lodBounds.mins, patch.lodBounds.maxs, Vec3f{}};
        for (const DrawVert &v : surface.verts)
            surface.bounds.Add(v.xyz);
        FlattenPatch(surface, planes);
        SetTextureCoordinates(surface, entity.brushOrigin, context.options);
        geometry.surfaces.push_back(std::move(surface));
    }
}

// ---- Patches that are drawn as triangles ----

namespace {

const Patch *PatchOf(const DrawSurface &surface, const MapEntity &entity) {
    return surface.patch >= 0 && std::size_t(surface.patch) < entity.patches.size()
               ? &entity.patches[std::size_t(surface.patch)]
               : nullptr;
}

bool IsDrawnAsTriangles(const DrawSurface &surface, const Patch *patch, const BspOptions &options) {
    if (surface.kind != SurfaceKind::Patch || surface.shader == nullptr || surface.Empty() || surface.collisionOnly)
        return false;
    if (!options.patchMeta && (patch == nullptr || !patch->patchMeta))
        return false;
    return (options.meta || surface.shader->geometry.forceMeta) && !surface.shader->autosprite;
}

DrawSurface TriangleSurfaceOf(const DrawSurface &surface, int subdivisions) {
    const PatchMesh mesh = TessellatedSurface(surface, subdivisions);
    DrawSurface result = surface;
    result.kind = SurfaceKind::ForcedMeta;
    result.verts = mesh.verts;
    result.width = result.height = 0;
    result.longestCurve = 0;
    result.patch = -1;
    result.lightmapAxis = {};
    result.lightmapVecs = {};
    for (const auto &[a, b, c] : MeshTriangles(mesh))
        result.indexes.insert(result.indexes.end(), {a, b, c});
    return result;
}

bool Collides(const ShaderInfo &shader, const Game &game) {
    const SurfaceParm *clip = game.FindParm("playerclip");
    return (shader.compileFlags & C_SOLID) || (clip && (shader.contentFlags & clip->contentSet));
}

} // namespace

PatchMesh TessellatedSurface(const DrawSurface &surface, int subdivisions) {
    Patch patch;
    patch.shader = surface.shader;
    patch.width = surface.width, patch.height = surface.height;
    patch.verts = surface.verts;
    patch.longestCurve = surface.longestCurve;
    return TessellatePatch(patch, subdivisions);
}

void MakePatchMeshes(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context) {
    const std::size_t count = geometry.surfaces.size();
    for (std::size_t i = first; i < count; ++i) {
        const Patch *patch = PatchOf(geometry.surfaces[i], entity);
        if (!IsDrawnAsTriangles(geometry.surfaces[i], patch, context.options))
            continue;
        const int ofPatch = patch == nullptr ? 0 : patch->patchSubdivisions;
        const int subdivisions = ofPatch > 0 ? ofPatch : context.options.subdivisions;
        geometry.surfaces.push_back(TriangleSurfaceOf(geometry.surfaces[i], subdivisions));
        DrawSurface &source = geometry.surfaces[i];
        if (Collides(*source.shader, context.game))
            source.collisionOnly = true;
        else
            source.verts.clear();
    }
}

} // namespace q3
