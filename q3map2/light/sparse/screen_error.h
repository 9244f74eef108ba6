// GPL-2.0-or-later. Difference of two lights on surfaces as a screen shows them: cut off at black and white.
#pragma once

#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/grid/sh_floats.h"

#include <array>

namespace q3 {

/// Compares light on surfaces with 26 normals: those towards the faces, edges and corners of a cube.
/// SquaredDisplayError dims light as a whole that is too bright for a screen; here only the normals that are too bright
/// are cut off.
class ScreenError {
  public:
    ScreenError();
    /// Mean squared difference over normals and channels, bytes^2. a, b: convolved with the cosine.
    float Squared(const ShFloats &a, const ShFloats &b) const;

  private:
    std::array<Lanes, 9> basis_; ///< by coefficient: its basis function at 13 of the normals; the others are opposite
};

} // namespace q3
