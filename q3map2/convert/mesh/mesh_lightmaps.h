// GPL-2.0-or-later. Which lightmap image a surface shows. Internal to mesh export.
#pragma once

#include "q3map2/bspfile/bsp.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace q3 {

/// A lightmap image: a page of the file, which -export writes, or an external one that shaders name.
struct LightmapImage {
    int number = 0;
    bool external = false;

    /// File name without extension: "lightmap_0003" or "lm_0003".
    std::string Name() const;
};

/// Lightmaps of a map: pages in the file, and lm_NNNN.tga in the folder that has the map's name.
class MeshLightmaps {
  public:
    /// `script`: of the generated shaders; need not exist.
    MeshLightmaps(const Bsp &bsp, const std::filesystem::path &bspPath, const std::filesystem::path &script);

    /// Number of pages in the file, and of external images up to the first gap.
    int InternalCount() const { return internal_; }
    int ExternalCount() const { return external_; }
    bool Exists(const LightmapImage &image) const { return image.number < (image.external ? external_ : internal_); }
    /// The surface's own number (in a file without pages that of an external image), else the image that its shader
    /// draws. Nothing: the surface has no lightmap.
    std::optional<LightmapImage> Of(const bspDrawSurface_t &surface, std::string_view shader) const;

  private:
    void ReadScript(const std::filesystem::path &script);

    int internal_ = 0, external_ = 0;
    std::map<std::string, int, std::less<>> byShader_; ///< number of the external image by lower-case shader name
};

} // namespace q3
