// GPL-2.0-or-later. Static props: models placed by entities, which the game draws and the light stage lights.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/props/prop_model.h"
#include "q3map2/light/scene/prop_casters.h"
#include "q3map2/model/model_transform.h"
#include "q3map2/shader/shader_library.h"

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A model placed by an entity.
struct StaticProp {
    std::size_t entity = 0; ///< number among the entities of the .bsp
    std::string name;       ///< of the model, as in the entity's key
    const PropModel *model = nullptr;
    ModelTransform transform;
    Boundsf bounds; ///< in world space
    bool selfShadows = true, vertexLight = true, ignoresNormals = false;
    int receiveShadows = 1;                  ///< shadow group
    std::optional<Vec3f> lightingOrigin;     ///< origin of the entity that its key lightingorigin names
    std::vector<const ShaderInfo *> shaders; ///< by mesh; null: the skin leaves the mesh out
    std::vector<int> surfaces;               ///< surface numbers of its shadow casters: after all draw surfaces
};

/// All static props of a map. Const after loading.
struct StaticProps {
    std::vector<StaticProp> props;
    PropShadows shadows;
    std::shared_ptr<PropModels> models;
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
