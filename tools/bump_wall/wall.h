// GPL-2.0-or-later. A brick wall with bumps and two lamps, and the light on it.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <vector>

namespace q3::bump_wall {

/// The frame of everything here, which is the wall's tangent space: x right (s), y down (t), z out of the wall, all in
/// world units.
inline constexpr float kWidth = 128, kHeight = 96; // world units
inline constexpr float kTallest = 2.6f;            // world units that bumps stand out
inline constexpr Vec3f kFlatNormal{0, 0, 1};

/// Light of one lamp at a point: lit value at normal incidence, direction towards it.
struct Ray {
    Vec3f color, direction;
    float distance = 0;
};

/// Both lamps, seen from a point of the wall.
std::array<Ray, 2> LampsAt(const Vec3f &point);

/// World units above the flat wall: bricks with rounded edges, a stud on every other one.
float BumpHeight(float x, float y);
/// Unit normal of the bumps.
Vec3f BumpNormal(float x, float y);
/// Whether bumps stand between the surface at (x, y) and what lies in this direction, in a quarter of a unit's steps.
bool BumpsBlock(float x, float y, const Vec3f &direction);

/// Response to the three basis vectors of radiosity normal mapping, 0 to 1 (a texel of a self-shadowed bump map):
/// max(0, n . b_i) times the visible share of directions weighted with both cosines, by `kLobeRays` rays.
inline constexpr int kLobeRays = 256;
std::array<float, 3> SelfShadowedTexel(float x, float y, const Vec3f &normal);

/// What the surface receives, by both lamps themselves.
Vec3f BruteForce(float x, float y, const Vec3f &normal, bool withShadows);

} // namespace q3::bump_wall
