// GPL-2.0-or-later. Everything that shines, in the photometric model of the established program.
#pragma once

#include "libs/math/bounds.h"
#include "libs/math/winding.h"

#include <array>
#include <string>
#include <vector>

namespace q3 {

/// Distance of suns: "infinite". Game units, 8 times kMaxWorldCoord.
inline constexpr float kSunDistance = 524288;

/// Lights farther out than this on an axis are left out. Game units.
inline constexpr float kMaxLightCoordinate = 262144;

enum class LightType { Point, Spot, Area, Sun };

/// Geometry of an area light's polygon that visibility and moments need.
struct AreaShape {
    Winding<float> back;           ///< the polygon with reversed winding
    Vec3d normal;                  ///< of the plane through the corners
    double dist = 0;               ///< origin of the plane: normal . p = dist
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
    LightType type = LightType::Point;
    FalloffCurve curve = FalloffCurve::InverseSquare;
    Attenuation attenuation;
    SpotCone cone;
    bool grid = true;     ///< lights grid points
    bool surfaces = true; ///< lights lightmaps and vertices
    bool noFast = false;  ///< q3map_noFast: never ends at its tolerance
    bool twoSided = false;
    bool negative = false;  ///< subtracts
    bool angle = true;      ///< surfaces: weaker at grazing angles
    float angleScale = 0;   ///< surfaces: factor min(1, cosine / angleScale); 0: off
    float filterRadius = 0; ///< lightmaps: blur of its light. Game units
    Vec3f color{1, 1, 1};
    float photons = 0;
    float add = 0;  ///< area: light per unit of form factor
    Vec3f origin;   ///< area: 1 unit off the center of the box of the polygon
    Vec3f normal;   ///< spot: aim; area: facing; sun: away from the sun
    float dist = 0; ///< area: origin . normal
    float fade = 1;
    float radiusByDist = 0; ///< spot: cone radius per unit of distance
    float extraDist = 0;
    float tolerance = 1;
    int style = 0;
    int skyIndex = -1; ///< sun: the sky that it shines through; -1 any
    Winding<float> w;  ///< area: clockwise seen from the front
    AreaShape shape;   ///< area: derived from w by SetShape

    // Set by SetupEnvelopes.
    std::vector<int> clusters;  ///< clusters that hold it; empty for suns
    std::vector<bool> seenFrom; ///< by cluster: whether points there may see it; empty: all may
    float envelope = 0;         ///< no light beyond this distance
    Boundsf bounds;
    bool fast = false; ///< contributions up to the tolerance are left out

    bool SeenFrom(int cluster) const { return cluster >= 0 && (seenFrom.empty() || seenFrom[std::size_t(cluster)]); }
    void SetShape();
};

} // namespace q3
