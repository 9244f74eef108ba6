// GPL-2.0-or-later. sampling_cost: CPU time of lighting entities and vertices by the forms of the SH grid of a map.
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
#include <functional>
#include <limits>
#include <numbers>
#include <random>

namespace q3 {

namespace {

constexpr std::string_view kUsage = R"(usage: sampling_cost [options] LIT.bsp [LIT.bsp ...]
The files are the same map, lit with different forms of the SH grid; two of the three forms are needed.
An entity takes a sample, or with named lights shgrid_lights; a vertex the light on one normal.
  --positions N   samples of a measurement (200000)
  --repeats N     measurements, of which the least counts (15)
  --lights N      named lights of an entity that are kept, the others becoming coefficients (all)
  --seed N        of the random positions (1)
)";

constexpr int kPlaces = 20;          ///< number of walks
constexpr double kStep = 2;          ///< of a walk, game units
constexpr double kWalkRadius = 128;  ///< game units
constexpr double kNanoseconds = 1e9; ///< in a second
constexpr int kEntities = 500;       ///< whose vertices are lit
constexpr int kNormals = 200;        ///< vertices of each of these

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

/// One form of the grid, as an engine uses it.
struct GridForm {
    std::string_view name;
    shgrid_grid grid;
    int lights; ///< of an entity, at most

