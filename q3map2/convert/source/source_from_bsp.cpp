// GPL-2.0-or-later. Decompiles a .bsp to a map source: its brushes as convex solids, their planes, entities and
// textures.
#include "q3map2/convert/source/source_from_bsp.h"
#include "q3map2/bspfile/switchable_lights.h"

#include "common/text/text.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/convert/source/source_writer.h"
#include "q3map2/convert/source/texture_form.h"
#include "q3map2/map/map_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace q3 {

// ---- Planes as the three points of map text ----

namespace {

constexpr double kSameDistance = 1e-7; ///< difference of equal plane distances, game units
constexpr double kSpacing = 256;       ///< between points that are not corners, game units

using ThreePoints = std::array<Vec3d, 3>;

/// Corners that span a large triangle: the first, the farthest from it, and the farthest from the line through both.
ThreePoints SpreadCorners(std::span<const Vec3d> winding) {
    const Vec3d &first = winding.front();
    const auto nearer = [&](const Vec3d &a, const Vec3d &b) { return Length(a - first) < Length(b - first); };
    const Vec3d &second = *std::ranges::max_element(winding, nearer);
    const auto offLine = [&](const Vec3d &p) { return Length(Cross(p - first, second - first)); };
    const Vec3d &third = *std::ranges::max_element(winding, {}, offLine);
    return {first, second, third};
}

/// The projection of `near` onto the plane, and two points of the plane kSpacing from it.
ThreePoints PointsApart(const Plane &plane, const Vec3d &near) {
    const Vec3d &n = plane.normal;
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const Vec3d axis = x <= y && x <= z ? Vec3d{1, 0, 0} : y <= z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
    const Vec3d u = Normalize(Cross(axis, n)), v = Cross(n, u);
    const Vec3d base = near - n * plane.Distance(near);
    return {base, base + u * kSpacing, base + v * kSpacing};
}

/// The points rounded to `decimals`, in the order that makes the plane face along `front`.
PlanePoints PrintedPoints(ThreePoints points, int decimals, const Vec3d &front) {
    PlanePoints printed;
    for (Vec3d &p : points)
        for (std::size_t axis = 0; axis < 3; ++axis)
            p[axis] = NumberFromText(FixedText(p[axis], decimals));
    printed.plane = PlaneThrough(points);
    if (Dot(printed.plane.normal, front) < 0) {
        std::swap(points[1], points[2]);
        printed.plane = PlaneThrough(points);
    }
    for (std::size_t i = 0; i < 3; ++i)
        printed.points[i] = fmt::format("( {} {} {} )", FixedText(points[i].x, decimals),
                                        FixedText(points[i].y, decimals), FixedText(points[i].z, decimals));
    return printed;
}

/// |value| 2^-24: half the distance from a power of two to the next float; between half of it and all of it for other
/// values.
double HalfStep(double value) {
    return std::abs(value) * double(std::numeric_limits<float>::epsilon()) / 2;
}

/// A unit vector that rounds to `normal`, whose length differs from 1 as its components were rounded to float. If there
/// is none, the normalized normal.
Vec3d UnitStoredAs(const Vec3d &normal) {
    // Each component may be off by `slack`, a share t of which is subtracted: |normal - t slack|^2 = 1 to first order
    // for t = excess / reach with excess = (|normal|^2 - 1) / 2 and reach = normal . slack.
    Vec3d slack;
    double reach = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (normal[axis] == 0)
            continue;
        // All floats of a binade are equally far apart; below its first one they are twice as dense.
        const double first = std::exp2(std::floor(std::log2(std::abs(normal[axis]))));
        const bool isFirst = std::abs(normal[axis]) == first;
        slack[axis] = std::copysign(HalfStep(first) * (isFirst ? 0.5 : 1), normal[axis]);
        reach += std::abs(slack[axis] * normal[axis]);
    }
    const double excess = (Dot(normal, normal) - 1) / 2;
    const Vec3d moved = normal - slack * (excess / reach);
    return std::abs(excess) <= reach ? Normalize(moved) : Normalize(normal);
}

/// Whether the planes are the same once they are stored as float.
bool AreSameStored(const Plane &a, const Plane &b) {
    // HalfStep / 2 is at most half the distance from the float b.dist to the next one.
    return Vec3f(a.normal) == Vec3f(b.normal) &&
           std::abs(a.dist - b.dist) <= std::max(kSameDistance, HalfStep(b.dist) / 2);
}

} // namespace

