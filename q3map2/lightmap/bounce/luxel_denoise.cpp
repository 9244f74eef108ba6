// GPL-2.0-or-later. Denoises estimates of bounced light over neighboring luxels.
#include "q3map2/lightmap/bounce/luxel_denoise.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// The denoising window reaches this many luxels to each side, over luxels whose normals are within this cosine of
/// the center's.
constexpr int kWindowReach = 2;
constexpr float kMinNormalCosine = 0.9f;
/// Ridge regression: added to the variance of x and y, so that slopes of small windows stay small. Luxels squared.
constexpr double kSlopePenalty = 0.7;

/// Luxels in the window around a luxel that are connected to it over mapped luxels with similar normals (flood fill).
class LuxelWindow {
  public:
    struct Neighbor {
        std::size_t luxel;
        float dx, dy;
    };
    const std::vector<Neighbor> &Around(const RawLightmap &raw, int x, int y, int reach) {
        list_.clear();
        const int side = 2 * reach + 1;
        seen_.assign(std::size_t(side * side), 0);
        const std::size_t center = raw.SuperIndex(x, y);
        Visit(center, 0, 0, reach);
        for (std::size_t next = 0; next < list_.size(); ++next) {
            const int dx = int(list_[next].dx), dy = int(list_[next].dy);
            for (const auto &[sx, sy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                const int ox = dx + sx, oy = dy + sy;
                if (std::abs(ox) > reach || std::abs(oy) > reach || x + ox < 0 || y + oy < 0 ||
                    x + ox >= raw.SuperWidth() || y + oy >= raw.SuperHeight() ||
                    seen_[std::size_t((oy + reach) * side + ox + reach)] != 0)
                    continue;
                const std::size_t luxel = raw.SuperIndex(x + ox, y + oy);
                if (raw.Mapped(luxel) && Dot(raw.normals[luxel], raw.normals[center]) > kMinNormalCosine)
                    Visit(luxel, ox, oy, reach);
            }
        }
        return list_;
    }

  private:
    void Visit(std::size_t luxel, int dx, int dy, int reach) {
        seen_[std::size_t((dy + reach) * (2 * reach + 1) + dx + reach)] = 1;
        list_.push_back({luxel, float(dx), float(dy)});
    }
    std::vector<Neighbor> list_;
    std::vector<std::uint8_t> seen_;
};

struct WindowSample {
    Vec3f value;
    float dx, dy; ///< luxels from the center
};

/// Value at (0, 0) of the plane a + b x + c y fitted to the samples by least squares, with kSlopePenalty on b and c: at
/// the rim of a lightmap, with samples on one side only, free slopes would turn noise into a seam.
Vec3f FittedPlaneAtCenter(const std::vector<WindowSample> &around) {
    double mx = 0, my = 0;
    Vec3d mean;
    const auto n = double(around.size());
    for (const auto &[value, dx, dy] : around)
        mx += double(dx) / n, my += double(dy) / n, mean += Vec3d(value) * (1 / n);
    double xx = kSlopePenalty * n, xy = 0, yy = kSlopePenalty * n;
    Vec3d xv, yv;
    for (const auto &[sampled, dx, dy] : around) {
        const double x = double(dx) - mx, y = double(dy) - my;
        const Vec3d value = Vec3d(sampled) - mean;
        xx += x * x, xy += x * y, yy += y * y;
        xv += value * x, yv += value * y;
    }
    const double det = xx * yy - xy * xy;
    const Vec3d slopeX = (xv * yy - yv * xy) * (1 / det), slopeY = (yv * xx - xv * xy) * (1 / det);
    return Vec3f(mean - slopeX * mx - slopeY * my);
}

/// Whether all luxels of the window are mapped and have normals like that of the center.
bool WindowIsComplete(const RawLightmap &raw, int x, int y, int reach) {
    if (x < reach || y < reach || x + reach >= raw.SuperWidth() || y + reach >= raw.SuperHeight())
        return false;
    const Vec3f normal = raw.normals[raw.SuperIndex(x, y)];
    for (int row = y - reach; row <= y + reach; ++row)
        for (std::size_t i = raw.SuperIndex(x - reach, row); i <= raw.SuperIndex(x + reach, row); ++i)
            if (!raw.Mapped(i) || !(Dot(raw.normals[i], normal) > kMinNormalCosine))
                return false;
    return true;
}

/// Mean over a complete window, which equals its FittedPlaneAtCenter.
Vec3f MeanOverWindow(const RawLightmap &raw, const std::vector<Vec3f> &values, int x, int y, int reach) {
    Vec3f mean;
    for (int row = y - reach; row <= y + reach; ++row)
        for (std::size_t i = raw.SuperIndex(x - reach, row); i <= raw.SuperIndex(x + reach, row); ++i)
            mean += values[i];
    const int side = 2 * reach + 1;
    return mean / float(side * side);
}

/// Luxels over which the estimate at a luxel is denoised: a complete window, or some in its lightmap and across seams.
struct DenoiseWindow {
    bool complete = false;
    std::span<const LuxelWindow::Neighbor> own;
    std::span<const LightmapSeams::Neighbor> across;
};

/// Denoised estimate. imageOf(i): the estimates of raw lightmap i, null if it has none.
template <typename ImageOf>
Vec3f Denoised(const RawLightmap &raw, std::size_t lightmap, int x, int y, int reach, const DenoiseWindow &window,
               std::vector<WindowSample> &samples, const ImageOf &imageOf) {
    const std::vector<Vec3f> &own = *imageOf(lightmap);
    if (window.complete)
        return MeanOverWindow(raw, own, x, y, reach);
    samples.clear();
    for (const auto &[near, dx, dy] : window.own)
        samples.push_back({own[near], dx, dy});
    for (const auto &[other, near, dx, dy] : window.across)
        if (const std::vector<Vec3f> *image = imageOf(other))
            samples.push_back({(*image)[near], dx, dy});
    return FittedPlaneAtCenter(samples);
}

} // namespace

LuxelDenoiser::LuxelDenoiser(const SurfaceInputs &in, const SurfaceLight &surfaces)
    : seams_(in, surfaces, kWindowReach, kMinNormalCosine) {}

void LuxelDenoiser::AddTo(const std::vector<BounceEstimate> &all, std::size_t lightmap, std::size_t slot,
                          RawLightmap &raw) const {
    const int reach = kWindowReach * std::min(raw.super, 2);
    std::vector<WindowSample> samples;
    LuxelWindow around;
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x) {
            const std::size_t luxel = raw.SuperIndex(x, y);
            if (!raw.Mapped(luxel))
                continue;
            DenoiseWindow window;
            window.complete = WindowIsComplete(raw, x, y, reach);
            if (!window.complete) {
                window.own = around.Around(raw, x, y, reach);
                window.across = seams_.NeighborsAcross(lightmap, luxel);
            }
            const auto light = [&](std::size_t i) { return all[i].Empty() ? nullptr : &all[i].irradiance; };
            raw.light[slot][luxel] += Max(Denoised(raw, lightmap, x, y, reach, window, samples, light), Vec3f{});
            for (std::size_t c = 0; c < raw.channels.Count(); ++c) {
                // Basis normals of another lightmap may have other tangents.
                const bool isSh = raw.channels.IsSh(c);
                const auto channel = [&](std::size_t i) {
                    return all[i].Empty() || (i != lightmap && !isSh) ? nullptr : &all[i].channels[c];
                };
                const Vec3f value = Denoised(raw, lightmap, x, y, reach, window, samples, channel);
                raw.directional[slot][c][luxel] += isSh ? value : Max(value, Vec3f{});
            }
        }
}

} // namespace q3
