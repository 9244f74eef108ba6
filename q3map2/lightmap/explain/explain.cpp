// GPL-2.0-or-later. Explains why points of a map are lit as they are: -explain.
#include "q3map2/lightmap/explain/explain.h"

#include "q3map2/bspfile/light_keys.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"

namespace q3 {

Explainer::Explainer(const Bsp &bsp, const LightInputs &inputs, const std::string &mapText, const std::string &mapName,
                     const LightOptions &options, const LightmapOptions &lightmap, ShaderLibrary &library,
                     const Game &game, const JobPool &jobs, Log &log)
    : quiet_(Log::Nowhere()),
      setup_(bsp, inputs, options, SurfaceDefaultsOf(lightmap), library, log), lightmap_(lightmap),
      source_(inputs.mapEntities.value_or(setup_.stored),
              inputs.mapEntities && keys::kKeepLights.Flag(setup_.stored.front())
                  ? std::optional(setup_.stored)
                  : std::optional<std::vector<Entity>>(),
              !inputs.mapEntities || !inputs.surfaceFile.empty()),
      obstacles_(setup_, source_), lights_(setup_, source_, obstacles_),
      prepared_(PrepareLights(setup_, LightPass::GridSH, lightmap_.fastPoint)),
      grid_(setup_, obstacles_, jobs), in_{setup_.bsp, setup_.space, setup_.scene, setup_.table, setup_.options,
                                           lightmap_,  setup_.world, jobs,         quiet_},
      luxels_(in_, setup_, source_, obstacles_) {
    if (!mapText.empty())
        source_.Read(mapText, mapName, game, library, log);
}

PlaceAccount Explainer::PlaceOf(const Vec3f &p) const {
    const Bsp &bsp = setup_.bsp;
    PlaceAccount place;
    place.point = p;
    place.leaf = LeafAt(bsp, p);
    place.area = bsp.leafs[std::size_t(place.leaf)].area;
    place.cluster = setup_.space.ClusterAt(p, 0);
    place.solid = obstacles_.SolidAt(p);
    return place;
}

std::optional<SurfacePlace> Explainer::PlaceBefore(const SurfaceTriangle &triangle, const Vec3f &p) const {
    constexpr float kPlayerOrigin = 24; // height of a player's origin over the floor. Game units
    constexpr float kStart = 0.5f;      // off the surface, so that rays do not meet it. Game units
    const Vec3f from = p + triangle.normal * kStart;
    for (const float height : {kPlayerOrigin, kPlayerOrigin / 3, 2.0f}) {
        const Vec3f point = p + triangle.normal * height;
        const ShadowRay ray{triangle.normal, height - kStart};
        if (PlaceInOpen(setup_.space, point).state == PointState::Open &&
            obstacles_.Blocking(from, {&ray, 1}, {}).empty())
            return SurfacePlace{triangle.surface, p, point};
    }
    return {};
}

Explanation Explainer::Explain(const Vec3f &p) const {
    Explanation result;
    result.place = PlaceOf(p);
    result.bounces = lightmap_.bounces > 0;
    PlacedPoint from = PlaceInOpen(setup_.space, p);
    if (from.state != PointState::Open && from.cluster < 0)
        from = PlaceBeside(setup_.space, p);
    if (from.cluster >= 0) {
        result.place.litFrom = from.position;
        result.lights = lights_.AtPoint(prepared_, from.position, from.cluster);
    }
    const LightOptions &options = setup_.options;
    if (options.sh || options.shAdaptive || setup_.bsp.gridSH)
        result.grid = grid_.CellAt(p);
    if (!options.noGrid)
        result.legacy = grid_.LegacyCellAt(p);
    if (!lightmap_.onlyGrid)
        result.luxel = luxels_.NearestTo(p);
    return result;
}

} // namespace q3
