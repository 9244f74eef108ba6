// GPL-2.0-or-later. sampling_cost: CPU time of a sample of the uniform and of the sparse SH grid of a map.
#include "common/arguments.h"
#include "common/error.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "common/tool_main.h"
#include "libs/sh/sh.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/light/scene/light_space.h"
#include "tools/measure/shbench/truth.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <random>

namespace q3 {

namespace {

constexpr std::string_view kUsage = R"(usage: sampling_cost [options] LIT.bsp [LIT.bsp]
The map has both the uniform and the sparse SH grid, or each of two files of it has one.
  --positions N   samples of a measurement (200000)
  --repeats N     measurements, of which the least counts (15)
  --seed N        of the random positions (1)
)";

constexpr int kPlaces = 20;          ///< number of walks
constexpr double kStep = 2;          ///< of a walk, game units
constexpr double kWalkRadius = 128;  ///< game units
constexpr double kNanoseconds = 1e9; ///< in a second

/// Positions along random walks, one after the other, about places where a player fits. A walk turns at obstacles and
/// kWalkRadius away from its place.
std::vector<Vec3f> Walks(const Bsp &bsp, const BspSpace &space, std::string_view name, int count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> turns(0, 2 * std::numbers::pi);
    std::vector<Vec3f> positions;
    for (const Vec3f &place : bench::PlayerPositions(bsp, space, name, kPlaces, seed)) {
        Vec3f p = place;
        double turn = turns(random);
        for (int i = 0; i < count / kPlaces; ++i) {
            const Vec3f next = p + Vec3f(Vec3d{kStep * std::cos(turn), kStep * std::sin(turn), 0});
            if (double(Length(next - place)) < kWalkRadius && space.PlayerFits(next))
                p = next;
            else
                turn = turns(random);
            positions.push_back(p);
        }
    }
    return positions;
}

/// CPU time of sampling one grid at many positions.
struct SamplingCost {
    double seconds = std::numeric_limits<double>::max(); ///< CPU time of all positions
    std::array<double, 27> sums{}; ///< of 9 coefficients x 3 channels, so that none is optimized away

    /// Mean light over positions, normals and channels, of 255.
    double Mean(std::size_t positions) const {
        return 255 * kSHC0 * (sums[0] + sums[1] + sums[2]) / (3 * double(positions));
    }

    void Measure(const shgrid_grid &grid, const std::vector<Vec3f> &positions) {
        sums = {};
        const CpuTimer timer;
        for (const Vec3f &p : positions) {
            const float at[3] = {p.x, p.y, p.z};
            shgrid_coeffs light;
            shgrid_sample(&grid, at, &light);
            for (std::size_t i = 0; i < sums.size(); ++i)
                sums[i] += double(light.c[i / 3][i % 3]);
        }
        seconds = std::min(seconds, timer.Seconds());
    }
};

void PrintCosts(std::string_view pattern, const shgrid_grid &uniform, const shgrid_grid &sparse,
                const std::vector<Vec3f> &positions, int repeats) {
    SamplingCost ofUniform, ofSparse;
    for (int i = 0; i < repeats; ++i) {
        ofUniform.Measure(uniform, positions);
        ofSparse.Measure(sparse, positions);
    }
    const double each = kNanoseconds / double(positions.size());
    fmt::print("{:<20} {:>10.0f} {:>10.0f} {:>10.2f} {:>11.2f} {:>10.2f}\n", pattern, ofUniform.seconds * each,
               ofSparse.seconds * each, ofSparse.seconds / ofUniform.seconds, ofUniform.Mean(positions.size()),
               ofSparse.Mean(positions.size()));
}

/// The grid of that form in the first of the files that has it.
shgrid_grid FindGrid(const std::vector<std::vector<std::byte>> &files, shgrid_form form, std::string_view name) {
    shgrid_grid grid;
    for (const std::vector<std::byte> &file : files) {
        const shgrid_result result = shgrid_load_form(file.data(), file.size(), form, &grid);
        if (result == SHGRID_OK)
            return grid;
        if (result != SHGRID_ABSENT)
            throw Error("{} SH grid: {}", name, shgrid_message(result));
    }
    throw Error("no {} SH grid", name);
}

int Run(const std::vector<std::string> &words) {
    Arguments arguments(words);
    if (arguments.TakeFlag({"--help", "-h"}) || arguments.Empty()) {
        fmt::print("{}", kUsage);
        return 0;
    }
    const auto number = [&](std::string_view name, double fallback, double least) {
        const auto text = arguments.TakeValue(name);
        const double value = text ? NumberFromText(*text) : fallback;
        if (value < least)
            throw Error("{}: expected at least {}", name, least);
        return value;
    };
    const int positions = int(number("--positions", 200000, kPlaces)), repeats = int(number("--repeats", 15, 1));
    const auto seed = std::uint64_t(number("--seed", 1, 0));
    const std::vector<std::string> paths = arguments.Rest();
    std::vector<std::vector<std::byte>> files;
    for (const std::string &path : paths)
        files.push_back(ReadFile(path));
    if (files.empty())
        throw Error("expected lit maps");
    const shgrid_grid uniform = FindGrid(files, SHGRID_UNIFORM, "uniform"),
                      sparse = FindGrid(files, SHGRID_SPARSE, "sparse");

    Log log(PrintWarnings);
    const Bsp bsp = ReadBspFile(paths.front(), {}, log);
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size()));
    fmt::print("{}: points {} uniform, {} sparse\n{:<20} {:>10} {:>10} {:>10} {:>22}\n{:<20} {:>10} {:>10} {:>10} "
               "{:>11} {:>10}\n",
               paths.front(), uniform.count, sparse.count, "", "ns of CPU", "a sample", "", "mean light of 255", "",
               "uniform", "sparse", "ratio", "uniform", "sparse");
    PrintCosts("all over the map", uniform, sparse, bench::PlayerPositions(bsp, space, paths.front(), positions, seed),
               repeats);
    PrintCosts("near one place", uniform, sparse, Walks(bsp, space, paths.front(), positions, seed), repeats);
    return 0;
}

} // namespace

} // namespace q3

int main(int count, char **words) {
    return q3::RunTool("sampling_cost", count, words, q3::Run);
}
