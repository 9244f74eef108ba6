// GPL-2.0-or-later. Reference: path traced light at luxels and positions of a map, kept in a cache.
#pragma once

#include "tools/measure/bounce_error/path_tracer.h"
#include "tools/measure/shbench/truth_lights.h"

#include <filesystem>

namespace q3::bounce {

/// A luxel at which light is compared.
struct LuxelReceiver {
    std::size_t lightmap = 0, luxel = 0;
    int surface = 0;        ///< one of the surfaces that share the lightmap
    Vec3f position, normal; ///< of the luxel
    /// Where its light is traced: its position if that is clear (IsClear), else clear places on the luxel. The position
    /// of a luxel at the edge of a wall lies in the plane of the adjacent wall.
    std::vector<Vec3f> places;
};

/// Luxels and positions where light is compared.
struct Receivers {
    std::vector<LuxelReceiver> luxels;
    std::vector<Vec3f> positions;
    double hiddenShare = 0; ///< share of surface area that is behind other surfaces or in solids, and gets no luxels
};

/// Whether a place is clear of solids and in front of surfaces: few rays from it hit the backs of one-sided surfaces.
bool IsClear(const SurfaceInputs &in, const PathScene &scene, const Vec3f &place, const Vec3f &normal);

/// LuxelReceiver::places of a luxel; empty if no place on it is clear.
std::vector<Vec3f> PlacesOf(const SurfaceInputs &in, const PathScene &scene, const RawLightmap &raw, std::size_t luxel);

/// Mapped luxels, drawn with replacement, with a probability proportional to the part of their area that is clear.
std::vector<LuxelReceiver> LuxelsByArea(const SurfaceInputs &in, const SurfaceLight &surfaces, const PathScene &scene,
                                        int count, std::uint64_t seed, double *hiddenShare = nullptr);

using PositionEstimate = std::array<Estimate, bench::kNormals>; ///< on each of bench::Normals()

/// Path traced light of the receivers, in their order.
struct Reference {
    std::vector<Estimate> luxels;
    std::vector<PositionEstimate> positions;
    double cpuSeconds = 0;
    bool fromCache = false;
};

/// Computes the reference on all worker threads; it does not depend on their number. cache: folder in which it is kept
/// under a hash of its inputs; empty: none. Errors: the folder cannot be written.
Reference MakeReference(const SurfaceInputs &in, const PathTracer &tracer, const DirectLights &lights,
                        const Receivers &receivers, int paths, const std::filesystem::path &cache);

} // namespace q3::bounce
