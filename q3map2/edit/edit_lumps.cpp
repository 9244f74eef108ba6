// GPL-2.0-or-later. BSPX lumps, light grids and entity text of maps that were scaled, moved or merged.
#include "q3map2/edit/edit_lumps.h"

#include "common/error.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

namespace q3 {

// ---- Text and boxes of edited maps ----

namespace {

constexpr double kMostBound = 1 << 30; ///< game units; limit of this program, chosen: an int holds it

std::int32_t WholeBound(double bound) {
    return std::int32_t(std::clamp(bound, -kMostBound, kMostBound));
}

} // namespace

std::string NumberText(double number) {
    std::string text = fmt::format("{:.6f}", number);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.')
        text.pop_back();
    return text == "-0" ? "0" : text;
}

std::string VectorText(const Vec3d &v) {
    return NumberText(v.x) + ' ' + NumberText(v.y) + ' ' + NumberText(v.z);
}

void TransformBox(const AxisTransform &transform, Int3 &mins, Int3 &maxs) {
    for (std::size_t i = 0; i < 3 && mins[i] <= maxs[i]; ++i) {
        mins[i] = WholeBound(std::floor(mins[i] * transform.factors[i] + transform.shift[i]));
        maxs[i] = WholeBound(std::ceil(maxs[i] * transform.factors[i] + transform.shift[i]));
    }
}

// ---- Light grids of a map whose world was scaled or moved ----

namespace {

/// Positions that differ by less than this fraction of a cell are the same.
constexpr double kSamePlace = 1e-3;
/// Chosen: how many floats next to a bound are tried, upward and downward, and how many sizes of a cell.
constexpr int kMostSteps = 16;
/// Fraction of a cell by which each step shrinks it: the last decimal of NumberText for cells of 1.
constexpr double kCellStep = 1e-6;

/// A bound of the world along an axis. Engines place the first grid point at cell * ceil(mins / cell), the last one at
/// cell * floor(maxs / cell).
enum class BoundSide { Mins, Maxs };

/// The bound, or a float near it, that makes engines place its grid point at `wanted`.
float NudgedBound(float bound, float cell, double wanted, BoundSide side) {
    const auto fits = [&](float value) {
        const double place =
            double(cell * (side == BoundSide::Mins ? std::ceil(value / cell) : std::floor(value / cell)));
        return std::abs(place - wanted) < kSamePlace * double(cell);
    };
    float down = bound, up = bound;
    for (int step = 0; step <= kMostSteps; ++step) {
        if (fits(down))
            return down;
        if (fits(up))
            return up;
        down = std::nextafter(down, -std::numeric_limits<float>::infinity());
        up = std::nextafter(up, std::numeric_limits<float>::infinity());
    }
    return bound;
}

bool IsSameOnAxis(const GridLayout &a, const GridLayout &b, std::size_t axis) {
    return a.bounds[axis] == b.bounds[axis] &&
           std::abs(a.mins[axis] - b.mins[axis]) <= float(kSamePlace) * a.size[axis];
}

/// Changes a cell and the bounds of the world by rounding steps until the rule of engines gives the wanted points along
/// the axis. False: it does not.
bool FitAxis(const GridLayout &wanted, std::size_t axis, bspModel_t &world, Float3 &cell) {
    for (int step = 0; step <= kMostSteps; ++step) {
        const std::string text = NumberText(double(wanted.size[axis]) * (1 - step * kCellStep));
        bspModel_t model = world;
        Float3 size = cell;
        size[axis] = float(NumberFromText(text));
        const double first = double(wanted.mins[axis]), count = wanted.bounds[axis] - 1;
        model.mins[axis] = NudgedBound(model.mins[axis], size[axis], first, BoundSide::Mins);
        model.maxs[axis] =
            NudgedBound(model.maxs[axis], size[axis], first + double(size[axis]) * count, BoundSide::Maxs);
        if (IsSameOnAxis(wanted, LayoutGrid(model.mins, model.maxs, size), axis)) {
            world = model;
            cell = size;
            return true;
        }
    }
    return false;
}

/// Whether the legacy grid of `before` is where it belongs in `bsp`, whose world bounds and gridsize may change by
/// rounding.
bool FitLegacyGrid(const Bsp &before, const AxisTransform &transform, Bsp &bsp) {
    std::vector<Entity> entities = StoredEntities(bsp.entities, "the map");
    try {
        const bspModel_t &old = before.models[0];
        GridLayout wanted =
            LayoutGrid(old.mins, old.maxs, GridCellOf(StoredEntities(before.entities, "the map").front()));
        if (wanted.Count() != std::int64_t(bsp.gridPoints.size()))
            return false;
        wanted.mins = transform.Apply(wanted.mins);
        wanted.size = GridCellOf(entities.front());
        Float3 cell = wanted.size;
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (!FitAxis(wanted, axis, bsp.models[0], cell))
                return false;
        if (cell != wanted.size) {
            entities.front().Set("gridsize", VectorText(Vec3d(cell)));
            bsp.entities = FormatEntities(entities);
        }
        return true;
    } catch (const Error &) { // no grid can be laid out
        return false;
    }
}

} // namespace

Float3 GridCellOf(const Entity &world) {
    const auto given = world.Vector({"gridsize"});
    if (!given || given->x <= 0 || given->y <= 0 || given->z <= 0)
        return kDefaultGridSize;
    return given->Array();
}

void TransformLumps(const Bsp &before, const AxisTransform &transform, Bsp &bsp, Log &log) {
    if (!bsp.gridPoints.empty() && !FitLegacyGrid(before, transform, bsp)) {
        bsp.gridPoints.clear();
        log.Warn("light grid", "the legacy light grid is dropped: engines would look for its points elsewhere; "
                               "-light -onlygrid makes a new one");
    }
    for (const LumpEdit &edit : LumpEdits())
        if (edit.transform != nullptr && RowOf(edit.id).has(bsp))
            edit.transform(transform, bsp);
    TransformRawLumps(transform, bsp, log);
}

// ---- BSPX lumps of maps that were scaled, moved or merged ----

namespace {

/// What scaling or moving the world changes in a lump.
enum class LumpContent {
    NoPositions, ///< light, numbers, checksums
    Directions,  ///< valid unless the axes are scaled by different factors
    Grid,        ///< a GridHead, then positions in cells
    Grids        ///< such grids, each after its length in bytes
};

struct LumpRule {
    std::string_view name;
    LumpContent content;
};

constexpr LumpRule kLumpRules[] = {
    {kBspxGridOctree, LumpContent::Grid},
    {kBspxGrids, LumpContent::Grids},
    // Lumps of other compilers, with light or the layout of lightmaps for each face or luxel.
    {"RGBLIGHTING", LumpContent::NoPositions},
    {"LIGHTINGDIR", LumpContent::NoPositions},
    {"LIGHTINGDIR_E5BGR9", LumpContent::NoPositions},
    {"LMSHIFT", LumpContent::NoPositions},
    {"LMOFFSET", LumpContent::NoPositions},
    {"LMSTYLE", LumpContent::NoPositions},
    {"LMSTYLE16", LumpContent::NoPositions},
    {"FACENORMALS", LumpContent::Directions},
    {"VERTEXNORMALS", LumpContent::Directions},
};

const LumpRule *RuleOf(std::string_view name) {
    const auto found = std::ranges::find(kLumpRules, name, &LumpRule::name);
    return found == std::end(kLumpRules) ? nullptr : found;
}

/// What the grids of LIGHTGRID_OCTREE and LIGHTGRIDS begin with.
struct GridHead {
    Float3 cell;
    Int3 counts;
    Float3 mins;
};
static_assert(kPinned<GridHead, 36>);

/// False: the lump is too short for a head.
bool TransformGrid(const AxisTransform &transform, std::span<std::byte> grid) {
    GridHead head{};
    if (grid.size() < sizeof head)
        return false;
    std::memcpy(&head, grid.data(), sizeof head);
    for (std::size_t i = 0; i < 3; ++i)
        head.cell[i] = float(double(head.cell[i]) * transform.factors[i]);
    head.mins = transform.Apply(head.mins);
    std::memcpy(grid.data(), &head, sizeof head);
    return true;
}

/// Grids, each after its length in bytes. False: the lump ends within one.
bool TransformGridList(const AxisTransform &transform, std::span<std::byte> rest) {
    while (!rest.empty()) {
        std::uint32_t length = 0;
        if (rest.size() < sizeof length)
            return false;
        std::memcpy(&length, rest.data(), sizeof length);
        rest = rest.subspan(sizeof length);
        if (length > rest.size() || !TransformGrid(transform, rest.first(length)))
            return false;
        rest = rest.subspan(length);
    }
    return true;
}

/// False: the lump cannot be kept.
bool TransformLump(const AxisTransform &transform, BspxLump &lump) {
    const LumpRule *rule = RuleOf(lump.name);
    if (rule == nullptr)
        return false;
    switch (rule->content) {
    case LumpContent::NoPositions:
        return true;
    case LumpContent::Directions:
        return transform.IsUniform();
    case LumpContent::Grid:
        return TransformGrid(transform, lump.data);
    case LumpContent::Grids:
        return TransformGridList(transform, lump.data);
    }
    return false;
}

bool IsGridLump(std::string_view name) {
    const LumpRule *rule = RuleOf(name);
    return rule && (rule->content == LumpContent::Grid || rule->content == LumpContent::Grids);
}

} // namespace

void TransformRawLumps(const AxisTransform &transform, Bsp &bsp, Log &log) {
    std::erase_if(bsp.bspx, [&](BspxLump &lump) {
        const bool keeps = TransformLump(transform, lump);
        if (!keeps)
            log.Warn(lump.name, "the BSPX lump {} ({} bytes) is dropped: it may hold positions{}", lump.name,
                     lump.data.size(), IsGridLump(lump.name) ? " and is damaged" : "");
        return !keeps;
    });
}

void MergeLumps(const LumpMerge &maps) {
    std::erase_if(maps.merged.bspx, [&](const BspxLump &lump) {
        const bool keeps = IsGridLump(lump.name);
        if (!keeps)
            maps.log.Warn(lump.name, "{}: the BSPX lump {} ({} bytes) is dropped: it is for this map without the other",
                          maps.mainName, lump.name, lump.data.size());
        return !keeps;
    });
    for (const BspxLump &lump : maps.added.bspx) {
        const bool isGrid = IsGridLump(lump.name);
        if (!isGrid || std::ranges::find(maps.main.bspx, lump.name, &BspxLump::name) == maps.main.bspx.end())
            maps.log.Warn(lump.name, "{}: the BSPX lump {} ({} bytes) is dropped: {}", maps.addedName, lump.name,
                          lump.data.size(),
                          isGrid ? "light grids are those of the first map" : "it is for this map without the other");
    }
    for (const LumpEdit &edit : LumpEdits())
        edit.merge(maps);
    WarnOfLostGrid(maps, !maps.main.gridPoints.empty(), !maps.added.gridPoints.empty(), "legacy light grid");
}

// ---- What scaling, moving and merging do with each BSPX lump that Bsp has a member for ----

namespace {

// ---- Scaled and moved maps ----

void TransformUniformGrid(const AxisTransform &transform, Bsp &bsp) {
    bspGridSHHeader_t &head = bsp.gridSH->header;
    head.gridMins = transform.Apply(head.gridMins);
    for (std::size_t i = 0; i < 3; ++i)
        head.gridSize[i] = float(double(head.gridSize[i]) * transform.factors[i]);
}

void TransformSparseGrid(const AxisTransform &transform, Bsp &bsp) {
    SparseGridSH &grid = *bsp.sparseGridSH;
    grid.mins = transform.Apply(grid.mins);
    for (std::size_t i = 0; i < 3; ++i)
        grid.cell[i] = float(double(grid.cell[i]) * transform.factors[i]);
}

/// A direction that moves with the map, and stays as it is unless axes are scaled by different factors.
void TransformDirection(const AxisTransform &transform, Float3 &direction) {
    if (!transform.IsUniform() && direction != Float3{})
        direction = Vec3f(Normalize(Vec3d(direction) * transform.factors)).Array();
}

/// Lengths of falloff and cone times `f`. Light stays the same at positions that are as many times as far away: what
/// falls off with the square of the distance needs f^2 times the photons.
void ScaleLight(float f, GridLight &light) {
    const bool hasPlace = light.type == SHGRID_POINT || light.type == SHGRID_SPOT;
    if (hasPlace && (light.curve == SHGRID_INVERSE_SQUARE || light.curve == SHGRID_WINDOWED))
        light.intensity *= f * f;
    for (float *length :
         {&light.extraDist, &light.end, &light.fadeFrom, &light.flatFrom, &light.nearest, &light.coneFade})
        *length *= f;
    light.fade /= f, light.linear /= f, light.quadratic /= f * f;
}

/// The plane of a polygon whose vertices move, and its size.
void TransformPolygon(const AxisTransform &transform, GridPolygon &polygon) {
    const Vec3d &factors = transform.factors;
    // Points p of the plane have (normal / factors) . (factors p) = dist.
    const Vec3d normal = Vec3d(polygon.normal) * Vec3d{1 / factors.x, 1 / factors.y, 1 / factors.z};
    const double length = Length(normal);
    if (length > 0) {
        if (!transform.IsUniform())
            polygon.normal = Vec3f(normal / length).Array();
        polygon.dist = float(double(polygon.dist) / length + Dot(Vec3d(polygon.normal), transform.shift));
        polygon.area = float(double(polygon.area) * (factors.x * factors.y * factors.z * length));
    }
    polygon.center = transform.Apply(polygon.center);
    polygon.radius = float(double(polygon.radius) * std::max({factors.x, factors.y, factors.z}));
}

/// Moves a grid with its lights. An even scaling keeps their light; with another one it is that of lights of a mean
/// size, and polygons stay planar.
void TransformNamedGrid(const AxisTransform &transform, Bsp &bsp) {
    NamedGridSH &grid = *bsp.namedGridSH;
    grid.mins = transform.Apply(grid.mins);
    for (std::size_t i = 0; i < 3; ++i)
        grid.cell[i] = float(double(grid.cell[i]) * transform.factors[i]);
    const auto f = float(std::cbrt(transform.factors[0] * transform.factors[1] * transform.factors[2]));
    for (GridLight &light : grid.table.lights) {
        light.origin = transform.Apply(light.origin);
        TransformDirection(transform, light.normal);
        ScaleLight(f, light);
    }
    for (Float3 &vertex : grid.table.vertices)
        vertex = transform.Apply(vertex);
    for (GridPolygon &polygon : grid.table.polygons)
        TransformPolygon(transform, polygon);
}

// ---- Merged maps ----

/// Whether both maps have the lump. If only one has it, the other has no light to fill it with.
bool IsInBoth(const LumpMerge &maps, BspxId id) {
    const BspxRow &row = RowOf(id);
    const bool inMain = row.has(maps.main), inAdded = row.has(maps.added);
    if (inMain != inAdded)
        maps.log.Warn(row.name, "the BSPX lump {} is dropped: only {} has it", row.name,
                      inMain ? maps.mainName : maps.addedName);
    return inMain && inAdded;
}

/// Pages of the second map follow those of the first.
void MergeHdrLightmaps(const LumpMerge &maps) {
    std::vector<std::uint32_t> &codes = maps.merged.lightmapsE5bgr9;
    if (IsInBoth(maps, BspxId::LightmapsE5bgr9))
        codes.insert(codes.end(), maps.added.lightmapsE5bgr9.begin(), maps.added.lightmapsE5bgr9.end());
    else
        codes.clear();
}

void MergeVertexLight(const LumpMerge &maps) {
    std::vector<std::uint32_t> &codes = maps.merged.vertexE5bgr9;
    if (!IsInBoth(maps, BspxId::VertexE5bgr9)) {
        codes.clear();
        return;
    }
    for (const auto &[first, count] : maps.vertRuns) {
        const auto begin = maps.added.vertexE5bgr9.begin() + first;
        codes.insert(codes.end(), begin, begin + count);
    }
}

/// RNM pages name their lightmap, so they are kept even if only one of the maps has them.
void MergeRnm(const LumpMerge &maps) {
    const std::optional<RnmLightmaps> &added = maps.added.rnm;
    std::optional<RnmLightmaps> &rnm = maps.merged.rnm;
    if (!added)
        return;
    if (!rnm) {
        rnm.emplace().header = added->header;
        rnm->header.pageCount = 0;
    }
    if (rnm->header.side != added->header.side || rnm->header.storage != added->header.storage) {
        maps.log.Warn(kBspxRnm, "{}: the BSPX lump {} is dropped: its page side or storage differs from that of {}",
                      maps.addedName, kBspxRnm, maps.mainName);
        return;
    }
    for (const RnmPage &page : added->pages) {
        rnm->pages.push_back(page);
        rnm->pages.back().lightmapNum += maps.lightmapBase;
        ++rnm->header.pageCount;
    }
}

/// Adds the props of the second map. Its entities, without its worldspawn, begin at `firstEntity` of the merged map.
void AppendProps(const PropLight &added, std::size_t firstEntity, PropLight &light) {
    const auto meshes = std::uint32_t(light.meshes.size()), colors = std::uint32_t(light.colors.size());
    for (bspPropLight_t prop : added.props) {
        if (prop.entity == 0)
            throw Error("prop light of worldspawn, which is not in the merged map");
        prop.entity += std::uint32_t(firstEntity - 1);
        prop.firstMesh += meshes;
        light.props.push_back(prop);
    }
    for (bspPropMesh_t mesh : added.meshes) {
        mesh.firstColor += colors;
        light.meshes.push_back(mesh);
    }
    light.colors.insert(light.colors.end(), added.colors.begin(), added.colors.end());
}

void MergeProps(const LumpMerge &maps) {
    if (!maps.added.propLight)
        return;
    try {
        PropLight light = maps.main.propLight.value_or(PropLight{});
        AppendProps(*maps.added.propLight, StoredEntities(maps.main.entities, maps.mainName).size(), light);
        maps.merged.propLight = std::move(light);
    } catch (const Error &error) {
        maps.log.Warn(kBspxPropLight, "{}: the BSPX lump {} is dropped: {}", maps.addedName, kBspxPropLight,
                      error.what());
    }
}

void KeepUniformGrid(const LumpMerge &maps) {
    WarnOfLostGrid(maps, maps.main.gridSH.has_value(), maps.added.gridSH.has_value(), "SH light grid");
}

void KeepSparseGrid(const LumpMerge &maps) {
    WarnOfLostGrid(maps, maps.main.sparseGridSH.has_value(), maps.added.sparseGridSH.has_value(),
                   "sparse SH light grid");
}

void KeepNamedGrid(const LumpMerge &maps) {
    WarnOfLostGrid(maps, maps.main.namedGridSH.has_value(), maps.added.namedGridSH.has_value(),
                   "SH light grid that names lights");
}

/// The leafs of the merged map are those of the first.
void KeepCubes(const LumpMerge &maps) {
    if (maps.added.ambientCubes)
        maps.log.Warn(kBspxAmbientCubes, "{}: the BSPX lump {} is dropped: its leafs are not in the merged map",
                      maps.addedName, kBspxAmbientCubes);
}

constexpr LumpEdit kLumpEdits[] = {
    {BspxId::LightmapsE5bgr9, UnevenScaling::KeepsLight, nullptr, MergeHdrLightmaps},
    {BspxId::VertexE5bgr9, UnevenScaling::KeepsLight, nullptr, MergeVertexLight},
    {BspxId::Rnm, UnevenScaling::KeepsLight, nullptr, MergeRnm},
    {BspxId::PropLight, UnevenScaling::KeepsLight, nullptr, MergeProps},
    {BspxId::LightGridSH, UnevenScaling::SpoilsLight, TransformUniformGrid, KeepUniformGrid},
    {BspxId::SparseGridSH, UnevenScaling::SpoilsLight, TransformSparseGrid, KeepSparseGrid},
    {BspxId::NamedGridSH, UnevenScaling::SpoilsLight, TransformNamedGrid, KeepNamedGrid},
    // A cube's position is a fraction of its leaf's box on each axis, so it moves with the leaf.
    {BspxId::AmbientCubes, UnevenScaling::SpoilsLight, nullptr, KeepCubes},
};
static_assert(HasRowOfEachLump(kLumpEdits));

} // namespace

std::span<const LumpEdit> LumpEdits() {
    return kLumpEdits;
}

void WarnOfLostGrid(const LumpMerge &maps, bool inMain, bool inAdded, std::string_view what) {
    if (inAdded && !inMain)
        maps.log.Warn(what,
                      "{}: the {} is dropped, since light grids are those of {}, which has none; light the merged map "
                      "to make one",
                      maps.addedName, what, maps.mainName);
}

bool IsSpoiledByUnevenScaling(const Bsp &bsp) {
    return std::ranges::any_of(kLumpEdits, [&](const LumpEdit &edit) {
        return edit.unevenScaling == UnevenScaling::SpoilsLight && RowOf(edit.id).has(bsp);
    });
}

} // namespace q3
