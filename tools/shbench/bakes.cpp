// GPL-2.0-or-later. Bakes of one grid with their cost, and the light that an engine shows from them.
#include "tools/shbench/bakes.h"

#include "common/error.h"
#include "libs/ambientcubes/ambient_cubes.h"
#include "q3map2/bspfile/bsp_tree.h"
#include "q3map2/convert/preview/grid_preview_light.h"
#include "q3map2/lightmap/light_world.h"

#include <bit>
#include <memory>

namespace q3::bench {

namespace {

struct SparseProto {
    const SparseGridSH g;
    std::vector<bspGridPointSH_t> v;
    using P = std::array<int, 3>;
    SparseProto(const SparseGridSH &grid) : g(grid), v(DequantizePoints(grid)) {}
    struct Leaf { bool ok; P o; int e; const SparseGridNode *n; int c; };
    Leaf Find(const P &p) const {
        std::size_t at = 0, st = 1;
        for (std::size_t a = 0; a < 3; ++a) {
            int r = p[a] >> g.levels;
            if (p[a] < 0 || r >= g.roots[a]) return {false, {}, 0, nullptr, 0};
            at += st * std::size_t(r); st *= std::size_t(g.roots[a]);
        }
        int l = g.levels;
        P o;
        for (std::size_t a = 0; a < 3; ++a) o[a] = p[a] >> l << l;
        for (;;) {
            const auto &n = g.nodes[at];
            --l;
            const int c = (p[0] >> l & 1) | (p[1] >> l & 1) << 1 | (p[2] >> l & 1) << 2;
            for (std::size_t a = 0; a < 3; ++a) if (c >> a & 1) o[a] += 1 << l;
            if (n.inner >> c & 1) { at = n.children + std::size_t(std::popcount(unsigned(n.inner & ((1 << c) - 1)))); continue; }
            return {true, o, 1 << l, &n, c};
        }
    }
    bool Corner(const P &p, bspGridPointSH_t &out) const {
        const Leaf f = Find(p);
        if (!f.ok) return false;
        if (f.o == p) {
            if (f.n->stored >> f.c & 1) { out = v[f.n->points + std::size_t(std::popcount(unsigned(f.n->stored & ((1 << f.c) - 1))))]; return true; }
            if (!(f.n->hanging >> f.c & 1)) return false;
            const int t = std::countr_zero(unsigned(p[0] | p[1] | p[2]));
            std::vector<P> ps{p};
            for (std::size_t a = 0; a < 3; ++a) if (p[a] >> t & 1) { const std::size_t n = ps.size(); for (std::size_t i = 0; i < n; ++i) { ps.push_back(ps[i]); ps[i][a] -= 1 << t; ps.back()[a] += 1 << t; } }
            out = {}; int n = 0;
            for (auto &q : ps) { bspGridPointSH_t x; if (!Corner(q, x)) { std::fprintf(stderr, "hanging on absent\n"); continue; } ++n; for (std::size_t k = 0; k < 9; ++k) for (std::size_t c = 0; c < 3; ++c) out.coeffs[k][c] += x.coeffs[k][c]; }
            for (std::size_t k = 0; k < 9; ++k) for (std::size_t c = 0; c < 3; ++c) out.coeffs[k][c] /= float(std::max(1, n));
            return n > 0;
        }
        return In(f, {float(p[0]), float(p[1]), float(p[2])}, out);
    }
    bool In(const Leaf &f, const Vec3f &at, bspGridPointSH_t &out) const {
        out = {}; float total = 0;
        for (int c = 0; c < 8; ++c) {
            float w = 1;
            P q = f.o;
            for (std::size_t a = 0; a < 3; ++a) { const float t = (at[a] - float(f.o[a])) / float(f.e); w *= c >> a & 1 ? t : 1 - t; if (c >> a & 1) q[a] += f.e; }
            bspGridPointSH_t x;
            if (w == 0 || !Corner(q, x)) continue;
            total += w;
            for (std::size_t k = 0; k < 9; ++k) for (std::size_t ch = 0; ch < 3; ++ch) out.coeffs[k][ch] += w * x.coeffs[k][ch];
        }
        for (std::size_t k = 0; k < 9 && total > 0; ++k) for (std::size_t ch = 0; ch < 3; ++ch) out.coeffs[k][ch] /= total;
        return total > 0;
    }
    bspGridPointSH_t Sample(const Vec3f &w) const {
        Vec3f f; P p;
        for (std::size_t a = 0; a < 3; ++a) { f[a] = (w[a] - g.mins[a]) / g.cell[a]; p[a] = int(std::floor(f[a])); }
        bspGridPointSH_t out{};
        const Leaf l = Find(p);
        if (l.ok) In(l, f, out);
        return out;
    }
};

/// Heading of the pass in the log.
std::string_view PassOf(BakedFormat format, const LightOptions &options) {
    switch (format) {
    case BakedFormat::LegacyGrid:
        return "--- TraceGrid ---";
    case BakedFormat::AmbientCubes:
        if (!options.cubesFromSH)
            return "--- TraceAmbientCubes ---";
        [[fallthrough]];
    default:
        return "--- TraceGridSH ---";
    }
}

/// Size of the lump.
std::int64_t LumpBytes(BakedFormat format, const Bsp &bsp) {
    if (format == BakedFormat::LegacyGrid)
        return std::int64_t(bsp.gridPoints.size() * sizeof(bspGridPoint_t));
    if (format == BakedFormat::GridSH && bsp.sparseGridSH)
        return std::int64_t(EncodeSparseGrid(*bsp.sparseGridSH).size());
    if (format == BakedFormat::GridSH)
        return std::int64_t(sizeof(bspGridSHHeader_t) + bsp.gridSH->points.size() * sizeof(bspGridPointSH_t));
    if (!bsp.ambientCubes)
        return 0;
    return std::int64_t(sizeof(bspCubeHeader_t) + bsp.ambientCubes->leafs.size() * sizeof(bspCubeLeaf_t) +
                        bsp.ambientCubes->samples.size() * sizeof(bspCubeSample_t));
}

} // namespace

Baked Bake(const BenchMap &map, LightOptions options, BakedFormat format, ShaderLibrary &library, const JobPool &jobs) {
    options.ambientCubes = format == BakedFormat::AmbientCubes;
    options.sh = (format == BakedFormat::GridSH && !options.shAdaptive) || (options.ambientCubes && options.cubesFromSH);
    options.noGrid = format != BakedFormat::LegacyGrid;
    Baked baked;
    baked.bsp = map.bsp;
    // The set-up ends when the heading of the pass is logged.
    double passStart = 0;
    const std::string_view pass = PassOf(format, options);
    Log log([&](LogLevel, std::string_view text) {
        if (text.find(pass) != std::string_view::npos)
            passStart = CpuSeconds();
    });
    LightmapOptions onlyGrid;
    onlyGrid.onlyGrid = true;
    const double start = CpuSeconds();
    const LightResult result = LightWorld(baked.bsp, map.inputs, options, onlyGrid, library, jobs, log);
    const double end = CpuSeconds();
    const GridStats &stats = format == BakedFormat::GridSH       ? result.gridSH
                             : format == BakedFormat::LegacyGrid ? result.grid
                                                                 : result.cubes;
    baked.cost.cpuSeconds = end - start;
    baked.cost.setUpSeconds = (passStart > 0 ? passStart : end) - start;
    baked.cost.rays = stats.counts.rays + (options.ambientCubes ? result.gridSH.counts.rays : 0);
    baked.cost.points = stats.points;
    baked.cost.litPoints = stats.open + stats.moved;
    baked.cost.bytes = LumpBytes(format, baked.bsp);
    if (options.ambientCubes && baked.bsp.ambientCubes) {
        baked.cost.litPoints = baked.cost.points;
        baked.cost.points = std::int64_t(baked.bsp.ambientCubes->samples.size());
    }
    return baked;
}

namespace {

ShownLight ShownBySparse(const Bsp &bsp) {
    auto s = std::make_shared<SparseProto>(*bsp.sparseGridSH);
        return [s](const Vec3f &position) {
            ShSample sample;
            const bspGridPointSH_t v = s->Sample(position);
            for (std::size_t k = 0; k < 9; ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    sample.coeffs.c[k][c] = v.coeffs[k][c];
            NormalLight light;
            for (std::size_t i = 0; i < kNormals; ++i)
                light[i] = LightOn(sample, Vec3f(Normals()[i]));
            return light;
        };
}
ShownLight ShownBySH(const Bsp &bsp) {
    if (bsp.sparseGridSH)
        return ShownBySparse(bsp);
    return [view = ShPreview(bsp)](const Vec3f &position) {
        ShSample sample = view.At(position);
        sample.tone.reset(); // compared with exact light, which is linear
        NormalLight light;
        for (std::size_t i = 0; i < kNormals; ++i)
            light[i] = LightOn(sample, Vec3f(Normals()[i]));
        return light;
    };
}

ShownLight ShownByLegacy(const Bsp &bsp) {
    const auto view = LegacyPreview::Make(bsp);
    if (!view)
        throw Error("the map has no legacy light grid of the size that engines expect");
    return [view = *view](const Vec3f &position) {
        const LegacySample sample = view.At(position);
        NormalLight light;
        for (std::size_t i = 0; i < kNormals; ++i)
            light[i] = LightOn(sample, Vec3f(Normals()[i]));
        return light;
    };
}

/// Through the reader for engines, from the bytes of the file.
ShownLight ShownByCubes(const Bsp &bsp) {
    Bsp alone = bsp;
    alone.gridSH.reset();
    const auto file = std::make_shared<const std::vector<std::byte>>(WriteBsp(alone, {}));
    ambient_cubes cubes;
    if (const auto result = ambient_cubes_load(file->data(), file->size(), &cubes); result != AMBIENT_CUBES_OK)
        throw Error("ambient cubes: {}", ambient_cubes_message(result));
    return [file, cubes, &bsp](const Vec3f &position) {
        const float at[3] = {position.x, position.y, position.z};
        ambient_cube cube;
        ambient_cubes_blend(&cubes, std::uint32_t(LeafAt(bsp, position)), at, &cube);
        NormalLight light;
        for (std::size_t i = 0; i < kNormals; ++i) {
            const Vec3f n(Normals()[i]);
            const float normal[3] = {n.x, n.y, n.z};
            float rgb[3];
            ambient_cube_evaluate(&cube, normal, rgb);
            light[i] = {rgb[0], rgb[1], rgb[2]};
        }
        return light;
    };
}

} // namespace

ShownLight ShownBy(BakedFormat format, const Bsp &bsp) {
    return format == BakedFormat::GridSH       ? ShownBySH(bsp)
           : format == BakedFormat::LegacyGrid ? ShownByLegacy(bsp)
                                               : ShownByCubes(bsp);
}

} // namespace q3::bench
