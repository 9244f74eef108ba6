// GPL-2.0-or-later. The members of every JSON record, in order, for reading and writing alike. See
// docs/reference/json.md.
#pragma once

#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/convert/game/game_flags.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace q3 {

template <typename JsonArchive> void Describe(JsonArchive &a, bspShader_t &shader) {
    a.Name("shader", shader.shader);
    a.Flags("surfaceFlags", shader.surfaceFlags, FlagKind::Surface);
    a.Flags("contentFlags", shader.contentFlags, FlagKind::Content);
}

template <typename JsonArchive, typename Record> void DescribeBounds(JsonArchive &a, Record &record) {
    a.Group("minmax", [&] {
        a.Field("mins", record.mins);
        a.Field("maxs", record.maxs);
    });
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspModel_t &model) {
    DescribeBounds(a, model);
    a.Field("firstBSPSurface", model.firstBSPSurface);
    a.Field("numBSPSurfaces", model.numBSPSurfaces);
    a.Field("firstBSPBrush", model.firstBSPBrush);
    a.Field("numBSPBrushes", model.numBSPBrushes);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspPlane_t &plane) {
    std::array<float, 4> values = {plane.normal[0], plane.normal[1], plane.normal[2], plane.dist};
    a.Whole(values);
    plane = {{values[0], values[1], values[2]}, values[3]};
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspLeaf_t &leaf) {
    a.Field("cluster", leaf.cluster);
    a.Field("area", leaf.area);
    DescribeBounds(a, leaf);
    a.Field("firstBSPLeafSurface", leaf.firstBSPLeafSurface);
    a.Field("numBSPLeafSurfaces", leaf.numBSPLeafSurfaces);
    a.Field("firstBSPLeafBrush", leaf.firstBSPLeafBrush);
    a.Field("numBSPLeafBrushes", leaf.numBSPLeafBrushes);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspNode_t &node) {
    a.Field("planeNum", node.planeNum);
    a.Field("children", node.children);
    DescribeBounds(a, node);
}

/// Indices and bytes: lumps of single numbers.
template <typename JsonArchive> void Describe(JsonArchive &a, std::int32_t &number) {
    a.Field("Num", number);
}
template <typename JsonArchive> void Describe(JsonArchive &a, std::uint8_t &number) {
    a.Field("Num", number);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspBrush_t &brush) {
    a.Field("firstSide", brush.firstSide);
    a.Field("numSides", brush.numSides);
    a.Field("shaderNum", brush.shaderNum);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspBrushSide_t &side) {
    a.Field("planeNum", side.planeNum);
    a.Field("shaderNum", side.shaderNum);
    a.Field("surfaceNum", side.surfaceNum);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspDrawVert_t &vert) {
    a.Field("xyz", vert.xyz);
    a.Field("st", vert.st);
    a.Field("lightmap", vert.lightmap);
    a.Field("normal", vert.normal);
    a.Field("color", vert.color);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspDrawSurface_t &surface) {
    a.Field("shaderNum", surface.shaderNum);
    a.Field("fogNum", surface.fogNum);
    a.Field("surfaceType", surface.surfaceType);
    a.Field("firstVert", surface.firstVert);
    a.Field("numVerts", surface.numVerts);
    a.Field("firstIndex", surface.firstIndex);
    a.Field("numIndexes", surface.numIndexes);
    a.Field("lightmapStyles", surface.lightmapStyles);
    a.Field("vertexStyles", surface.vertexStyles);
    a.Field("lightmapNum", surface.lightmapNum);
    a.Field("lightmapX", surface.lightmapX);
    a.Field("lightmapY", surface.lightmapY);
    a.Field("lightmapWidth", surface.lightmapWidth);
    a.Field("lightmapHeight", surface.lightmapHeight);
    a.Field("lightmapOrigin", surface.lightmapOrigin);
    a.Field("lightmapVecs", surface.lightmapVecs);
    a.Field("patchWidth", surface.patchWidth);
    a.Field("patchHeight", surface.patchHeight);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspFog_t &fog) {
    a.Name("shader", fog.shader);
    a.Field("brushNum", fog.brushNum);
    a.Field("visibleSide", fog.visibleSide);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspGridPoint_t &point) {
    a.Field("ambient", point.ambient);
    a.Field("directed", point.directed);
    a.Field("styles", point.styles);
    a.Field("latLong", point.latLong);
}