std::string PointText(const Vec3d &p) {
    return fmt::format("( {} {} {} )", ExactText(p.x), ExactText(p.y), ExactText(p.z));
}

Plane PlaneThrough(const ThreePoints &points) {
    const Vec3d normal = Normalize(Cross(points[2] - points[0], points[1] - points[0]));
    return {normal, Dot(normal, points[0])};
}

PlanePoints PointsOfPlane(const Plane &plane, std::span<const Vec3d> winding) {
    const Plane wanted{UnitStoredAs(Vec3d(Vec3f(plane.normal))), plane.dist};
    if (winding.size() >= 3)
        for (const int decimals : {3, 6}) {
            const PlanePoints points = PrintedPoints(SpreadCorners(winding), decimals, wanted.normal);
            if (AreSameStored(points.plane, wanted))
                return points;
        }
    Vec3d center;
    for (const Vec3d &p : winding)
        center += p / double(winding.size());
    const ThreePoints apart = PointsApart(wanted, center);
    constexpr int kMostDecimals = 12;
    for (int decimals = 3; decimals < kMostDecimals; decimals += 3) {
        const PlanePoints points = PrintedPoints(apart, decimals, wanted.normal);
        if (AreSameStored(points.plane, wanted))
            return points;
    }
    return PrintedPoints(apart, kMostDecimals, wanted.normal);
}

// ---- Brushes of a .bsp as convex polyhedra ----

namespace {

constexpr double kClipEpsilon = 1e-6;   ///< game units
constexpr std::size_t kFewestSides = 4; ///< of a solid: a tetrahedron

bool IsInWorld(const Winding<double> &winding) {
    return std::ranges::all_of(winding, [](const Vec3d &p) {
        return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= kMaxWorldCoord;
    });
}

/// Numbers of the named sides, in an order that compiles to the stored one. For each axial direction, 0 to 5, a
/// compiler appends a bevel if no side has it, then swaps the side that has it with the one at that place. This undoes
/// it for bevels.
std::vector<std::size_t> SourceOrderOfSides(const Bsp &bsp, const bspBrush_t &brush) {
    constexpr std::size_t kAxialSides = 6;
    std::vector<std::size_t> order(std::size_t(brush.numSides));
    std::iota(order.begin(), order.end(), std::size_t(brush.firstSide));
    const auto isBevel = [&](std::size_t side) { return IsUnnamed(SideShader(bsp, side)); };
    while (order.size() > kAxialSides && isBevel(order.back()))
        order.pop_back();
    for (std::size_t place = std::min(kAxialSides, order.size()); place-- > 0;)
        if (isBevel(order[place])) {
            std::swap(order[place], order.back());
            order.pop_back();
        }
    std::erase_if(order, isBevel);
    return order;
}

bool AreOpposite(const Plane &a, const Plane &b) {
    return a.normal == -b.normal && a.dist == -b.dist;
}

} // namespace

bool IsUnnamed(std::string_view shader) {
    return shader.empty() || EqualNoCase(shader, "noshader") || EqualNoCase(shader, "default");
}

std::string_view SideShader(const Bsp &bsp, std::size_t i) {
    return FieldName(bsp.shaders[std::size_t(bsp.brushSides[i].shaderNum)].shader);
}

bool IsModelClip(const Bsp &bsp, const bspBrush_t &brush) {
    int named = 0;
    for (std::int32_t i = 0; i < brush.numSides; ++i)
        named += !IsUnnamed(SideShader(bsp, std::size_t(brush.firstSide + i)));
    return named <= 1;
}

std::vector<RebuiltSide> RebuildBrush(const Bsp &bsp, const bspBrush_t &brush) {
    std::vector<std::size_t> numbers = SourceOrderOfSides(bsp, brush);
    if (IsModelClip(bsp, brush)) {
        numbers.resize(std::size_t(brush.numSides));
        std::iota(numbers.begin(), numbers.end(), std::size_t(brush.firstSide));
    }
    std::vector<RebuiltSide> sides;
    for (const std::size_t i : numbers) {
        const bspPlane_t &plane = bsp.planes[std::size_t(bsp.brushSides[i].planeNum)];
        sides.push_back({SideShader(bsp, i), {Vec3d(plane.normal), double(plane.dist)}, {}});
    }
    for (RebuiltSide &side : sides) {
        side.winding = BaseWinding(side.plane);
        for (const RebuiltSide &other : sides)
            if (&other != &side && !side.winding.empty() && !AreOpposite(other.plane, side.plane))
                ChopPolygon(side.winding, {-other.plane.normal, -other.plane.dist}, kClipEpsilon);
        if (!IsInWorld(side.winding))
            return {};
    }
    std::erase_if(sides, [](const RebuiltSide &side) { return side.winding.size() < 3; });
    if (sides.size() < kFewestSides)
        sides.clear();
    return sides;
}

