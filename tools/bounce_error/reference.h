// GPL-2.0-or-later. Path traced light at luxels and positions of a map.
#pragma once

#include "tools/bounce_error/path_tracer.h"
#include "tools/shbench/truth_lights.h"

#include <filesystem>

namespace q3::bounce {

struct LuxelReceiver {
    std::size_t lightmap = 0, luxel = 0;
    int surface = 0;        ///< one of the surfaces that share the lightmap
    Vec3f position, normal; ///< of the luxel
    /// Where its light is compared: its position, or places on the part of the luxel that is clear of solids and in
    /// front of surfaces if the position is not. Luxels at the edge of a wall lie in the plane of the next one.
    std::vector<Vec3f> places;
};

/// Where light is compared.
struct Receivers {
    std::vector<LuxelReceiver> luxels;
    std::vector<Vec3f> positions;
    double hiddenShare = 0; ///< of the area of surfaces: behind others or in solids, without luxels
};

/// Whether a place is clear of solids and in front of surfaces: few of its rays meet the backs of one-sided ones.
bool IsClear(const SurfaceInputs &in, const PathScene &scene, const Vec3f &place, const Vec3f &normal);

/// LuxelReceiver::places of a luxel; none if it cannot be seen.
std::vector<Vec3f> PlacesOf(const SurfaceInputs &in, const PathScene &scene, const RawLightmap &raw, std::size_t luxel);

/// Mapped luxels, drawn with replacement: a luxel's chance is the part of its area that can be seen.
std::vector<LuxelReceiver> LuxelsByArea(const SurfaceInputs &in, const SurfaceLight &surfaces, const PathScene &scene,
                                        int count, std::uint64_t seed, double *hiddenShare = nullptr);

using PositionEstimate = std::array<Estimate, bench::kNormals>; ///< on each of bench::Normals()

struct Reference {
    std::vector<Estimate> luxels;
    std::vector<PositionEstimate> positions;
    double cpuSeconds = 0;
    bool fromCache = false;
};

/// Computes the reference on all worker threads; it does not depend on their number. With a folder it is kept there
/// under a hash of all that it depends on. Errors: the folder cannot be written.
Reference MakeReference(const SurfaceInputs &in, const PathTracer &tracer, const DirectLights &lights,
                        const Receivers &receivers, int paths, const std::filesystem::path &cache);

} // namespace q3::bounce
