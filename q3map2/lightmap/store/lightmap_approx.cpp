// GPL-2.0-or-later. -approx: lightmaps that vertex colors can replace.
#include "q3map2/lightmap/store/lightmap_approx.h"

#include "q3map2/light/tone/light_tone.h"
#include "q3map2/lightmap/store/stored_light.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Surfaces with bounds up to this on each axis need no lightmap. Luxels.
constexpr float kTinyLuxels = 2;
/// Largest number of samples along a curve of a patch.
constexpr int kMaxSteps = 64;
/// Largest number of halvings of a triangle: bounds the recursion for any threshold.
constexpr int kMaxDepth = 20;

/// Interpolated vertex color at a point of a surface, and where it is in the lightmap.
struct SurfaceSample {
    std::array<float, 2> luxel{}; ///< of the lightmap, not of the super grid
    Vec3f color;                  ///< as stored, and blended as engines do; byte scale
};

SurfaceSample Blend(const SurfaceSample &a, const SurfaceSample &b, float share) {
    SurfaceSample result;
    for (std::size_t i = 0; i < 2; ++i)
        result.luxel[i] = a.luxel[i] + (b.luxel[i] - a.luxel[i]) * share;
    result.color = a.color + (b.color - a.color) * share;
    return result;
}

/// The sample at t of the quadratic curve with these control points.
SurfaceSample OnCurve(const SurfaceSample &a, const SurfaceSample &b, const SurfaceSample &c, float t) {
    return Blend(Blend(a, b, t), Blend(b, c, t), t);
}

float SquaredDistance(const SurfaceSample &a, const SurfaceSample &b) {
    const float s = a.luxel[0] - b.luxel[0], t = a.luxel[1] - b.luxel[1];
    return s * s + t * t;
}

std::array<std::uint8_t, 3> FirstThree(const std::array<std::uint8_t, 4> &color) {
    return {color[0], color[1], color[2]};
}

class Approximation {
  public:
    Approximation(const SurfaceInputs &in, const SurfaceLight &surfaces, const RawLightmap &lightmap)
        : in_(in), surfaces_(surfaces), lightmap_(lightmap),
          spacing_(std::max(std::abs(in.lightmap.threshold), 0.125f)), tone_(StoredTone(in)) {}

    bool Matches(int surface) const {
        const bspDrawSurface_t &record = in_.bsp.drawSurfaces[std::size_t(surface)];
        const ShaderInfo &shader = *in_.table[std::size_t(surface)].shader;
        if (shader.lightmap.noVertexLight)
            return false;
        if (record.surfaceType == MST_PATCH)
            return PatchMatches(record, shader);
        for (int i = record.firstIndex; i < record.firstIndex + record.numIndexes; i += 3) {
            std::array<SurfaceSample, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = AtVertex(record.firstVert + in_.bsp.drawIndexes[std::size_t(i) + k], shader);
            if (!std::all_of(corners.begin(), corners.end(), [&](const SurfaceSample &s) { return IsClose(s); }) ||
                !TriangleMatches(corners, 0))
                return false;
        }
        return true;
    }

  private:
    SurfaceSample AtVertex(int vertex, const ShaderInfo &shader) const {
        SurfaceSample sample;
        const auto v = std::size_t(vertex);
        for (std::size_t i = 0; i < 2; ++i)
            sample.luxel[i] = surfaces_.verts[v].luxel[i] / float(lightmap_.super);
        const auto color = surfaces_.vertex.sum[0].empty()
                               ? FirstThree(in_.bsp.drawVerts[v].color)
                               : VertexBytes(in_, shader, surfaces_.vertex.sum[0][v], tone_);
        sample.color = {float(color[0]), float(color[1]), float(color[2])};
        return sample;
    }

    bool IsClose(const SurfaceSample &sample) const {
        const auto along = [](float coordinate, int count) {
            return std::clamp(int(std::floor(coordinate)), 0, count - 1);
        };
        const std::size_t at =
            lightmap_.Index(along(sample.luxel[0], lightmap_.width), along(sample.luxel[1], lightmap_.height));
        for (std::size_t style = 0; style < kStyles; ++style) {
            if (lightmap_.styles[style] == kNoStyle || lightmap_.result[style].empty())
                continue;
            const Vec3f &luxel = lightmap_.result[style][at];
            if (luxel.x < 0)
                continue;
            const Vec3f least = style == 0 ? in_.world.minLight : Vec3f{};
            const auto wanted = ColorToBytes(Max(luxel, least), 1, lightmap_.brightness, tone_);
            const Vec3f got = style == 0 ? sample.color : Vec3f{}; // vertices have no light of other styles
            for (std::size_t i = 0; i < 3; ++i)
                if (std::abs(float(wanted[i]) - got[i]) > in_.lightmap.approximate)
                    return false;
        }
        return true;
    }

