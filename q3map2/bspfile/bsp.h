// GPL-2.0-or-later. A compiled map in memory, and point queries on its BSP tree.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/bspfile_named.h"
#include "q3map2/bspfile/bspfile_sparse.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Vertex of a draw surface during the bsp stage, or of a model.
struct DrawVert {
    Vec3f xyz, normal;
    std::array<float, 2> st{};
    std::array<std::uint8_t, 4> color{255, 255, 255, 255};
    bool inserted = false; ///< by T-junction repair
};

/// One named lump of the BSPX directory that may follow the header lumps.
struct BspxLump {
    std::string name; ///< at most 23 bytes; 24, without a NUL, are read and written back
    std::vector<std::byte> data;
};

inline constexpr std::string_view kBspxLightGridSH = "LIGHTGRID_SH", kBspxSparseGridSH = "LIGHTGRID_SH_SPARSE",
                                  kBspxNamedGridSH = "LIGHTGRID_SH_LIGHTS";
inline constexpr std::string_view kBspxLightmapsE5bgr9 = "LIGHTING_E5BGR9", kBspxVertexE5bgr9 = "VERTEX_E5BGR9",
                                  kBspxRnm = "LIGHTING_RNM";
inline constexpr std::string_view kBspxAmbientCubes = "AMBIENT_CUBES", kBspxPropLight = "STATIC_PROP_LIGHT";

/// The SH light grid, as in lump 18 or the BSPX lump kBspxLightGridSH.
struct LightGridSH {
    bspGridSHHeader_t header{};
    std::vector<bspGridPointSH_t> points;
};

/// Light on the three basis normals of radiosity normal mapping, for the luxels of a lightmap page.
struct RnmPage {
    std::int32_t lightmapNum = 0;
    std::array<std::vector<std::uint32_t>, 3> maps; ///< E5BGR9 codes, row 0 of the page first
};

/// The BSPX lump kBspxRnm. The head's pageCount is the number of pages.
struct RnmLightmaps {
    bspRnmHeader_t header;
    std::vector<RnmPage> pages;
};

/// The BSPX lump kBspxAmbientCubes: ambient cubes of leafs.
struct AmbientCubes {
    std::vector<bspCubeLeaf_t> leafs; ///< one for each leaf of the map
    std::vector<bspCubeSample_t> samples;
};

/// The BSPX lump kBspxPropLight: light at the vertices of static props.
struct PropLight {
    std::vector<bspPropLight_t> props;
    std::vector<bspPropMesh_t> meshes;
    std::vector<std::uint32_t> colors; ///< E5BGR9, unit scale
};

/// Where the SH light grid is stored.
enum class GridSHContainer {
    Lump, ///< lump 18 of a version 47 file with 19 slots: only engines that know this layout load the file
    Bspx  ///< BSPX lump of a version 46 file: unmodified engines load it and see no SH grid
};

/// The first four bytes of a file of each format.
inline constexpr std::string_view kIbspIdent = "IBSP", kRbspIdent = "RBSP", kFbspIdent = "FBSP";

