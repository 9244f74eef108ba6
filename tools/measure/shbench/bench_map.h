// GPL-2.0-or-later. A map ready to be measured: its lights and what rays meet, without any shortcut.
#pragma once

#include "common/platform/platform.h"
#include "q3map2/light/light_setup.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/sources/light_sources.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace q3::bench {

/// Everything that the reference light of a map is computed from. Const after construction; parts refer to each other,
/// so it is neither copied nor moved.
class BenchMap {
  public:
    /// Ignores those `lightOptions` that trade quality for speed. Errors: as LightWorld.
    BenchMap(Bsp map, LightInputs files, const LightOptions &lightOptions, ShaderLibrary &library, Log &log);
    BenchMap(const BenchMap &) = delete;
    BenchMap &operator=(const BenchMap &) = delete;

    const Bsp bsp;
    const LightInputs inputs;
    const LightOptions options;
    const std::vector<Entity> stored; ///< entities of the .bsp, the world first
    const WorldLight world;
    SurfaceTable table; ///< with skyIndex, set by CreateLights
    const BspSpace space;
    const std::vector<Light> created; ///< before SetupEnvelopes
    const LightScene scene;
    const std::vector<Light> lights; ///< those of style 0, with unlimited bounds
};

/// The words of a text, split at blanks.
std::vector<std::string> WordsOf(std::string_view text);

/// Calls `parse` with the options of -light in `words`, which are `text` and perhaps more. Errors, which quote `text`:
/// what `parse` logs, and words that it leaves.
void ParseOptionWords(const std::vector<std::string> &words, std::string_view text,
                      const std::function<void(Arguments &, Log &)> &parse);

/// Options of -light with -sh in front of them. Errors: words that ParseLightOptions does not know.
LightOptions LightOptionsFrom(std::string_view text, const Game &game);

} // namespace q3::bench
