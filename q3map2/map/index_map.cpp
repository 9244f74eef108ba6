// GPL-2.0-or-later. Index maps: images with the terrain layer of each texel.
#include "q3map2/map/index_map.h"

#include "common/error.h"
#include "common/image/image.h"
#include "q3map2/bspfile/map_keys.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

std::vector<float> NumbersOf(std::string_view text, std::size_t count) {
    std::vector<float> numbers;
    while (numbers.size() < count) {
        const auto number = TakeNumber(text);
        if (!number)
            break;
        numbers.push_back(float(std::clamp(*number, -kMaxWorldCoord, kMaxWorldCoord)));
    }
    return numbers;
}

/// The layer of each texel: its palette index or, without a palette, red * layers / 256.
IndexImage ReadPicture(std::string_view name, int layers, const BspContext &context) {
    const auto bytes = context.vfs == nullptr ? std::nullopt : context.vfs->Read(name);
    if (!bytes)
        throw Error("{}: there is no such file", name);
    const std::string lower = LowerCase(name);
    if (lower.ends_with(".pcx"))
        return DecodePcx(*bytes, name);
    const bool isPng = lower.ends_with(".png");
    if (isPng)
        if (auto indexes = DecodePngIndexes(*bytes, name))
            return std::move(*indexes);
    const Image image = isPng ? DecodePng(*bytes, name) : DecodeTga(*bytes, name);
    IndexImage picture{image.width, image.height, {}};
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
        picture.indexes.push_back(std::uint8_t(image.rgba[i] * layers / 256));
    return picture;
}

/// The extent of the picture: keys of the entity, else the bounds of its primitives, moved by `shift`.
Boundsf ExtentOf(const MapEntity &entity, const Vec3f &shift) {
    Boundsf bounds;
    for (const Brush &brush : entity.brushes)
        bounds.Add(brush.bounds);
    for (const Patch &patch : entity.patches)
        for (const DrawVert &vert : patch.verts)
            bounds.Add(vert.xyz);
    if (!bounds.Empty())
        bounds = {bounds.mins + shift, bounds.maxs + shift};
    bounds.mins = keys::kIndexMapMin.Vector(entity.pairs).value_or(bounds.mins);
    bounds.maxs = keys::kIndexMapMax.Vector(entity.pairs).value_or(bounds.maxs);
    return bounds;
}

void WarnOfNoEffect(const MapEntity &entity, std::string_view text, const BspContext &context) {
    context.log.Warn("index map", "{}: its index map has no effect: {}", entity.MessagePrefix(), text);
}

} // namespace

int IndexMap::LayerAt(const Vec3f &p) const {
    const auto cell = [](float from, float size, int count) {
        const float at = size > 0 ? from / size * float(count) : 0;
        return std::clamp(int(std::clamp(at, 0.f, float(count))), 0, count - 1);
    };
    const Vec3f size = bounds.maxs - bounds.mins;
    const int column = cell(p.x - bounds.mins.x, size.x, width), row = cell(bounds.maxs.y - p.y, size.y, height);
    return pixels[std::size_t(row) * std::size_t(width) + std::size_t(column)];
}

float IndexMap::OffsetOf(int layer) const {
    return std::size_t(layer) < offsets.size() ? offsets[std::size_t(layer)] : 0;
}

std::shared_ptr<const IndexMap> ReadIndexMap(const MapEntity &entity, const Vec3f &shift, const BspContext &context) {
    const std::string_view name = keys::kIndexMap.Text(entity.pairs);
    if (name.empty() || (entity.brushes.empty() && entity.patches.empty()))
        return {};
    auto map = std::make_shared<IndexMap>();
    map->layers = IntegerFromText(keys::kLayers.Text(entity.pairs));
    map->shader = keys::kLayerShader.Text(entity.pairs);
    if (!keys::kLayers.info.range.Contains(map->layers))
        return WarnOfNoEffect(entity, "expected \"_layers\" of 1 to 255", context), nullptr;
    if (map->shader.empty())
        return WarnOfNoEffect(entity, "expected \"_shader\"", context), nullptr;
    IndexImage picture;
    try {
        picture = ReadPicture(name, map->layers, context);
    } catch (const Error &error) {
        return WarnOfNoEffect(entity, error.what(), context), nullptr;
    }
    if (picture.width < 2 || picture.height < 2)
        return WarnOfNoEffect(entity, "expected a picture of at least 2 x 2", context), nullptr;
    map->bounds = ExtentOf(entity, shift);
    map->width = picture.width, map->height = picture.height;
    map->offsets = NumbersOf(keys::kLayerOffsets.Text(entity.pairs), std::size_t(map->layers));
    map->pixels = std::move(picture.indexes);
    return map;
}

} // namespace q3
