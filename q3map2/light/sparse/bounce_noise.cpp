// GPL-2.0-or-later. Random error of bounced light at points of the SH grid.
#include "q3map2/light/sparse/bounce_noise.h"

#include "libs/math/low_discrepancy.h"
#include "libs/sh/sh.h"
#include "q3map2/light/sparse/display_error.h"

#include <algorithm>

namespace q3 {

namespace {

/// Binary logarithm of the edge of a block in base cells.
constexpr int kBlockLevels = 1;
/// On average one in this many points of the uniform grid is measured.
constexpr std::uint64_t kStride = 12;
/// In the mean of a block the mean over all blocks has the weight of this many points.
constexpr double kPrior = 2;
/// Seeds of the gathers, apart from those of grid points.
constexpr std::uint64_t kSeed = 0x4E6F697365ull;

/// Bounced light at a point in the open, convolved with the cosine.
ShFloats GatherAt(const GridInputs &in, const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) {
    in.indirect->Gather(position, seed, rays);
    const float scale = (in.options.gridScale > 0 ? float(in.options.gridScale) : 1.0f) / 255;
    ShFloats light{};
    for (const IndirectRay &ray : rays) {
        const ShVector basis = ShBasis(Vec3d(ray.direction));
        for (std::size_t i = 0; i < kShFloats; ++i)
            light[i] += float(basis[i / 3] * kCosineLobe[i / 3]) * scale * ray.light[i % 3];
    }
    return light;
}

} // namespace

BounceNoise::BounceNoise(const GridInputs &in, const SparseLattice &lattice, const LatticePoints &points) {
    if (!in.indirect)
        return;
    blockLevel_ = lattice.BaseLevel() + kBlockLevels;
    std::size_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        blocks_[axis] = (lattice.Roots()[axis] << (lattice.Levels() - blockLevel_)) + 1;
        count *= std::size_t(blocks_[axis]);
    }
    std::vector<std::uint32_t> chosen;
    for (std::size_t i = 0; i < points.Size(); ++i)
        if (points[i].open && HashIndex(KeyOf(points[i].at) + kSeed) % kStride == 0)
            chosen.push_back(std::uint32_t(i));
    std::vector<float> measured(chosen.size());
    in.jobs.For(std::int64_t(chosen.size()), [&](std::int64_t i, int) {
        const LatticeSample &point = points[chosen[std::size_t(i)]];
        const std::uint64_t seed = HashIndex(KeyOf(point.at) ^ kSeed);
        const Vec3f position = lattice.PositionOf(point.at);
        std::vector<IndirectRay> rays;
        ShFloats other = point.value;
        AddScaled(1, GatherAt(in, position, seed, rays), other);
        AddScaled(-1, GatherAt(in, position, seed + 1, rays), other);
        measured[std::size_t(i)] = SquaredDisplayError(point.value, other) / 2;
    });
    double total = 0;
    std::vector<double> sums(count), numbers(count);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const std::size_t block = BlockOf(points[chosen[i]].at);
        total += double(measured[i]);
        sums[block] += double(measured[i]);
        ++numbers[block];
    }
    const double mean = chosen.empty() ? 0 : total / double(chosen.size());
    variance_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        variance_[i] = float((sums[i] + kPrior * mean) / (numbers[i] + kPrior));
}

std::size_t BounceNoise::BlockOf(const LatticePoint &p) const {
    std::size_t block = 0;
    for (std::size_t axis = 3; axis-- > 0;)
        block =
            block * std::size_t(blocks_[axis]) + std::size_t(std::clamp(p[axis] >> blockLevel_, 0, blocks_[axis] - 1));
    return block;
}

} // namespace q3