std::vector<bool> BrushesInTheOpen(const Bsp &bsp) {
    std::vector<bool> open(bsp.brushes.size());
    for (const bspLeaf_t &leaf : bsp.leafs)
        for (std::int32_t i = 0; i < leaf.numBSPLeafBrushes && leaf.cluster != kSolidCluster; ++i)
            open[std::size_t(bsp.leafBrushes[std::size_t(leaf.firstBSPLeafBrush + i)])] = true;
    return open;
}

// ---- The map source: entities, brushes with their textures, patches ----

namespace {

constexpr int kDetailFlag = 0x8000000; ///< CONTENTS_DETAIL
/// Tolerance of written texture coordinates: more digits would only repeat the float rounding of the .bsp. Texels.
constexpr double kStoredError = 2e-4;
constexpr double kOriginHalfEdge = 8; ///< of origin brushes, game units
/// Scale of default texture axes: of sides whose axes are unknown, and of all sides with -fast. Game units per texel.
constexpr double kUnknownScale = 0.25, kFastScale = kDefaultTextureScale;
/// Shaders of sides whose texture axes are unknown (-wtf), and of sides without a shader.
constexpr std::string_view kUnknownTexture = "common/WTF", kUnnamedTexture = "common/caulk";

/// Writes one .bsp, entity by entity.
class Decompiler {
  public:
    Decompiler(const Bsp &bsp, std::string_view name, const DecompileOptions &options, const BspContext &context)
        : bsp_(bsp), name_(name), options_(options), context_(context), open_(BrushesInTheOpen(bsp)),
          writer_(options.form) {
        for (const bspShader_t &shader : bsp.shaders)
            context.shaders.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
    }

    std::string Write();

  private:
    void WriteEntity(const Entity &entity, std::size_t number);
    std::optional<std::size_t> ModelOf(const Entity &entity, std::size_t number) const;
    void WriteOriginBrush(const Vec3d &origin);
    void WriteBrush(std::size_t brush, std::size_t model, const Vec3d &origin, const TextureSamples &samples);
    SideWords WordsOfSide(const RebuiltSide &side, const Vec3d &origin, const TextureSamples &samples, int contents);
    void WritePatch(std::size_t surface, const Vec3d &origin);
    std::vector<std::size_t> SourceOrder(const bspModel_t &model) const;
    std::uint32_t CompileFlagsOf(std::size_t brush) const;
    bool IsDetail(std::size_t brush, std::size_t model) const;
    void PrintCounts() const;

