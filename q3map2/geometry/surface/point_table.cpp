// GPL-2.0-or-later. Spatial hash of points, equal within a tolerance.
#include "q3map2/geometry/surface/point_table.h"

#include <algorithm>
#include <cmath>

namespace q3 {
namespace {

constexpr double kCell = 0.5;
/// Draw vertices lie on multiples of 1/8. Cell borders halfway between these keep vertices off the borders.
constexpr double kShift = 0.0625;
constexpr double kFar = 1e9; ///< cells

} // namespace

std::size_t PointTable::CellHash::operator()(const Cell &c) const {
    const auto mix = [](std::size_t h, long long v) { return (h ^ std::size_t(v)) * 0x9E3779B97F4A7C15ull; };
    const std::size_t h = mix(mix(mix(0, c.x), c.y), c.z);
    return h ^ (h >> 32);
}

PointTable::Cell PointTable::CellOf(const Vec3f &p, double x, double y, double z) const {
    // No map has points beyond the limit; if any, they share a cell.
    const auto cell = [](double v) { return (long long)(std::floor(std::clamp((v + kShift) / kCell, -kFar, kFar))); };
    return {cell(double(p.x) + x), cell(double(p.y) + y), cell(double(p.z) + z)};
}

int PointTable::FindIn(const Cell &cell, const Vec3f &p) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end())
        return -1;
    for (const int i : found->second) {
        const Vec3d d = Vec3d(points_[std::size_t(i)]) - Vec3d(p);
        if (std::abs(d.x) <= tolerance_ && std::abs(d.y) <= tolerance_ && std::abs(d.z) <= tolerance_)
            return i;
    }
    return -1;
}

int PointTable::FindOrAdd(const Vec3f &p) {
    const Cell lo = CellOf(p, -tolerance_, -tolerance_, -tolerance_),
               hi = CellOf(p, tolerance_, tolerance_, tolerance_);
    int first = -1;
    for (long long x = lo.x; x <= hi.x; ++x)
        for (long long y = lo.y; y <= hi.y; ++y)
            for (long long z = lo.z; z <= hi.z; ++z) {
                const int found = FindIn({x, y, z}, p);
                if (found >= 0 && (first < 0 || found < first))
                    first = found;
            }
    if (first >= 0)
        return first;
    points_.push_back(p);
    cells_[CellOf(p, 0, 0, 0)].push_back(int(points_.size()) - 1);
    return int(points_.size()) - 1;
}

} // namespace q3
