// GPL-2.0-or-later. The legacy light grid as engines load and blend it.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// How an engine treats the grid.
struct LegacyEngine {
    float ambientScale = 1, directedScale = 1; ///< r_ambientScale, r_directedScale
    float ambientAdded = 0;                    ///< bytes of the lump
    int angleSteps = 256;                      ///< of angle bytes, for 360 degrees
    bool skipsBlack = false;                   ///< leaves points without ambient light out: they are in walls
    bool keepsDirected = false;                ///< of them, keeps those with directed light
};
/// ioquake3 with default settings.
inline constexpr LegacyEngine kIoquake3Engine{.ambientScale = 0.6f, .ambientAdded = 8, .skipsBlack = true};
/// No factors, all points count.
inline constexpr LegacyEngine kPlainEngine{.angleSteps = 255};

/// Where an engine expects the points, from the bounds of the world and gridsize.
struct LegacyPlaces {
    Vec3f origin, cell;         ///< first point; distance of points on each axis, game units
    std::array<int, 3> count{}; ///< points on each axis
    LegacyPlaces(const Vec3f &worldMins, const Vec3f &worldMaxs, const Vec3f &gridSize);
    std::size_t Points() const { return std::size_t(count[0]) * std::size_t(count[1]) * std::size_t(count[2]); }
};

/// What an engine computes for one model.
struct LegacyLight {
    Vec3f ambient, directed; ///< byte scale
    Vec3f direction;         ///< to the directed light, unit
    /// Light on a surface with that normal.
    Vec3f On(const Vec3f &normal) const { return ambient + directed * std::max(0.0f, Dot(normal, direction)); }
};

/// The points of a legacy grid as an engine loads them.
class LegacyGridReader {
  public:
    /// Lump 15. Nothing if its length is not that of the points.
    static std::optional<LegacyGridReader> Load(std::span<const std::byte> lump, const LegacyPlaces &places,
                                                const LegacyEngine &engine);
    /// The same with lightgrid.raw for the colors, as the second renderer of ioquake3 loads it: scaled down where the
    /// largest channel passes 1, then 16 bits. `shift`: factor of overbright bits. Nothing if a length is wrong.
    static std::optional<LegacyGridReader> LoadRaw(std::span<const std::byte> lump, std::span<const std::byte> raw,
                                                   const LegacyPlaces &places, const LegacyEngine &engine, float shift);
    /// The same as rend2 of OpenJK loads it: divided by pi, times 255; no limit.
    static std::optional<LegacyGridReader> LoadRend2(std::span<const std::byte> lump, std::span<const std::byte> raw,
                                                     const LegacyPlaces &places, const LegacyEngine &engine);

    /// The light of a model at a position.
    LegacyLight At(const Vec3f &position) const;

  private:
    struct Point {
        Vec3f ambient, directed, direction;
        bool inWall = false;
    };
    LegacyGridReader(const LegacyPlaces &places, const LegacyEngine &engine) : places_(places), engine_(engine) {}

    LegacyPlaces places_;
    LegacyEngine engine_;
    std::vector<Point> points_;
};

} // namespace q3