    const Bsp &bsp_;
    std::string_view name_;
    const DecompileOptions &options_;
    const BspContext &context_;
    std::vector<bool> open_; ///< by brush: a leaf that is not solid holds it
    SourceWriter writer_;
    int entityCount_ = 0, brushCount_ = 0, detailCount_ = 0, patchCount_ = 0, modelClipCount_ = 0;
    int sideCount_ = 0, defaultAxesCount_ = 0;
};

std::string Decompiler::Write() {
    std::vector<Entity> entities = ParseEntities(bsp_.entities, name_);
    if (bsp_.ident != kIbspIdent)
        std::ranges::for_each(entities, RestoreLightStyle);
    for (std::size_t i = 0; i < entities.size(); ++i)
        WriteEntity(entities[i], i);
    PrintCounts();
    return writer_.Text();
}

void Decompiler::PrintCounts() const {
    Log &log = context_.log;
    log.Count(entityCount_, "entities");
    log.Count(brushCount_, "brushes");
    log.Count(detailCount_, "detail brushes");
    log.Count(modelClipCount_, "clip brushes of models, left out");
    log.Count(sideCount_, "sides");
    log.Count(defaultAxesCount_, "sides with default texture axes");
    log.Count(patchCount_, "patches");
}

/// Number of the entity's brush model, if it has one.
std::optional<std::size_t> Decompiler::ModelOf(const Entity &entity, std::size_t number) const {
    if (number == 0)
        return bsp_.models.empty() ? std::nullopt : std::optional<std::size_t>(0);
    const std::string_view model = entity.Value("model");
    if (!model.starts_with('*'))
        return std::nullopt;
    const std::optional<int> index = StrictInteger(model.substr(1));
    if (index && *index > 0 && std::size_t(*index) < bsp_.models.size())
        return std::size_t(*index);
    context_.log.Warn("missing model", "{}: entity {} has the model {}, and there are {}: it gets no brushes", name_,
                      number, model, bsp_.models.size());
    return std::nullopt;
}

void Decompiler::WriteEntity(const Entity &entity, std::size_t number) {
    ++entityCount_;
    const std::optional<std::size_t> model = ModelOf(entity, number);
    writer_.BeginEntity(int(number));
    for (const auto &[key, value] : entity.pairs) {
        const bool isModel = EqualNoCase(key, "model") && value.starts_with('*');
        if (!isModel && !(model && EqualNoCase(key, "origin")))
            writer_.WritePair(key, value);
    }
    if (model) {
        const Vec3d origin(number == 0 ? Vec3f{} : entity.Vector({"origin"}).value_or(Vec3f{}));
        if (origin != Vec3d{})
            WriteOriginBrush(origin);
        const bspModel_t &record = bsp_.models[*model];
        const TextureSamples samples(bsp_, *model, context_.shaders, context_.options.distanceEpsilon);
        for (const std::size_t brush : SourceOrder(record))
            WriteBrush(brush, *model, origin, samples);
        // A compiler writes the patch that it read last first.
        for (std::int32_t i = record.numBSPSurfaces - 1; i >= 0; --i)
            WritePatch(std::size_t(record.firstBSPSurface + i), origin);
    }
    writer_.EndEntity();
}

/// Writes a cube around the origin, with one image centered on each side.
void Decompiler::WriteOriginBrush(const Vec3d &origin) {
    const std::string shader(context_.game.originShader);
    const GeometryDirectives &directives = context_.shaders.Get("textures/" + shader).geometry;
    std::vector<SideWords> sides;
    for (const double sign : {1.0, -1.0})
        for (const std::size_t axis : {2u, 1u, 0u}) {
            Plane plane;
            plane.normal[axis] = sign;
            plane.dist = sign * origin[axis] + kOriginHalfEdge;
            Winding<double> corners;
            for (const auto &[u, v] : {std::pair{-1.0, -1.0}, {-1.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}}) {
                Vec3d corner = origin;
                corner[axis] += sign * kOriginHalfEdge;
                corner[(axis + 1) % 3] += u * kOriginHalfEdge, corner[(axis + 2) % 3] += v * kOriginHalfEdge;
                corners.push_back(corner);
            }
            const ProjectionAxes axes = ClassicAxes(plane.normal);
            TextureProjection texture;
            for (std::size_t row = 0; row < 2; ++row) {
                const Vec3d along = (row == 0 ? axes.s : axes.t) / (2 * kOriginHalfEdge);
                texture.vecs[row] = {along.x, along.y, along.z, 0.5 - Dot(along, origin)};
            }
            const PlanePoints points = PointsOfPlane(plane, corners);
            sides.push_back(
                {points.points,
                 shader,
                 TextureInForm(options_.form, {texture, points.plane, plane.normal, directives, corners}).words,
                 {}});
        }
    writer_.WriteBrush(-1, sides);
}

/// Compile flags of all sides of a brush, combined.
std::uint32_t Decompiler::CompileFlagsOf(std::size_t brush) const {
    const bspBrush_t &record = bsp_.brushes[brush];
    std::uint32_t flags = 0;
    for (std::int32_t i = 0; i < record.numSides; ++i)
        if (const std::string_view name = SideShader(bsp_, std::size_t(record.firstSide + i)); !IsUnnamed(name))
            flags |= context_.shaders.Get(name).compileFlags;
    return flags;
}

/// Numbers of the model's brushes in an order that compiles to the stored one. A compiler prepends opaque brushes to
/// its list and appends translucent ones. The order matters, for instance for which vertices are welded.
std::vector<std::size_t> Decompiler::SourceOrder(const bspModel_t &model) const {
    std::vector<std::size_t> opaque, others;
    for (std::int32_t i = 0; i < model.numBSPBrushes; ++i) {
        const std::size_t brush = std::size_t(model.firstBSPBrush + i);
        ((CompileFlagsOf(brush) & C_TRANSLUCENT) != 0 ? others : opaque).push_back(brush);
    }
    std::ranges::reverse(opaque);
    opaque.insert(opaque.end(), others.begin(), others.end());
    return opaque;
}

/// Structural solid brushes lie in solid leafs only, so a brush in another leaf is detail. Only the world has leafs.
bool Decompiler::IsDetail(std::size_t brush, std::size_t model) const {
    return model == 0 && open_[brush] && (CompileFlagsOf(brush) & C_STRUCTURAL) == 0;
}

void Decompiler::WriteBrush(std::size_t brush, std::size_t model, const Vec3d &origin, const TextureSamples &samples) {
    const bspBrush_t &record = bsp_.brushes[brush];
    if (!options_.keepModelClip && IsModelClip(bsp_, record)) {
        ++modelClipCount_;
        return;
    }
    std::vector<RebuiltSide> sides = RebuildBrush(bsp_, record);
    // A compiler takes the contents from the first side, unless a later one is a liquid, fog or clip.
    const std::string_view contents = FieldName(bsp_.shaders[std::size_t(record.shaderNum)].shader);
    const auto first =
        std::ranges::find_if(sides, [&](const RebuiltSide &side) { return EqualNoCase(side.shader, contents); });
    if (first != sides.end())
        std::swap(sides.front(), *first);
    if (sides.empty()) {
        context_.log.Warn("brush without volume", "{}: brush {} encloses nothing or leaves the world: it is left out",
                          name_, brush);
        return;
    }
    const bool isDetail = IsDetail(brush, model);
    std::vector<SideWords> words;
    for (const RebuiltSide &side : sides)
        words.push_back(WordsOfSide(side, origin, samples, isDetail ? kDetailFlag : 0));
    writer_.WriteBrush(int(brush), words);
    ++brushCount_;
    detailCount_ += isDetail;
}

SideWords Decompiler::WordsOfSide(const RebuiltSide &side, const Vec3d &origin, const TextureSamples &samples,
                                  int contents) {
    const GeometryDirectives &directives = context_.shaders.Get(side.shader).geometry;
    const Plane moved{side.plane.normal, side.plane.dist + Dot(side.plane.normal, origin)};
    Winding<double> corners = side.winding;
    for (Vec3d &p : corners)
        p += origin;
    const PlanePoints points = PointsOfPlane(moved, corners);
    SideWords words{points.points, std::string(WithoutTexturesFolder(side.shader)), {}, {contents, 0, 0}};
    ++sideCount_;
    if (IsUnnamed(side.shader))
        words.shader = kUnnamedTexture;
    if (options_.withTextures)
        if (auto texture = samples.Find(side.shader, directives, side.plane, side.winding)) {
            for (auto &row : texture->vecs)
                row[3] -= Dot(Vec3d{row[0], row[1], row[2]}, origin);
            words.texture =
                TextureInForm(options_.form, {*texture, points.plane, moved.normal, directives, corners, kStoredError})
                    .words;
            return words;
        }
    ++defaultAxesCount_;
    words.texture = DefaultTexture(options_.form, moved.normal, options_.withTextures ? kUnknownScale : kFastScale);
    const bool isTool = words.shader.starts_with("common/") || words.shader.starts_with("system/");
    if (options_.markUnknown && !isTool)
        words.shader = kUnknownTexture;
    return words;
}

void Decompiler::WritePatch(std::size_t surface, const Vec3d &origin) {
    const bspDrawSurface_t &record = bsp_.drawSurfaces[surface];
    if (record.surfaceType != MST_PATCH)
        return;
    const std::string_view name = FieldName(bsp_.shaders[std::size_t(record.shaderNum)].shader);
    const GeometryDirectives &directives = context_.shaders.Get(name).geometry;
    PatchWords patch{.shader = std::string(WithoutTexturesFolder(name)),
                     .header = {"0", "0", "0"},
                     .width = record.patchWidth,
                     .height = record.patchHeight};
    if (std::int64_t(patch.width) * patch.height > record.numVerts)
        return;
    for (std::int32_t i = 0; i < patch.width * patch.height; ++i) {
        const bspDrawVert_t &from = bsp_.drawVerts[std::size_t(record.firstVert + i)];
        DrawVert v;
        v.xyz = Vec3f(Vec3d(Vec3f(from.xyz) - Vec3f(from.normal) * directives.offset) + origin);
        const std::array<double, 2> st = WithoutTexMod(from.st, directives);
        v.st = {float(st[0]), float(st[1])};
        patch.verts.push_back(v);
    }
    writer_.WritePatch(int(surface), patch);
    ++patchCount_;
}

} // namespace

std::string DecompiledSource(const Bsp &bsp, std::string_view name, const DecompileOptions &options,
                             const BspContext &context) {
    return Decompiler(bsp, name, options, context).Write();
}

} // namespace q3
