// GPL-2.0-or-later. Light of one source that arrives at the receivers of a batch.
#pragma once

#include "q3map2/light/batch/lanes.h"

#include <array>

namespace q3 {

/// Light of one source at each receiver: the light's color times `add` times `tint`.
struct IncidentLight {
    LaneMask live{};     ///< receivers that get light; values in other lanes are undefined
    Lanes add;           ///< light for color 1 1 1, byte scale, > 0
    Lanes3 direction;    ///< unit, to the light; zero at the light's own position
    Lanes distance;      ///< length of the shadow ray. Game units
    bool tinted = false; ///< some live ray went through a see-through surface
    Lanes3 tint;         ///< transmittance per channel, if tinted
};

/// IncidentLight with its SH projection, for light grids.
struct ProbeIncidentLight : IncidentLight {
    /// SH grid only: the incident radiance projected on the nine basis functions (sh.h), cosine-convolved unless
    /// LightSettings::radiance, before the tint; byte scale, for a light of color 1 1 1. Zero where nothing arrives.
    std::array<Lanes, 9> shCoeffs;
};

/// The directions that light comes from. A receiver in the same place with normal b gets
/// add * (max(0, vector . b) + uniform), which is `add` for its own normal.
struct LightDirections {
    Lanes3 vector; ///< irradiance vector divided by `add`
    Lanes uniform; ///< share of `add` that every normal gets
    Lanes spread;  ///< fluence divided by the length of the irradiance vector: 1 for a point, 2 for a hemisphere
};

/// IncidentLight on surfaces.
struct SurfaceIncidentLight : IncidentLight {
    LaneMask undirected{};      ///< lit from behind: adds nothing to deluxe maps
    LaneMask filtered{};        ///< the ray went through a see-through surface, or ended at one
    LightDirections directions; ///< of live receivers, if SurfaceLightSettings::directional
};

} // namespace q3
