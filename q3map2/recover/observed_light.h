// GPL-2.0-or-later. What a lit map says about its lights: stored light at places whose position is known.
#pragma once

#include "q3map2/light/light_setup.h"
#include "q3map2/lightmap/light_stage.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// Stored light at one place, the tone of storing undone, and the part of it that known sources give. Byte scale.
struct ObservedLight {
    Vec3f stored;
    Vec3f known;          ///< of surfaces, skies, suns and ambient light
    bool isBound = false; ///< a byte was at its limit: the light is at least `stored`
};

/// Luxels of one raw lightmap that are observed. They are lit like luxels of the light stage.
struct ObservedLuxels {
    SurfaceLightSettings settings;
    std::vector<SurfaceReceiverBatch> batches;
    std::size_t first = 0;      ///< number of the light of the first receiver, in ObservedMap::light
    std::vector<Boundsf> boxes; ///< by batch
    std::vector<float> dirt;    ///< by receiver: factor of light; empty: none
};

/// All places of a map whose stored light is read.
struct ObservedMap {
    std::vector<ObservedLuxels> lightmaps;
    std::vector<ReceiverBatch> grid;       ///< points of the legacy grid
    std::vector<Boundsf> gridBoxes;        ///< by batch of `grid`
    std::vector<ObservedLight> light;      ///< first of luxels, then of grid points
    std::vector<Vec3f> positions, normals; ///< by `light`; normals of grid points are zero
    std::size_t firstGrid = 0;             ///< number of the first grid point in `light`
};

/// Game units between the luxels that are observed, or more where the lightmap is coarser.
inline constexpr float kLuxelSpacing = 32;

/// Reads the light of `bsp`, whose surfaces are those of `passes`; SurfacePasses::Run has lit these by the known
/// sources. knownGrid: the legacy grid lit by them. Luxels are thinned out to about kLuxelSpacing.
ObservedMap ObserveLight(const Bsp &bsp, const LightSetup &setup, const SurfacePasses &passes,
                         const std::vector<bspGridPoint_t> &knownGrid);

} // namespace q3
