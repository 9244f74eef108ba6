// GPL-2.0-or-later. The legacy light grid as engines load and blend it.
#include "tests/support/grid_readers/legacy_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

namespace q3 {

namespace {

constexpr std::size_t kPointBytes = 8; ///< ambient and directed color, two angles
/// A point of lightgrid.raw: ambient color, then directed color, three floats each.
constexpr std::size_t kRawBytes = 24, kRawDirected = 12;

/// The unit vector of two angles, in steps of 360 / `steps` degrees: from +z, and around it from +x.
Vec3f DecodeAngles(float polar, float around, int steps) {
    const float unit = 2 * std::numbers::pi_v<float> / float(steps);
    return {std::cos(around * unit) * std::sin(polar * unit), std::sin(around * unit) * std::sin(polar * unit),
            std::cos(polar * unit)};
}

/// Three floats of lightgrid.raw.
Vec3f RawColor(std::span<const std::byte> raw, std::size_t at) {
    float rgb[3];
    std::memcpy(rgb, raw.data() + at, sizeof rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

/// A color as 16-bit textures hold it: scaled down where a channel passes 1, then rounded.
Vec3f Stored16(Vec3f color, float scale) {
    color *= scale;
    if (const float most = MaxComponent(color); most > 1)
        color = color / most;
    const auto stored = [](float c) { return std::round(std::max(c, 0.0f) * 65535) / 65535; };
    return {stored(color.x), stored(color.y), stored(color.z)};
}

} // namespace

LegacyPlaces::LegacyPlaces(const Vec3f &worldMins, const Vec3f &worldMaxs, const Vec3f &gridSize) : cell(gridSize) {
    for (std::size_t i = 0; i < 3; ++i) {
        origin[i] = cell[i] * std::ceil(worldMins[i] / cell[i]);
        const float last = cell[i] * std::floor(worldMaxs[i] / cell[i]);
        count[i] = int((last - origin[i]) / cell[i] + 1);
    }
}

std::optional<LegacyGridReader> LegacyGridReader::Load(std::span<const std::byte> lump, const LegacyPlaces &places,
                                                       const LegacyEngine &engine) {
    if (lump.size() != kPointBytes * places.Points())
        return std::nullopt;
    LegacyGridReader reader(places, engine);
    for (std::size_t at = 0; at < lump.size(); at += kPointBytes) {
        const auto byte = [&](std::size_t i) { return float(std::to_integer<int>(lump[at + i])); };
        Point point{{byte(0), byte(1), byte(2)}, {byte(3), byte(4), byte(5)}, {}};
        point.direction = DecodeAngles(byte(6), byte(7), engine.angleSteps);
        point.inWall =
            engine.skipsBlack && point.ambient == Vec3f{} && !(engine.keepsDirected && point.directed != Vec3f{});
        reader.points_.push_back(point);
    }
    return reader;
}

std::optional<LegacyGridReader> LegacyGridReader::LoadRaw(std::span<const std::byte> lump,
                                                          std::span<const std::byte> raw, const LegacyPlaces &places,
                                                          const LegacyEngine &engine, float shift) {
    auto reader = Load(lump, places, engine);
    if (!reader || raw.size() != kRawBytes * places.Points())
        return std::nullopt;
    for (std::size_t i = 0; i < reader->points_.size(); ++i) {
        Point &point = reader->points_[i];
        const Vec3f ambient = Stored16(RawColor(raw, kRawBytes * i), shift / 255);
        const Vec3f directed = Stored16(RawColor(raw, kRawBytes * i + kRawDirected), shift / 255);
        point.inWall = engine.skipsBlack && ambient == Vec3f{} && directed == Vec3f{};
        point.ambient = ambient * (255 / shift);
        point.directed = directed * (255 / shift);
    }
    return reader;
}

std::optional<LegacyGridReader> LegacyGridReader::LoadRend2(std::span<const std::byte> lump,
                                                            std::span<const std::byte> raw, const LegacyPlaces &places,
                                                            const LegacyEngine &engine) {
    auto reader = Load(lump, places, engine);
    if (!reader || raw.size() != kRawBytes * places.Points())
        return std::nullopt;
    for (std::size_t i = 0; i < reader->points_.size(); ++i) {
        constexpr float kScale = 255 / std::numbers::pi_v<float>;
        reader->points_[i].ambient = RawColor(raw, kRawBytes * i) * kScale;
        reader->points_[i].directed = RawColor(raw, kRawBytes * i + kRawDirected) * kScale;
    }
    return reader;
}

LegacyLight LegacyGridReader::At(const Vec3f &position) const {
    int low[3];
    float fraction[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float at = (position[axis] - places_.origin[axis]) / places_.cell[axis], floor = std::floor(at);
        fraction[axis] = at - floor;
        low[axis] = std::clamp(int(floor), 0, places_.count[axis] - 1);
    }
    LegacyLight sum;
    float total = 0;
    for (int corner = 0; corner < 8; ++corner) {
        float weight = 1;
        std::size_t index = 0, stride = 1;
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int upper = corner >> axis & 1;
            inside = inside && low[axis] + upper < places_.count[axis];
            weight *= upper != 0 ? fraction[axis] : 1 - fraction[axis];
            index += stride * std::size_t(low[axis] + upper);
            stride *= std::size_t(places_.count[axis]);
        }
        if (!inside || points_[index].inWall)
            continue;
        total += weight;
        sum.ambient += points_[index].ambient * weight;
        sum.directed += points_[index].directed * weight;
        sum.direction += points_[index].direction * weight;
    }
    constexpr float kWholeWeight = 0.99f; // as in engines: from here on the sum is taken as complete
    if (total > 0 && total < kWholeWeight) {
        sum.ambient = sum.ambient / total;
        sum.directed = sum.directed / total;
    }
    const float added = engine_.ambientAdded;
    sum.ambient = sum.ambient * engine_.ambientScale + Vec3f{added, added, added};
    sum.directed *= engine_.directedScale;
    sum.direction = Normalize(sum.direction);
    return sum;
}

} // namespace q3
