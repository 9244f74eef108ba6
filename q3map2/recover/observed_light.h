// GPL-2.0-or-later. What a lit map says about its lights: stored light at places whose position is known.
#pragma once

#include "q3map2/light/light_setup.h"
#include "q3map2/lightmap/light_stage.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

inline float MeanOfChannels(const Vec3f &light) {
    return (light.x + light.y + light.z) / 3;
}

/// What stored light says about the light itself.
enum class StoredAs {
    Value,
    AtLeast, ///< a byte is at its limit: there is at least so much light
    AtMost   ///< it is the minimum light (_minlight): there is at most so much
};

/// Stored light at one place, the tone of storing undone, and the part of it that known sources give. Byte scale.
struct ObservedLight {
    Vec3f stored;
    Vec3f known; ///< of surfaces, skies, suns and ambient light, and bounced light
    StoredAs as = StoredAs::Value;

    /// The part of a residual, stored less explained light, that contradicts what is stored.
    Vec3f Contradiction(const Vec3f &residual) const {
        return as == StoredAs::AtLeast  ? Max(residual, Vec3f{})
               : as == StoredAs::AtMost ? Min(residual, Vec3f{})
                                        : residual;
    }
    /// Whether a residual of that sign contradicts it.
    bool Contradicts(float residual) const {
        return as == StoredAs::Value || (as == StoredAs::AtLeast) == (residual > 0);
    }
};

/// Places of one surface that are lit alike: luxels of a raw lightmap, or vertices of a surface without one.
struct ObservedSurface {
    SurfaceLightSettings settings;
    std::vector<SurfaceReceiverBatch> batches;
    std::size_t first = 0;           ///< number of the light of the first receiver, in ObservedMap::light
    std::vector<Boundsf> boxes;      ///< by batch
    std::vector<float> dirt;         ///< by receiver: factor of light; empty: none
    int lightmap = -1;               ///< number of the raw lightmap; -1: vertices
    std::vector<std::uint32_t> at;   ///< by receiver: luxel of the lightmap, or draw vertex
    float scale = 1, brightness = 1; ///< of its ToneMapper
    Vec3f least;                     ///< minimum light; byte scale
};

/// All places of a map whose stored light is read.
struct ObservedMap {
    std::vector<ObservedSurface> surfaces;
    std::vector<ReceiverBatch> grid;        ///< points of the legacy grid
    std::vector<Boundsf> gridBoxes;         ///< by batch of `grid`
    std::vector<std::uint32_t> gridNumbers; ///< by grid point: its number in the .bsp
    std::vector<ObservedLight> light;       ///< first of luxels and vertices, then of grid points
    std::vector<Vec3f> positions, normals;  ///< by `light`; of grid points the stored direction towards light
    std::size_t firstGrid = 0;              ///< number of the first grid point in `light`
    ToneOptions tone;                       ///< of luxels and vertices
};

/// Game units between the luxels that are observed, or more where the lightmap is coarser.
inline constexpr float kLuxelSpacing = 32;

/// Reads the light of `bsp`, whose surfaces are those of `passes`; SurfacePasses::Run has lit these by the known
/// sources. knownGrid: the legacy grid lit by them;
/// empty: that of the map is not read. Luxels are thinned out to about kLuxelSpacing. Vertices are left
/// out with ambient occlusion (-dirty).
ObservedMap ObserveLight(const Bsp &bsp, const LightSetup &setup, const SurfacePasses &passes,
                         const std::vector<bspGridPoint_t> &knownGrid);

/// The light that another run has at the places of `map`: of the same options, by other lights. Byte scale.
std::vector<Vec3f> LightAtPlaces(const ObservedMap &map, const LightSetup &setup, const SurfacePasses &passes,
                                 const std::vector<bspGridPoint_t> &grid);

} // namespace q3
