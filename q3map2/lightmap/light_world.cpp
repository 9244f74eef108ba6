// GPL-2.0-or-later. The light stage.
#include "q3map2/lightmap/light_world.h"

#include "common/cpu_time.h"
#include "q3map2/bspfile/written_keys.h"
#include "q3map2/light/sources/light_envelope.h"
#include "q3map2/light/tone/light_tone.h"
#include "q3map2/lightmap/ao/luxel_dirt.h"
#include "q3map2/lightmap/ao/luxel_flood.h"
#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "q3map2/lightmap/bounce/light_bounce.h"
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/direct/luxel_fill.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/direct/luxel_visibility.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/lightmap/raw/lightmap_shade.h"
#include "q3map2/lightmap/raw/luxel_map.h"
#include "q3map2/lightmap/raw/luxel_tangents.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/vertex/vertex_light.h"

#include <memory>
#include <optional>

namespace q3 {

namespace {

/// The passes over surfaces, from setup to storing.
class SurfacePasses {
  public:
    SurfacePasses(const LightSetup &setup, const LightmapOptions &lightmap, const JobPool &jobs, Log &log)
        : setup_(setup), in_{setup.bsp, setup.space, setup.scene, setup.table, setup.options,
                             lightmap,  setup.world, jobs,        log},
          surfaces_(Prepare()) {}

    /// Direct light and all bounces. Call once.
    void Run() {
        in_.log.Section("IlluminateRawLightmap");
        Pass(setup_.lights, {}, nullptr);
        if (in_.lightmap.lightmass)
            FindMasks();
        const int bounces = in_.lightmap.bounces;
        for (int bounce = 1; bounce <= bounces; ++bounce) {
            in_.log.Section(fmt::format("Radiosity (bounce {} of {})", bounce, bounces));
            AverageLuxels(in_, {.bounce = bounce > 1}, false, surfaces_);
            if (!bounces_) {
                bounces_.emplace(in_, surfaces_);
                in_.log.Count((long long)(bounces_->Rays()), "rays gather the light of bounces");
            }
            if (!bounces_->CollectRadiosity(surfaces_)) {
                in_.log.Print("No light is left to bounce\n");
                averaged_ = true;
                break;
            }
            Pass({}, {.bounce = true}, &*bounces_);
        }
        if (!averaged_)
            AverageLuxels(in_, {.bounce = bounces > 0}, true, surfaces_);
    }
    /// -bouncegrid: bounced light for the light grids; else null.
    std::unique_ptr<IndirectLight> ForGrids() const {
        if (!bounces_ || !in_.lightmap.bounceGrid)
            return nullptr;
        return std::make_unique<BouncedLight>(bounces_->Total());
    }
    /// Call last: it moves the results out.
    StoredLightmaps Store(std::string_view mapName, Bsp &bsp) {
        in_.log.Section("StoreSurfaceLightmaps");
        return StoreLightmaps(in_, surfaces_, mapName, bsp);
    }
    const ContributionCounts &Counts() const { return counts_; }