/// All lumps of a file as records, in whatever format it is. A value: copy, compare, edit. ReadBsp returns only
/// validated data.
struct Bsp {
    std::string_view ident = kIbspIdent; ///< of the records; WriteBsp goes by its BspFormat
    std::string entities;                ///< text of the lump without the final NUL
    std::vector<bspShader_t> shaders;
    std::vector<bspPlane_t> planes;
    std::vector<bspNode_t> nodes;
    std::vector<bspLeaf_t> leafs;
    std::vector<std::int32_t> leafSurfaces, leafBrushes;
    std::vector<bspModel_t> models;
    std::vector<bspBrush_t> brushes;
    std::vector<bspBrushSide_t> brushSides;
    std::vector<bspDrawVert_t> drawVerts;
    std::vector<std::int32_t> drawIndexes;
    std::vector<bspFog_t> fogs;
    std::vector<bspDrawSurface_t> drawSurfaces;
    int lightmapSide = kLightmapSide;    ///< texels of a side of the pages
    std::vector<std::uint8_t> lightmaps; ///< pages of LightmapPageBytes(lightmapSide) bytes
    std::vector<bspGridPoint_t> gridPoints;
    std::vector<std::uint8_t> visibility; ///< i32 clusters, i32 bytes per row, rows; empty: everything is visible
    std::vector<bspAdvertisement_t> advertisements;
    std::optional<LightGridSH> gridSH;
    GridSHContainer gridSHContainer = GridSHContainer::Lump;
    std::optional<SparseGridSH> sparseGridSH; ///< in the BSPX lump kBspxSparseGridSH
    std::optional<NamedGridSH> namedGridSH;   ///< in the BSPX lump kBspxNamedGridSH
    // HDR light as E5BGR9 codes (libs/math/packed_color.h), in BSPX lumps; empty: no such lump.
    std::vector<std::uint32_t> lightmapsE5bgr9; ///< for each texel of `lightmaps`; pages of directions hold 0
    std::vector<std::uint32_t> vertexE5bgr9;    ///< for each of drawVerts
    std::optional<RnmLightmaps> rnm;
    std::optional<AmbientCubes> ambientCubes;
    std::optional<PropLight> propLight;
    std::vector<BspxLump> bspx; ///< without those that members above hold (bspx_lumps.h)

    /// Lightmap pages in the file.
    std::size_t LightmapPages() const { return lightmaps.size() / LightmapPageBytes(lightmapSide); }
    /// One past the last page that a surface names: more than the file has where pages are images beside it.
    std::int64_t NamedPages() const;
};

/// Which format a file gets. IBSP without an SH lump: version 46 has 17 slots, version 47 has 17 (Wolfenstein family)
/// or 18 with the advertisement lump (Quake Live). RBSP and FBSP: version 1, with four light styles in their records.
struct BspFormat {
    int version = 46;
    bool advertisements = false; ///< slot 17 belongs to the format
    bool force = false;          ///< reading: wrong ident or version, or a partial record (lump dropped), only warns
    std::string_view ident = kIbspIdent; ///< writing: which format; reading goes by the file
    /// Reading IBSP, which does not tell it: texels of a side of the pages. Files with part of such a page have pages
    /// of kLightmapSide.
    int lightmapSide = kLightmapSide;

    /// Whether records hold kStyles light styles, not one.
    bool HasStyleSlots() const { return ident != kIbspIdent; }
};

/// Name of a 64-byte field: up to the first NUL.
template <std::size_t N> std::string_view FieldName(const std::array<char, N> &field) {
    const std::string_view all(field.data(), N);
    return all.substr(0, all.find('\0'));
}

/// Points within this distance of a node's plane count as on both sides. Game units.
inline constexpr float kOnPlane = 0.1f;

/// Cluster of solid leafs.
inline constexpr int kSolidCluster = -1;

/// A child of a node: the number of a node, or -1 - the number of a leaf.
using BspChild = int;
inline int LeafOf(BspChild child) {
    return -1 - child;
}
/// The root node, or leaf 0 in a map without nodes.
inline BspChild RootOf(const Bsp &bsp) {
    return bsp.nodes.empty() ? -1 : 0;
}

/// Number of the leaf that holds p in a validated Bsp. A point within kOnPlane of a plane belongs to the front, unless
/// the leaf found there is solid.
int LeafAt(const Bsp &bsp, const Vec3f &p);

/// Compact copy of the tree of a validated Bsp: planes, children and clusters only, to stay in CPU caches.
class BspTree {
  public:
    struct Node {
        Vec3f normal;
        float dist = 0;
        std::array<BspChild, 2> children{};
    };
    explicit BspTree(const Bsp &bsp);

    BspChild Root() const { return nodes_.empty() ? -1 : 0; }
    const Node &NodeOf(BspChild child) const { return nodes_[std::size_t(child)]; }
    int ClusterOf(int leaf) const { return clusters_[std::size_t(leaf)]; }
    /// As the free function LeafAt.
    int LeafAt(const Vec3f &p) const;

  private:
    std::vector<Node> nodes_;
    std::vector<int> clusters_; ///< by leaf
};

} // namespace q3
