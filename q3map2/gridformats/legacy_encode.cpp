// GPL-2.0-or-later. Points of the legacy grid as engines read them: lump 15, and lightgrid.raw.
#include "q3map2/gridformats/legacy_encode.h"

#include "q3map2/gridformats/ambient_directed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr double kFullByte = 255;

AmbientDirected Fit(const bspGridPointSH_t &light, const LegacyTarget &target, const GridTone &tone,
                    double ambientFactor) {
    // The least ambient light that the engine shows: that of byte 1. With a tone, the light that becomes byte 1 is not
    // known.
    const bool raises = target.ambientAdded > 0 && ambientFactor == 1 && tone.IsPlain();
    const double least = raises ? (target.ambientScale + target.ambientAdded) / kFullByte : 0;
    AmbientDirected fit =
        target.directedShare > 0 ? FitMeanAndDirected(light, target.directedShare) : FitAmbientDirected(light, least);
    fit.ambient *= ambientFactor;
    return fit;
}

bool IsWritten(PointUse use, const LegacyTarget &target) {
    return use == PointUse::Open || use == PointUse::Only || (use == PointUse::Solid && !target.skipsSolid);
}

/// Ambient light from which the engine's factor and addition make this. Byte scale.
Vec3d UndoAmbient(const Vec3d &ambient, const LegacyTarget &target) {
    const double added = target.ambientAdded;
    return Max(ambient - Vec3d{added, added, added}, Vec3d{}) / target.ambientScale;
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

std::vector<bspGridPoint_t> EncodeLegacyGrid(const LegacyPoints &points, const LegacyTarget &target,
                                             const GridTone &tone, double ambientFactor) {
    std::vector<bspGridPoint_t> grid(points.light.size(), bspGridPoint_t{});
    for (std::size_t i = 0; i < grid.size(); ++i) {
        if (!IsWritten(points.use[i], target))
            continue;
        const AmbientDirected fit = Fit(points.light[i], target, tone, ambientFactor);
        bspGridPoint_t &point = grid[i];
        point.ambient = ToBytes(UndoAmbient(tone.Limited(fit.ambient), target));
        point.directed = ToBytes(tone.Limited(fit.directed));
        if (point.ambient == std::array<std::uint8_t, 3>{})
            point.ambient = {1, 1, 1};
        point.latLong = EncodeDirection(fit.direction, target.angleSteps);
    }
    return grid;
}

std::vector<std::byte> EncodeRawGrid(const LegacyPoints &points, const LegacyTarget &target, const GridTone &tone,
                                     double ambientFactor, double scale) {
    constexpr double kMinAmbient = 1; // of 255: points outside the void are never black
    std::vector<std::byte> bytes;
    bytes.reserve(points.light.size() * 6 * sizeof(float));
    for (std::size_t i = 0; i < points.light.size(); ++i) {
        Vec3d ambient, directed;
        if (IsWritten(points.use[i], target)) {
            const AmbientDirected fit = Fit(points.light[i], target, tone, ambientFactor);
            ambient = UndoAmbient(tone.Unlimited(fit.ambient), target);
            directed = tone.Unlimited(fit.directed);
            if (ambient == Vec3d{})
                ambient = {kMinAmbient, kMinAmbient, kMinAmbient};
        }
        AppendFloats(ambient * scale, bytes);
        AppendFloats(directed * scale, bytes);
    }
    return bytes;
}

} // namespace q3
