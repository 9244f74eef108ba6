// GPL-2.0-or-later. Models of static props, prepared for lighting at vertices.
#pragma once

#include "common/files/vfs.h"
#include "libs/math/bounds.h"
#include "q3map2/model/model_load.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A model whose vertices with the same position and normal are welded to points, across all meshes. The vertices of
/// MD3 models are those of the file in its order; other formats have the vertices that ModelLibrary makes.
struct PropModel {
    struct Point {
        Vec3f xyz, normal;      ///< in model space
        std::uint32_t mesh = 0; ///< the first mesh that has the point
    };
    explicit PropModel(Model model);

    std::vector<ModelMesh> meshes;
    std::uint32_t crc = 0; ///< Crc32 of the file
    Boundsf bounds;
    std::vector<Point> points;
    std::vector<std::vector<std::uint32_t>> pointOf; ///< [mesh][vertex]: number of its point
    std::vector<Vec3f> corners;                      ///< positions, three for each triangle of all meshes
    /// cornersAt[firstCorner[i]] to before cornersAt[firstCorner[i + 1]]: indexes of the corners at point i.
    std::vector<std::uint32_t> firstCorner, cornersAt;
};

/// Cache of prop models: each is read once.
class PropModels {
  public:
    /// Finds no models if `vfs` is null.
    explicit PropModels(const VirtualFileSystem *vfs) : vfs_(vfs), library_(vfs) {}
    /// Null if the model cannot be read; then `problem` is the reason.
    const PropModel *Get(std::string_view name, int frame, std::string &problem);

  private:
    struct Entry {
        std::unique_ptr<PropModel> model;
        std::string problem;
    };
    std::unique_ptr<PropModel> Read(const std::string &name, int frame);

    const VirtualFileSystem *vfs_;
    ModelLibrary library_;
    std::map<std::pair<std::string, int>, Entry> entries_;
};

} // namespace q3
