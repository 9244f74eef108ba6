// GPL-2.0-or-later. Records of compiled maps: little endian, no padding, as they lie in RBSP and FBSP files. Brush
// sides, vertices, surfaces and grid points are smaller in IBSP files: bspfile_ibsp.cpp. See
// docs/reference/bsp_format.md.
#pragma once

#include "libs/math/packed_color.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace q3 {

enum BspLump {
    LUMP_ENTITIES,
    LUMP_SHADERS,
    LUMP_PLANES,
    LUMP_NODES,
    LUMP_LEAFS,
    LUMP_LEAFSURFACES,
    LUMP_LEAFBRUSHES,
    LUMP_MODELS,
    LUMP_BRUSHES,
    LUMP_BRUSHSIDES,
    LUMP_DRAWVERTS,
    LUMP_DRAWINDEXES,
    LUMP_FOGS,
    LUMP_SURFACES,
    LUMP_LIGHTMAPS,
    LUMP_LIGHTGRID,
    LUMP_VISIBILITY,
    LUMP_ADVERTISEMENTS, ///< IBSP 47 of Quake Live only
    LUMP_LIGHTGRID_SH,   ///< IBSP 47 of this program only
    kNumLumps,
    LUMP_LIGHTARRAY = LUMP_ADVERTISEMENTS ///< RBSP and FBSP: u16 numbers of light grid records, one for each point
};

/// Light styles that a record can hold. IBSP files have slot 0 only.
inline constexpr std::size_t kStyles = 4;
/// Style by slot. Slot 0 of surfaces but flares holds style 0, and free slots come last.
using Styles = std::array<std::uint8_t, kStyles>;
/// Marks a free slot.
inline constexpr std::uint8_t kNoStyle = 255;
inline constexpr Styles kOnlyStyle0{0, kNoStyle, kNoStyle, kNoStyle};
/// A grid point in a wall: engines of RBSP leave it out of their interpolation.
inline constexpr Styles kNoStyles{kNoStyle, kNoStyle, kNoStyle, kNoStyle};
/// RBSP and FBSP: styles from kFirstSwitchStyle to kLastStyle belong to switchable lights, a style for each group of
/// them. Engines of RBSP have no styles above.
inline constexpr int kFirstSwitchStyle = 32, kSwitchStyleCount = 32;
inline constexpr int kLastStyle = kFirstSwitchStyle + kSwitchStyleCount - 1;
/// A value for each light style.
template <typename T> using PerStyle = std::array<T, kStyles>;

/// lightmapNum of surfaces that are lit at their vertices: LIGHTMAP_BY_VERTEX of engines.
inline constexpr std::int32_t kLightmapByVertex = -3;
/// Texels of a side of a lightmap page in IBSP and RBSP files, and in FBSP files without _lightmapimagesize.
inline constexpr int kLightmapSide = 128, kFbspLightmapSide = 512;
/// Bytes of a lightmap page of RGB texels.
constexpr std::size_t LightmapPageBytes(int side) {
    return std::size_t(side) * std::size_t(side) * 3;
}
inline constexpr std::size_t kLightmapPageBytes = LightmapPageBytes(kLightmapSide);

using Float3 = std::array<float, 3>;
using Int3 = std::array<std::int32_t, 3>;

struct bspShader_t {
    std::array<char, 64> shader; ///< NUL terminated; bytes after the NUL may be anything
    std::uint32_t surfaceFlags, contentFlags;
};
/// Greatest length of a shader name, without the NUL.
inline constexpr std::size_t kMaxShaderName = sizeof(bspShader_t::shader) - 1;

/// A point p is in front when normal . p - dist > 0. Planes 2k and 2k + 1 are each other's opposites.
struct bspPlane_t {
    Float3 normal;
    float dist;
};

/// children: [0] front, [1] back; >= 0 a node, else leaf -1 - child.
struct bspNode_t {
    std::int32_t planeNum;
    std::array<std::int32_t, 2> children;
    Int3 mins, maxs;
};

struct bspLeaf_t {
    std::int32_t cluster; ///< -1 is solid
    std::int32_t area;
    Int3 mins, maxs;
    std::int32_t firstBSPLeafSurface, numBSPLeafSurfaces;
    std::int32_t firstBSPLeafBrush, numBSPLeafBrushes;
};

