// GPL-2.0-or-later. The bytes that ioquake3 shows of the light grids of a map on a white matte surface.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace q3 {

enum class Renderer { OpenGL1, OpenGL2 };

/// Light on surfaces at one position, by their normals: what the screen shows, byte scale.
using NormalColor = std::function<Vec3f(const Vec3f &normal)>;
/// The same at any position.
using EngineLight = std::function<NormalColor(const Vec3f &position)>;

/// The SH grid of a file in memory, which must stay: light of the grid, the tone of the lightmaps, then the factor
/// 2^shift of r_mapOverBrightBits with the limit that keeps the hue, as for lightmaps. Errors: the file has no grid.
EngineLight ShGridLight(const std::vector<std::byte> &file, const Bsp &bsp, int shift);

/// The legacy grid with default settings: ambient light times 0.6, plus 32. Renderer 1 limits the ambient light and
/// then the sum, by channel; renderer 2 limits ambient and directed light, keeping the hue of each. Errors: a grid of
/// the wrong length.
EngineLight LegacyGridLight(const Bsp &bsp, Renderer renderer, int shift);

} // namespace q3
