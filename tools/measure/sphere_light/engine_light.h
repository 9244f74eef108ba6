// GPL-2.0-or-later. The bytes that ioquake3 shows of the light grids of a map on a white matte surface.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace q3 {

enum class Renderer { OpenGL1, OpenGL2 };

/// Color that the screen shows of a white matte surface at one position, by its normal; 0 to 255.
using NormalColor = std::function<Vec3f(const Vec3f &normal)>;
/// The same at any position.
using EngineLight = std::function<NormalColor(const Vec3f &position)>;

/// Light of the SH grid of a file in memory, which must outlive the result: the tone of the lightmaps is applied, then
/// the factor 2^shift and the limit to 255 that keeps the hue, as for lightmaps. shift: r_mapOverBrightBits less
/// r_overBrightBits. darkStyle: a light style that is switched off. Errors: there is no valid grid or no valid tone.
EngineLight SHGridLight(const std::vector<std::byte> &file, const Bsp &bsp, int shift,
                        std::optional<int> darkStyle = {});

/// Light of the legacy grid with the engine's default settings: ambient light times 0.6, plus 32. Renderer 1 limits the
/// ambient light and then the sum, by channel; renderer 2 limits ambient and directed light, keeping the hue of each.
/// Errors: a grid of the wrong length.
EngineLight LegacyGridLight(const Bsp &bsp, Renderer renderer, int shift);

} // namespace q3