  private:
    SurfaceLight Prepare() {
        in_.log.Section("SetupSurfaceLightmaps");
        SurfaceLight surfaces = SetupSurfaceLight(in_);
        if (in_.lightmap.shade)
            SmoothNormals(in_, surfaces);
        in_.log.Section("MapRawLightmap");
        MapLuxels(in_, surfaces);
        FindTangents(in_, surfaces);
        if (in_.lightmap.dirty) {
            in_.log.Section("DirtyRawLightmap");
            DirtLuxels(in_, surfaces);
        }
        FloodLuxels(in_, surfaces);
        return surfaces;
    }
    /// Sky occlusion and shadow masks of -lightmass.
    void FindMasks() {
        FindOcclusion(in_, surfaces_);
        if (in_.lightmap.shadowMaps.empty())
            return;
        int culled = 0;
        const std::vector<Light> lights = SetupEnvelopes(setup_.lights, LightPass::Surfaces, in_.options, in_.space,
                                                         setup_.skySeenFrom, culled, in_.lightmap.fastPoint);
        FindVisibility(in_, lights, surfaces_, counts_);
    }
    void Pass(const std::vector<Light> &created, const SurfacePass &pass, const Bounces *bounces) {
        const CpuTimer timer;
        const std::uint64_t raysBefore = counts_.rays;
        int culled = 0;
        const std::vector<Light> lights = SetupEnvelopes(created, LightPass::Surfaces, in_.options, in_.space,
                                                         setup_.skySeenFrom, culled, in_.lightmap.fastPoint);
        if (!bounces) {
            in_.log.Count((long long)(lights.size()), "lights");
            in_.log.Count(culled, "lights culled");
        }
        LightLuxels(in_, lights, pass, surfaces_, counts_);
        if (bounces)
            bounces->AddToLuxels(surfaces_);
        FinishLuxels(in_, pass, surfaces_);
        LightVertices(in_, lights, pass, surfaces_, counts_);
        if (bounces)
            bounces->AddToVertices(surfaces_);
        if (!bounces)
            in_.log.Count((long long)(counts_.rays - raysBefore), "rays");
        in_.log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
    }

    const LightSetup &setup_;
    const SurfaceInputs in_;
    SurfaceLight surfaces_;
    std::optional<Bounces> bounces_;
    ContributionCounts counts_;
    bool averaged_ = false;
};

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

void RecordRnm(const LightmapOptions &options, const StoredLightmaps &stored, Entity &world) {
    world.Erase(kRnmKey);
    if (std::any_of(stored.pages.begin(), stored.pages.end(), [](const auto &page) { return page.HasBasis(); }))
        world.Set(kRnmKey, RnmStorageWord(options.rnmRescaled ? RnmStorage::Rescaled : RnmStorage::Raw));
}

} // namespace

LightResult LightWorld(Bsp &bsp, const LightInputs &inputs, const LightOptions &options,
                       const LightmapOptions &lightmap, ShaderLibrary &library, const JobPool &jobs, Log &log) {
    LightSetup setup(bsp, inputs, options, SurfaceDefaultsOf(lightmap), library, log);
    // Bounced light comes from lit surfaces, whether or not they are stored.
    const bool gridBounces = lightmap.bounces > 0 && lightmap.bounceGrid;
    const bool lightSurfaces = !lightmap.onlyGrid || gridBounces;
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
    bsp.gridSH.reset();
    bsp.ambientCubes.reset();
    setup.stored.front().Erase(kGridSHKey);
    RecordTone(ToneText(setup.options.tone, lightmap.brightness), lightmap.onlyGrid, !options.noGrid,
               setup.stored.front(), log);
    if (!options.noGrid)
        bsp.gridPoints = LightLegacyGrid(setup, bounced.get(), jobs, log, result.grid);
    if (options.sh) {
        bsp.gridSH = BakeGridSH(setup, bounced.get(), jobs, log, result.gridSH);
        bsp.gridSHContainer = options.shBspx ? GridSHContainer::Bspx : GridSHContainer::Lump;
        if (options.shRadiance)
            setup.stored.front().Set(kGridSHKey, kRadiance);
    }
    if (options.ambientCubes)
        bsp.ambientCubes =
            BakeAmbientCubes(setup, bounced.get(), bsp.gridSH ? &*bsp.gridSH : nullptr, jobs, log, result.cubes);
    if (!lightmap.onlyGrid) {
        ClearHdrLight(bsp);
        result.lightmaps = surfaces->Store(inputs.name, bsp);
        StoreHdrLight(lightmap, result.lightmaps, bsp);
        RecordRnm(lightmap, result.lightmaps, setup.stored.front());
    }
    bsp.entities = FormatEntities(setup.stored);
    return result;
}

} // namespace q3
