// GPL-2.0-or-later. Which texels of a surface's lightmap hold light of that surface.
#include "tools/measure/lightmap_compare/luxel_cover.h"

#include <algorithm>
#include <cmath>

namespace q3::compare {

namespace {

constexpr double kAbove = 1;            ///< luxels are lit this far above the surface; game units
constexpr float kBrushEpsilon = 0.125f; ///< points this close to a brush count as inside; game units
/// Texels with less weight are ignored: they come from rounded coordinates.
constexpr double kLeastWeight = 0.01;

/// World brushes that the light stage takes as opaque, by the flags of the file alone.
std::vector<bool> OpaqueBrushes(const Bsp &bsp) {
    const Game &game = Games().front();
    std::vector<bool> opaque(bsp.brushes.size());
    const bspModel_t &world = bsp.models.front();
    for (int i = world.firstBSPBrush; i < world.firstBSPBrush + world.numBSPBrushes; ++i) {
        const bspBrush_t &brush = bsp.brushes[std::size_t(i)];
        bool translucent = false;
        for (int s = brush.firstSide; s < brush.firstSide + brush.numSides; ++s) {
            const bspShader_t &shader = bsp.shaders[std::size_t(bsp.brushSides[std::size_t(s)].shaderNum)];
            translucent |= (game.CompileFlagsOf(shader.surfaceFlags, shader.contentFlags) & C_TRANSLUCENT) != 0;
        }
        opaque[std::size_t(i)] = !translucent;
    }
    return opaque;
}

} // namespace

LuxelCover::LuxelCover(const LitMap &map) : map_(map), space_(map.Map(), OpaqueBrushes(map.Map())) {}

bool LuxelCover::IsOpen(const TexelFrame &frame, double s, double t) const {
    for (const double across : {0.0, -0.5, 0.5})
        for (const double down : {0.0, -0.5, 0.5}) {
            const Vec3d p = frame.origin + frame.along[0] * (s + across) + frame.along[1] * (t + down);
            if (space_.ClusterAt(Vec3f(p + frame.normal * kAbove), kBrushEpsilon) >= 0)
                return true;
        }
    return false;
}

bool LuxelCover::Covers(std::size_t surface, const SurfacePoint &position) const {
    const Bsp &bsp = map_.Map();
    const bspModel_t &world = bsp.models.front();
    const auto number = std::int64_t(surface);
    const bool ofWorld = number >= world.firstBSPSurface && number < world.firstBSPSurface + world.numBSPSurfaces;
    if (!ofWorld || position.count != 3)
        return true;
    const auto [width, height] = map_.PageSize(surface);
    std::array<Vec3d, 3> xyz;
    std::array<std::array<double, 2>, 3> st{};
    double s = 0, t = 0;
    TexelFrame frame;
    for (std::size_t i = 0; i < 3; ++i) {
        const bspDrawVert_t &v = bsp.drawVerts[std::size_t(position.verts[i])];
        xyz[i] = Vec3d(v.xyz);
        st[i] = {double(v.lightmap[0][0]) * width - 0.5, double(v.lightmap[0][1]) * height - 0.5};
        s += position.weights[i] * st[i][0], t += position.weights[i] * st[i][1];
        frame.normal += Vec3d(v.normal) * position.weights[i];
    }
    // The frame maps the texel coordinates of the corners to their positions: with edges e1, e2 of the triangle and
    // (s1, t1), (s2, t2) in texels, along[0] s1 + along[1] t1 = e1, and e2 likewise, by Cramer's rule.
    const double s1 = st[1][0] - st[0][0], t1 = st[1][1] - st[0][1], s2 = st[2][0] - st[0][0], t2 = st[2][1] - st[0][1];
    const double determinant = s1 * t2 - s2 * t1;
    if (!std::isfinite(determinant) || determinant == 0)
        return true;
    frame.normal = Normalize(frame.normal);
    frame.along[0] = ((xyz[1] - xyz[0]) * t2 - (xyz[2] - xyz[0]) * t1) / determinant;
    frame.along[1] = ((xyz[2] - xyz[0]) * s1 - (xyz[1] - xyz[0]) * s2) / determinant;
    frame.origin = xyz[0] - frame.along[0] * st[0][0] - frame.along[1] * st[0][1];
    for (const double x : {std::floor(s), std::floor(s) + 1})
        for (const double y : {std::floor(t), std::floor(t) + 1})
            if ((1 - std::abs(s - x)) * (1 - std::abs(t - y)) > kLeastWeight && !IsOpen(frame, x, y))
                return false;
    return true;
}

} // namespace q3::compare
