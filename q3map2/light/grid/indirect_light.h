// GPL-2.0-or-later. Bounced light at points in the open, for light grids.
#pragma once

#include "libs/math/vec.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// Bounced light that arrives at a point from one direction.
struct IndirectRay {
    Vec3f direction; ///< unit, to the surface that reflects it
    Vec3f light;     ///< on a surface with normal `direction`, byte scale
};

/// Bounced light at points in the open. Const after construction; safe from several threads.
class IndirectLight {
  public:
    virtual ~IndirectLight() = default;
    /// Number of rays that gather light at a point, without shadow rays to bright emitters.
    virtual int RaysPerPoint() const = 0;
    /// Sets `rays` to directional lights that together give the bounced light at the point; `seed` rotates the pattern
    /// of directions.
    virtual void Gather(const Vec3f &point, std::uint64_t seed, std::vector<IndirectRay> &rays) const = 0;
};

} // namespace q3
