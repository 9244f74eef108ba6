// GPL-2.0-or-later. A map lit again with lamps that were found, and how it differs from the light that it stores.
#pragma once

#include "common/log.h"
#include "q3map2/recover/lamp_light.h"

#include <span>
#include <string>
#include <vector>

namespace q3 {

/// What a map is lit from, and how. Keeps references.
struct RecoverInputs {
    const Bsp &bsp;
    const LightInputs &inputs; ///< mapEntities is not used: the lights are those that the .bsp has
    const LightOptions &options;
    const LightmapOptions &lightmap;
    ShaderLibrary &library;
    KeptImages images; ///< that bounced light needs, of this and of later runs
    const JobPool &jobs;
    Log &log;
    bool readsGrid = true; ///< the legacy grid is of the same light run as surfaces
};

/// Entities of the .bsp, and lamps after them.
std::vector<Entity> EntitiesWithLamps(const RecoverInputs &in, std::span<const Lamp> lamps);
/// Of these the lights and what they aim at, after an empty worldspawn: a map source without brushes.
std::vector<Entity> SourceOfLamps(const RecoverInputs &in, std::span<const Lamp> lamps);

/// Light of a map.
struct RelitMap {
    std::vector<Vec3f> light; ///< at the places of an ObservedMap
    std::vector<bspGridPoint_t> grid;
};
/// Lights the map with the lamps and all that the .bsp has, bounced light included. Errors: as LightWorld.
RelitMap Relight(const RecoverInputs &in, const ObservedMap &map, std::span<const Lamp> lamps);

/// How stored light and that of a relit map differ.
struct RelitDifference {
    double surfaces = 0;            ///< root mean square over luxels, vertices and channels. Bytes
    double grid = 0;                ///< the same over the ambient and directed bytes of open points of the legacy grid
    std::vector<float> unexplained; ///< by luxel or vertex: stored less relit, mean of the channels. Bytes
};
RelitDifference Compare(const Bsp &bsp, const ObservedMap &map, const RelitMap &relit);

/// The file x.unexplained.json, which viewers show. Its format: docs/guide/viewer.md.
std::string UnexplainedText(const ObservedMap &map, const RelitDifference &difference, const std::string &name);

} // namespace q3
