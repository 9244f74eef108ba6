// GPL-2.0-or-later. Raw lightmaps made by hand, and the maps that they are stored in.
#include "tests/support/store_fixture.h"

#include <cmath>

namespace q3::test {

StoreTest::StoreTest() {
    SceneBuilder scene;
    scene.SetInterior({0, 0, 0}, {256, 256, 256}, {"textures/test/wall0"});
    for (int i = 1; i < 6; ++i)
        scene.SetWallShader(BoxFace(i), {"textures/test/wall" + std::to_string(i)});
    bsp = scene.Build();
}

void StoreTest::Script(std::string_view text) {
    script_ += text;
    folder.Write("scripts/test.shader", script_);
    folder.Write("scripts/shaderlist.txt", "test\n");
}

void StoreTest::MakeLightmaps(int width, int height, int super) {
    VirtualFileSystem vfs(log);
    vfs.Mount(folder.Root(), "pk3");
    library = std::make_unique<ShaderLibrary>(vfs, *FindGame("quake3"), ShaderOptions{}, log);
    table.resize(bsp.drawSurfaces.size());
    surfaces = {};
    surfaces.verts.resize(bsp.drawVerts.size());
    surfaces.vertex.styles.resize(bsp.drawSurfaces.size(), {0, kNoStyle, kNoStyle, kNoStyle});
    for (std::size_t i = 0; i < table.size(); ++i) {
        const bspDrawSurface_t &surface = bsp.drawSurfaces[i];
        table[i].shader = &library->Get(ShaderOf(i));
        RawLightmap raw;
        raw.surfaces = {int(i)};
        raw.width = width, raw.height = height, raw.super = super;
        raw.pageSize = lightmap.pageSize;
        raw.planar = true, raw.planeNormal = Vec3f(surface.lightmapVecs[2]);
        const std::size_t count = std::size_t(raw.SuperWidth()) * std::size_t(raw.SuperHeight());
        raw.luxelClusters.assign(count, 0);
        raw.normals.assign(count, raw.planeNormal);
        raw.positions.resize(count);
        for (int v = 0; v < surface.numVerts; ++v) {
            const Vec3f at(bsp.drawVerts[std::size_t(surface.firstVert + v)].xyz);
            // The first corner at the middle of luxel (0, 0), the third at that of the last.
            const int x = v == 1 || v == 2 ? width - 1 : 0, y = v >= 2 ? height - 1 : 0;
            surfaces.verts[std::size_t(surface.firstVert + v)] = {
                at, raw.planeNormal, {}, {float(super) * (float(x) + 0.5f), float(super) * (float(y) + 0.5f)}};
            raw.bounds.Add(at);
        }
        surfaces.lightmapOf.push_back(int(i));
        surfaces.lightmaps.push_back(std::move(raw));
    }
}

void StoreTest::Fill(RawLightmap &raw, const std::function<Vec3f(int x, int y)> &color, std::size_t slot) {
    raw.light[slot].resize(raw.luxelClusters.size());
    raw.filled[slot].assign(raw.luxelClusters.size(), 1);
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x)
            raw.light[slot][raw.SuperIndex(x, y)] = color(x, y);
}

void StoreTest::FillNoise(RawLightmap &raw, std::uint32_t seed, std::size_t slot) {
    std::mt19937 random(seed);
    const auto value = [&] { return float(random() % 2000) / 8; };
    Fill(
        raw,
        [&](int, int) {
            return Vec3f{value(), value(), value()};
        },
        slot);
}

void StoreTest::Unmap(RawLightmap &raw, int x, int y) {
    raw.luxelClusters[raw.SuperIndex(x, y)] = kUnmapped;
    raw.filled[0][raw.SuperIndex(x, y)] = 0;
}

void StoreTest::Use(int threads, const std::function<void(const SurfaceInputs &)> &body) {
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size()));
    const LightScene scene(bsp, table, options, 0);
    const JobPool jobs(threads);
    body({bsp, space, scene, table, options, lightmap, world, jobs, log});
}

void StoreTest::Average(const SurfacePass &pass, bool last, int threads) {
    Use(threads,
        [&](const SurfaceInputs &in) { AverageLuxels(in, pass, last ? PassData::Free : PassData::Keep, surfaces); });
}

StoredLightmaps StoreTest::Store(int threads, std::string_view mapName) {
    StoredLightmaps stored;
    Use(threads, [&](const SurfaceInputs &in) { stored = StoreLightmaps(in, surfaces, mapName, bsp); });
    return stored;
}

StoredLightmaps StoreTest::Finish(int threads, std::string_view mapName) {
    Average({}, true, threads);
    return Store(threads, mapName);
}

std::string_view StoreTest::ShaderOf(std::size_t surface) const {
    return FieldName(bsp.shaders[std::size_t(bsp.drawSurfaces[surface].shaderNum)].shader);
}

const LightmapPage &StoreTest::PageOf(const StoredLightmaps &stored, std::size_t surface) const {
    for (const LightmapPage &page : stored.pages)
        if (page.number == bsp.drawSurfaces[surface].lightmapNum[0])
            return page;
    throw std::out_of_range("surface without page");
}

std::size_t StoreTest::Texel(const LightmapPage &page, std::size_t surface, int x, int y) const {
    const auto &at = bsp.drawVerts[std::size_t(bsp.drawSurfaces[surface].firstVert)].lightmap[0];
    const int column = int(std::floor(at[0] * float(page.width))) + x;
    const int row = int(std::floor(at[1] * float(page.height))) + y;
    return 3 * (std::size_t(row) * std::size_t(page.width) + std::size_t(column));
}

std::array<int, 3> StoreTest::Shown(const StoredLightmaps &stored, std::size_t surface, int x, int y) const {
    const LightmapPage &page = PageOf(stored, surface);
    const std::size_t at = Texel(page, surface, x, y);
    return {page.colors.at(at), page.colors.at(at + 1), page.colors.at(at + 2)};
}

std::array<int, 3> StoreTest::Direction(const StoredLightmaps &stored, std::size_t surface, int x, int y) const {
    const LightmapPage &page = PageOf(stored, surface);
    const std::size_t at = Texel(page, surface, x, y);
    return {page.directions.at(at), page.directions.at(at + 1), page.directions.at(at + 2)};
}

} // namespace q3::test
