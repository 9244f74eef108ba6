// GPL-2.0-or-later. Model files as triangles in the map's axes.
#pragma once

#include "common/files/vfs.h"
#include "common/log.h"
#include "q3map2/bspfile/draw_vert.h"

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// Triangles of a model with one shader.
struct ModelMesh {
    std::string shader; ///< see ShaderOfMaterial
    std::vector<DrawVert> verts;
    std::vector<std::array<int, 3>> triangles; ///< clockwise seen from the front
};

/// A model file.
struct Model {
    std::vector<ModelMesh> meshes;
};

/// Models by file name and frame; each is read once.
class ModelLibrary {
  public:
    /// Finds no models if `vfs` is null.
    explicit ModelLibrary(const VirtualFileSystem *vfs) : vfs_(vfs) {}
    /// The model in any format that assimp reads (md3, ase, obj ...). Null with the reason in `problem` if it cannot be
    /// read.
    const Model *Get(std::string_view name, int frame, std::string &problem);

  private:
    struct Entry {
        std::unique_ptr<Model> model;
        std::string problem;
    };
    const VirtualFileSystem *vfs_;
    std::map<std::pair<std::string, int>, Entry> entries_;
};

/// Shader name for a material: without extension, with the model's folder when it has none; paths from other machines
/// are cut at their "models" or "textures" folder. A material without a name gets that of the model.
std::string ShaderOfMaterial(std::string_view material, std::string_view modelName);

} // namespace q3