template <typename JsonArchive> void Describe(JsonArchive &a, Entity &entity) {
    a.Pairs("KeyValue", entity.pairs);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspAdvertisement_t &advertisement) {
    a.Field("cellId", advertisement.cellId);
    a.Field("normal", advertisement.normal);
    a.Field("rect", advertisement.rect);
    a.Name("model", advertisement.model);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspGridSHHeader_t &header) {
    a.Field("gridMins", header.gridMins);
    a.Field("gridSize", header.gridSize);
    a.Field("gridBounds", header.gridBounds);
}

template <typename JsonArchive> void Describe(JsonArchive &a, bspGridPointSH_t &point) {
    a.Whole(point.coeffs);
}

/// An E5BGR9 color: from the lowest bit, mantissas of red, green and blue of 9 bits each, and 5 bits of exponent.
struct JsonE5bgr9 {
    std::uint32_t code = 0;
};
inline constexpr std::int32_t kJsonMaxMantissa = 511, kJsonMaxExponent = 31;
template <typename JsonArchive> void Describe(JsonArchive &a, JsonE5bgr9 &color) {
    std::array<std::int32_t, 4> parts{};
    for (std::uint32_t i = 0; i < 4; ++i)
        parts[i] = std::int32_t(color.code >> 9 * i & std::uint32_t(kJsonMaxMantissa));
    a.Whole(parts);
    a.Check(std::ranges::all_of(parts, [](std::int32_t part) { return part >= 0 && part <= kJsonMaxMantissa; }) &&
                parts[3] <= kJsonMaxExponent,
            "expected three mantissas in 0..511 and an exponent in 0..31");
    color.code = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
        color.code |= std::uint32_t(parts[i]) << 9 * i;
}

/// A sample of ambient cubes: six colors of ColorRGBExp32, and the position as stored.
template <typename JsonArchive> void Describe(JsonArchive &a, bspCubeSample_t &sample) {
    std::array<std::array<std::int32_t, 4>, 6> sides{};
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const ColorRgbExp32 &side = sample.sides[i];
        sides[i] = {side.r, side.g, side.b, side.exponent};
    }
    a.Field("sides", sides);
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const auto &[r, g, b, exponent] = sides[i];
        a.Check(std::min({r, g, b}) >= 0 && std::max({r, g, b}) <= UINT8_MAX && exponent >= INT8_MIN &&
                    exponent <= INT8_MAX,
                "sides: expected three mantissas in 0..255 and an exponent in -128..127");
        sample.sides[i] = {std::uint8_t(r), std::uint8_t(g), std::uint8_t(b), std::int8_t(exponent)};
    }
    a.Field("position", sample.position);
}

/// What a file says besides its lumps.
struct JsonFormat {
    std::string ident;
    std::int32_t lightmapSide = 0;
};
template <typename JsonArchive> void Describe(JsonArchive &a, JsonFormat &format) {
    a.Text("ident", format.ident);
    a.Field("lightmapSide", format.lightmapSide);
}

/// One entry of the BSPX directory: its bytes in hex, or the file that holds its records.
struct JsonBspxEntry {
    std::string name;
    std::string bytes, file; ///< one of the two
};
template <typename JsonArchive> void Describe(JsonArchive &a, JsonBspxEntry &entry) {
    a.Text("name", entry.name);
    a.OneOf("bytes", entry.bytes, "file", entry.file);
}

} // namespace q3
