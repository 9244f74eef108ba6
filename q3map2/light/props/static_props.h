// GPL-2.0-or-later. Static props: models placed by entities, which the game draws and the light stage lights.
#pragma once

#include "common/files/vfs.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/scene/shadow_casters.h"
#include "q3map2/model/model_load.h"
#include "q3map2/shader/shader_library.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
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

/// A model placed by an entity.
struct StaticProp {
    std::size_t entity = 0; ///< number among the entities of the .bsp
    std::string name;       ///< of the model, as in the entity's key
    const PropModel *model = nullptr;
    ModelTransform transform;
    Boundsf bounds;                          ///< in world space
    bool selfShadows = true;                 ///< its shadow casters shadow its own vertices
    bool vertexLight = true;                 ///< it gets light at its vertices
    bool ignoresNormals = false;             ///< its vertices count as facing every light
    int receiveShadows = 1;                  ///< shadow group, see LightScene::TraceSurfaceToLight
    std::optional<Vec3f> lightingOrigin;     ///< origin of the entity that its key lightingorigin names
    std::vector<const ShaderInfo *> shaders; ///< by mesh; null: the skin leaves the mesh out
    std::vector<int> surfaces;               ///< surface numbers of its shadow casters: after all draw surfaces
};

/// All static props of a map. Const after loading.
struct StaticProps {
    std::vector<StaticProp> props;
    PropShadows shadows;
    std::shared_ptr<PropModels> models;             ///< owns the models of the props
    std::shared_ptr<std::deque<ShaderInfo>> masked; ///< shaders of casters that block light by their image's alpha
};

/// Whether the light stage treats the entity as a static prop.
bool IsStaticProp(const Entity &entity);

/// A predicate on the name of a model.
using ModelTest = std::function<bool(std::string_view model)>;

/// Loads the props of a map; none unless options.staticPropLighting or staticPropPolys is set. drawSurfaces: number of
/// draw surfaces of the map. textureShadows: models that cast shadows by texture even without options.textureShadows.
/// Unreadable models and bad keys cause warnings.
StaticProps LoadStaticProps(std::span<const Entity> entities, const VirtualFileSystem *vfs, int drawSurfaces,
                            const ModelTest &textureShadows, const LightOptions &options, ShaderLibrary &library,
                            Log &log);

} // namespace q3
