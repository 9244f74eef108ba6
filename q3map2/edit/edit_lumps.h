// GPL-2.0-or-later. BSPX lumps, light grids and entity text of maps that were scaled, moved or merged.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/entities.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// Six decimals, without zeros at the end.
std::string NumberText(double number);
/// The three numbers, with blanks between them.
std::string VectorText(const Vec3d &v);

/// Cell of the legacy grid: worldspawn's gridsize, or 64 64 128 where it is missing or no size.
Float3 GridCellOf(const Entity &world);

/// How positions of a map change: times `factors`, then plus `shift`.
struct AxisTransform {
    Vec3d factors{1, 1, 1}, shift;

    /// Whether shapes keep their proportions.
    bool IsUniform() const { return factors.x == factors.y && factors.y == factors.z; }
    float Apply(float value, std::size_t axis) const { return float(double(value) * factors[axis] + shift[axis]); }
    Float3 Apply(const Float3 &p) const { return {Apply(p[0], 0), Apply(p[1], 1), Apply(p[2], 2)}; }
};

/// Transforms the box of a node or leaf outward to whole units, which are at most 2^30 from 0. An empty box stays.
void TransformBox(const AxisTransform &transform, Int3 &mins, Int3 &maxs);

/// Takes the grids of `before` over to `bsp`, the transformed map with transformed world bounds and a gridsize that
/// fits. The head of the SH grid says where its points are, so they move exactly. Engines derive the points of the
/// legacy grid from world bounds and gridsize: where that does not give the transformed points, the grid is dropped
/// with a warning. World bounds and gridsize may change by rounding. All other BSPX lumps are edited too: by LumpEdits
/// and TransformRawLumps.
void TransformLumps(const Bsp &before, const AxisTransform &transform, Bsp &bsp, Log &log);

/// Edits the BSPX lumps that Bsp has no members for: keeps those without positions and transforms positions in known
/// formats. Others may hold positions: each is dropped with a warning.
void TransformRawLumps(const AxisTransform &transform, Bsp &bsp, Log &log);

/// Two maps whose records are merged already.
struct LumpMerge {
    const Bsp &main, &added;
    std::string_view mainName, addedName;
    Bsp &merged; ///< `main` with the records and entities of `added` after its own
    Log &log;
    int lightmapBase = 0; ///< number in `merged` of the first lightmap of `added`
    /// The runs of vertices of `added` that were copied, first (its number in `added`) and count, in the order in which
    /// they follow those of `main` in `merged`.
    std::vector<std::pair<int, int>> vertRuns;
};

/// Merges the lumps: light of surfaces and static props is that of both maps, light grids are those of `main`. Other
/// lumps fit neither the records nor the entities of the merged map: each is dropped with a warning, as are grids of
/// `added` if `main` has none.
void MergeLumps(const LumpMerge &maps);

/// What becomes of a lump's light if axes are scaled by different factors, which turns normals.
enum class UnevenScaling {
    KeepsLight, ///< it belongs to records of the map
    SpoilsLight ///< it is stored by direction
};

/// An edit of a lump.
struct LumpEdit {
    BspxId id;
    UnevenScaling unevenScaling;
    /// Only for maps that have the lump. Null: it has no positions.
    void (*transform)(const AxisTransform &transform, Bsp &bsp);
    /// Makes the lump of LumpMerge::merged, which begins as that of `main`.
    void (*merge)(const LumpMerge &maps);
};

/// A row for each lump, in the order in which they are merged.
std::span<const LumpEdit> LumpEdits();

/// Warns that light grids are those of the main map, if it lacks one that the other has. `what`: the grid.
void WarnOfLostGrid(const LumpMerge &maps, bool inMain, bool inAdded, std::string_view what);

/// Whether the map has lumps with UnevenScaling::SpoilsLight.
bool IsSpoiledByUnevenScaling(const Bsp &bsp);

} // namespace q3
