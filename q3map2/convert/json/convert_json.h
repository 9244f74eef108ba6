// GPL-2.0-or-later. A compiled map as a folder of JSON files, and back. See docs/reference/json.md.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/shader/games.h"

#include <filesystem>
#include <string_view>

namespace q3 {

/// Calls visit(file, member prefix, records) for every lump that is a plain list of records, in the order in which the
/// files are written. All of them are required.
template <typename AnyBsp, typename Visit> void ForEachJsonFile(AnyBsp &bsp, Visit &&visit) {
    visit("shaders.json", "shader", bsp.shaders);
    visit("models.json", "model", bsp.models);
    visit("planes.json", "plane", bsp.planes);
    visit("leafs.json", "leaf", bsp.leafs);
    visit("nodes.json", "node", bsp.nodes);
    visit("LeafSurfaces.json", "LeafSurface", bsp.leafSurfaces);
    visit("LeafBrushes.json", "LeafBrush", bsp.leafBrushes);
    visit("Brushes.json", "Brush", bsp.brushes);
    visit("BrushSides.json", "BrushSide", bsp.brushSides);
    visit("DrawVert.json", "DrawVert", bsp.drawVerts);
    visit("DrawSurfaces.json", "DrawSurface", bsp.drawSurfaces);
    visit("fogs.json", "fog", bsp.fogs);
    visit("DrawIndexes.json", "DrawIndex", bsp.drawIndexes);
    visit("VisBytes.json", "VisByte", bsp.visibility);
    visit("LightBytes.json", "LightByte", bsp.lightmaps);
    visit("GridPoints.json", "GridPoint", bsp.gridPoints);
}

inline constexpr std::string_view kJsonEntities = "entities.json";

// Optional files, unknown to other programs: written only if the map has such data.
inline constexpr std::string_view kJsonEntityText =
    "entities.ent"; ///< written if the pairs in entities.json do not reproduce the text
inline constexpr std::string_view kJsonFormat = "format.json"; ///< written if the map is not IBSP
inline constexpr std::string_view kJsonAdvertisements = "Advertisements.json";
inline constexpr std::string_view kJsonBspx = "bspx.json"; ///< its entries name the files of lumps: kJsonLumps

/// Writes every lump as a JSON file into `folder` (made if missing). Streams: memory use does not grow with the lumps.
void UnpackJson(const Bsp &bsp, const Game &game, const std::filesystem::path &folder, Log &log);

// ---- Packing ----

struct PackJsonOptions {
    bool useFlagNames = false;     ///< bits come from the names in the game's table
    bool dropUnknownFlags = false; ///< with useFlagNames: unknown names are ignored
};

/// Reads what UnpackJson (or NetRadiant's q3map2's -json -unpack) wrote. Without kJsonFormat the map has the format
/// of `game`. The result is validated. Errors: Error
/// with file, member and what was expected.
Bsp PackJson(const std::filesystem::path &folder, const Game &game, const PackJsonOptions &options, Log &log);

} // namespace q3
