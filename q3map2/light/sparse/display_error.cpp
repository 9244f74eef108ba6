// GPL-2.0-or-later. Difference of two lights as a screen shows them, and the random error of bounced light.
#include "q3map2/light/sparse/display_error.h"

#include "libs/math/sampling.h"
#include "libs/sh/sh.h"
#include "q3map2/light/batch/lanes.h"

#include <algorithm>

namespace q3 {

// ---- Difference of two lights on surfaces as a screen shows them ----

namespace {

/// Number of pairs of opposite normals, and of normals.
constexpr int kAxes = 13, kNormals = 2 * kAxes;

/// Light of one channel at 13 normals n: even + odd, the sums over bands 0 and 2 and over band 1. At -n it is
/// even - odd.
struct Halves {
    Lanes even, odd;
};

/// light: coefficient 0 of the channel; the following ones are three floats apart.
Halves HalvesOf(const std::array<Lanes, 9> &basis, const float *light) {
    return Vectorize([&]() Q3_INLINE {
        Halves halves;
        for (const std::size_t i : kEachLane) {
            halves.odd[i] = basis[1][i] * light[3] + basis[2][i] * light[6] + basis[3][i] * light[9];
            halves.even[i] = basis[0][i] * light[0] + basis[4][i] * light[12] + basis[5][i] * light[15] +
                             basis[6][i] * light[18] + basis[7][i] * light[21] + basis[8][i] * light[24];
        }
        return halves;
    });
}

float SumOfSquares(const Halves &a, const Halves &b) {
    return Vectorize([&]() Q3_INLINE {
        Lanes squares;
        for (const std::size_t i : kEachLane) {
            const float up =
                std::clamp(a.even[i] + a.odd[i], 0.0f, 1.0f) - std::clamp(b.even[i] + b.odd[i], 0.0f, 1.0f);
            const float down =
                std::clamp(a.even[i] - a.odd[i], 0.0f, 1.0f) - std::clamp(b.even[i] - b.odd[i], 0.0f, 1.0f);
            squares[i] = up * up + down * down;
        }
        float sum = 0;
        for (const std::size_t i : kEachLane)
            sum += squares[i];
        return sum;
    });
}

} // namespace

ScreenError::ScreenError() : basis_{} {
    // The first 13 of the 3 x 3 x 3 vectors with components -1, 0, 1: number 13 is zero, and the rest are opposite.
    for (int i = 0; i < kAxes; ++i) {
        const Vec3d n = Normalize(Vec3d{double(i % 3 - 1), double(i / 3 % 3 - 1), double(i / 9 - 1)});
        const SHVector basis = SHBasis(n);
        for (std::size_t k = 0; k < 9; ++k)
            basis_[k][std::size_t(i)] = float(basis[k]);
    }
}

float ScreenError::Squared(const SHFloats &a, const SHFloats &b) const {
    float sum = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        sum += SumOfSquares(HalvesOf(basis_, a.data() + channel), HalvesOf(basis_, b.data() + channel));
    return sum * (255.0f * 255.0f / float(3 * kNormals));
}

// ---- Random error of bounced light at points of the SH grid ----

namespace {

/// Binary logarithm of the edge of a block in base cells.
constexpr int kBlockLevels = 1;
/// On average one in this many points of the uniform grid is measured.
constexpr std::uint64_t kStride = 12;
/// In the mean of a block the mean over all blocks has the weight of this many points.
constexpr double kPriorPoints = 2;
/// Keeps the seeds of these gathers apart from those of grid points: "Noise" in ASCII.
constexpr std::uint64_t kSeedNoise = 0x4E6F697365ull;

/// Bounced light at a point in the open, convolved with the cosine.
SHFloats GatherAt(const GridInputs &in, const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) {
    in.indirect->Gather(position, seed, rays);
    const float scale = in.options.PositiveGridScale() / 255;
    SHFloats light{};
    for (const IndirectRay &ray : rays) {
        const SHVector basis = SHBasis(Vec3d(ray.direction));
        for (std::size_t i = 0; i < kSHFloats; ++i)
            light[i] += float(basis[i / 3] * kCosineLobe[i / 3]) * scale * ray.light[i % 3];
    }
    return light;
}

} // namespace

BounceNoise::BounceNoise(const GridInputs &in, const SparseLattice &lattice, const LatticePoints &points) {
    if (!in.indirect)
        return;
    blockLevel_ = lattice.BaseLevel() + kBlockLevels;
    std::size_t blockCount = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        blocks_[axis] = (lattice.Roots()[axis] << (lattice.Levels() - blockLevel_)) + 1;
        blockCount *= std::size_t(blocks_[axis]);
    }
    std::vector<std::uint32_t> chosen;
    for (std::size_t i = 0; i < points.Size(); ++i)
        if (points[i].traced && HashIndex(KeyOf(points[i].at) + kSeedNoise) % kStride == 0)
            chosen.push_back(std::uint32_t(i));
    std::vector<float> measured(chosen.size());
    in.jobs.For(std::int64_t(chosen.size()), [&](std::int64_t i, int) {
        const LatticeSample &point = points[chosen[std::size_t(i)]];
        const std::uint64_t seed = HashIndex(KeyOf(point.at) ^ kSeedNoise);
        const Vec3f position = lattice.PositionOf(point.at);
        std::vector<IndirectRay> rays;
        SHFloats other = point.value;
        AddScaled(1, GatherAt(in, position, seed, rays), other);
        AddScaled(-1, GatherAt(in, position, seed + 1, rays), other);
        measured[std::size_t(i)] = SquaredDisplayError(point.value, other) / 2; // Var X = E[(X1 - X2)^2] / 2
    });
    double total = 0;
    std::vector<double> sums(blockCount), counts(blockCount);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const std::size_t block = BlockOf(points[chosen[i]].at);
        total += double(measured[i]);
        sums[block] += double(measured[i]);
        ++counts[block];
    }
    const double mean = chosen.empty() ? 0 : total / double(chosen.size());
    variance_.resize(blockCount);
    for (std::size_t i = 0; i < blockCount; ++i)
        variance_[i] = float((sums[i] + kPriorPoints * mean) / (counts[i] + kPriorPoints));
}

std::size_t BounceNoise::BlockOf(const LatticePoint &p) const {
    std::size_t block = 0;
    for (std::size_t axis = 3; axis-- > 0;)
        block =
            block * std::size_t(blocks_[axis]) + std::size_t(std::clamp(p[axis] >> blockLevel_, 0, blocks_[axis] - 1));
    return block;
}

} // namespace q3
