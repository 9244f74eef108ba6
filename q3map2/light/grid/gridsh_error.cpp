// GPL-2.0-or-later. Error of the SH grid against exact light, where players can be.
#include "q3map2/light/grid/gridsh_error.h"

#include "libs/math/morton.h"
#include "libs/math/sampling.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/light/grid/light_gridsh.h"
#include "q3map2/light/grid/probe_integrator.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace q3 {

namespace {

constexpr std::uint64_t kSeedError = 0x4572726F72ull; ///< "Error" in ASCII
/// At most this many random positions are tried per wanted receiver.
constexpr std::size_t kTries = 2000;
/// Sample patterns of receivers are seeded from this index on, apart from those of grid points.
constexpr std::uint32_t kFirstIndex = 0x80000000u;
constexpr double kDarkFraction = 0.01, kShownLit = 0.05; ///< fractions of the map's mean light: see GridSHError::leak
/// Errors below this are invisible. 255ths.
constexpr double kInvisible = 0.1;

struct Receiver {
    Vec3f position;
    int cluster = kSolidCluster;
    std::uint32_t mortonCode = 0; ///< of the position
};

/// Morton code of a point of the unit cube, 10 bits per axis; x is the highest of three bits.
std::uint32_t MortonInCube(const Vec3f &fraction) {
    constexpr std::uint32_t kSteps = 1 << 10;
    const auto step = [](float f) { return std::uint32_t(f * float(kSteps)) & (kSteps - 1); };
    return std::uint32_t(MortonCode(step(fraction.z), step(fraction.y), step(fraction.x)));
}

/// Random positions where a player fits, in Morton order so that batches hold neighbors.
std::vector<Receiver> FindReceivers(const BspSpace &space, std::size_t count) {
    const bspModel_t &world = space.Map().models.front();
    const Vec3f mins(world.mins), size = Vec3f(world.maxs) - mins;
    std::vector<Receiver> receivers;
    for (std::size_t i = 0; i < count * kTries && receivers.size() < count; ++i) {
        Vec3f fraction;
        for (std::size_t axis = 0; axis < 3; ++axis)
            fraction[axis] = float(UnitFromHash(HashIndex(kSeedError + 3 * i + axis)));
        const Vec3f p = mins + size * fraction;
        const int cluster = space.ClusterAt(p, kPlayerHalfSize);
        if (cluster >= 0 && space.PlayerFits(p))
            receivers.push_back({p, cluster, MortonInCube(fraction)});
    }
    std::stable_sort(receivers.begin(), receivers.end(),
                     [](const Receiver &a, const Receiver &b) { return a.mortonCode < b.mortonCode; });
    return receivers;
}

/// Coefficients that grid points at the receivers would hold, computed without shortcuts. firstIndex: seeds of the
/// sample patterns.
std::vector<bspGridPointSH_t> ExactPoints(const GridInputs &in, const std::vector<Light> &lights,
                                          const std::vector<Receiver> &receivers, std::uint32_t firstIndex) {
    LightOptions options = in.options;
    options.shSamples = std::max(1.0f, options.shSamples);
    options.skip.faint = options.skip.moments = options.skip.probes = options.skip.coarse = false;
    const GridInputs exact{in.space, in.scene, options, in.world, in.jobs, in.log, in.indirect};
    const ProbeIntegrator integrator(exact, lights);
    std::vector<bspGridPointSH_t> points(receivers.size());
    in.jobs.For(std::int64_t(BatchCount(receivers.size())), [&](std::int64_t block, int) {
        std::vector<ReceiverBatch> batches(1);
        for (const Receiver &receiver : BatchOf(std::span(receivers), std::size_t(block)))
            batches[0].Add(receiver.position, receiver.position, receiver.cluster,
                           firstIndex + std::uint32_t(&receiver - receivers.data()));
        GridStats work;
        integrator.Trace(batches, std::uint64_t(block), work, [&](std::size_t i, const bspGridPointSH_t &value) {
            bspGridPointSH_t &point = points[std::size_t(block) * kPacketSize + i];
            point = value;
            if (options.shDering)
                DeringPoint(point, options.shRadiance);
        });
    });
    return points;
}

/// Every second point per axis of a grid, as if the others had not been lit.
class EverySecond {
  public:
    EverySecond(const LightGridSH &grid, const BspSpace &space) : grid_(grid), space_(space) {}

