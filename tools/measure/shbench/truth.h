// GPL-2.0-or-later. Reference light at random positions of a map, by brute force.
#pragma once

#include "common/jobs.h"
#include "tools/measure/shbench/bench_map.h"
#include "tools/measure/shbench/truth_lights.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace q3::bench {

/// The byte that a screen shows for light on the scale 1.0 = byte 255, unrounded.
inline double Displayed(float light) {
    return 255 * std::clamp(double(light), 0.0, 1.0);
}

/// What the reference is computed for.
struct TruthSettings {
    int positions = 2000;
    std::uint64_t seed = 1;
    /// Target standard error of the light of all area lights together at one position. Byte scale.
    double noise = 0.02;
};

/// Reference at one position. 1.0 is byte 255.
struct TruthPoint {
    Vec3f position;
    NormalLight light;               ///< on a surface with each of Normals()
    std::array<Vec3f, 9> projection; ///< its exact L2 projection, convolved with the cosine
    bool operator==(const TruthPoint &) const = default;
};

/// Reference at all positions of a map.
struct Truth {
    std::vector<TruthPoint> points;
    double noise = 0; ///< measured standard error of the displayed light from two halves of the rays: RMS, byte scale
    std::uint64_t rays = 0;
    double cpuSeconds = 0;
};

/// Positions uniform in the space that a player can be in: in a cluster, a cube of 16 units half size clear of solid.
/// Errors: too little such space.
std::vector<Vec3f> PlayerPositions(const Bsp &bsp, const BspSpace &space, std::string_view mapName, int count,
                                   std::uint64_t seed);
inline std::vector<Vec3f> PlayerPositions(const BenchMap &map, int count, std::uint64_t seed) {
    return PlayerPositions(map.bsp, map.space, map.inputs.name, count, seed);
}

/// Light at one position. `noise`: sum over normals and channels of ((a - b) / 2)^2, a and b being the displayed bytes
/// from each half of the rays.
TruthPoint TruthAt(const BenchMap &map, const Vec3f &position, std::uint64_t seed, double noiseGoal,
                   std::uint64_t &rays, double *noise = nullptr);

/// Computes the reference on all worker threads. The result does not depend on their number.
Truth MakeTruth(const BenchMap &map, const TruthSettings &settings, const JobPool &jobs);

/// Hex SHA-256 of everything that the truth depends on.
std::string TruthKey(const BenchMap &map, const TruthSettings &settings);
/// Reads the truth from the file of its key in `folder`, else computes and stores it. Without a folder nothing is
/// cached. `fromCache`: it was read. Errors: the folder cannot be written.
Truth CachedTruth(const BenchMap &map, const TruthSettings &settings, const JobPool &jobs,
                  const std::filesystem::path &folder, bool &fromCache);

} // namespace q3::bench
