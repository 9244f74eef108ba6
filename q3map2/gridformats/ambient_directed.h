// GPL-2.0-or-later. Light of SH coefficients as an ambient part and one directed light.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp_records.h"

namespace q3 {

/// Light ambient + directed * max(0, n . direction) on a surface with the normal n; 1 is byte 255. No part is negative.
struct AmbientDirected {
    Vec3d ambient, directed;
    Vec3d direction{0, 0, 1}; ///< toward the light, unit
};

/// The nearest such light by least squares over all normals, channel by channel, to convolved coefficients. The
/// direction is that of band 1's luminance; +z if that is zero. minAmbient: the least ambient light that an engine
/// shows; where the fit has less on a channel, directed light is fitted to this.
AmbientDirected FitAmbientDirected(const bspGridPointSH_t &light, double minAmbient = 0);

/// The same with ambient + directedShare * directed equal to the mean of the light over all normals, for engines that
/// keep one color. directedShare above 0.
AmbientDirected FitMeanAndDirected(const bspGridPointSH_t &light, double directedShare);

/// Mean of convolved coefficients over all normals. May be negative after lights that take light away.
Vec3d MeanLight(const bspGridPointSH_t &light);
/// Light on a surface with this unit normal, at least 0.
Vec3d LightOn(const bspGridPointSH_t &light, const Vec3d &normal);

} // namespace q3