    /// Trilinear blend; false outside. Leaves out black points in solids: the fine grid did not fill them, but a grid
    /// with cells this large would have.
    bool Sample(const Vec3f &p, shgrid_coeffs &out) const {
        const auto &h = grid_.header;
        std::array<int, 3> low{};
        Vec3f fraction;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float at = (p[axis] - h.gridMins[axis]) / (2 * h.gridSize[axis]);
            low[axis] = int(std::floor(at));
            fraction[axis] = at - float(low[axis]);
            if (low[axis] < 0 || 2 * low[axis] + 2 >= h.gridBounds[axis])
                return false;
        }
        out = {};
        float total = 0;
        for (int corner = 0; corner < 8; ++corner) {
            std::array<int, 3> at{};
            float weight = 1;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const int upper = corner >> axis & 1;
                at[axis] = 2 * (low[axis] + upper);
                weight *= upper != 0 ? fraction[axis] : 1 - fraction[axis];
            }
            if (!AddPoint(at, weight, out))
                continue;
            total += weight;
        }
        for (auto &k : out.c)
            for (float &c : k)
                c = total > 0 ? c / total : 0;
        return true;
    }

  private:
    /// Adds weight times a grid point. False: it is a black point in a solid, which is left out.
    bool AddPoint(const std::array<int, 3> &at, float weight, shgrid_coeffs &out) const {
        const auto &h = grid_.header;
        const auto width = std::size_t(h.gridBounds[0]), height = std::size_t(h.gridBounds[1]);
        const bspGridPointSH_t &point =
            grid_.points[std::size_t(at[0]) + width * (std::size_t(at[1]) + height * std::size_t(at[2]))];
        const GridLayout layout{h.gridMins, h.gridSize, h.gridBounds};
        const bool black = std::all_of(point.coeffs.begin(), point.coeffs.end(), [](const auto &k) {
            return std::all_of(k.begin(), k.end(), [](float c) { return c == 0; });
        });
        if (black && space_.ClusterAt(Vec3f(layout.Position(at[0], at[1], at[2])), 0) < 0)
            return false;
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                out.c[k][channel] += weight * point.coeffs[k][channel];
        return true;
    }

    const LightGridSH &grid_;
    const BspSpace &space_;
};

/// Absolute differences over many receivers.
class Differences {
  public:
    void Add(const DisplayedLight &a, const DisplayedLight &b) {
        for (std::size_t i = 0; i < a.size(); ++i) {
            all_.push_back(std::abs(a[i] - b[i]));
            squares_ += double(all_.back()) * double(all_.back());
        }
    }
    /// noise: subtracted from the mean square, bytes^2.
    double Rms(double noise) const {
        return all_.empty() ? 0 : std::sqrt(std::max(0.0, squares_ / double(all_.size()) - noise));
    }
    double Percentile95() {
        if (all_.empty())
            return 0;
        const auto rank = all_.begin() + std::ptrdiff_t(all_.size() * 95 / 100);
        std::nth_element(all_.begin(), rank, all_.end());
        return double(*rank);
    }

  private:
    std::vector<float> all_;
    double squares_ = 0;
};

double Mean(const DisplayedLight &shown) {
    double sum = 0;
    for (const float light : shown)
        sum += double(light);
    return sum / double(shown.size());
}

/// Fraction of receivers that are dark but displayed as lit.
double LeakFraction(const std::vector<DisplayedLight> &exact, const std::vector<DisplayedLight> &shown) {
    double mean = 0;
    for (const DisplayedLight &light : exact)
        mean += Mean(light) / double(exact.size());
    std::size_t leaks = 0;
    for (std::size_t i = 0; i < exact.size(); ++i)
        leaks += Mean(exact[i]) < kDarkFraction * mean && Mean(shown[i]) > kShownLit * mean;
    return double(leaks) / double(exact.size());
}

/// Sets `doubled` and `order`, from the receivers that lie inside the grid of doubled cells too.
void CompareWithDoubled(const GridInputs &in, const LightGridSH &grid, const ExactReceivers &receivers,
                        const std::vector<DisplayedLight> &exact, const std::vector<DisplayedLight> &shown,
                        GridSHError &error) {
    const EverySecond everySecond(grid, in.space);
    Differences here, coarse;
    for (std::size_t i = 0; i < receivers.Size(); ++i) {
        shgrid_coeffs coeffs;
        if (!everySecond.Sample(receivers.Position(i), coeffs))
            continue;
        here.Add(shown[i], exact[i]);
        coarse.Add(DisplayLight(coeffs, in.options.shRadiance), exact[i]);
    }
    constexpr double kMinOrder = 0.5, kMaxOrder = 2;
    const double fine = here.Percentile95();
    error.doubled = coarse.Percentile95();
    if (fine > 0 && error.doubled > 0)
        error.order = std::clamp(std::log2(error.doubled / fine), kMinOrder, kMaxOrder);
}

/// What a grid shows at receivers, the exact light there, and how they differ.
struct GridComparison {
    GridComparison(const ExactReceivers &receivers, const shgrid_grid &reader, bool radiance);

    std::vector<DisplayedLight> exact, shown; ///< by receiver
    GridSHError error;
};

