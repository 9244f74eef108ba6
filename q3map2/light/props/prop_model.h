// GPL-2.0-or-later. Models of static props, with what lighting at vertices needs.
#pragma once

#include "common/files/vfs.h"
#include "libs/math/bounds.h"
#include "q3map2/model/model_load.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A model whose vertices with the same position and normal are welded to points, in all its meshes. MD3 models have
/// the vertices of the file; other formats those of ModelLibrary.
struct PropModel {
    struct Point {
        Vec3f xyz, normal;      ///< as in the model
        std::uint32_t mesh = 0; ///< the first that has it
    };
    explicit PropModel(Model model);

    std::vector<ModelMesh> meshes;
    std::uint32_t crc = 0; ///< Crc32 of the file
    Boundsf bounds;
    std::vector<Point> points;
    std::vector<std::vector<std::uint32_t>> pointOf; ///< [mesh][vertex]
    std::vector<Vec3f> corners;                      ///< of all triangles, three each
    /// Corners at point i, as indexes of `corners`: from firstCorner[i] to before firstCorner[i + 1].
    std::vector<std::uint32_t> firstCorner, cornersAt;
};

/// The models that props name; each is read once.
class PropModels {
  public:
    /// Finds no models if `vfs` is null.
    explicit PropModels(const VirtualFileSystem *vfs) : vfs_(vfs), library_(vfs) {}
    /// Null with the reason in `problem` if it cannot be read.
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
