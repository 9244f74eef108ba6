// GPL-2.0-or-later. The passes of the light stage over the surfaces of a map.
#include "q3map2/lightmap/surface_passes.h"

#include "common/cpu_time.h"
#include "q3map2/light/sources/light_envelope.h"
#include "q3map2/lightmap/ao/luxel_dirt.h"
#include "q3map2/lightmap/ao/luxel_flood.h"
#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/direct/luxel_fill.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/direct/luxel_visibility.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/lightmap/raw/lightmap_shade.h"
#include "q3map2/lightmap/raw/luxel_map.h"
#include "q3map2/lightmap/raw/luxel_tangents.h"
#include "q3map2/lightmap/raw/macro_texture.h"
#include "q3map2/lightmap/vertex/vertex_light.h"

#include <algorithm>

namespace q3 {

SurfacePasses::SurfacePasses(const LightSetup &setup, const LightmapOptions &lightmap, const JobPool &jobs, Log &log,
                             const SurfacePassesOptions &options)
    : setup_(setup), in_{setup.bsp, setup.space, setup.scene, setup.table, setup.options,
                         lightmap,  setup.world, jobs,        log},
      options_(options), surfaces_(Prepare()) {}

SurfaceLight SurfacePasses::Prepare() {
    in_.log.Section("SetupSurfaceLightmaps");
    SurfaceLight surfaces = SetupSurfaceLight(in_);
    surfaces.styled =
        std::any_of(setup_.lights.begin(), setup_.lights.end(), [](const Light &light) { return light.style != 0; });
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
    if (in_.lightmap.lightmass)
        FindMasks();
    if (in_.lightmap.bounces > 0)
        Bounce();
    else
        AverageLuxels(in_, {}, !options_.keepLuxels, surfaces_);
    if (in_.lightmap.show == DebugView::Light)
        ApplyTints(in_, surfaces_);
}

void SurfacePasses::Bounce() {
    in_.log.Section("Radiosity");
    const CpuTimer timer;
    AverageLuxels(in_, {}, false, surfaces_);
    bounces_.emplace(in_, surfaces_);
    in_.log.Count((long long)(bounces_->Rays()), "rays to gather the light of bounces");
    if (!bounces_->Solve(surfaces_))
        return in_.log.Print("No surface reflects light\n");
    in_.log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
    in_.log.Section("Final gathering");
    Pass({}, {.bounce = true}, &*bounces_);
    AverageLuxels(in_, {.bounce = true}, !options_.keepLuxels, surfaces_);
}

std::unique_ptr<IndirectLight> SurfacePasses::ForGrids() const {
    if (!bounces_ || !in_.lightmap.bounceGrid)
        return nullptr;
    return bounces_->ForPoints();
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
    int culled = 0;
    const std::vector<Light> lights = SetupEnvelopes(setup_.lights, LightPass::Surfaces, in_.options, in_.space,
                                                     setup_.skySeenFrom, culled, in_.lightmap.fastPoint);
    FindVisibility(in_, lights, surfaces_, counts_);
}

void SurfacePasses::Pass(const std::vector<Light> &created, const SurfacePass &pass, const Bounces *bounces) {
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

} // namespace q3
