// GPL-2.0-or-later. Points of the legacy grid as engines read them: lump 15, and lightgrid.raw.
#include "q3map2/gridformats/legacy_encode.h"

#include "q3map2/gridformats/ambient_directed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr double kFullByte = 255;

AmbientDirected Fit(const bspGridPointSH_t &light, const LegacyReader &reader, const GridTone &tone,
                    double ambientFactor) {
    // A point that is not black has at least a byte. Under a tone the light that such bytes stand for is not looked
    // for.
    const bool raises = reader.ambientAdded > 0 && ambientFactor == 1 && tone.IsPlain();
    const double least = raises ? (reader.ambientScale + reader.ambientAdded) / kFullByte : 0;
    AmbientDirected fit =
        reader.directedShare > 0 ? FitMeanAndDirected(light, reader.directedShare) : FitAmbientDirected(light, least);
    fit.ambient *= ambientFactor;
    return fit;
}

bool IsWritten(PointUse use, const LegacyReader &reader) {
    return use == PointUse::Open || use == PointUse::Only || (use == PointUse::Solid && !reader.skipsSolid);
}

/// Ambient light on the byte scale, before the engine's factor and addition.
Vec3d BeforeReader(const Vec3d &ambient, const LegacyReader &reader) {
    const double added = reader.ambientAdded;
    return Max(ambient - Vec3d{added, added, added}, Vec3d{}) / reader.ambientScale;
}

/// Rounded; what is brighter than 255 keeps its hue.
std::array<std::uint8_t, 3> ToBytes(Vec3d color) {
    if (const double most = MaxComponent(color); most > kFullByte)
        color *= kFullByte / most;
    std::array<std::uint8_t, 3> bytes;
    for (std::size_t i = 0; i < 3; ++i)
        bytes[i] = std::uint8_t(std::lround(color[i]));
    return bytes;
}

void AppendFloats(const Vec3d &color, std::vector<std::byte> &bytes) {
    for (const float value : Vec3f(color).Array()) {
        const auto *from = reinterpret_cast<const std::byte *>(&value);
        bytes.insert(bytes.end(), from, from + sizeof value);
    }
}

} // namespace

std::array<std::uint8_t, 2> EncodeDirection(const Vec3d &direction, int angleSteps) {
    const double steps = angleSteps / (2 * std::numbers::pi);
    const int fromZ = int(std::lround(std::acos(std::clamp(direction.z, -1.0, 1.0)) * steps));
    const bool isPole = direction.x == 0 && direction.y == 0;
    const int aroundZ = isPole ? 0 : int(std::lround(std::atan2(direction.y, direction.x) * steps));
    return {std::uint8_t(fromZ), std::uint8_t((aroundZ + angleSteps) % angleSteps)};
}

std::vector<bspGridPoint_t> EncodeLegacyGrid(const LegacyPoints &points, const LegacyReader &reader,
                                             const GridTone &tone, double ambientFactor) {
    std::vector<bspGridPoint_t> grid(points.light.size(), bspGridPoint_t{});
    for (std::size_t i = 0; i < grid.size(); ++i) {
        if (!IsWritten(points.use[i], reader))
            continue;
        const AmbientDirected fit = Fit(points.light[i], reader, tone, ambientFactor);
        bspGridPoint_t &point = grid[i];
        point.ambient = ToBytes(BeforeReader(tone.Limited(fit.ambient), reader));
        point.directed = ToBytes(tone.Limited(fit.directed));
        if (point.ambient == std::array<std::uint8_t, 3>{})
            point.ambient = {1, 1, 1};
        point.latLong = EncodeDirection(fit.direction, reader.angleSteps);
    }
    return grid;
}

std::vector<std::byte> EncodeRawGrid(const LegacyPoints &points, const LegacyReader &reader, const GridTone &tone,
                                     double ambientFactor, double scale) {
    constexpr double kLeastAmbient = 1; // of 255: points outside the void are never black
    std::vector<std::byte> bytes;
    bytes.reserve(points.light.size() * 6 * sizeof(float));
    for (std::size_t i = 0; i < points.light.size(); ++i) {
        Vec3d ambient, directed;
        if (IsWritten(points.use[i], reader)) {
            const AmbientDirected fit = Fit(points.light[i], reader, tone, ambientFactor);
            ambient = BeforeReader(tone.Unlimited(fit.ambient), reader);
            directed = tone.Unlimited(fit.directed);
            if (ambient == Vec3d{})
                ambient = {kLeastAmbient, kLeastAmbient, kLeastAmbient};
        }
        AppendFloats(ambient * scale, bytes);
        AppendFloats(directed * scale, bytes);
    }
    return bytes;
}

} // namespace q3
