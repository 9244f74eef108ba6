// GPL-2.0-or-later. A lit map as an engine draws it: light at points of its surfaces.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/shader/shader_library.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace q3::compare {

/// A point of a surface: vertices and their weights. Valid in all .bsp files of a map that differ in light only.
struct SurfacePoint {
    std::array<int, 9> verts{}; ///< indices of draw vertices
    std::array<double, 9> weights{};
    std::size_t count = 0;
};

/// A page of lightmaps: RGB bytes, row by row.
struct Page {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

/// A .bsp file with its lightmap pages: those of the lump, lm_NNNN.tga in the folder named like the file, or both.
class LitMap {
  public:
    /// pageOfShader: by lower-case name, for surfaces whose lightmapNum is no page.
    LitMap(Bsp bsp, std::vector<Page> pages, std::map<std::string, int> pageOfShader);
    /// side: of a page in the lump. Errors: Error, for files that cannot be read.
    static LitMap Load(const std::filesystem::path &path, int side, Log &log);

    const Bsp &Map() const { return bsp_; }
    std::size_t PageCount() const { return pages_.size(); }
    /// Whether pages come in pairs of light and light directions.
    bool Deluxe() const { return deluxe_; }
    /// Number of the page that lights the surface; -1: its vertices do.
    int PageOf(std::size_t surface) const { return pageOf_[surface]; }
    /// Texels across and down; the surface must have a page.
    std::array<int, 2> PageSize(std::size_t surface) const {
        const Page &page = pages_[std::size_t(PageOf(surface))];
        return {page.width, page.height};
    }
    /// Bilinear, byte scale; the surface must have a page.
    Vec3d Light(std::size_t surface, const SurfacePoint &point) const { return Sample(PageOf(surface), point); }
    /// Direction towards the light, not normalized. Needs Deluxe.
    Vec3d Direction(std::size_t surface, const SurfacePoint &point) const;
    /// Game units.
    Vec3d Position(const SurfacePoint &point) const;
    std::string_view ShaderOf(std::size_t surface) const {
        return FieldName(bsp_.shaders[std::size_t(bsp_.drawSurfaces[surface].shaderNum)].shader);
    }

  private:
    Vec3d Sample(int page, const SurfacePoint &point) const;

    Bsp bsp_;
    std::vector<Page> pages_;
    std::vector<int> pageOf_;
    bool deluxe_ = false;
};

/// Whether engines leave the surface out or draw a sky instead, by the flags of its shader in Quake III.
bool IsUndrawn(const Bsp &bsp, std::size_t surface);

/// Whether engines show the vertex colors of the shader's surfaces that have no lightmap (r_vertexLight 0): if no
/// script defines the shader, it has implicitMap, implicitMask or implicitBlend, or a stage has rgbGen vertex or the
/// like.
bool DrawsVertexColors(const ShaderInfo &shader);

/// Whether a point on a surface of the world is buried in solid leafs, so that nobody sees it.
bool IsBuried(const Bsp &bsp, std::size_t surface, const SurfacePoint &point);

/// Square units; of patches roughly. 0 for surfaces that are not drawn as triangles or patches.
double AreaOf(const Bsp &bsp, std::size_t surface);

/// `count` well-spread points of a surface, uniform by area on triangles and by parameter on patches; none for surfaces
/// that are not drawn so.
std::vector<SurfacePoint> PointsOn(const Bsp &bsp, std::size_t surface, int count);

} // namespace q3::compare
