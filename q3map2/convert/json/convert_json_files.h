// GPL-2.0-or-later. Names of the files of a JSON folder and of their members. See docs/json.md.
#pragma once

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
inline constexpr std::string_view kJsonAdvertisements = "Advertisements.json";
inline constexpr std::string_view kJsonGridSH = "GridPointsSH.json";
inline constexpr std::string_view kJsonBspx = "bspx.json";

// Files that entries of bspx.json name.
inline constexpr std::string_view kJsonLightmapsE5bgr9 = "LightTexelsE5BGR9.json";
inline constexpr std::string_view kJsonVertexE5bgr9 = "DrawVertE5BGR9.json";
inline constexpr std::string_view kJsonRnm = "LightTexelsRNM.json";
inline constexpr std::string_view kJsonSparseGrid = "GridPointsSHSparse.json";
inline constexpr std::string_view kJsonCubes = "AmbientCubes.json";
inline constexpr std::string_view kJsonPropLight = "PropLight.json";

// Members of files.
inline constexpr std::string_view kJsonCodes = "colors";
inline constexpr std::string_view kJsonRnmStorage = "storage", kJsonRnmSide = "side", kJsonRnmPages = "lightmapNums";
inline constexpr std::string_view kJsonRnmRaw = "raw", kJsonRnmRescaled = "rescaled";

inline constexpr std::string_view kJsonCubeLeafs = "leafs", kJsonCubeSamples = "samples";
inline constexpr std::string_view kJsonProps = "props";
inline constexpr std::string_view kJsonGridSHHeader = "header", kJsonGridSHPoints = "points";
inline constexpr std::string_view kJsonSparseNodes = "nodes";

} // namespace q3
