// GPL-2.0-or-later. Small portal files for the tests.
#include "tests/vis/portal_maps.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace q3::test {

std::string PrtText(int clusters, const std::vector<std::string> &portals) {
    std::string text = fmt::format("PRT1\n{}\n{}\n0\n", clusters, portals.size());
    for (const std::string &portal : portals)
        text += portal + "\n";
    return text;
}

std::string Corridor(int rooms, int flags) {
    std::vector<std::string> portals;
    for (int k = 1; k < rooms; ++k) {
        std::string line = fmt::format("4 {} {} {} ", k - 1, k, k == rooms - 1 ? flags : 0);
        for (const auto &[y, z] : {std::pair(48, 48), {80, 48}, {80, 80}, {48, 80}})
            line += fmt::format("({} {} {} ) ", 128 * k, y, z);
        portals.push_back(line);
    }
    return PrtText(rooms, portals);
}

VisRun RunVis(const std::string &prt, const VisOptions &options, int threads) {
    return RunVis(prt, options, JobPool(threads));
}

VisRun RunVis(const std::string &prt, const VisOptions &options, const JobPool &jobs) {
    VisRun run;
    Log log([&](LogLevel, std::string_view text) { run.log += text; }, true);
    run.visibility = *ComputeVisibility(ParsePortalFile(prt, "test.prt"), "test.prt", options, nullptr, jobs, log);
    PrintStatistics(run.visibility, true, log);
    for (int from = 0; from < run.visibility.clusters; ++from) {
        run.rows += from == 0 ? "" : " ";
        for (int to = 0; to < run.visibility.clusters; ++to)
            run.rows += run.visibility.Sees(from, to) ? '1' : '0';
    }
    return run;
}

RoomGrid::RoomGrid(std::uint32_t seed) : windows_(std::size_t(3 * kRooms)) {
    std::mt19937 random(seed);
    const int counts[3] = {kSide, kSide, kFloors}, steps[3] = {1, kSide, kSide * kSide};
    std::vector<std::string> portals;
    for (int room = 0; room < kRooms; ++room)
        for (int axis = 0; axis < 3; ++axis) {
            const int cell[3] = {room % kSide, room / kSide % kSide, room / (kSide * kSide)};
            if (cell[axis] + 1 == counts[axis] || random() % 8 == 0)
                continue;
            Window &window = windows_[std::size_t(3 * room + axis)];
            window.open = true;
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (const int k : {0, 1}) {
                const double base = kRoom * cell[k == 0 ? u : v];
                const int low = int(random() % 96), size = 16 + int(random() % 96);
                window.low[k] = base + low;
                window.high[k] = base + std::min(low + size, int(kRoom));
            }
            // Counterclockwise as seen from the next room.
            std::string line = fmt::format("4 {} {} 0 ", room, room + steps[axis]);
            const double corners[4][2] = {{window.low[0], window.low[1]},
                                          {window.high[0], window.low[1]},
                                          {window.high[0], window.high[1]},
                                          {window.low[0], window.high[1]}};
            for (const auto &corner : corners) {
                double p[3];
                p[axis] = kRoom * (cell[axis] + 1), p[u] = corner[0], p[v] = corner[1];
                line += fmt::format("({} {} {} ) ", p[0], p[1], p[2]);
            }
            portals.push_back(line);
        }
    prt_ = PrtText(kRooms, portals);
}

int RoomGrid::RoomAt(const Vec3d &p) {
    return int(p.x / kRoom) + kSide * int(p.y / kRoom) + kSide * kSide * int(p.z / kRoom);
}

bool RoomGrid::IsClear(const Vec3d &a, const Vec3d &b, double margin) const {
    for (int axis = 0; axis < 3; ++axis) {
        const auto along = std::size_t(axis);
        const Vec3d &first = a[along] < b[along] ? a : b, &last = a[along] < b[along] ? b : a;
        for (int wall = int(first[along] / kRoom) + 1; wall * kRoom < last[along]; ++wall) {
            const Vec3d p = first + (last - first) * ((wall * kRoom - first[along]) / (last[along] - first[along]));
            int cell[3] = {int(p.x / kRoom), int(p.y / kRoom), int(p.z / kRoom)};
            cell[axis] = wall - 1;
            const Window &window = WindowAt(cell[0] + kSide * cell[1] + kSide * kSide * cell[2], axis);
            if (!window.open)
                return false;
            for (std::size_t k = 0; k < 2; ++k) {
                const double at = p[(along + 1 + k) % 3];
                if (at < window.low[k] + margin || at > window.high[k] - margin)
                    return false;
            }
        }
    }
    return true;
}

} // namespace q3::test
