// GPL-2.0-or-later. Models among the surfaces of an entity.
#pragma once

#include "q3map2/geometry/model_load.h"
#include "q3map2/geometry/surface.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Spawnflags of misc_model.
enum ModelFlags : unsigned {
    kModelRenameAlternative = 1,
    kModelClip = 2,
    kModelForceMeta = 4,
    kModelClipFaceNormals = 8,
    kModelClipTerrain = 16,
    kModelColorToAlpha = 32,
    kModelClipVertexNormals = 128,
    kModelClipPyramid = 256,
    kModelClipDown = 512,
    kModelClipUp = 1024,
    kModelClipFull = 2048,
    kModelClipAxialBack = 4096
};
inline constexpr unsigned kModelClipShapes = kModelClipFaceNormals | kModelClipTerrain | kModelClipVertexNormals |
                                             kModelClipPyramid | kModelClipDown | kModelClipUp | kModelClipFull |
                                             kModelClipAxialBack;

/// point' = linear . point + origin.
struct ModelTransform {
    std::array<Vec3d, 3> rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d origin;

    Vec3d Point(const Vec3d &p) const;
    /// By the inverse transpose; unit length. A flat transform leaves the normal as it is.
    Vec3d Normal(const Vec3d &n) const;
    double Determinant() const;
};
/// Scale, then roll, pitch and yaw in degrees, then the origin.
ModelTransform MakeModelTransform(const Vec3d &scale, const Vec3d &pitchYawRoll, const Vec3d &origin);

/// Another shader for a material; empty: the mesh is left out.
using ShaderMap = std::function<std::string(std::string_view)>;

struct ModelPlacement {
    std::string name;
    std::string who; ///< MapEntity::Who of its entity, for messages
    int frame = 0;
    ModelTransform transform;
    SurfaceSettings settings;
    unsigned flags = 0;
    double clipDepth = 2;
    ShaderMap shaders; ///< none: the model's own
    int fogNum = -1;
};

/// Surfaces of a model, and clip brushes where flags or shaders ask for them: appended to the brushes of `target`, so
/// that numbers of others stay. False: the model cannot be read; a warning names it and the entity.
bool PlaceModel(const ModelPlacement &placement, MapEntity &target, Geometry &geometry, PlaneTable &planes,
                const BspContext &context);

/// model_clip.cpp. Brushes for the solid triangles of a placed mesh.
struct ClipMesh {
    const ShaderInfo *shader = nullptr;
    std::vector<Vec3f> points, normals;
    std::vector<std::array<int, 3>> triangles;
};
void MakeClipBrushes(const std::vector<ClipMesh> &meshes, const ModelPlacement &placement, MapEntity &target,
                     PlaneTable &planes, const BspContext &context);

/// model_skin.cpp. What the skin file and the _remap keys of a misc_model say.
ShaderMap ShaderMapOf(const MapEntity &entity, std::string_view model, const BspContext &context);

} // namespace q3
