// GPL-2.0-or-later. Maps as model files: triangles with materials and lightmap images, written for Wavefront and 3D
// Studio Max.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/shader/shader_library.h"

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A lightmap image: a page of the .bsp, which -export writes, or an external one that shaders name.
struct LightmapImage {
    enum class Place { InBsp, External };

    int number = 0;
    Place place = Place::InBsp;

    /// File name without extension: "lightmap_0003" or "lm_0003".
    std::string Name() const;
};

/// Lightmaps of a map: pages in the file, and lm_NNNN.tga in the folder that has the map's name.
class MeshLightmaps {
  public:
    /// `script`: of the generated shaders; need not exist.
    MeshLightmaps(const Bsp &bsp, const std::filesystem::path &bspPath, const std::filesystem::path &script);

    /// Number of pages in the file, and of external images up to the first gap.
    int InternalCount() const { return internalCount_; }
    int ExternalCount() const { return externalCount_; }
    bool Exists(const LightmapImage &image) const {
        return image.number < (image.place == LightmapImage::Place::External ? externalCount_ : internalCount_);
    }
    /// The surface's own number (in a file without pages that of an external image), else the image that its shader
    /// draws. Nothing: the surface has no lightmap.
    std::optional<LightmapImage> Of(const bspDrawSurface_t &surface, std::string_view shader) const;

  private:
    void ReadScript(const std::filesystem::path &script);

    int internalCount_ = 0, externalCount_ = 0;
    std::map<std::string, int, std::less<>> byShader_; ///< number of the external image by lower-case shader name
};

/// How a map becomes a model file.
struct MeshExportOptions {
    bool shadersAsBitmap = false;              ///< images are named by their shader, as the game would find them
    bool lightmapsAsTexCoord = false;          ///< lightmap coordinates, and a material a lightmap
    bool deluxemapsAsTexCoord = false;         ///< the same with the images of light directions, one number higher
    std::string_view shaderFolder = "scripts"; ///< of the game; generated shaders are looked up there
};

/// A material of a model file.
struct MeshMaterial {
    std::string name;
    Vec3f color{1, 1, 1}; ///< diffuse, largest component 1
    std::string image; ///< path with '/', relative to the folder of the map or as MeshExportOptions says; may be empty
    bool isNamedByShader = false; ///< `image` is a shader name, not a path: its '/' stay in every format
};

/// A vertex of a model file.
struct MeshVertex {
    Vec3f xyz, normal;         ///< in the map's axes and game units, in world space
    std::array<float, 2> st{}; ///< t runs downwards, as in the game
};

/// One draw surface of one model.
struct MeshSurface {
    int shader = 0, model = 0, surface = 0; ///< numbers in the .bsp
    int type = MST_PLANAR;
    std::size_t material = 0;
    Vec3f origin; ///< of the entity that shows the model
    std::vector<MeshVertex> verts;
    std::vector<std::array<int, 3>> triangles; ///< counterclockwise seen from the front

    /// "mat4model0surf12".
    std::string Name() const;
    std::string_view TypeName() const;
};

/// What a model file holds.
struct MeshScene {
    std::string name; ///< of the map, without folder and extension
    std::vector<MeshMaterial> materials;
    std::vector<MeshSurface> surfaces;
};

/// Planar surfaces and triangle soups of the world, then of the brush entities in their order, moved to their origin.
/// Curves and flares have no triangles and are left out, with a note. `bspPath`: of the map, for the names of
/// lightmap images. Warnings: lightmaps without an image, entities with a model that is not there.
MeshScene MakeMeshScene(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
                        const std::filesystem::path &bspPath, Log &log);

/// The text with everything that would end a name in a model file (control characters, quotes) as '_'.
std::string MeshName(std::string_view text);

/// The scene in the ASCII scene format of 3D Studio Max (.ase), an object a surface. Lines end with CR LF.
std::string AseText(const MeshScene &scene);
/// The scene as a Wavefront model (.obj) with y up, a group a surface. It names NAME.mtl, the text of MtlText.
std::string ObjText(const MeshScene &scene);
/// The materials of the scene for ObjText, those of equal name once.
std::string MtlText(const MeshScene &scene);

/// Writes the map as `output`, x.ase beside x.bsp: names of lightmap images and generated shaders follow from it.
/// Errors: Error, for files that cannot be written.
void WriteAse(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log);
/// The same as `output`, x.obj, and its materials as x.mtl.
void WriteObj(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log);

} // namespace q3
