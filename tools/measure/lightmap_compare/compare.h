// GPL-2.0-or-later. Differences of the light of two files of one map.
#pragma once

#include "tools/measure/lightmap_compare/lit_map.h"

#include <optional>
#include <string>
#include <vector>

namespace q3::compare {

/// Statistics of differences. Bytes of 255, or degrees.
struct Spread {
    std::size_t count = 0;
    double mean = 0;         ///< mean absolute difference of all channels
    double within8 = 0;      ///< share whose largest channel is within 8
    double percentile95 = 0; ///< of the largest channel
    double percentile99 = 0, worst = 0;
    std::optional<double> bias; ///< mean of A - B, of colors
};

/// Collects differences.
class Differences {
  public:
    /// A pair of colors: its largest channel is the difference that percentiles are of.
    void Add(const Vec3d &a, const Vec3d &b);
    /// One difference, such as an angle.
    void Add(double difference);
    Spread Summary() const;

  private:
    std::vector<float> largest_;     ///< of each pair: absolute difference of the channel that differs most
    double sum_ = 0, signedSum_ = 0; ///< of absolute and of signed differences, means over channels
    bool hasColors_ = false;         ///< pairs of colors were added, so that there is a bias
};

/// Difference of the lightmap of one surface.
struct SurfaceDifference {
    std::size_t surface = 0;
    std::string shader;
    Vec3d position; ///< where it is worst
    Spread spread;
    Vec3d a, b; ///< mean light in both
};

/// Counts of surfaces or samples that have something in both files, in one, or in neither.
struct PresenceCounts {
    std::size_t both = 0, onlyA = 0, onlyB = 0, neither = 0;
    void Add(bool a, bool b) { ++(a ? b ? both : onlyA : b ? onlyB : neither); }
};

/// Means weighted by surface area.
struct AreaSpread {
    double area = 0; ///< square units
    double mean = 0, within8 = 0;
    /// Adds a surface.
    void Add(double ownArea, const Spread &own);
};

/// All differences of two files.
struct Comparison {
    PresenceCounts lightmapped; ///< surfaces
    /// Samples in solids, left out: invisible, and the page may hold light of other surfaces there.
    std::size_t buried = 0;
    /// Samples with texels that no luxel of their surface covers, left out for the same reason.
    std::size_t uncovered = 0;
    PresenceCounts lit; ///< the remaining samples, by whether they are not black
    Spread lightmaps;   ///< samples that are black in neither file, on surfaces with lightmaps in both
    AreaSpread byArea;  ///< the same samples; unweighted, a sliver counts as much as a wall
    Spread surfaces;    ///< mean difference of each of those surfaces
    std::size_t surfacesWithin2 = 0, surfacesCompared = 0;
    Spread directions;                    ///< degrees; no samples unless both are deluxe
    Spread vertices;                      ///< colors of surfaces without lightmap in both, except those of the next two
    Spread undrawnVertices;               ///< the same for skies and other surfaces that no engine draws
    Spread unseenVertices;                ///< the same where the shader does not use vertex colors; needs shaders
    Spread lightmapVertices;              ///< colors of surfaces with lightmap in both
    std::vector<SurfaceDifference> worst; ///< surfaces with lightmaps in both, the worst mean first
};

/// Samples every surface at the same points in both. `shaders`: null if the game is unknown. Errors: Error, for files
/// of different maps.
Comparison Compare(const LitMap &a, const LitMap &b, int samplesASurface, std::size_t worstCount,
                   ShaderLibrary *shaders = nullptr);

/// The comparison for people, and with the same numbers as JSON.
std::string ToText(const Comparison &comparison);
std::string ToJson(const Comparison &comparison);

} // namespace q3::compare