struct bspModel_t {
    Float3 mins, maxs;
    std::int32_t firstBSPSurface, numBSPSurfaces;
    std::int32_t firstBSPBrush, numBSPBrushes;
};

struct bspBrush_t {
    std::int32_t firstSide, numSides, shaderNum;
};

struct bspBrushSide_t {
    std::int32_t planeNum, shaderNum;
    std::int32_t surfaceNum = -1; ///< draw surface made from this side; -1: none, or not known (IBSP)
};

struct bspDrawVert_t {
    Float3 xyz;
    std::array<float, 2> st;
    PerStyle<std::array<float, 2>> lightmap; ///< may be NaN in valid files, where no lightmap is used
    Float3 normal;
    PerStyle<std::array<std::uint8_t, 4>> color;
};

struct bspFog_t {
    std::array<char, 64> shader;
    std::int32_t brushNum, visibleSide;
};

enum BspSurfaceType { MST_BAD, MST_PLANAR, MST_PATCH, MST_TRIANGLE_SOUP, MST_FLARE, MST_FOLIAGE };

struct bspDrawSurface_t {
    std::int32_t shaderNum, fogNum, surfaceType;
    std::int32_t firstVert, numVerts, firstIndex, numIndexes;
    Styles lightmapStyles = kOnlyStyle0, vertexStyles = kOnlyStyle0;
    PerStyle<std::int32_t> lightmapNum{kLightmapByVertex, kLightmapByVertex, kLightmapByVertex, kLightmapByVertex};
    PerStyle<std::int32_t> lightmapX{}, lightmapY{};
    std::int32_t lightmapWidth, lightmapHeight;
    Float3 lightmapOrigin;
    std::array<Float3, 3> lightmapVecs;
    std::int32_t patchWidth, patchHeight;
};

/// Legacy light grid point.
struct bspGridPoint_t {
    PerStyle<std::array<std::uint8_t, 3>> ambient, directed;
    Styles styles = kOnlyStyle0;
    std::array<std::uint8_t, 2> latLong; ///< angle from +z, angle around z; 255 steps encode 360 degrees
    bool operator==(const bspGridPoint_t &) const = default;
};

struct bspAdvertisement_t {
    std::int32_t cellId;
    Float3 normal;
    std::array<Float3, 4> rect;
    std::array<char, 64> model;
};

/// Head of the SH light grid lump. numPoints = product of gridBounds; point (x, y, z) is at gridMins + (x, y, z) *
/// gridSize and has index x + y * gridBounds[0] + z * gridBounds[0] * gridBounds[1].
struct bspGridSHHeader_t {
    Float3 gridMins, gridSize;
    Int3 gridBounds;
    std::int32_t numPoints;
};

/// Nine L2 coefficients [k][rgb]; 1.0 is lightmap byte 255, linear. Cosine-convolved unless baked with -shradiance.
struct bspGridPointSH_t {
    std::array<Float3, 9> coeffs;
};

/// Values as in the file: Raw is 0, Rescaled 1.
enum class RnmStorage : std::uint32_t {
    Raw,     ///< light on each basis normal
    Rescaled ///< scaled per luxel and channel so that the mean of the three is the flat lightmap
};

/// Head of the BSPX lump LIGHTING_RNM. Pages follow, each an int32 lightmapNum and three maps of
/// side * side E5BGR9 codes.
struct bspRnmHeader_t {
    std::array<char, 4> magic{'R', 'N', 'M', '1'};
    std::uint32_t version = 1;
    RnmStorage storage = RnmStorage::Raw;
    std::uint32_t side = 0, pageCount = 0;
};
/// Largest bspRnmHeader_t::side, texels.
inline constexpr std::uint32_t kMaxRnmSide = 16384;

/// Head of the BSPX lump AMBIENT_CUBES. A bspCubeLeaf_t for each leaf and the samples follow.
struct bspCubeHeader_t {
    std::array<char, 4> magic{'A', 'C', 'U', 'B'};
    std::uint32_t version = 1;
    std::uint32_t leafCount = 0, sampleCount = 0;
};

/// Samples of a leaf: count > 0: from `first` on; count 0: those of leaf `first`.
struct bspCubeLeaf_t {
    std::uint16_t count = 0, first = 0;
};

