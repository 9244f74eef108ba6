// GPL-2.0-or-later. Self-shadowed bump maps: responses of a height field to the basis of radiosity normal mapping, as
// image files.
#pragma once

#include "common/arguments.h"
#include "common/image/image.h"
#include "common/jobs.h"
#include "common/log.h"
#include "common/settings.h"
#include "libs/math/rnm_basis.h"
#include "libs/math/vec.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// The coordinate modulo the size: 0 to size - 1, for negative ones too.
inline int Wrapped(int coordinate, int size) {
    return (coordinate % size + size) % size;
}

/// Heights at the centers of texels, in texels, row 0 on top. Between centers they are bilinear.
struct HeightField {
    int width = 0, height = 0;
    bool tiles = true; ///< repeats without end; else there is nothing beyond the outer centers
    std::vector<float> heights{};

    float At(int x, int y) const { return heights[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    /// The height at (x + right, y + down); nullopt beyond the edges of a field that does not tile.
    std::optional<float> Beside(int x, int y, int right, int down) const;
};

/// A slope: growth of the height along s (to the right) and t (down), texels per texel.
struct Gradient {
    float s = 0, t = 0;
};

/// By central differences; at edges of a field that does not tile, one-sided ones.
Gradient GradientAt(const HeightField &field, int x, int y);
/// The unit normal of a surface with this gradient: x along s, y along t, z up.
Vec3f NormalOf(const Gradient &gradient);

/// Heights from the luminance (30 % red, 59 % green, 11 % blue) of an image; `scale`: height of white, in texels.
HeightField HeightsOf(const DeepImage &image, double scale, bool tiles);

/// Smooths the terraces that few bits make of a slope: `passes` of relaxation toward a thin plate, in which no height
/// moves by more than half a step. `step`: height between neighboring values of the image, in texels.
void SmoothSteps(HeightField &field, int passes, double step, const JobPool &jobs);

/// For each texel with unit normal n the three channels max(0, b_i.n) V_i, 0 to 1; b_i: kRnmBasis. V_i is the share of
/// the light that no height blocks: an integral of max(0, b_i.w) max(0, n.w) over the visible directions w above the
/// plane of the texture, divided by the integral over all of them. Exactly 1 where nothing blocks.
///
/// Visibility comes from the horizon: along each of `rays` azimuths, the steepest slope from the texel to where the
/// ray crosses lines between neighboring texel centers; the integral over elevations is in closed form. `done`: as in
/// JobPool::For, rows finished. Results do not depend on the number of threads.
std::vector<Vec3f> SelfShadowedBump(const HeightField &field, int rays, const JobPool &jobs,
                                    const std::function<void(std::int64_t)> &done = {});

// ---- Options of the stage -ssbump, and bump maps as image files ----

struct SsbumpOptions {
    double bumpScale = 8; ///< height of white over black, texels; negative: white is deep
    bool tile = true;     ///< the height map repeats
    int rays = 32;        ///< azimuths along which a texel looks for its horizon
    int filter = 0;       ///< passes that smooth the steps of the image
    std::string normals;  ///< path of a normal map to write; empty: none
};

/// The options of the stage, declared.
std::vector<SettingGroup<SsbumpOptions>> SsbumpSettings();
/// Removes these options from `arguments`.
SsbumpOptions ParseSsbumpOptions(Arguments &arguments, Log &log);

/// Bytes of the channels of a bump map: 255 for 1, rounded to nearest.
std::vector<std::uint8_t> SsbumpBytes(std::span<const Vec3f> bump);
/// Bytes of the unit normals of a field, x, y, z for red, green, blue: 127 for 0, 255 for 1.
std::vector<std::uint8_t> NormalBytes(const HeightField &field);

/// Reads a height map, and writes its self-shadowed bump map and, if asked for, its normal map. The extension of the
/// files written, .tga or .png, is their format. They have 24 bits a texel, or 32 with the alpha of the height map if
/// it has any texel that is not opaque. Errors: other extensions, files that cannot be read or written.
void WriteSsbump(const std::filesystem::path &heightMap, const std::filesystem::path &output,
                 const SsbumpOptions &options, const JobPool &jobs, Log &log);

} // namespace q3
