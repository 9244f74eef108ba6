// GPL-2.0-or-later. Light that surfaces send on, as grids take it.
#pragma once

#include "libs/math/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// What arrives at a place from one direction.
struct IndirectRay {
    Vec3f direction; ///< unit, to the surface that sends it
    Vec3f color;     ///< byte scale: a sphere full of this colour lights what faces anywhere by it
};

/// Bounced light at receivers in the open. Const after construction; safe from several threads.
class IndirectLight {
  public:
    /// A sphere full of colour 1 has this much light of all its rays together, each taken as a light that is faced.
    static constexpr float kFacing = 4;

    virtual ~IndirectLight() = default;
    /// Evenly spread samples of the sphere around the place, all of equal weight; `seed` turns them.
    virtual void Gather(const Vec3f &place, std::uint64_t seed, std::vector<IndirectRay> &rays) const = 0;
};

} // namespace q3
