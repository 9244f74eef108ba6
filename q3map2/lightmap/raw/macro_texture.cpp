// GPL-2.0-or-later. Macro textures: images over the whole world that tint lightmaps and vertex light.
#include "q3map2/lightmap/raw/macro_texture.h"

#include "common/error.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace q3 {

namespace {

/// Index of the texel at a fraction of a side, 0 to 1.
int TexelAt(double fraction, int count) {
    return int(std::clamp(std::floor(fraction * count), 0.0, double(count - 1)));
}

Boundsf WorldBox(const SurfaceInputs &in) {
    const bspModel_t &model = in.bsp.models.front();
    const Boundsf box{in.world.macroMins.value_or(Vec3f(model.mins)), in.world.macroMaxs.value_or(Vec3f(model.maxs))};
    if (!(box.maxs.x > box.mins.x && box.maxs.y > box.mins.y))
        throw Error("macro texture: the world is from {:g} {:g} to {:g} {:g}, expected world_mins below world_maxs",
                    box.mins.x, box.mins.y, box.maxs.x, box.maxs.y);
    return box;
}

/// The texture of a surface; nothing if it has none.
std::optional<MacroTexture> TextureOf(const SurfaceInputs &in, std::size_t surface) {
    const Image *image = in.table[surface].macroImage.get();
    return image ? std::optional<MacroTexture>(std::in_place, *image, WorldBox(in)) : std::nullopt;
}

void Tint(const std::vector<Vec3f> &tint, const std::vector<Vec3f> &used, std::vector<Vec3f> &values) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (used[i].x >= 0)
            values[i] = values[i] * tint[i];
}

} // namespace

Vec3f MacroTexture::At(const Vec3f &position) const {
    const Vec3d p(position), mins(world_.mins), size = Vec3d(world_.maxs) - mins;
    const int column = TexelAt((p.x - mins.x) / size.x, image_.width);
    const int row = image_.height - 1 - TexelAt((p.y - mins.y) / size.y, image_.height);
    const auto texel = image_.Texel(column, row);
    const auto channel = [&](std::size_t i) { return LinearFromSrgb(float(texel[i]) / 255); };
    return Vec3f{channel(0), channel(1), channel(2)} * (float(texel[3]) / 255);
}

void FindTints(const SurfaceInputs &in, SurfaceLight &surfaces) {
    if (std::none_of(in.table.begin(), in.table.end(), [](const SurfaceEntry &entry) { return entry.macroImage; }))
        return;
    WorldBox(in); // reports a bad one before workers start
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t i, int) {
        RawLightmap &raw = surfaces.lightmaps[std::size_t(i)];
        // Surfaces of one lightmap have one texture.
        if (const auto texture = TextureOf(in, std::size_t(raw.surfaces.front())))
            raw.tint =
                LuxelMeans(raw, Vec3f{1, 1, 1}, [&](std::size_t luxel) { return texture->At(raw.positions[luxel]); });
    });
}

void ApplyTints(const SurfaceInputs &in, SurfaceLight &surfaces) {
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t i, int) {
        RawLightmap &raw = surfaces.lightmaps[std::size_t(i)];
        for (std::size_t style = 0; style < kStyles && !raw.tint.empty(); ++style) {
            for (std::vector<Vec3f> &channel : raw.resultChannels[style])
                Tint(raw.tint, raw.result[style], channel);
            Tint(raw.tint, raw.result[style], raw.result[style]);
        }
    });
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = in.bsp.drawSurfaces[i];
        const auto texture = TextureOf(in, i);
        for (auto v = std::size_t(surface.firstVert); texture && v < std::size_t(surface.firstVert + surface.numVerts);
             ++v)
            for (std::vector<Vec3f> &sum : surfaces.vertex.sum)
                if (!sum.empty())
                    sum[v] = sum[v] * texture->At(surfaces.verts[v].xyz);
    }
}

} // namespace q3
