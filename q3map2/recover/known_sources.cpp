// GPL-2.0-or-later. How strong the surfaces and skies that emit light were when the map was lit.
#include "q3map2/recover/known_sources.h"

#include "q3map2/light/transfer/light_sample.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

namespace {

/// A shader dominates places to which it gives this share of known light.
constexpr float kDominant = 0.7f;
/// This share of the places that a shader dominates may be darker than its factor says: shadows differ a little between
/// programs.
constexpr double kDarker = 0.3;
/// Factors from here on are taken as 1: the models of light differ a little between programs.
constexpr float kSame = 0.8f;
/// A shader must give this much, byte scale, at so many places.
constexpr float kLeastLight = 8;
constexpr std::size_t kFewestPlaces = 16;
/// Rounds in which the factors of all shaders follow those of the others.
constexpr int kRounds = 8;

struct ColoredEntry {
    std::uint32_t place;
    Vec3f light;
};
using ColoredColumn = std::vector<ColoredEntry>;

/// The direct light of some lights at luxels and vertices.
ColoredColumn LightOf(const std::vector<const Light *> &lights, const ObservedMap &map, const LightSetup &setup,
                      const JobPool &jobs) {
    std::vector<Vec3f> sums(map.firstGrid);
    jobs.For(std::int64_t(map.surfaces.size()), [&](std::int64_t number, int) {
        const ObservedSurface &surface = map.surfaces[std::size_t(number)];
        ContributionCounts counts;
        for (std::size_t b = 0; b < surface.batches.size(); ++b)
            for (const Light *light : lights) {
                SurfaceReceiverBatch batch = surface.batches[b];
                SurfaceIncidentLight incident;
                LightContributionToSample(*light, surface.settings, setup.scene, batch, incident, counts);
                for (std::size_t i = 0; i < batch.count; ++i) {
                    if (incident.live[i] == 0)
                        continue;
                    const std::size_t at = b * kPacketSize + i;
                    Vec3f color = light->color * incident.strength[i];
                    const Vec3f tint = incident.tinted ? Vec3f(incident.tint[i]) : Vec3f{1, 1, 1};
                    for (std::size_t channel = 0; channel < 3; ++channel)
                        color[channel] *= tint[channel];
                    if (!surface.dirt.empty())
                        color *= surface.dirt[at];
                    sums[surface.first + at] += color;
                }
            }
    });
    ColoredColumn column;
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (sums[i] != Vec3f{})
            column.push_back({std::uint32_t(i), sums[i]});
    return column;
}

} // namespace

std::vector<KnownSource> FitKnownSources(const ObservedMap &map, const LightSetup &setup,
                                         const LightmapOptions &lightmap, const JobPool &jobs) {
    int culled = 0;
    const std::vector<Light> lights = SetupEnvelopes(setup.lights, LightPass::Surfaces, setup.options, setup.space,
                                                     setup.skySeenFrom, culled, lightmap.fastPoint);
    std::map<std::string, std::vector<const Light *>> byShader;
    for (const Light &light : lights)
        if (light.surface >= 0 && light.style == 0)
            byShader[setup.table[std::size_t(light.surface)].shader->name].push_back(&light);
    std::vector<KnownSource> sources;
    std::vector<ColoredColumn> columns;
    for (const auto &[shader, ofShader] : byShader) {
        ColoredColumn column = LightOf(ofShader, map, setup, jobs);
        const auto bright = std::ranges::count_if(
            column, [](const ColoredEntry &entry) { return MaxComponent(entry.light) >= kLeastLight; });
        if (std::size_t(bright) < kFewestPlaces)
            continue;
        sources.push_back({shader});
        columns.push_back(std::move(column));
    }
    std::vector<float> known; // mean of the channels, with all factors
    for (std::size_t i = 0; i < map.firstGrid; ++i)
        known.push_back(MeanOfChannels(map.light[i].known));
    std::vector<float> ratios;
    for (int round = 0; round < kRounds; ++round)
        for (std::size_t k = 0; k < sources.size(); ++k) {
            ratios.clear();
            for (const auto &[place, light] : columns[k]) {
                const float own = MeanOfChannels(light), ofSource = own * sources[k].factor;
                if (own < kLeastLight || own < kDominant * (known[place] - ofSource + own))
                    continue;
                const float ratio = (MeanOfChannels(map.light[place].stored) - known[place] + ofSource) / own;
                ratios.push_back(map.light[place].as == StoredAs::AtLeast ? std::max(ratio, 1.0f) : ratio);
            }
            if (ratios.size() < kFewestPlaces)
                continue;
            const auto at = ratios.begin() + std::ptrdiff_t(kDarker * double(ratios.size()));
            std::ranges::nth_element(ratios, at);
            const float next = *at < kSame ? std::max(0.0f, *at) : 1;
            for (const auto &[place, light] : columns[k])
                known[place] += MeanOfChannels(light) * (next - sources[k].factor);
            sources[k].factor = next;
        }
    return sources;
}

} // namespace q3
