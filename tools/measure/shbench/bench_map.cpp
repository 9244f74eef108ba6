// GPL-2.0-or-later. A map with everything that its reference light is computed from.
#include "tools/measure/shbench/bench_map.h"

#include "common/error.h"
#include "common/settings.h"
#include "q3map2/light/sources/light_sources.h"

#include <algorithm>
#include <sstream>

namespace q3::bench {

namespace {

LightOptions WithoutShortcuts(LightOptions options) {
    options.skip.reach = false;
    options.fastGrid = options.faster = options.cheapGrid = false;
    return options;
}

std::vector<Entity> StoredEntities(const Bsp &bsp, const std::string &name) {
    std::vector<Entity> stored = ParseEntities(bsp.entities, name);
    if (stored.empty())
        stored.push_back({{{"classname", "worldspawn"}}});
    return stored;
}

/// Lights of the .map replace those that the .bsp kept, unless _keepLights.
std::vector<Entity> WithLights(std::vector<Entity> entities, const LightInputs &inputs) {
    const auto isLight = [](const Entity &entity) { return StartsWithNoCase(entity.ClassName(), "light"); };
    if (!inputs.mapEntities || entities.front().Flag("_keepLights"))
        return entities;
    std::erase_if(entities, isLight);
    std::copy_if(inputs.mapEntities->begin(), inputs.mapEntities->end(), std::back_inserter(entities), isLight);
    return entities;
}

std::vector<Light> LightsOfStyle0(const BenchMap &map) {
    int culled = 0;
    auto lights = SetupEnvelopes(map.created, LightPass::GridSH, map.options, map.space, {}, culled);
    std::erase_if(lights, [](const Light &light) { return light.style != 0; });
    return lights;
}

} // namespace

BenchMap::BenchMap(Bsp map, LightInputs files, const LightOptions &lightOptions, ShaderLibrary &library, Log &log)
    : bsp(std::move(map)), inputs(std::move(files)), options(WithoutShortcuts(lightOptions)),
      stored(StoredEntities(bsp, inputs.name)), world(ReadWorldLight(stored.front(), options)),
      table(MakeSurfaceTable(bsp, stored, inputs.surfaceFile, inputs.name + ".srf", library, log)),
      space(bsp, OpaqueBrushes(bsp, library)),
      created(CreateLights(space, WithLights(stored, inputs), table, options, world, library, log)),
      scene(bsp, table, options, 0), lights(LightsOfStyle0(*this)) {}

std::vector<std::string> WordsOf(std::string_view text) {
    std::istringstream in{std::string(text)};
    std::vector<std::string> words;
    for (std::string word; in >> word;)
        words.push_back(word);
    return words;
}

void ParseOptionWords(const std::vector<std::string> &words, std::string_view text,
                      const std::function<void(Arguments &, Log &)> &parse) {
    Arguments arguments(words);
    std::string logged;
    {
        Log log([&](LogLevel, std::string_view line) { logged += line; }); // also logs when it is destroyed
        parse(arguments, log);
        WarnOfUnknown(arguments, log);
    }
    if (logged.empty())
        return;
    std::replace(logged.begin(), logged.end(), '\n', ' ');
    throw Error("light options \"{}\": {}", text, logged);
}

LightOptions LightOptionsFrom(std::string_view text, const Game &game) {
    std::vector<std::string> words = WordsOf(text);
    words.insert(words.begin(), "-sh");
    LightOptions options;
    ParseOptionWords(words, text,
                     [&](Arguments &arguments, Log &log) { options = ParseLightOptions(arguments, game, log); });
    return options;
}

} // namespace q3::bench
