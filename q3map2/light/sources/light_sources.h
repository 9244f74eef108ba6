// GPL-2.0-or-later. Everything that emits light, in the lighting model of NetRadiant's q3map2, and how far it
// reaches.
#pragma once

#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// Red, green, blue and brightness, byte scale; colors are gamma-encoded.
using LightQuad = std::array<double, 4>;

/// The linear color of a quad, where byte 255 is 1: (c / 255)^2.2. The light of the quad is this times its brightness.
inline Vec3d LinearColor(const LightQuad &quad) {
    constexpr double kSourceGamma = 2.2;
    Vec3d linear;
    for (std::size_t channel = 0; channel < 3; ++channel)
        linear[channel] = std::pow(quad[channel] / 255, kSourceGamma);
    return linear;
}

/// Distance of suns: "infinite". Game units, 8 times kMaxWorldCoord.
inline constexpr float kSunDistance = 524288;

/// Lights farther out than this on an axis are left out. Game units.
inline constexpr float kMaxLightCoordinate = 262144;

enum class LightType { Point, Spot, Area, Sun };

/// Geometry of an area light's polygon that visibility and moments need.
struct AreaShape {
    Winding<float> back;           ///< the polygon with reversed winding
    Vec3d normal;                  ///< of the plane through the corners
    double dist = 0;               ///< of points p in the plane: normal . p
    Vec3f center;                  ///< centroid
    float radius = 0, area = 0;    ///< radius around the center, game units; area, square units
    std::vector<float> cumulative; ///< running sum of areas over the triangles of the fan
};

/// How light falls off with distance; formulas: Falloff.
enum class FalloffCurve {
    InverseSquare,
    Linear,
    Windowed,  ///< inverse square that ends smoothly
    Polynomial ///< one over a polynomial of the distance
};

/// Parameters of the curves Windowed and Polynomial. Distances in game units.
struct Attenuation {
    float constant = 1, linear = 0, quadratic = 0; ///< of the polynomial
    float flatFrom = kSunDistance;                 ///< from here on the polynomial stays as it is
    float fadeFrom = kSunDistance;                 ///< polynomial: up to here nothing is lost to the end
    float end = 2 * kSunDistance;                  ///< no light from here on
};

/// Cone of a spotlight.
struct SpotCone {
    bool byAngles = false; ///< false: by Light::radiusByDist
    float cosInner = 1;    ///< cosine of the half angle up to which the light is full
    float cosOuter = 0;    ///< cosine of the half angle from which there is none
    float exponent = 1;    ///< of the fringe between them
};

/// One light. Color times the number that falloff or form factor give is light on the byte scale, 255 = full.
struct Light {
    std::string name;  ///< targetname of its entity
    std::string label; ///< what messages call it; of surfaces and skies, only those of styles other than 0 have one
    int entity = -1;   ///< number of its entity: as given to EntityLights, in LightSetup as in the file; -1: none
    int surface = -1;  ///< draw surface that it is from, of a sky the first one; -1: none
    int sample = 0;    ///< number among the samples of one sun, sky or light with a deviance; those follow each other
    int group = -1;    ///< in LightSetup: number that the samples of one share, see LightGroup
    LightType type = LightType::Point;
    FalloffCurve curve = FalloffCurve::InverseSquare;
    Attenuation attenuation;
    SpotCone cone;
    bool lightsGrid = true;     ///< counts at grid points
    bool lightsSurfaces = true; ///< counts on lightmaps and at vertices
    bool noFast = false;        ///< q3map_noFast: never ends at its tolerance
    bool twoSided = false;
    bool negative = false;        ///< subtracts
    bool angleAttenuation = true; ///< surfaces: weaker at grazing angles
    float angleScale = 0;         ///< surfaces: factor min(1, cosine / angleScale); 0: off
    float filterRadius = 0;       ///< lightmaps: blur of its light. Game units
    Vec3f color{1, 1, 1};
    float photons = 0;      ///< intensity: see Falloff; sun: light on a surface that faces it
    float radiosity = 0;    ///< area: light on a receiver is this times its form factor
    Vec3f origin;           ///< area: 1 unit off the center of the box of the polygon
    Vec3f normal;           ///< spot: aim; area: facing; sun: away from the sun
    float dist = 0;         ///< area: origin . normal
    float fade = 1;         ///< linear falloff: light lost per unit of distance
    float radiusByDist = 0; ///< spot: cone radius per unit of distance
    float extraDist = 0;    ///< the square root of distance^2 + extraDist^2 counts as distance. Game units
    float tolerance = 1;    ///< light below which it may end, see endsAtTolerance. Byte scale
    int style = 0;
    int skyIndex = -1;      ///< sun: the sky that it shines through; -1 any
    Winding<float> polygon; ///< area: clockwise seen from the front
    AreaShape shape;        ///< area: derived from the polygon by SetShape

