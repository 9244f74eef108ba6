// GPL-2.0-or-later. Models scattered over surfaces by q3map_surfaceModel, with triangles and random numbers,
// which foliage uses too.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace q3 {

using SurfaceTriangle = std::array<DrawVert, 3>;

/// Triangles of a surface: faces and decals as a fan around their centroid, patches tessellated. Clockwise.
std::vector<SurfaceTriangle> TrianglesOf(const DrawSurface &surface, const BspContext &context);
/// Bisects triangles at their longest edge until no edge is longer than `density` game units. False if it stopped
/// early, at 2^18 triangles.
bool Bisect(std::vector<SurfaceTriangle> &triangles, float density);

/// Uniform random numbers in 0..1, the same on every machine.
class ScatterRandom {
  public:
    explicit ScatterRandom(std::uint32_t seed) : engine_(seed) {}
    double Next() { return double(engine_()) / 4294967296.0; }
    double Between(double low, double high) { return low + (high - low) * Next(); }

  private:
    std::mt19937 engine_;
};

/// Places the models that q3map_surfaceModel scatters over the surfaces from `first` on. Throws Error for more
/// surfaces than -maxmapdrawsurfs allows.
void AddShaderModels(MapEntity &entity, Geometry &geometry, std::size_t first, PlaneTable &planes,
                     const BspContext &context);

} // namespace q3
