// GPL-2.0-or-later. The portal file (.prt) that the bsp stage hands to the vis stage.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Bits of a portal's flags in the file: it lies on a hint face, it lies on a sky face.
inline constexpr int kPrtHintFlag = 1, kPrtSkyFlag = 2;

/// A portal between two clusters, or a face: a polygon between a cluster and solid.
struct PrtWinding {
    /// The normal of the first three points, (p2 - p0) x (p1 - p0), points into clusters[0]. On the other side is
    /// clusters[1], which is -1 for a face.
    std::array<int, 2> clusters{-1, -1};
    bool isHint = false, isSky = false; ///< the flags of a portal
    int line = 0;                       ///< in the file, from 1
    std::size_t firstPoint = 0, numPoints = 0;
};

struct PortalFile {
    int clusters = 0;
    std::vector<PrtWinding> portals, faces;
    std::vector<Vec3f> points; ///< of all windings, in game units

    std::span<const Vec3f> Points(const PrtWinding &winding) const {
        return {points.data() + winding.firstPoint, winding.numPoints};
    }
};

/// Parses the text of a portal file: cluster numbers, counts and coordinates are checked. `name` is for messages.
/// Errors: Error with the line and what was expected there.
PortalFile ParsePortalFile(std::string_view text, std::string_view name);
/// The same from disk. Errors also as ReadFile.
PortalFile ReadPortalFile(const std::filesystem::path &path);

} // namespace q3
