// GPL-2.0-or-later. BSPX lumps of maps that were scaled, moved or merged.
#include "q3map2/edit/edit_lumps.h"

#include "common/error.h"
#include "q3map2/bspfile/bspx.h"
#include "q3map2/bspfile/prop_light.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

namespace q3 {

namespace {

/// What scaling or moving the world changes in a lump.
enum class LumpContent {
    Nothing,    ///< no positions: light, numbers, checksums
    Directions, ///< valid unless the axes are scaled by different factors
    Grid,       ///< a GridHead, then positions in cells
    Grids       ///< such grids, each after its length in bytes
};

struct LumpRule {
    std::string_view name;
    LumpContent content;
};

constexpr LumpRule kLumpRules[] = {
    {kBspxPropLight, LumpContent::Nothing},
    {kBspxGridOctree, LumpContent::Grid},
    {kBspxGrids, LumpContent::Grids},
    // Of other compilers: light and the layout of lightmaps, by face or luxel.
    {"RGBLIGHTING", LumpContent::Nothing},
    {"LIGHTINGDIR", LumpContent::Nothing},
    {"LIGHTINGDIR_E5BGR9", LumpContent::Nothing},
    {"LMSHIFT", LumpContent::Nothing},
    {"LMOFFSET", LumpContent::Nothing},
    {"LMSTYLE", LumpContent::Nothing},
    {"LMSTYLE16", LumpContent::Nothing},
    {"FACENORMALS", LumpContent::Directions},
    {"VERTEXNORMALS", LumpContent::Directions},
};

const LumpRule *RuleOf(std::string_view name) {
    const auto found = std::ranges::find(kLumpRules, name, &LumpRule::name);
    return found == std::end(kLumpRules) ? nullptr : found;
}

/// What the grids of both formats begin with.
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

bool TransformLengthsAndGrids(const AxisTransform &transform, std::span<std::byte> rest) {
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
    const Vec3d &by = transform.factors;
    switch (rule->content) {
    case LumpContent::Nothing:
        return true;
    case LumpContent::Directions:
        return by.x == by.y && by.y == by.z;
    case LumpContent::Grid:
        return TransformGrid(transform, lump.data);
    case LumpContent::Grids:
        return TransformLengthsAndGrids(transform, lump.data);
    }
    return false;
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

void MergeProps(const Bsp &main, const Bsp &added, std::string_view mainName, std::string_view addedName, Bsp &bsp,
                Log &log) {
    const BspxLump *first = FindPropLight(main), *second = FindPropLight(added);
    if (second == nullptr)
        return;
    try {
        PropLight light = first ? DecodePropLight(first->data) : PropLight{};
        AppendProps(DecodePropLight(second->data), StoredEntities(main.entities, mainName).size(), light);
        SetPropLight(bsp, light);
    } catch (const Error &error) {
        log.Warn(kBspxPropLight, "{}: the BSPX lump {} is dropped: {}", addedName, kBspxPropLight, error.what());
    }
}

bool IsGridLump(std::string_view name) {
    const LumpRule *rule = RuleOf(name);
    return rule && (rule->content == LumpContent::Grid || rule->content == LumpContent::Grids);
}

} // namespace

void TransformLumps(const AxisTransform &transform, Bsp &bsp, Log &log) {
    std::erase_if(bsp.bspx, [&](BspxLump &lump) {
        const bool keeps = TransformLump(transform, lump);
        if (!keeps)
            log.Warn(lump.name, "the BSPX lump {} ({} bytes) is dropped: it may hold positions{}", lump.name,
                     lump.data.size(), IsGridLump(lump.name) ? " and is damaged" : "");
        return !keeps;
    });
}

void MergeLumps(const Bsp &main, const Bsp &added, std::string_view mainName, std::string_view addedName, Bsp &bsp,
                Log &log) {
    std::erase_if(bsp.bspx, [&](const BspxLump &lump) {
        const bool keeps = IsGridLump(lump.name) || lump.name == kBspxPropLight;
        if (!keeps)
            log.Warn(lump.name, "{}: the BSPX lump {} ({} bytes) is dropped: it is for this map without the other",
                     mainName, lump.name, lump.data.size());
        return !keeps;
    });
    MergeProps(main, added, mainName, addedName, bsp, log);
    for (const BspxLump &lump : added.bspx) {
        if (lump.name == kBspxPropLight)
            continue;
        const bool isGrid = IsGridLump(lump.name);
        if (!isGrid || std::ranges::find(main.bspx, lump.name, &BspxLump::name) == main.bspx.end())
            log.Warn(lump.name, "{}: the BSPX lump {} ({} bytes) is dropped: {}", addedName, lump.name,
                     lump.data.size(),
                     isGrid ? "light grids are those of the first map" : "it is for this map without the other");
    }
    const auto grid = [&](bool inMain, bool inAdded, std::string_view what) {
        if (inAdded && !inMain)
            log.Warn(what,
                     "{}: the {} is dropped, since light grids are those of {}, which has none; light the merged map "
                     "to make one",
                     addedName, what, mainName);
    };
    grid(main.gridSH.has_value(), added.gridSH.has_value(), "SH light grid");
    grid(main.sparseGridSH.has_value(), added.sparseGridSH.has_value(), "sparse SH light grid");
    grid(!main.gridPoints.empty(), !added.gridPoints.empty(), "legacy light grid");
}

} // namespace q3
