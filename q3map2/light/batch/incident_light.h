// GPL-2.0-or-later. Light of one source that arrives at the receivers of a batch.
#pragma once

#include "q3map2/light/batch/lanes.h"

#include <array>

namespace q3 {

/// What one light gives to each receiver: colour of the light times `add` times `tint`.
struct IncidentLight {
    LaneMask live{};     ///< receivers that get any; the others' numbers mean nothing
    Lanes add;           ///< light of full colour, byte scale, > 0
    Lanes3 direction;    ///< unit, to the light; zero for a receiver in it
    Lanes distance;      ///< of the shadow ray. Game units
    bool tinted = false; ///< by coloured surfaces on the way
    Lanes3 tint;         ///< transmittance per channel, if tinted
};

/// The same with its SH projection, for light grids.
struct ProbeIncidentLight : IncidentLight {
    /// SH grid only: the incident radiance projected on the nine basis functions (sh.h), cosine-convolved unless
    /// LightSettings::radiance, before the tint; byte scale, for a light of colour 1 1 1. Zero where nothing arrives.
    std::array<Lanes, 9> shCoeffs;
};

/// The same on surfaces.
struct SurfaceIncidentLight : IncidentLight {
    LaneMask undirected{}; ///< lit from behind: nothing for direction maps
    LaneMask filtered{};   ///< the ray went through a see-through surface, or ended at one
};

} // namespace q3
