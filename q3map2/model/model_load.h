// GPL-2.0-or-later. Model files as triangles in the map's axes, their skins, and MD3 models with the vertices of the
// file.
#pragma once

#include "common/files/vfs.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/entities.h"

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// The shader replacements of one placed model; by default none.
class ShaderRemap {
  public:
    /// A shader by its name or, in _remap keys, the end of its name, and the one in its place.
    struct Replacement {
        std::string from, to;
    };

    ShaderRemap() = default;
    /// `skin`: the lines of a skin file, if there is one. `remaps`: _remap keys in the order in which they are tried.
    ShaderRemap(std::optional<std::vector<Replacement>> skin, std::vector<Replacement> remaps)
        : skin_(std::move(skin)), remaps_(std::move(remaps)) {}

    /// The replacement for the shader of a mesh. Empty: the mesh is omitted.
    std::string operator()(std::string_view shader) const;
    /// Warns of each _remap key that matches none of the shaders of the model.
    void WarnOfUnmatched(std::span<const std::string> shaders, std::string_view who, Log &log) const;

  private:
    std::string Skinned(std::string_view shader) const;

    std::optional<std::vector<Replacement>> skin_;
    std::vector<Replacement> remaps_;
};

/// The shader replacements defined by the skin file and the _remap keys of an entity with this model. who: the entity,
/// for messages. Without `vfs` no skin is found.
ShaderRemap ShaderRemapOf(const Entity &entity, std::string_view who, std::string_view model,
                          const VirtualFileSystem *vfs, Log &log);

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

/// An affine map: p' = A p + origin, where A has these rows.
struct ModelTransform {
    std::array<Vec3d, 3> rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d origin;

    /// The transformed position of a point.
    Vec3d Point(const Vec3d &p) const;
    /// Transforms a normal by the inverse transpose, to unit length. Returns `n` if the transform makes it zero.
    Vec3d Normal(const Vec3d &n) const;
    /// Of A; below 0: it mirrors.
    double Determinant() const;
};
/// Scales, rotates by roll, then pitch, then yaw (degrees), and adds the origin.
ModelTransform MakeModelTransform(const Vec3d &scale, const Vec3d &pitchYawRoll, const Vec3d &origin);
/// Scale of an entity's model along its axes: the key "modelscale_vec", else "modelscale".
Vec3d ModelScaleOf(const Entity &entity);
/// Pitch, yaw and roll of an entity in degrees: the key "angles", else "angle" as yaw.
Vec3d AnglesOf(const Entity &entity);

/// Whether the file begins as an MD3 model does.
bool IsMd3(std::span<const std::byte> file);
/// The meshes and vertices of an MD3 model as an engine has them: nothing is joined, split or left out. modelName: for
/// shader names, see ShaderOfMaterial. Errors: a version other than 15, no such frame, parts outside the file.
Model ReadMd3(std::span<const std::byte> file, std::string_view modelName, int frame);

} // namespace q3
