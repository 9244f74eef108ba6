// GPL-2.0-or-later. Lighting of small scenes in process, and the definition of the SH grid to compare with.
#include "tests/support/light_fixture.h"

#include "tests/support/compiled_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace q3::test {

namespace {

constexpr double kPi = std::numbers::pi;

} // namespace

std::array<double, 9> BasisAt(const Vec3d &d) {
    const double c1 = std::sqrt(3 / (4 * kPi)), c2 = std::sqrt(15 / (4 * kPi));
    const double c3 = std::sqrt(5 / (16 * kPi)), c4 = std::sqrt(15 / (16 * kPi));
    return {std::sqrt(1 / (4 * kPi)),
            c1 * d.y,
            c1 * d.z,
            c1 * d.x,
            c2 * d.x * d.y,
            c2 * d.y * d.z,
            c3 * (3 * d.z * d.z - 1),
            c2 * d.x * d.z,
            c4 * (d.x * d.x - d.y * d.y)};
}

double Lobe(std::size_t k) {
    return k == 0 ? kPi : k < 4 ? 2 * kPi / 3 : kPi / 4;
}

Coefficients operator+(const Coefficients &a, const Coefficients &b) {
    Coefficients sum = a;
    for (std::size_t k = 0; k < 9; k++)
        sum[k] += b[k];
    return sum;
}

Coefficients operator*(const Coefficients &a, const Vec3d &s) {
    Coefficients product = a;
    for (Vec3d &c : product)
        c = c * s;
    return product;
}

Coefficients FromDirection(const Vec3d &d, const Vec3d &color) {
    Coefficients c{};
    const auto basis = BasisAt(d);
    for (std::size_t k = 0; k < 9; k++)
        c[k] = color * (Lobe(k) * basis[k]);
    return c;
}

Coefficients FromEverywhere(const Vec3d &color) {
    return {color * std::sqrt(4 * kPi)};
}

Coefficients FromPoint(const Vec3d &p, const Vec3d &light, double intensity, const Vec3d &color) {
    const Vec3d way = light - p;
    const double distance = Length(way), used = std::max(16.0, distance);
    // Photons 7500 per unit of intensity over the squared distance, on the scale 1 = byte 255.
    const Vec3d arriving = color * (7500 * intensity / (used * used) / 255);
    if (distance > 0)
        return FromDirection(way / distance, arriving);
    return {arriving * (kPi * std::sqrt(1 / (4 * kPi)))};
}

Coefficients FromRectangle(const Vec3d &p, const Vec3d &corner, const Vec3d &u, const Vec3d &v, const Vec3d &normal,
                           double add, const Vec3d &color) {
    Coefficients c{};
    if (Dot(p - corner, normal) <= 0)
        return c;
    // Pieces that look large are halved across their longer side, so that five nodes a side are exact enough.
    const double width = Length(u), height = Length(v);
    if (2 * std::max(width, height) > Length(corner + (u + v) * 0.5 - p)) {
        const bool halveU = width >= height;
        const Vec3d half = (halveU ? u : v) * 0.5;
        for (const Vec3d &at : {corner, corner + half})
            c = c + FromRectangle(p, at, halveU ? half : u, halveU ? v : half, normal, add, color);
        return c;
    }
    // Gauss-Legendre quadrature with five nodes on 0..1.
    static constexpr double kNodes[5] = {0.046910077030668, 0.2307653449471584, 0.5, 0.7692346550528416,
                                         0.953089922969332};
    static constexpr double kWeights[5] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                           0.2393143352496832, 0.1184634425280945};
    const double area = Length(Cross(u, v));
    for (std::size_t i = 0; i < 25; i++) {
        const Vec3d way = corner + u * kNodes[i % 5] + v * kNodes[i / 5] - p;
        const double distance = Length(way), share = kWeights[i % 5] * kWeights[i / 5];
        const double solidAngle = -Dot(way, normal) * area * share / (distance * distance * distance);
        c = c + FromDirection(way / distance, color * (add / 255 / kPi * solidAngle));
    }
    return c;
}

Vec3d Evaluate(const Coefficients &c, const Vec3d &normal) {
    const auto basis = BasisAt(normal);
    Vec3d sum;
    for (std::size_t k = 0; k < 9; k++)
        sum += c[k] * basis[k];
    return sum;
}

double Difference(const Coefficients &a, const Coefficients &b) {
    return Largest(a + b * Vec3d{-1, -1, -1});
}

double Largest(const Coefficients &c) {
    double largest = 0;
    for (const Vec3d &v : c)
        for (std::size_t channel = 0; channel < 3; channel++)
            largest = std::max(largest, std::abs(v[channel]));
    return largest;
}

bool AllFinite(const Coefficients &c) {
    return std::all_of(c.begin(), c.end(), [](const Vec3d &v) { return IsFinite(v); });
}

