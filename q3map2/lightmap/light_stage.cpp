// GPL-2.0-or-later. The light stage: a compiled map in, a lit one out.
#include "q3map2/lightmap/light_stage.h"

#include "common/platform/platform.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/light/options/light_tone.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sources/light_units.h"
#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/lightmap/raw/luxel_map.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "q3map2/lightmap/raw/macro_texture.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/vertex/vertex_light.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>

namespace q3 {

namespace {

bool HasStyledLights(const LightSetup &setup) {
    return std::ranges::any_of(setup.lights, [](const Light &light) { return light.style != 0; });
}

SurfaceInputs InputsOf(const LightSetup &setup, const LightmapOptions &lightmap, const JobPool &jobs, Log &log) {
    const bool gamePagesOnly = setup.options.styleSlots && !lightmap.external && HasStyledLights(setup);
    return {setup.bsp,   setup.space, setup.scene, setup.table,   setup.options, lightmap,
            setup.world, jobs,        log,         gamePagesOnly, setup.units};
}

struct PreparedLights {
    std::vector<Light> lights;
    int culled = 0; ///< number of lights left out
};

/// `created` prepared for lightmaps and vertices.
PreparedLights LightsForSurfaces(const std::vector<Light> &created, const LightSetup &setup,
                                 const LightmapOptions &lightmap) {
    PreparedLights prepared;
    prepared.lights = SetupEnvelopes(created, LightPass::Surfaces, setup.options, setup.space, setup.skySeenFrom,
                                     prepared.culled, lightmap.fastPoint);
    return prepared;
}

} // namespace

// ---- The passes of the light stage over the surfaces of a map ----

SurfacePasses::SurfacePasses(const LightSetup &setup, const LightmapOptions &lightmap, const JobPool &jobs, Log &log,
                             const SurfacePassesOptions &options)
    : setup_(setup), in_(InputsOf(setup, lightmap, jobs, log)), options_(options), surfaces_(Prepare()) {}

SurfaceLight SurfacePasses::Prepare() {
    in_.log.Section("SetupSurfaceLightmaps");
    SurfaceLight surfaces = SetupSurfaceLight(in_);
    surfaces.styled = HasStyledLights(setup_);
    if (in_.lightmap.shade)
        SmoothNormals(in_, surfaces);
    in_.log.Section("MapRawLightmap");
    MapLuxels(in_, surfaces);
    FindTangents(in_, surfaces);
    FindTints(in_, surfaces);
    if (in_.lightmap.dirty) {
        in_.log.Section("DirtyRawLightmap");
        DirtLuxels(in_, surfaces);
    }
    if (options_.floodlight)
        FloodLuxels(in_, surfaces);
    return surfaces;
}

void SurfacePasses::Run() {
    in_.log.Section("IlluminateRawLightmap");
    Pass(setup_.lights, {}, nullptr);
    if (in_.units && in_.units->IsPartOfFirstRound())
        return;
    if (in_.lightmap.lightmass)
        FindMasks();
    if (in_.lightmap.bounces > 0)
        Bounce();
    else
        AverageLuxels(in_, {}, options_.keepLuxels ? PassData::Keep : PassData::Free, surfaces_);
    if (in_.lightmap.show == DebugView::Light)
        ApplyTints(in_, surfaces_);
}

void SurfacePasses::Bounce() {
    in_.log.Section("Radiosity");
    const CpuTimer timer;
    AverageLuxels(in_, {}, PassData::Keep, surfaces_);
    bounces_.emplace(in_, surfaces_);
    in_.log.Count(bounces_->Rays(), "radiosity rays");
    if (!bounces_->Solve(surfaces_))
        return in_.log.Print("No surface reflects light\n");
    in_.log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
    if (in_.units && in_.units->IsPart())
        return; // the last join gathers: that takes little
    in_.log.Section("Final gathering");
    Pass({}, {.bounce = true}, &*bounces_);
    AverageLuxels(in_, {.bounce = true}, options_.keepLuxels ? PassData::Keep : PassData::Free, surfaces_);
}

BouncedLight SurfacePasses::ForGrids() const {
    if (!bounces_ || !in_.lightmap.bounceGrid)
        return {};
    BouncedLight bounced{.steady = bounces_->ForPoints(), .styled = {}};
    if (in_.options.styleSlots)
        bounced.styled = bounces_->StyledForPoints();
    return bounced;
}

StoredLightmaps SurfacePasses::Store(std::string_view mapName, Bsp &bsp) {
    in_.log.Section("StoreSurfaceLightmaps");
    return StoreLightmaps(in_, surfaces_, mapName, bsp);
}

/// Sky occlusion and shadow masks of -lightmass.
void SurfacePasses::FindMasks() {
    FindOcclusion(in_, surfaces_);
    if (in_.lightmap.shadowMaps.empty())
        return;
    FindVisibility(in_, LightsForSurfaces(setup_.lights, setup_, in_.lightmap).lights, surfaces_, counts_);
}

void SurfacePasses::Pass(const std::vector<Light> &created, const SurfacePass &pass, const Bounces *bounces) {
    const CpuTimer timer;
    const std::uint64_t raysBefore = counts_.rays;
    const auto [lights, culled] = LightsForSurfaces(created, setup_, in_.lightmap);
    if (!bounces) {
        in_.log.Count(lights.size(), "lights");
        in_.log.Count(culled, "lights culled");
    }
    LightLuxels(in_, lights, pass, surfaces_, counts_);
    if (in_.units && in_.units->IsPartOfFirstRound()) // vertices of other surfaces need complete lightmaps
        return LightVertices(in_, lights, pass, surfaces_, counts_);
    if (bounces)
        bounces->AddToLuxels(surfaces_);
    FinishLuxels(in_, pass, surfaces_);
    LightVertices(in_, lights, pass, surfaces_, counts_);
    if (bounces)
        bounces->AddToVertices(surfaces_);
    if (!bounces)
        in_.log.Count(counts_.rays - raysBefore, "rays");
    in_.log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
}

// ---- Units: what results depend on, and the rounds of parts ----

namespace {

void AddEntity(const Entity &entity, KeyBuilder &key) {
    key.Add(std::uint64_t(entity.pairs.size()));
    for (const auto &[name, value] : entity.pairs)
        if (!name.starts_with("_q3map2_"))
            key.AddText(name), key.AddText(value);
}

/// Of everything that results depend on besides lights and geometry: settings, the keys of the world and of models, and
/// the game's files that were read.
Hash128 HashOfInputs(const LightSetup &setup, const LightInputs &inputs) {
    KeyBuilder key("light");
    const auto add = [&](const Hash128 &hash) { key.Add(hash.low, hash.high); };
    add(inputs.units->settings);
    for (std::size_t i = 0; i < setup.bspEntities.size(); ++i)
        if (i == 0 || !setup.bspEntities[i].Value("model").empty())
            AddEntity(setup.bspEntities[i], key);
    if (inputs.vfs)
        add(inputs.vfs->AnswersTo(inputs.vfs->Requests()));
    return key.Key();
}

/// Of the geometry, settings of surfaces, and the visibility data.
Hash128 HashOfGeometry(const Bsp &bsp, std::string_view surfaceFile) {
    KeyBuilder key("geometry");
    key.AddText(surfaceFile);
    const auto addLump = [&](const auto &records) {
        const Hash128 hash = HashOf(std::as_bytes(std::span(records)));
        key.Add(hash.low, hash.high);
    };
    addLump(bsp.shaders), addLump(bsp.planes), addLump(bsp.nodes), addLump(bsp.leafs), addLump(bsp.leafSurfaces);
    addLump(bsp.leafBrushes), addLump(bsp.models), addLump(bsp.brushes), addLump(bsp.brushSides);
    addLump(bsp.drawVerts), addLump(bsp.drawIndexes), addLump(bsp.fogs), addLump(bsp.drawSurfaces);
    addLump(bsp.visibility);
    return key.Key();
}

using Fingerprint = LightScene::Fingerprint;

/// Boxes of triangles that are in only one of two scenes; at most kMostBoxes, else one around all.
std::vector<Boundsf> ChangedBoxes(std::span<const Fingerprint> before, std::span<const Fingerprint> after) {
    constexpr std::size_t kMostBoxes = 512;
    std::vector<Fingerprint> changed;
    std::ranges::set_symmetric_difference(before, after, std::back_inserter(changed), {}, &Fingerprint::hash,
                                          &Fingerprint::hash);
    std::vector<Boundsf> boxes;
    for (const Fingerprint &one : changed)
        boxes.push_back(one.box);
    if (boxes.size() <= kMostBoxes)
        return boxes;
    Boundsf all;
    for (const Boundsf &box : boxes)
        all.Add(box.mins), all.Add(box.maxs);
    return {all};
}

/// Compares the scene with that of the run whose results the cache holds, and keeps this one.
void CompareScene(const LightScene &scene, UnitStore &units) {
    const Hash128 key = HashOf("scene of a run");
    const std::vector<Fingerprint> &now = scene.Fingerprints();
    std::vector<Fingerprint> before;
    if (const auto bytes = units.TakeLoaded(key)) {
        UnitReader reader(*bytes);
        reader.GetAll(before);
    }
    units.changedBoxes = ChangedBoxes(before, now);
    UnitWriter writer;
    writer.PutAll(now);
    units.Keep(key, writer.Take());
}

/// To be called when the setup is complete: results that do not fit the inputs are dropped or refused.
void BeginUnits(const LightSetup &setup, const LightInputs &inputs) {
    UnitStore &units = *inputs.units;
    units.geometry = HashOfGeometry(setup.bsp, inputs.surfaceFile);
    KeyBuilder key("inputs");
    const auto add = [&](const Hash128 &hash) { key.Add(hash.low, hash.high); };
    add(HashOfInputs(setup, inputs));
    if (!units.IsCache())
        add(HashOfLights(setup.lights));
    // Light that passes through several see-through surfaces is multiplied in the order in which rays meet them, which
    // is that of a tree over all of them.
    if (!units.IsCache() || setup.scene.HasFilters())
        add(units.geometry);
    units.Begin(key.Key());
    if (units.IsCache())
        CompareScene(setup.scene, units);
}

/// What a part of a run computes after direct light on surfaces. Bounced light needs that of all parts, so what depends
/// on it is computed in a second round.
struct PartOfRun {
    bool props = true, grids = true;
};
PartOfRun PartOf(const UnitStore *units, const LightOptions &options, const LightmapOptions &lightmap) {
    if (!units || !units->IsPart())
        return {};
    const bool isFirst = units->IsPartOfFirstRound(), gridsBounce = lightmap.bounces > 0 && lightmap.bounceGrid;
    return {.props = isFirst == !(lightmap.bounces > 0 && options.staticPropLighting),
            .grids = isFirst == !gridsBounce};
}

/// The grids whose points are units: the legacy grid and the uniform SH grid.
void LightPartOfGrids(const LightSetup &setup, const BouncedLight &bounced, const JobPool &jobs, Log &log,
                      LightResult &result) {
    const LightOptions &options = setup.options;
    if (!options.noGrid)
        LightLegacyGrid(setup, bounced, jobs, log, result.grid);
    if (options.sh || (options.shAdaptive && !options.shLights))
        BakeGridSH(setup, bounced.steady.get(), jobs, log, result.gridSH);
}

} // namespace

bool HasSecondRound(const LightOptions &options, const LightmapOptions &lightmap) {
    const bool grids = lightmap.bounceGrid && (!options.noGrid || options.sh || options.shAdaptive);
    return lightmap.bounces > 0 && (grids || options.staticPropLighting);
}

// ---- Surfaces, props, grids and storing, in this order ----

namespace {

/// Records the tone mapping of the lightmaps, which readers of the SH grid apply too. -onlygrid keeps the lightmaps and
/// so their record. If they have none, another program may have lit them: `tone`, the settings of this run, is
/// recorded.
void RecordTone(const std::string &tone, const LightmapOptions &lightmap, const LightOptions &options, Entity &world,
                Log &log) {
    const std::string recorded(world.Value(kToneKey));
    if (lightmap.onlyGrid && !recorded.empty()) {
        if (!options.noGrid && recorded != tone)
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
        if (IsLight(entity))
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
    const SurfaceInputs in = InputsOf(setup, lightmap, jobs, log);
    std::vector<Light> lights = LightsForSurfaces(setup.lights, setup, lightmap).lights;
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
    std::vector<std::string> shaders;
    for (const bspShader_t &shader : bsp.shaders)
        shaders.emplace_back(FieldName(shader.shader));
    library.ReadAhead(shaders, jobs);
    LightSetup setup(bsp, inputs, options, SurfaceDefaultsOf(lightmap), library, log);
    const PartOfRun part = PartOf(inputs.units, options, lightmap);
    // Bounced light comes from lit surfaces, whether or not they are stored.
    const bool gridBounces = lightmap.bounces > 0 && lightmap.bounceGrid;
    const bool lightSurfaces =
        !lightmap.onlyGrid || gridBounces || (lightmap.bounces > 0 && setup.options.staticPropLighting);
    const bool bounces = lightmap.bounces > 0 && lightSurfaces;
    library.ReleaseImages(bounces ? KeptImages::OfReflectors : KeptImages::SeeThrough, jobs);
    LightResult result;
    std::optional<SurfacePasses> surfaces;
    BouncedLight bounced;
    if (lightSurfaces)
        surfaces.emplace(setup, lightmap, jobs, log);
    if (inputs.units)
        BeginUnits(setup, inputs);
    if (lightSurfaces) {
        surfaces->Run();
        bounced = surfaces->ForGrids();
        result.surfaces = surfaces->Counts();
    }
    if (setup.options.staticPropLighting && part.props)
        LightStaticProps(setup, lightmap, surfaces ? surfaces->Bounced() : nullptr, jobs, log, result);
    if (inputs.units && inputs.units->IsPart()) {
        if (part.grids)
            LightPartOfGrids(setup, bounced, jobs, log, result);
        return result;
    }
    for (const StaleAfter staleAfter : {StaleAfter::EveryBake, StaleAfter::SurfaceBake})
        if (MakesStale(staleAfter, lightmap.onlyGrid))
            DropStaleLumps(bsp, staleAfter);
    if (setup.options.staticPropLighting)
        bsp.propLight = PackPropLight(setup.props, result.props);
    setup.bspEntities.front().Erase(kGridSHKey);
    RecordTone(ToneText(setup.options.tone, lightmap.brightness), lightmap, options, setup.bspEntities.front(), log);
    if (!options.noGrid)
        bsp.gridPoints = LightLegacyGrid(setup, bounced, jobs, log, result.grid);
    if (options.sh || (options.shAdaptive && !options.shLights)) {
        BakedGridSH baked = BakeGridSH(setup, bounced.steady.get(), jobs, log, result.gridSH);
        bsp.gridSH = std::move(baked.uniform);
        bsp.gridSHContainer = options.shBspx || options.styleSlots ? GridSHContainer::Bspx : GridSHContainer::Lump;
        bsp.sparseGridSH = std::move(baked.sparse);
        if (options.shRadiance)
            setup.bspEntities.front().Set(kGridSHKey, kRadiance);
    }
    if (options.shLights)
        bsp.namedGridSH = BakeNamedGridSH(setup, bounced.steady.get(), jobs, log, result.gridSH);
    if (options.ambientCubes)
        bsp.ambientCubes =
            BakeAmbientCubes(setup, bounced.steady.get(), bsp.gridSH ? &*bsp.gridSH : nullptr, jobs, log, result.cubes);
    if (!options.sh)
        bsp.gridSH.reset();
    if (!lightmap.onlyGrid) {
        RecordStyles(setup.styles, setup.bspEntities);
        bsp.entities = FormatEntities(setup.bspEntities); // generated shaders depend on keys of the world
        result.lightmaps = surfaces->Store(inputs.name, bsp);
        StoreHdrLight(lightmap, result.lightmaps, bsp);
        RecordRnm(lightmap, result.lightmaps, setup.bspEntities.front());
    }
    bsp.entities = FormatEntities(setup.bspEntities);
    return result;
}

} // namespace q3
