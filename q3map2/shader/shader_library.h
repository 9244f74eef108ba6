// GPL-2.0-or-later. All shaders and images of the game files, by name.
#pragma once

#include "common/files/vfs.h"
#include "common/jobs.h"
#include "q3map2/shader/shader_table.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// The images that the light stage goes on to need.
enum class KeptImages {
    SeeThrough,  ///< of alpha shadows and light filters
    OfReflectors ///< those, and of all reflecting shaders that were looked up, for bounces
};

/// All scripts and images, looked up by name. Not thread safe: look up everything before workers start. Where a
/// function takes a pool, it reads images on all workers.
class ShaderLibrary {
  public:
    /// Reads every script that shaderlist.txt files name (or, without any, all *.shader files of the shader folder).
    ShaderLibrary(const VirtualFileSystem &vfs, const Game &game, const ShaderOptions &options, Log &log);
    ~ShaderLibrary();
    ShaderLibrary(ShaderLibrary &&) noexcept;

    /// The shader of that name (without extension, case-insensitive). Unknown names give an implicit shader with the
    /// image of that name. The reference stays valid as long as the library. Images, and colors from them, are there
    /// for shaders that emit or transmit light; with ShaderOptions::imageSizes (the bsp stage) only for those with a
    /// flare shader. For others see ReleaseImages.
    const ShaderInfo &Get(std::string_view name);
    /// Reads the images that Get needs for these shaders, so that it finds them. To be called before Get, which warns
    /// of those that are damaged.
    void ReadAhead(std::span<const std::string> names, const JobPool &jobs);
    /// As Get, with the light image and the colors of any shader that is drawn.
    const ShaderInfo &GetWithImage(std::string_view name);
    /// The image file, with extension, that editors show for the shader: the first that exists of editor image, the
    /// shader's name, implicit image and light image. Empty: none of them exists, or the shader is not drawn.
    std::string ImageFile(std::string_view name);
    /// Whether surfaces with the shader are normal mapped: as q3map_rnm or q3map_noRnm says; else if a stage,
    /// q3map_normalImage or q3map_ssbumpImage names a map, or an image like NAME_n.tga exists beside the image NAME.
    bool HasNormalMap(std::string_view name);
    /// Flags of a .bsp's shader record, for a shader without script: of records of one name, the surface flags that all
    /// have and the contents of the first. Records without flags are ignored. To be called for all before Get.
    void SetDefaultFlags(std::string_view name, std::uint32_t surfaceFlags, std::uint32_t contentFlags);
    /// An image by its name without extension; null when there is none. Cached.
    std::shared_ptr<const Image> LoadImage(std::string_view nameWithoutExtension);
    std::size_t DefinedCount() const;
    /// To be called once the lights are made. Frees all images except those of `kept`, which are read if they were not.
    /// A ShaderInfo whose image is freed keeps its colors and refers to the white default image.
    void ReleaseImages(KeptImages kept, const JobPool &jobs = JobPool(1));

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3
