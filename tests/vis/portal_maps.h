// GPL-2.0-or-later. Small portal files for the tests.
#pragma once

#include "q3map2/vis/vis.h"

#include <string>
#include <vector>

namespace q3::test {

/// A portal file of these portal lines.
std::string PrtText(int clusters, const std::vector<std::string> &portals);

/// Rooms in a row along x: portal k at x = 128 k, y and z from 48 to 80, between rooms k - 1 and k. `flags` is that of
/// the last portal.
std::string Corridor(int rooms, int flags = 0);

/// What a run gave: rows as text such as "110 111 011", and the log.
struct VisRun {
    Visibility visibility;
    std::string rows, log;
    bool Printed(std::string_view part) const { return log.find(part) != std::string::npos; }
};
VisRun RunVis(const std::string &prt, const VisOptions &options = {}, int threads = 1);
VisRun RunVis(const std::string &prt, const VisOptions &options, const JobPool &jobs);

/// Rooms of 128 units a side in a grid, with a window in most walls. Cell (x, y, z) has number x + 6 y + 36 z.
class RoomGrid {
  public:
    static constexpr int kSide = 6, kFloors = 2, kRooms = kSide * kSide * kFloors;
    static constexpr double kRoom = 128;

    explicit RoomGrid(std::uint32_t seed);
    const std::string &Prt() const { return prt_; }
    /// Whether the line between two places passes walls through windows only, at least `margin` units from their edges.
    bool IsClear(const Vec3d &a, const Vec3d &b, double margin) const;
    static int RoomAt(const Vec3d &p);

  private:
    struct Window {
        bool open = false;
        double low[2]{}, high[2]{}; ///< on the axes after the wall's
    };
    /// Window from a room to the next one on an axis.
    const Window &WindowAt(int room, int axis) const { return windows_[std::size_t(3 * room + axis)]; }

    std::vector<Window> windows_;
    std::string prt_;
};

} // namespace q3::test
