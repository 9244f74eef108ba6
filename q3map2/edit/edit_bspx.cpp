// GPL-2.0-or-later. What scaling, moving and merging do with each BSPX lump that Bsp has a member for.
#include "q3map2/edit/edit_bspx.h"

#include "common/error.h"

#include <algorithm>

namespace q3 {

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
    std::vector<std::uint32_t> &codes = maps.bsp.lightmapsE5bgr9;
    if (IsInBoth(maps, BspxId::LightmapsE5bgr9))
        codes.insert(codes.end(), maps.added.lightmapsE5bgr9.begin(), maps.added.lightmapsE5bgr9.end());
    else
        codes.clear();
}

void MergeVertexLight(const LumpMerge &maps) {
    std::vector<std::uint32_t> &codes = maps.bsp.vertexE5bgr9;
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
    std::optional<RnmLightmaps> &rnm = maps.bsp.rnm;
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
        maps.bsp.propLight = std::move(light);
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

/// The leafs of the merged map are those of the first.
void KeepCubes(const LumpMerge &maps) {
    if (maps.added.ambientCubes)
        maps.log.Warn(kBspxAmbientCubes, "{}: the BSPX lump {} is dropped: its leafs are not in the merged map",
                      maps.addedName, kBspxAmbientCubes);
}

constexpr LumpEdit kLumpEdits[] = {
    {BspxId::LightmapsE5bgr9, LumpSpace::None, nullptr, MergeHdrLightmaps},
    {BspxId::VertexE5bgr9, LumpSpace::None, nullptr, MergeVertexLight},
    {BspxId::Rnm, LumpSpace::None, nullptr, MergeRnm},
    {BspxId::PropLight, LumpSpace::None, nullptr, MergeProps},
    {BspxId::LightGridSH, LumpSpace::Directions, TransformUniformGrid, KeepUniformGrid},
    {BspxId::SparseGridSH, LumpSpace::Directions, TransformSparseGrid, KeepSparseGrid},
    // Positions of cubes are shares of their leafs.
    {BspxId::AmbientCubes, LumpSpace::Directions, nullptr, KeepCubes},
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

bool HasDirections(const Bsp &bsp) {
    return std::ranges::any_of(kLumpEdits, [&](const LumpEdit &edit) {
        return edit.space == LumpSpace::Directions && RowOf(edit.id).has(bsp);
    });
}

} // namespace q3
