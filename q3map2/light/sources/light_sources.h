// GPL-2.0-or-later. Everything that shines, in the photometric model of the established program.
#pragma once

#include "libs/math/bounds.h"
#include "libs/math/winding.h"

#include <array>
#include <vector>

namespace q3 {

/// Distance of suns: "infinite". Game units, 8 times the half size of the world.
inline constexpr float kSunDistance = 524288;

/// Lights farther out than this on an axis are in no map. Game units.
inline constexpr float kMaxLightCoordinate = 262144;

enum class LightType { Point, Spot, Area, Sun };

/// What visibility and moments of an area light need of its polygon.
struct AreaShape {
    Winding<float> back;           ///< the polygon the other way round
    Vec3d normal;                  ///< of its plane, by its corners
    double dist = 0;               ///< origin of the plane: normal . p = dist
    Vec3f center;                  ///< of gravity
    float radius = 0, area = 0;    ///< around the centre; square units
    std::vector<float> cumulative; ///< area of the first triangles of the fan, by triangle
};

/// One light. Colour times the number that falloff or form factor give is light on the byte scale, 255 = full.
struct Light {
    LightType type = LightType::Point;
    bool linear = false;     ///< falloff photons / 8000 - distance * fade instead of photons / distance^2
    bool grid = true;        ///< lights grid points
    bool surfaces = true;    ///< lights lightmaps and vertices
    bool alwaysFast = false; ///< entity lights: the falloff tolerance counts in every pass
    bool noFast = false;     ///< q3map_noFast
    bool twoSided = false;
    bool negative = false;  ///< subtracts
    bool angle = true;      ///< surfaces: weaker at grazing angles
    float angleScale = 0;   ///< surfaces: cosines are divided by it, up to 1; 0: not
    float filterRadius = 0; ///< lightmaps: blur of its light. Game units
    Vec3f color{1, 1, 1};
    float photons = 0;
    float add = 0;  ///< area: light per unit of form factor
    Vec3f origin;   ///< area: 1 unit off the centre of the box of the polygon
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
    std::vector<int> clusters;  ///< where it is; empty for suns
    std::vector<bool> seenFrom; ///< by cluster: points there may see it; empty: everywhere
    float envelope = 0;         ///< no light beyond this distance
    Boundsf bounds;
    bool fast = false; ///< contributions up to the tolerance count as none

    bool SeenFrom(int cluster) const { return cluster >= 0 && (seenFrom.empty() || seenFrom[std::size_t(cluster)]); }
    void SetShape();
};

} // namespace q3