    /// Compares at the midpoint of the longest edge, and so on for both halves until all edges are short.
    bool TriangleMatches(const std::array<SurfaceSample, 3> &corners, int depth) const {
        std::size_t longest = 0;
        float length = 0;
        for (std::size_t i = 0; i < 3; ++i)
            if (const float d = SquaredDistance(corners[i], corners[(i + 1) % 3]); d > length)
                longest = i, length = d;
        if (length <= spacing_ * spacing_ || depth >= kMaxDepth)
            return true;
        const SurfaceSample middle = Blend(corners[longest], corners[(longest + 1) % 3], 0.5f);
        if (!IsClose(middle))
            return false;
        std::array<SurfaceSample, 3> one = corners, other = corners;
        one[(longest + 1) % 3] = other[longest] = middle;
        return TriangleMatches(one, depth + 1) && TriangleMatches(other, depth + 1);
    }

    int Steps(const SurfaceSample &a, const SurfaceSample &b, const SurfaceSample &c) const {
        const float length = std::sqrt(SquaredDistance(a, b)) + std::sqrt(SquaredDistance(b, c));
        return std::clamp(int(std::ceil(length / spacing_)), 1, kMaxSteps);
    }

    /// Compares on a grid over each biquadratic patch of 3 x 3 control points, as engines tessellate it.
    bool PatchMatches(const bspDrawSurface_t &record, const ShaderInfo &shader) const {
        for (int y = 0; y + 2 < record.patchHeight; y += 2)
            for (int x = 0; x + 2 < record.patchWidth; x += 2) {
                std::array<std::array<SurfaceSample, 3>, 3> points;
                for (int row = 0; row < 3; ++row)
                    for (int column = 0; column < 3; ++column)
                        points[std::size_t(row)][std::size_t(column)] =
                            AtVertex(record.firstVert + (y + row) * record.patchWidth + x + column, shader);
                if (!SubPatchMatches(points))
                    return false;
            }
        return true;
    }

    bool SubPatchMatches(const std::array<std::array<SurfaceSample, 3>, 3> &p) const {
        int across = 1, down = 1;
        for (std::size_t i = 0; i < 3; ++i) {
            across = std::max(across, Steps(p[i][0], p[i][1], p[i][2]));
            down = std::max(down, Steps(p[0][i], p[1][i], p[2][i]));
        }
        for (int x = 0; x <= across; ++x) {
            std::array<SurfaceSample, 3> column;
            for (std::size_t row = 0; row < 3; ++row)
                column[row] = OnCurve(p[row][0], p[row][1], p[row][2], float(x) / float(across));
            for (int y = 0; y <= down; ++y)
                if (!IsClose(OnCurve(column[0], column[1], column[2], float(y) / float(down))))
                    return false;
        }
        return true;
    }

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    const RawLightmap &lightmap_;
    float spacing_; ///< largest distance between compared points, luxels
    ToneOptions tone_;
};

VertexStandIn StandInFor(const SurfaceInputs &in, const SurfaceLight &surfaces, const RawLightmap &lightmap) {
    const auto usesVertexLight = [&](int surface) {
        return !in.table[std::size_t(surface)].shader->lightmap.noVertexLight;
    };
    const Vec3f size = lightmap.bounds.maxs - lightmap.bounds.mins;
    if (MaxComponent(size) <= kTinyLuxels * lightmap.sampleSize &&
        std::all_of(lightmap.surfaces.begin(), lightmap.surfaces.end(), usesVertexLight))
        return VertexStandIn::Forced;
    const Approximation approximation(in, surfaces, lightmap);
    const bool close = std::all_of(lightmap.surfaces.begin(), lightmap.surfaces.end(),
                                   [&](int surface) { return approximation.Matches(surface); });
    return close ? VertexStandIn::Close : VertexStandIn::No;
}

} // namespace

std::vector<VertexStandIn> FindVertexStandIns(const SurfaceInputs &in, const SurfaceLight &surfaces) {
    std::vector<VertexStandIn> standIns(surfaces.lightmaps.size(), VertexStandIn::No);
    if (in.lightmap.approximate > 0)
        in.jobs.For(std::int64_t(standIns.size()), [&](std::int64_t i, int) {
            const RawLightmap &lightmap = surfaces.lightmaps[std::size_t(i)];
            if (!lightmap.result[0].empty())
                standIns[std::size_t(i)] = StandInFor(in, surfaces, lightmap);
        });
    return standIns;
}

} // namespace q3
