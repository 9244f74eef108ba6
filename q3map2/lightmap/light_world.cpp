// GPL-2.0-or-later. The light stage.
#include "q3map2/lightmap/light_world.h"

#include "q3map2/bspfile/written_keys.h"
#include "q3map2/light/sources/light_envelope.h"
#include "q3map2/light/tone/light_tone.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/surface_passes.h"

#include <memory>
#include <optional>

namespace q3 {

namespace {

/// Records the tone mapping of the lightmaps, which readers of the SH grid apply too. -onlygrid keeps the lightmaps and
/// so their record. If they have none, another program may have lit them: `tone`, the settings of this run, is
/// recorded.
void RecordTone(const std::string &tone, bool onlyGrid, bool lightsGrid, Entity &world, Log &log) {
    const std::string recorded(world.Value(kToneKey));
    if (onlyGrid && !recorded.empty()) {
        if (lightsGrid && recorded != tone)
            log.Warn("tone of the lightmaps", "-onlygrid keeps lightmaps of tone \"{}\", but lights the legacy grid {}",
                     recorded, tone.empty() ? "without one" : fmt::format("with \"{}\"", tone));
        return;
    }
    world.Erase(kToneKey);
    if (!tone.empty())
        world.Set(kToneKey, tone);
}

/// Styles of patterns and switches: keys of the world, and of the light entities that stay in the map.
void RecordStyles(const LightStyles &styles, std::vector<Entity> &entities) {
    styles.Record(entities.front());
    for (Entity &entity : entities)
        if (StartsWithNoCase(entity.ClassName(), "light"))
            styles.Set(entity);
}

void RecordRnm(const LightmapOptions &options, const StoredLightmaps &stored, Entity &world) {
    world.Erase(kRnmKey);
    if (std::any_of(stored.pages.begin(), stored.pages.end(), [](const auto &page) { return page.HasBasis(); }))
        world.Set(kRnmKey, RnmStorageWord(options.rnmRescaled ? RnmStorage::Rescaled : RnmStorage::Raw));
}

/// Sets result.props.
void LightStaticProps(const LightSetup &setup, const LightmapOptions &lightmap, const Bounces *bounces,
                      const JobPool &jobs, Log &log, LightResult &result) {
    log.Section("LightStaticProps");
    const SurfaceInputs in{setup.bsp, setup.space, setup.scene, setup.table, setup.options,
                           lightmap,  setup.world, jobs,        log};
    int culled = 0;
    std::vector<Light> lights = SetupEnvelopes(setup.lights, LightPass::Surfaces, setup.options, setup.space,
                                               setup.skySeenFrom, culled, lightmap.fastPoint);
    PropBounce bounce;
    const std::unique_ptr<IndirectLight> indirect = bounces ? bounces->ForPoints() : nullptr;
    if (indirect) {
        bounce.indirect = indirect.get();
        bounce.irradiance = [bounces](const Vec3f &position, const Vec3f &normal, bool twoSided) {
            return bounces->IrradianceAt(position, normal, twoSided);
        };
    }
    result.props = LightProps(in, setup.props, std::move(lights), bounce, result.surfaces);
}

} // namespace

LightResult LightWorld(Bsp &bsp, const LightInputs &inputs, const LightOptions &options,
                       const LightmapOptions &lightmap, ShaderLibrary &library, const JobPool &jobs, Log &log) {
    LightSetup setup(bsp, inputs, options, SurfaceDefaultsOf(lightmap), library, log);
    // Bounced light comes from lit surfaces, whether or not they are stored.
    const bool gridBounces = lightmap.bounces > 0 && lightmap.bounceGrid;
    const bool lightSurfaces =
        !lightmap.onlyGrid || gridBounces || (lightmap.bounces > 0 && setup.options.staticPropLighting);
    library.ReleaseImages(lightmap.bounces > 0 && lightSurfaces);
    LightResult result;
    std::optional<SurfacePasses> surfaces;
    std::unique_ptr<IndirectLight> bounced;
    if (lightSurfaces) {
        surfaces.emplace(setup, lightmap, jobs, log);
        surfaces->Run();
        bounced = surfaces->ForGrids();
        result.surfaces = surfaces->Counts();
    }
    if (setup.options.staticPropLighting)
        LightStaticProps(setup, lightmap, surfaces ? surfaces->Bounced() : nullptr, jobs, log, result);
    if (setup.options.staticPropLighting || !lightmap.onlyGrid)
        SetPropLight(bsp, PackPropLight(setup.props, result.props));
    bsp.gridSH.reset();
    bsp.sparseGridSH.reset();
    bsp.ambientCubes.reset();
    setup.stored.front().Erase(kGridSHKey);
    RecordTone(ToneText(setup.options.tone, lightmap.brightness), lightmap.onlyGrid, !options.noGrid,
               setup.stored.front(), log);
    if (!options.noGrid)
        bsp.gridPoints = LightLegacyGrid(setup, bounced.get(), jobs, log, result.grid);
    if (options.sh || options.shAdaptive) {
        BakedGridSH baked = BakeGridSH(setup, bounced.get(), jobs, log, result.gridSH);
        bsp.gridSH = std::move(baked.uniform);
        bsp.gridSHContainer = options.shBspx ? GridSHContainer::Bspx : GridSHContainer::Lump;
        bsp.sparseGridSH = std::move(baked.sparse);
        if (options.shRadiance)
            setup.stored.front().Set(kGridSHKey, kRadiance);
    }
    if (options.ambientCubes)
        bsp.ambientCubes =
            BakeAmbientCubes(setup, bounced.get(), bsp.gridSH ? &*bsp.gridSH : nullptr, jobs, log, result.cubes);
    if (!options.sh)
        bsp.gridSH.reset();
    if (!lightmap.onlyGrid) {
        ClearHdrLight(bsp);
        RecordStyles(setup.styles, setup.stored);
        bsp.entities = FormatEntities(setup.stored); // generated shaders depend on keys of the world
        result.lightmaps = surfaces->Store(inputs.name, bsp);
        StoreHdrLight(lightmap, result.lightmaps, bsp);
        RecordRnm(lightmap, result.lightmaps, setup.stored.front());
    }
    bsp.entities = FormatEntities(setup.stored);
    return result;
}

} // namespace q3