/// Light at a position in a leaf.
struct bspCubeSample_t {
    std::array<ColorRgbExp32, 6> sides;     ///< on surfaces that face +x, -x, +y, -y, +z, -z
    std::array<std::uint8_t, 3> position{}; ///< by axis: 0 is the lower bound of the leaf, 255 the upper one
    std::uint8_t unused = 0;                ///< must be 0
};

/// Head of the BSPX lump STATIC_PROP_LIGHT. Props, meshes and colors follow.
struct bspPropLightHeader_t {
    std::array<char, 4> magic{'S', 'P', 'L', '1'};
    std::uint32_t version = 1;
    std::uint32_t propCount = 0, meshCount = 0, colorCount = 0;
};

/// One prop. Props are in ascending order of entities, and the meshes of each follow those of the one before.
struct bspPropLight_t {
    std::uint32_t entity = 0;   ///< number in the entities lump
    std::uint32_t nameCrc = 0;  ///< Crc32 of the value of its key "model", in lower case
    std::uint32_t modelCrc = 0; ///< Crc32 of the bytes of the model file
    std::uint32_t firstMesh = 0, meshCount = 0;
};

/// Colors of the vertices of a mesh; they follow those of the mesh before.
struct bspPropMesh_t {
    std::uint32_t firstColor = 0, colorCount = 0;
};

/// Head of the BSPX lump LIGHTGRID_SH_SPARSE. `nodes` SparseGridNode and `points` SparseGridPoint follow.
struct bspSparseGridHeader_t {
    std::array<char, 4> magic{'S', 'H', 'G', 'S'};
    std::uint32_t version = 1;
    std::uint32_t bytes = 0;  ///< of the lump
    Float3 mins{}, cell{};    ///< lower corner of the grid and size of the smallest cells, game units
    Int3 roots{};             ///< number of octrees along each axis
    std::uint32_t levels = 0; ///< a root's edge is cell * 2^levels
    std::uint32_t nodes = 0, points = 0, reserved = 0;
};

/// Head of the BSPX lump LIGHTGRID_SH_LIGHTS. GridLight, GridPolygon, Float3 vertices, NamedGridNode, NamedGridPoint,
/// uint16 names, uint8 shares and text follow; the last three are padded to 4 bytes.
struct bspNamedGridHeader_t {
    std::array<char, 4> magic{'S', 'H', 'G', 'L'};
    std::uint32_t version = 1;
    std::uint32_t bytes = 0; ///< of the lump
    Float3 mins{}, cell{};   ///< as of bspSparseGridHeader_t, like roots and levels
    Int3 roots{};
    std::uint32_t levels = 0;
    std::uint32_t nodes = 0, points = 0, lights = 0, polygons = 0, vertices = 0, names = 0, shares = 0, textBytes = 0;
    std::array<std::uint32_t, 3> reserved{};
};

/// Whether a record has the size that the format gives it, and can be copied as bytes.
template <typename Record, std::size_t size>
inline constexpr bool kPinned = sizeof(Record) == size &&std::is_trivially_copyable_v<Record>;
static_assert(kPinned<bspShader_t, 72> && kPinned<bspPlane_t, 16> && kPinned<bspNode_t, 36>);
static_assert(kPinned<bspLeaf_t, 48> && kPinned<bspModel_t, 40> && kPinned<bspBrush_t, 12>);
static_assert(kPinned<bspBrushSide_t, 12> && kPinned<bspDrawVert_t, 80> && kPinned<bspFog_t, 72>);
static_assert(kPinned<bspDrawSurface_t, 148> && kPinned<bspGridPoint_t, 30> && kPinned<bspAdvertisement_t, 128>);
static_assert(kPinned<bspRnmHeader_t, 20>);
static_assert(kPinned<bspCubeHeader_t, 16> && kPinned<bspCubeLeaf_t, 4> && kPinned<bspCubeSample_t, 28>);
static_assert(kPinned<bspPropLightHeader_t, 20> && kPinned<bspPropLight_t, 20> && kPinned<bspPropMesh_t, 8>);
static_assert(kPinned<bspSparseGridHeader_t, 64> && kPinned<bspNamedGridHeader_t, 96>);
static_assert(kPinned<bspGridSHHeader_t, 40> && kPinned<bspGridPointSH_t, 108>);

} // namespace q3
