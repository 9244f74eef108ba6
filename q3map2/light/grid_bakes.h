// GPL-2.0-or-later. Bakes of a map that is set up: legacy grid, SH grid, ambient cubes.
#pragma once

#include "q3map2/light/light_setup.h"

#include <memory>
#include <optional>
#include <vector>

namespace q3 {

/// What becomes of lights of styles other than 0: only grids that name lights can hold them.
enum class StyledLights { LeaveOut, Keep };
/// Lights prepared for SH grids and ambient cubes.
std::vector<Light> LightsForSH(const LightSetup &setup, StyledLights styles, Log &log);

/// Bounced light for grids.
struct BouncedLight {
    std::unique_ptr<IndirectLight> steady; ///< style 0; null: none
    std::vector<StyledIndirect> styled;    ///< other styles, if the file can hold them
};

/// The legacy grid.
std::vector<bspGridPoint_t> LightLegacyGrid(const LightSetup &setup, const BouncedLight &bounced, const JobPool &jobs,
                                            Log &log, GridStats &stats);

/// The uniform SH grid, and the sparse one made from it.
struct BakedGridSH {
    LightGridSH uniform;
    std::optional<SparseGridSH> sparse; ///< with -shadaptive
};
/// The SH grid, with bounced light unless that is null.
BakedGridSH BakeGridSH(const LightSetup &setup, const IndirectLight *indirect, const JobPool &jobs, Log &log,
                       GridStats &stats);

/// The SH grid that names lights, likewise. Bounced light of lights with a style is left out.
NamedGridSH BakeNamedGridSH(const LightSetup &setup, const IndirectLight *indirect, const JobPool &jobs, Log &log,
                            GridStats &stats);

/// Ambient cubes of the leafs, likewise. gridSH: that of this run, for -ambientcubesfrom sh; else not used. Empty if
/// the map has no open leaf. Errors: too many leafs, see StoreCubes.
std::optional<AmbientCubes> BakeAmbientCubes(const LightSetup &setup, const IndirectLight *indirect,
                                             const LightGridSH *gridSH, const JobPool &jobs, Log &log,
                                             GridStats &stats);

} // namespace q3
