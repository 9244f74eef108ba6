// GPL-2.0-or-later. A brick wall with bumps and two lamps, and the light on it.
#pragma once

#include "tools/measure/bump_wall/encodings.h"

namespace q3::bump_wall {

/// The frame of everything here, which is the wall's tangent space: x right (s), y down (t), z out of the wall, all in
/// world units.
inline constexpr float kWidth = 128, kHeight = 96; // world units
inline constexpr float kTallest = 2.6f;            // world units that bumps stand out

/// The light of both lamps at a point of the flat wall.
LocalLight LampsAt(float x, float y);

/// World units above the flat wall: bricks with rounded edges, a stud on every other one.
float BumpHeight(float x, float y);
/// Unit normal of the bumps.
Vec3f BumpNormal(float x, float y);
/// Whether bumps hide what lies in this direction from the surface at (x, y), checked in steps of a quarter unit.
bool BumpsBlock(float x, float y, const Vec3f &direction);

/// The lamps that bumps do not hide.
LocalLight VisibleLamps(float x, float y);

} // namespace q3::bump_wall