    // Set by SetupEnvelopes.
    std::vector<int> clusters;    ///< clusters that hold it; empty for suns
    std::vector<bool> seenFrom;   ///< by cluster: whether points there may see it; empty: all may
    float envelope = 0;           ///< no light beyond this distance
    Boundsf bounds;               ///< no light outside
    bool endsAtTolerance = false; ///< contributions up to the tolerance are left out

    /// Whether points in that cluster may see it.
    bool SeenFrom(int cluster) const { return cluster >= 0 && (seenFrom.empty() || seenFrom[std::size_t(cluster)]); }
    /// Whether the light of a sun, point or spot on a surface is that on one which faces it times the cosine.
    bool IsTimesCosine() const { return angleAttenuation && angleScale == 0 && curve != FalloffCurve::Linear; }
    /// Sets `shape`.
    void SetShape();
};

/// Least number of samples of a light of which surfaces take several, with soft shadows.
inline constexpr int kSurfaceSamples = 64;
/// make(n): n samples of one light. Returns make(count), which is what is asked for. With soft shadows and a count from
/// 2 to kSurfaceSamples - 1 these light the grids alone, and make(kSurfaceSamples) follows, for surfaces alone.
template <typename Make>
std::vector<Light> WithSurfaceSamples(int count, const LightOptions &options, const Make &make) {
    std::vector<Light> lights = make(count);
    if (options.areaShadows == 0 || count == 1 || count >= kSurfaceSamples)
        return lights;
    for (Light &light : lights)
        light.lightsSurfaces = false;
    for (Light &light : make(kSurfaceSamples)) {
        light.lightsGrid = false;
        lights.push_back(std::move(light));
    }
    return lights;
}

/// What messages call a light of a style other than 0.
inline std::string StyledLightName(const Light &light) {
    return light.label.empty() ? fmt::format("light of style {}", light.style) : light.label;
}

/// From where suns count as seen: from the clusters that visibility data says, or from all.
enum class SunsSeen { ByVisibility, Everywhere };

/// A row of bits per cluster, a bit per light. Keeps a reference to the lights.
class LightsByCluster {
  public:
    LightsByCluster(const std::vector<Light> &lights, SunsSeen suns);

    /// Calls use(number of the light) in order for every light that one of the clusters may see, and returns how many
    /// it left out.
    template <typename Use> std::size_t ForEach(std::span<const int> clusters, const Use &use) const {
        std::vector<std::uint64_t> any = everywhere_;
        for (const int cluster : clusters)
            if (cluster >= 0 && std::size_t(cluster) < rows_.size())
                for (std::size_t word = 0; word < any.size(); ++word)
                    any[word] |= rows_[std::size_t(cluster)][word];
        std::size_t used = 0;
        for (std::size_t word = 0; word < any.size(); ++word)
            for (std::uint64_t bits = any[word]; bits != 0; bits &= bits - 1, ++used)
                use(word * 64 + std::size_t(std::countr_zero(bits)));
        return lights_.size() - used;
    }
    const std::vector<Light> &Lights() const { return lights_; }

  private:
    const std::vector<Light> &lights_;
    std::vector<std::uint64_t> everywhere_;        ///< lights that every cluster may see
    std::vector<std::vector<std::uint64_t>> rows_; ///< by cluster: lights that it may see, without those of everywhere_
};

/// How SetupEnvelopes bounds the lights of a pass.
enum class LightPass {
    LegacyGrid, ///< as NetRadiant's q3map2: entity lights, under -fast all, end at their tolerance; one cluster per
                ///< light
    GridSH,     ///< no tolerance; all clusters that an area light touches
    Surfaces ///< lightmaps and vertices: point lights and spots, under -fast all, end at their tolerance; one cluster
             ///< per light
};

/// Prepares lights for a pass: sign of negative lights, clusters, envelope, bounds. Lights in solid are nudged out, or
/// dropped. `culled`: number of all lights left out, also those not for this pass or without reach. Sorted by style.
/// skySeenFrom: see SkySeenFrom. fastPoint: in the Surfaces pass, point lights and spots end at their tolerance; false
/// under -nofastpoint.
std::vector<Light> SetupEnvelopes(std::vector<Light> lights, LightPass pass, const LightOptions &options,
                                  const BspSpace &space, const std::vector<bool> &skySeenFrom, int &culled,
                                  bool fastPoint = true);

/// For each cluster, whether it sees a cluster with a sky surface. Empty, which means that all do, if any sky surface
/// is in no leaf.
std::vector<bool> SkySeenFrom(const BspSpace &space, const SurfaceTable &table);

} // namespace q3
