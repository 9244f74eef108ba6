// GPL-2.0-or-later. grid_format_error: difference of the light that engines show with each format of -gridformats from
// that of the SH grid.
#include "common/error.h"
#include "common/tool_main.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/gridformats/grid_source.h"
#include "q3map2/gridformats/legacy_encode.h"
#include "tests/support/grid_readers/legacy_reader.h"
#include "tests/support/grid_readers/octree_reader.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <random>

namespace q3 {

namespace {

constexpr int kPositions = 4000, kMaxTries = 2000000; ///< positions compared; random ones tried at most
constexpr float kFloorReach = 64;                     ///< a floor is at most this far below a position; game units
/// 2^(overbright bits), here of none: they would change lightmaps alike.
constexpr float kOverbrightFactor = 1;
/// kPlainEngine, but points in walls are left out.
constexpr LegacyEngine kSkippingEngine{.angleSteps = 255, .skipsBlack = true};
/// kIoquake3Engine without the added ambient light.
constexpr LegacyEngine kRawEngine{.ambientScale = 0.6f, .skipsBlack = true};

using Shown = std::function<Vec3f(const Vec3f &position, const Vec3f &normal)>; ///< displayed light, byte scale

/// Unit vectors from the center cell of a 3 x 3 x 3 cube to its other cells.
std::vector<Vec3f> Normals() {
    std::vector<Vec3f> normals;
    constexpr int kCenter = 13;
    for (int i = 0; i < 27; ++i)
        if (i != kCenter)
            normals.push_back(Normalize(Vec3f{float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 - 1)}));
    return normals;
}

/// Random positions where a player fits, with a floor within kFloorReach below.
std::vector<Vec3f> Positions(const Bsp &bsp, const BspSpace &space) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    const Vec3f mins(bsp.models[0].mins), size = Vec3f(bsp.models[0].maxs) - mins;
    std::vector<Vec3f> positions;
    for (int tries = 0; tries < kMaxTries && positions.size() < kPositions; ++tries) {
        const float x = unit(random), y = unit(random), z = unit(random);
        const Vec3f at = mins + size * Vec3f{x, y, z};
        const Vec3f half{kPlayerHalfSize, kPlayerHalfSize, kPlayerHalfSize};
        if (space.ClusterAt(at, 0) >= 0 && space.PlayerFits(at) &&
            space.AnySolid(at - half - Vec3f{0, 0, kFloorReach}, at + half))
            positions.push_back(at);
    }
    return positions;
}

Vec3f Limited(const Vec3f &light) {
    return Min(Max(light, {}), Vec3f{255, 255, 255});
}

/// The SH grid as libs/shgrid evaluates it.
Shown Truth(const Bsp &bsp) {
    return [grid = UniformReader(*bsp.gridSH)](const Vec3f &position, const Vec3f &normal) {
        const float at[3] = {position.x, position.y, position.z}, n[3] = {normal.x, normal.y, normal.z};
        float rgb[3];
        shgrid_light(&grid, at, n, rgb);
        return Vec3f{rgb[0], rgb[1], rgb[2]} * 255.0f;
    };
}

struct Errors {
    double mean = 0;         ///< absolute difference, 255ths
    double percentile95 = 0; ///< over positions, of the mean over normals and channels
    double bias = 0;         ///< mean signed difference
};

Errors Measure(const std::vector<Vec3f> &positions, const Shown &truth, const Shown &shown) {
    std::vector<double> byPosition;
    Errors errors;
    const std::vector<Vec3f> normals = Normals();
    for (const Vec3f &position : positions) {
        double sum = 0;
        for (const Vec3f &normal : normals) {
            const Vec3f difference = Limited(shown(position, normal)) - Limited(truth(position, normal));
            for (std::size_t i = 0; i < 3; ++i) {
                sum += double(std::abs(difference[i]));
                errors.bias += double(difference[i]);
            }
        }
        byPosition.push_back(sum / (3 * double(normals.size())));
        errors.mean += byPosition.back();
    }
    errors.mean /= double(positions.size());
    errors.bias /= double(positions.size() * normals.size() * 3);
    std::ranges::sort(byPosition);
    errors.percentile95 = byPosition[byPosition.size() * 95 / 100];
    return errors;
}

Shown Evaluated(const std::optional<LegacyGridReader> &reader) {
    return [reader](const Vec3f &position, const Vec3f &normal) { return reader->At(position).On(normal); };
}

Shown Evaluated(const OctreeReader &reader) {
    return [reader](const Vec3f &position, const Vec3f &normal) {
        const auto sides = reader.At(position);
        return sides ? OctreeReader::CubeLight(*sides, normal) : Vec3f{};
    };
}

/// What an engine shows of the map with one format; "baked": with its own legacy grid.
Shown Converted(Bsp bsp, std::string_view word, Log &log) {
    const LegacyPlaces places(Vec3f(bsp.models[0].mins), Vec3f(bsp.models[0].maxs), LegacyCell(bsp));
    if (word == "baked")
        return Evaluated(LegacyGridReader::Load(IbspGridLump(bsp.gridPoints), places, kSkippingEngine));
    if (word == "baked in ioquake3")
        return Evaluated(LegacyGridReader::Load(IbspGridLump(bsp.gridPoints), places, kIoquake3Engine));
    const auto files = StoreGridFormats(bsp, ParseGridFormats(word), {}, JobPool(1), log);
    if (word == "legacy")
        return Evaluated(LegacyGridReader::Load(IbspGridLump(bsp.gridPoints), places, kPlainEngine));
    if (word == "legacy-ioq3")
        return Evaluated(LegacyGridReader::Load(IbspGridLump(bsp.gridPoints), places, kIoquake3Engine));
    if (word == "raw-ioq3")
        return Evaluated(
            LegacyGridReader::LoadRaw(IbspGridLump(bsp.gridPoints), files[0].bytes, places, kRawEngine, kOverbrightFactor));
    if (word == "raw-rend2")
        return Evaluated(LegacyGridReader::LoadRend2(IbspGridLump(bsp.gridPoints), files[0].bytes, places, {}));
    std::string fault;
    const auto octree = OctreeReader::Load(bsp.bspx.back().data, word == "grids", fault);
    if (!octree)
        throw Error("{}: {}", word, fault);
    return Evaluated(*octree);
}

void PrintErrors(const char *path, Log &log) {
    const Bsp bsp = ReadBspFile(path, {}, log);
    const BspSpace space(bsp, SolidBrushes(bsp));
    const std::vector<Vec3f> positions = Positions(bsp, space);
    if (positions.empty() || !bsp.gridSH)
        throw Error("{}: no SH grid, or no room for a player", path);
    const Shown truth = Truth(bsp);
    std::printf("%s: %zu positions\n%-20s %8s %8s %8s\n", path, positions.size(), "", "mean", "95 %", "bias");
    for (const char *word :
         {"legacy", "legacy-ioq3", "raw-ioq3", "raw-rend2", "octree", "grids", "baked", "baked in ioquake3"}) {
        const Errors errors = Measure(positions, truth, Converted(bsp, word, log));
        std::printf("%-20s %8.2f %8.2f %8.2f\n", word, errors.mean, errors.percentile95, errors.bias);
    }
}

} // namespace

} // namespace q3

int main(int count, char **paths) {
    q3::Log log(q3::PrintWarnings);
    try {
        for (int i = 1; i < count; ++i)
            q3::PrintErrors(paths[i], log);
    } catch (const q3::Error &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return count > 1 ? 0 : 2;
}