    /// Light of one entity.
    void Sample(const Vec3f &position, shgrid_lighting &lighting) const {
        const float at[3] = {position.x, position.y, position.z};
        if (grid.lights == nullptr) {
            shgrid_sample(&grid, at, &lighting.rest);
            lighting.count = 0;
            return;
        }
        shgrid_lights(&grid, at, nullptr, &lighting);
        shgrid_limit_lights(&lighting, lights);
    }
    /// Light of vertices, one by one or by one call.
    void Shade(const shgrid_lighting &lighting, const std::vector<std::array<float, 3>> &normals, bool atOnce,
               std::vector<std::array<float, 3>> &colors) const {
        if (atOnce)
            return shgrid_shade_many(&lighting, normals[0].data(), 3, normals.size(), colors[0].data(), 3);
        for (std::size_t i = 0; i < normals.size(); ++i)
            if (grid.lights == nullptr)
                shgrid_evaluate(&lighting.rest, normals[i].data(), colors[i].data());
            else
                shgrid_shade(&lighting, normals[i].data(), colors[i].data());
    }
};

/// What one form costs.
struct Cost {
    double seconds = std::numeric_limits<double>::max(); ///< CPU time of a measurement, the least
    double light = 0;                                    ///< mean, of 255
    double lights = 0;                                   ///< named ones, mean number of an entity
};

/// Light of entities at these positions.
void MeasureEntities(const GridForm &form, const std::vector<Vec3f> &positions, Cost &cost) {
    double sum = 0, lights = 0;
    const CpuTimer timer;
    for (const Vec3f &p : positions) {
        shgrid_lighting lighting;
        form.Sample(p, lighting);
        for (int i = 0; i < lighting.count; ++i)
            for (const float channel : lighting.direct[i].color)
                sum += double(channel) / 4;             // mean of the cosine over normals
        for (const auto &coefficient : lighting.rest.c) // all, so that none is optimized away
            for (const float channel : coefficient)
                sum += &coefficient == &lighting.rest.c[0] ? kSHC0 * double(channel) : 1e-12 * double(channel);
        lights += lighting.count;
    }
    cost.seconds = std::min(cost.seconds, timer.Seconds());
    cost.light = 255 * sum / (3 * double(positions.size()));
    cost.lights = lights / double(positions.size());
}

/// Light of vertices of entities.
void MeasureVertices(const GridForm &form, const std::vector<shgrid_lighting> &entities,
                     const std::vector<std::array<float, 3>> &normals, bool atOnce, Cost &cost) {
    double sum = 0, lights = 0;
    std::vector<std::array<float, 3>> colors(normals.size());
    const CpuTimer timer;
    for (const shgrid_lighting &entity : entities) {
        form.Shade(entity, normals, atOnce, colors);
        for (const auto &color : colors)
            sum += double(color[0] + color[1] + color[2]);
        lights += entity.count;
    }
    cost.seconds = std::min(cost.seconds, timer.Seconds());
    cost.light = 255 * sum / (3 * double(entities.size() * normals.size()));
    cost.lights = lights / double(entities.size());
}

/// A line for each form: nanoseconds of CPU time of each of `count` things, and times those of the first form.
void PrintCosts(std::string_view title, const std::vector<GridForm> &forms, std::size_t count, int repeats,
                const std::function<void(std::size_t form, Cost &)> &measure) {
    std::vector<Cost> costs(forms.size());
    for (int i = 0; i < repeats; ++i)
        for (std::size_t form = 0; form < forms.size(); ++form)
            measure(form, costs[form]);
    for (std::size_t form = 0; form < forms.size(); ++form) {
        const Cost &cost = costs[form];
        fmt::print("{:<26} {:<8} {:>8.1f} {:>8.2f} {:>12.2f} {:>8.1f}\n", title, forms[form].name,
                   cost.seconds * kNanoseconds / double(count), cost.seconds / costs[0].seconds, cost.light,
                   cost.lights);
    }
}

void PrintEntities(std::string_view title, const std::vector<GridForm> &forms, const std::vector<Vec3f> &positions,
                   int repeats) {
    PrintCosts(title, forms, positions.size(), repeats,
               [&](std::size_t form, Cost &cost) { MeasureEntities(forms[form], positions, cost); });
}

void PrintVertices(const std::vector<GridForm> &forms, const std::vector<Vec3f> &positions, std::uint64_t seed,
                   int repeats) {
    std::mt19937_64 random(seed);
    std::normal_distribution<float> normal;
    std::vector<std::array<float, 3>> normals;
    for (int i = 0; i < kNormals; ++i) {
        const float x = normal(random), y = normal(random), z = normal(random);
        const Vec3f n = Normalize(Vec3f{x, y, z});
        normals.push_back({n.x, n.y, n.z});
    }
    std::vector<std::vector<shgrid_lighting>> entities(forms.size());
    for (std::size_t form = 0; form < forms.size(); ++form)
        for (std::size_t i = 0; i < std::min(std::size_t(kEntities), positions.size()); ++i)
            forms[form].Sample(positions[i], entities[form].emplace_back());
    for (const bool atOnce : {false, true})
        PrintCosts(
            atOnce ? "a vertex of many" : "a vertex", forms, entities[0].size() * normals.size(), repeats,
            [&](std::size_t form, Cost &cost) { MeasureVertices(forms[form], entities[form], normals, atOnce, cost); });
}

/// The forms that the files have, each of the first file with it.
std::vector<GridForm> FindGrids(const std::vector<std::vector<std::byte>> &files, int lights) {
    std::vector<GridForm> forms;
    for (const auto &[form, name] :
         {std::pair(SHGRID_UNIFORM, "uniform"), std::pair(SHGRID_SPARSE, "sparse"), std::pair(SHGRID_NAMED, "named")})
        for (const std::vector<std::byte> &file : files) {
            GridForm found{name, {}, lights};
            const shgrid_result result = shgrid_load_form(file.data(), file.size(), form, &found.grid);
            if (result != SHGRID_OK && result != SHGRID_ABSENT)
                throw Error("{} SH grid: {}", name, shgrid_message(result));
            if (result == SHGRID_OK) {
                forms.push_back(found);
                break;
            }
        }
    if (forms.size() < 2)
        throw Error("expected two forms of the SH grid, found {}", forms.size());
    return forms;
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
    const int lights = int(number("--lights", SHGRID_DIRECT_LIGHTS, 0));
    const std::vector<std::string> paths = arguments.Rest();
    std::vector<std::vector<std::byte>> files;
    for (const std::string &path : paths)
        files.push_back(ReadFile(path));
    if (files.empty())
        throw Error("expected lit maps");
    const std::vector<GridForm> forms = FindGrids(files, lights);

    Log log(PrintWarnings);
    const Bsp bsp = ReadBspFile(paths.front(), {}, log);
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size()));
    for (const GridForm &form : forms)
        fmt::print("{}: {} points\n", form.name, form.grid.count);
    fmt::print("{:<26} {:<8} {:>8} {:>8} {:>12} {:>8}\n", "", "", "ns", "ratio", "mean of 255", "lights");
    const std::vector<Vec3f> scattered = bench::PlayerPositions(bsp, space, paths.front(), positions, seed);
    PrintEntities("an entity, all over", forms, scattered, repeats);
    PrintEntities("an entity, near one place", forms, Walks(bsp, space, paths.front(), positions, seed), repeats);
    PrintVertices(forms, scattered, seed, repeats);
    return 0;
}

} // namespace

} // namespace q3

int main(int count, char **words) {
    return q3::RunTool("sampling_cost", count, words, q3::Run);
}
