// GPL-2.0-or-later. Static props: entities with a model that the game draws and the light stage lights.
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
    std::size_t entity = 0; ///< number among the stored entities
    std::string name;       ///< of the model, as the entity names it
    const PropModel *model = nullptr;
    ModelTransform transform;
    Boundsf bounds; ///< in the world
    bool selfShadows = true, vertexLight = true, ignoresNormals = false;
    int receiveShadows = 1;                  ///< shadow group
    std::optional<Vec3f> lightingOrigin;     ///< of its key
    std::vector<const ShaderInfo *> shaders; ///< by mesh; null: the skin leaves the mesh out
    std::vector<int> surfaces;               ///< its surface numbers as a shadow caster
};

/// All static props of a map. Const after loading.
struct StaticProps {
    std::vector<StaticProp> props;
    PropShadows shadows;
    std::shared_ptr<PropModels> models;
    std::shared_ptr<std::deque<ShaderInfo>> masked; ///< copies of shaders that block light by their image's alpha
};

/// Whether the light stage takes the entity as a static prop.
bool IsStaticProp(const Entity &entity);

/// Whether something holds for the model of that name.
using ModelTest = std::function<bool(std::string_view model)>;

/// Loads the props of a map; none unless options.staticPropLighting or staticPropPolys. drawSurfaces: how many the map
/// has. textureShadows: models of which options.textureShadows holds in any case. Models that cannot be read, and bad
/// keys, are warnings.
StaticProps LoadStaticProps(std::span<const Entity> entities, const VirtualFileSystem *vfs, int drawSurfaces,
                            const ModelTest &textureShadows, const LightOptions &options, ShaderLibrary &library,
                            Log &log);

} // namespace q3