bool SegmentMeets(const Vec3d &a, const Vec3d &b, const Boundsf &box, double margin) {
    double enter = 0, leave = 1;
    for (std::size_t axis = 0; axis < 3; axis++) {
        const double mins = double(box.mins[axis]) - margin, maxs = double(box.maxs[axis]) + margin;
        const double way = b[axis] - a[axis];
        if (way == 0) {
            if (a[axis] <= mins || a[axis] >= maxs)
                return false;
            continue;
        }
        const double t0 = (mins - a[axis]) / way, t1 = (maxs - a[axis]) / way;
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    return enter < leave;
}

GridView::GridView(const Bsp &bsp) : grid_(bsp.gridSH.value()) {}

Vec3d GridView::Position(std::size_t index) const {
    const auto &h = grid_.header;
    const auto width = std::size_t(h.gridBounds[0]), height = std::size_t(h.gridBounds[1]);
    const std::size_t at[3] = {index % width, index / width % height, index / width / height};
    Vec3d p;
    for (std::size_t axis = 0; axis < 3; axis++)
        p[axis] = double(h.gridMins[axis]) + double(at[axis]) * double(h.gridSize[axis]);
    return p;
}

Coefficients GridView::At(std::size_t index) const {
    Coefficients c;
    for (std::size_t k = 0; k < 9; k++)
        c[k] = Vec3d(grid_.points[index].coeffs[k]);
    return c;
}

Coefficients GridView::Sample(const Vec3d &p) const {
    const auto &h = grid_.header;
    std::array<int, 3> low{};
    Vec3d fraction;
    for (std::size_t axis = 0; axis < 3; axis++) {
        const double at = (p[axis] - double(h.gridMins[axis])) / double(h.gridSize[axis]);
        EXPECT_TRUE(at >= 0 && at <= h.gridBounds[axis] - 1) << "axis " << axis << ": outside the grid";
        low[axis] = std::clamp(int(std::floor(at)), 0, std::max(0, h.gridBounds[axis] - 2));
        fraction[axis] = at - low[axis];
    }
    Coefficients sum{};
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1;
        std::size_t index = 0, stride = 1;
        for (std::size_t axis = 0; axis < 3; axis++) {
            const int upper = corner >> axis & 1;
            weight *= upper ? fraction[axis] : 1 - fraction[axis];
            index += stride * std::size_t(std::min(low[axis] + upper, h.gridBounds[axis] - 1));
            stride *= std::size_t(h.gridBounds[axis]);
        }
        sum = sum + At(index) * Vec3d{weight, weight, weight};
    }
    return sum;
}

void LightTest::Script(std::string_view text) {
    script_ += text;
    folder.Write("scripts/test.shader", script_);
    folder.Write("scripts/shaderlist.txt", "test\n");
}

Bsp LightTest::Lit(Bsp bsp, std::string_view options, int threads) {
    printed.clear();
    Log log([this](LogLevel, std::string_view text) { printed += text; }, true);
    std::istringstream text("-sh " + std::string(options));
    Arguments arguments({std::istream_iterator<std::string>(text), {}});
    const Game &game = *FindGame("quake3");
    const LightOptions parsed = ParseLightOptions(arguments, game, log);
    LightmapOptions lightmap = ParseLightmapOptions(arguments, parsed, game, log);
    lightmap.onlyGrid = lightmap.onlyGrid || !surfaces;
    VirtualFileSystem vfs(log);
    vfs.Mount(folder.Root(), "pk3");
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    ShaderLibrary library(vfs, game, parsed.shader, log);
    LightInputs inputs;
    inputs.name = "test";
    inputs.texLights = texLights;
    result = LightWorld(bsp, inputs, parsed, lightmap, library, JobPool(threads), log);
    return bsp;
}

Bsp LightTest::Lit(const SceneBuilder &scene, std::string_view options, int threads) {
    KeptLog quiet;
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(folder.Root(), "pk3");
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    return Lit(CompiledScene(scene, vfs), options, threads);
}

void LightTest::ExpectPoints(const GridView &grid, double tolerance, int atLeast,
                             const std::function<bool(const Vec3d &, Coefficients &)> &expected) {
    int checked = 0;
    double worst = -1;
    std::size_t where = 0;
    for (std::size_t i = 0; i < grid.Count(); i++) {
        Coefficients wanted{};
        if (!expected(grid.Position(i), wanted))
            continue;
        checked++;
        const double off = Difference(grid.At(i), wanted) / std::max(Largest(wanted), 1.0 / 255);
        if (!(off <= worst))
            worst = off, where = i;
    }
    EXPECT_GE(checked, atLeast);
    const Vec3d p = grid.Position(where);
    EXPECT_LE(worst, tolerance) << "at " << p.x << ' ' << p.y << ' ' << p.z << " of " << checked << " points";
}

SceneBuilder Room(const Vec3f &mins, const Vec3f &maxs) {
    SceneBuilder scene;
    scene.SetInterior(mins, maxs, TestShader("textures/test/wall"));
    return scene;
}

SceneShader TestShader(std::string_view name) {
    return {std::string(name)};
}

Entity MakeEntity(std::string_view className, std::initializer_list<std::pair<std::string, std::string>> keys) {
    Entity entity{{{"classname", std::string(className)}}};
    entity.pairs.insert(entity.pairs.end(), keys);
    return entity;
}

bool Inside(const Vec3d &p, const Boundsf &box, double margin) {
    for (std::size_t axis = 0; axis < 3; axis++)
        if (p[axis] < double(box.mins[axis]) + margin || p[axis] > double(box.maxs[axis]) - margin)
            return false;
    return true;
}

std::vector<Vec3d> Normals() {
    std::vector<Vec3d> normals;
    constexpr int kCenter = 13; // of the 3 x 3 x 3 cells whose directions these are
    for (int i = 0; i < 27; i++)
        if (i != kCenter)
            normals.push_back(Normalize(Vec3d{double(i % 3 - 1), double(i / 3 % 3 - 1), double(i / 9 - 1)}));
    return normals;
}

} // namespace q3::test
