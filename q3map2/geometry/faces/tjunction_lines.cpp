// GPL-2.0-or-later. Lines along edges of surfaces, looked up in a grid of cells.
#include "q3map2/geometry/faces/tjunction_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace q3 {
namespace {

constexpr double kNearLine = 0.25, kSamePoint = 0.25; ///< game units
constexpr double kMaxCellsAcross = 64, kMinCell = 16;
/// Bound on the distance from the line for points within kNearLine of both planes (0.25 * sqrt(2) = 0.36).
constexpr double kReach = 0.5;

void Insert(EdgeLine &line, const Vec3f &p) {
    const double along = Dot(Vec3d(p) - line.origin, line.direction);
    const auto next = std::ranges::upper_bound(line.points, along - kSamePoint, {}, &EdgeLine::Point::along);
    if (next == line.points.end() || next->along - along >= kSamePoint)
        line.points.insert(next, {along, p});
}

bool IsNear(const EdgeLine &line, const Vec3d &p) {
    return std::abs(line.planes[0].Distance(p)) < kNearLine && std::abs(line.planes[1].Distance(p)) < kNearLine;
}

EdgeLine MakeLine(const Vec3d &origin, const Vec3d &direction) {
    std::size_t least = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (std::abs(direction[i]) < std::abs(direction[least]))
            least = i;
    Vec3d axis;
    axis[least] = 1;
    EdgeLine line{origin, direction, {}, {}};
    line.planes[0].normal = Normalize(Cross(axis, direction));
    line.planes[1].normal = Cross(line.planes[0].normal, direction);
    for (Plane &plane : line.planes)
        plane.dist = Dot(plane.normal, origin);
    return line;
}

} // namespace

EdgeLines::EdgeLines(const Boundsf &bounds, std::size_t edges) : bounds_{Vec3d(bounds.mins), Vec3d(bounds.maxs)} {
    if (bounds_.Empty())
        bounds_ = {Vec3d{}, Vec3d{}};
    const Vec3d extent = bounds_.maxs - bounds_.mins;
    const double across = std::clamp(2 * std::cbrt(double(edges)), 1., kMaxCellsAcross);
    cellSize_ = std::max(kMinCell, MaxComponent(extent) / across);
    for (std::size_t i = 0; i < 3; ++i)
        size_[i] = int(extent[i] / cellSize_) + 1;
    cells_.resize(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]));
}

std::array<int, 3> EdgeLines::CellOf(const Vec3d &p) const {
    std::array<int, 3> cell{};
    for (std::size_t i = 0; i < 3; ++i)
        cell[i] = int(std::clamp(std::floor((p[i] - bounds_.mins[i]) / cellSize_), 0., double(size_[i] - 1)));
    return cell;
}

void EdgeLines::EnterCells(int number) {
    const EdgeLine &line = lines_[std::size_t(number)];
    // Only the part of the line in the bounds and a margin: no point outside is ever looked up.
    double from = std::numeric_limits<double>::lowest(), to = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < 3; ++i) {
        const double d = line.direction[i];
        if (std::abs(d) < 1e-9)
            continue;
        const double t0 = (bounds_.mins[i] - kReach - line.origin[i]) / d;
        const double t1 = (bounds_.maxs[i] + kReach - line.origin[i]) / d;
        from = std::max(from, std::min(t0, t1)), to = std::min(to, std::max(t0, t1));
    }
    const Vec3d reach{kReach, kReach, kReach};
    for (double t = from; t < to; t += cellSize_) {
        const Vec3d a = line.origin + line.direction * t;
        const Vec3d b = line.origin + line.direction * std::min(to, t + cellSize_);
        const std::array<int, 3> lo = CellOf(Min(a, b) - reach), hi = CellOf(Max(a, b) + reach);
        for (int z = lo[2]; z <= hi[2]; ++z)
            for (int y = lo[1]; y <= hi[1]; ++y)
                for (int x = lo[0]; x <= hi[0]; ++x) {
                    std::vector<int> &cell = cells_[std::size_t((z * size_[1] + y) * size_[0] + x)];
                    if (cell.empty() || cell.back() != number)
                        cell.push_back(number);
                }
    }
}

int EdgeLines::Find(const Vec3d &a, const Vec3d &b) const {
    const std::array<int, 3> c = CellOf(a);
    for (const int line : cells_[std::size_t((c[2] * size_[1] + c[1]) * size_[0] + c[0])])
        if (IsNear(lines_[std::size_t(line)], a) && IsNear(lines_[std::size_t(line)], b))
            return line;
    return -1;
}

int EdgeLines::Add(const Vec3f &a, const Vec3f &b, const Vec3d &direction) {
    int line = Find(Vec3d(a), Vec3d(b));
    if (line < 0) {
        line = Count();
        lines_.push_back(MakeLine(Vec3d(a), direction));
        EnterCells(line);
    }
    Insert(lines_[std::size_t(line)], a);
    Insert(lines_[std::size_t(line)], b);
    return line;
}

} // namespace q3