GridComparison::GridComparison(const ExactReceivers &receivers, const shgrid_grid &reader, bool radiance) {
    error.receivers = receivers.Size();
    if (receivers.Size() == 0)
        return;
    Differences differences;
    for (std::size_t i = 0; i < receivers.Size(); ++i) {
        const Vec3f &p = receivers.Position(i);
        const float position[3] = {p.x, p.y, p.z};
        shgrid_coeffs coeffs;
        shgrid_sample(&reader, position, &coeffs);
        exact.push_back(DisplayLight(receivers.At(i), radiance));
        shown.push_back(DisplayLight(coeffs, radiance));
        differences.Add(shown[i], exact[i]);
    }
    error.rms = differences.Rms(receivers.Noise());
    error.percentile95 = differences.Percentile95();
    error.leak = LeakFraction(exact, shown);
}

/// Prints the number of receivers and the RMS error. False: there are no receivers.
bool PrintReceivers(const GridSHError &error, Log &log) {
    if (error.receivers == 0) {
        log.Print("No position is {} units clear of solids: nothing to check\n", kPlayerHalfSize);
        return false;
    }
    log.Count(error.receivers, "receivers that a player can be in, 26 directions each");
    log.Print("{:9.2f} levels: RMS error of displayed light (0 to 255)\n", error.rms);
    return true;
}

} // namespace

ExactReceivers::ExactReceivers(const GridInputs &in, const std::vector<Light> &lights, std::size_t receivers)
    : radiance_(in.options.shRadiance) {
    const std::vector<Receiver> found = FindReceivers(in.space, receivers);
    for (const Receiver &receiver : found)
        positions_.push_back(receiver.position);
    light_ = ExactPoints(in, lights, found, kFirstIndex);
    if (!in.indirect || found.empty())
        return;
    const std::vector<bspGridPointSH_t> again =
        ExactPoints(in, lights, found, kFirstIndex + std::uint32_t(found.size()));
    Differences differences;
    for (std::size_t i = 0; i < found.size(); ++i) {
        differences.Add(DisplayLight(light_[i], radiance_), DisplayLight(again[i], radiance_));
        bspGridPointSH_t mean{};
        AddScaled(0.5f, light_[i], mean);
        AddScaled(0.5f, again[i], mean);
        light_[i] = mean;
    }
    // The difference of two estimates has twice the variance of one, and their mean has half of it.
    noise_ = differences.Rms(0) * differences.Rms(0) / 4;
}

GridSHError ExactReceivers::ErrorOf(const SparseGridSH &grid) const {
    return ErrorOf(EncodeSparseGrid(grid));
}

GridSHError ExactReceivers::ErrorOf(std::span<const std::byte> lump) const {
    return GridComparison(*this, SparseReader(lump), radiance_).error;
}

GridSHError MeasureGridSH(const GridInputs &in, const LightGridSH &grid, const std::vector<Light> &lights,
                          std::size_t receivers) {
    const std::clock_t start = std::clock();
    const ExactReceivers exact(in, lights, receivers);
    GridComparison comparison(exact, UniformReader(grid), in.options.shRadiance);
    if (exact.Size() > 0)
        CompareWithDoubled(in, grid, exact, comparison.exact, comparison.shown, comparison.error);
    comparison.error.cpuSeconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    return comparison.error;
}

Float3 CellOfHalfError(const Float3 &cell, const GridSHError &error) {
    Float3 finer{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        finer[axis] = std::max(kMinCell, std::round(cell[axis] * float(std::exp2(-1 / error.order))));
    return finer;
}

void PrintGridSHError(const GridSHError &error, const Float3 &cell, const Float3 &legacyCell, Log &log) {
    log.Section("CheckGridSH");
    if (!PrintReceivers(error, log))
        return;
    log.Print("{:9.2f} levels: 95th percentile of the error; {:.2f} with doubled cells\n", error.percentile95,
              error.doubled);
    log.Print("{:9.2f} % of these receivers are dark but displayed as lit (leaks)\n", 100 * error.leak);
    const Float3 finer = CellOfHalfError(cell, error);
    double scale = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
        scale *= double(legacyCell[axis] / finer[axis]);
    if (error.percentile95 < kInvisible)
        log.Print("This error is hardly visible: smaller cells are of no use\n");
    else if (finer == cell)
        log.Print("Smaller cells are not possible\n");
    else
        log.Print("-gridsh {} {} {} or -gridscalesh {:.3g} would halve the 95th percentile\n", finer[0], finer[1],
                  finer[2], std::cbrt(scale));
    log.Print("{:9.2f} CPU seconds for the check\n", error.cpuSeconds);
}

void PrintSparseGridError(const GridSHError &error, Log &log) {
    log.Section("CheckSparseGridSH");
    if (!PrintReceivers(error, log))
        return;
    log.Print("{:9.2f} levels: 95th percentile of the error\n", error.percentile95);
    log.Print("{:9.2f} % of these receivers are dark but displayed as lit (leaks)\n", 100 * error.leak);
}

} // namespace q3
