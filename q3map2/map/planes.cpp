// GPL-2.0-or-later. The plane table of a compile, which becomes the planes lump.
#include "q3map2/map/planes.h"

#include <cmath>
#include <utility>

namespace q3 {

namespace {

/// A normal with two components smaller than this snaps to the third axis.
constexpr double kAlmostAxial = 0.00025;

Vec3d AsStored(const Vec3d &v) {
    return Vec3d(Vec3f(v));
}

bool IsWithin(double a, double b, double epsilon) {
    return a == b || std::abs(a - b) < epsilon;
}

std::size_t HashOf(double dist, std::size_t hashes) {
    return std::size_t(std::fmod(std::floor(std::abs(dist)), double(hashes)));
}

} // namespace

bool PlaneTable::SnapNormal(Vec3d &normal) const {
    bool changed = false;
    for (const auto &[a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
        double &u = a == 0 ? normal.x : normal.y, &v = b == 1 ? normal.y : normal.z;
        if (std::abs(u) < kAlmostAxial && std::abs(v) < kAlmostAxial && (u != 0 || v != 0)) {
            u = v = 0;
            changed = true;
            break;
        }
    }
    for (double *c : {&normal.x, &normal.y, &normal.z})
        if (*c != 0 && std::abs(*c) < normalEpsilon_) {
            *c = 0;
            changed = true;
        }
    if (const double length = Length(normal); changed && length > 0)
        normal = normal * (1 / length);
    return changed;
}

bool PlaneTable::Equal(int number, const Vec3d &normal, double dist) const {
    const Plane &plane = (*this)[number];
    return IsWithin(plane.dist, dist, distanceEpsilon_) && IsWithin(plane.normal.x, normal.x, normalEpsilon_) &&
           IsWithin(plane.normal.y, normal.y, normalEpsilon_) && IsWithin(plane.normal.z, normal.z, normalEpsilon_);
}

bool PlaneTable::IsAxial(int number) const {
    const Vec3d &n = (*this)[number].normal;
    return std::abs(n.x) == 1 || std::abs(n.y) == 1 || std::abs(n.z) == 1;
}

int PlaneTable::Find(const Vec3d &normal, double dist, std::span<const Vec3d> points) {
    Vec3d n = AsStored(normal);
    double d = double(float(dist));
    constexpr double kMinLength = 0.5; // a unit normal that was rounded is longer by far
    if (!(Length(n) >= kMinLength) || !IsFinite(n) || !std::isfinite(d))
        return -1;
    if (SnapNormal(n)) {
        n = AsStored(n);
        if (!points.empty()) {
            Vec3d sum;
            for (const Vec3d &p : points)
                sum += p;
            d = double(Dot(Vec3f(n), Vec3f(sum / double(points.size()))));
        }
    }
    const int zeros = (n.x == 0) + (n.y == 0) + (n.z == 0);
    if (zeros >= 2 && std::abs(d - std::rint(d)) < distanceEpsilon_)
        d = std::rint(d);
    const std::size_t hash = HashOf(d, kHashes);
    // Equal planes may have distances in neighboring chains: searches the chain before its own, which is kHashes - 1
    // steps on, its own, and the next.
    for (const std::size_t step : {kHashes - 1, std::size_t(0), std::size_t(1)})
        for (int i = chains_[(hash + step) % kHashes]; i >= 0; i = next_[std::size_t(i)]) {
            if (!Equal(i, n, d))
                continue;
            bool holdsPoints = true;
            for (const Vec3d &p : points)
                holdsPoints = holdsPoints && std::abs((*this)[i].Distance(p)) < distanceEpsilon_;
            if (holdsPoints)
                return i;
        }
    return Append(n, d);
}

int PlaneTable::Append(const Vec3d &normal, double dist) {
    const int first = Count();
    const bool swapped = normal.x == -1 || normal.y == -1 || normal.z == -1;
    // Adding 0 turns -0 into 0.
    const Plane asked{normal + Vec3d{}, dist}, opposite{-normal + Vec3d{}, -dist + 0.0};
    planes_.push_back(swapped ? opposite : asked);
    planes_.push_back(swapped ? asked : opposite);
    int &chain = chains_[HashOf(dist, kHashes)];
    for (int i = first; i < first + 2; ++i) {
        next_.push_back(chain);
        chain = i;
    }
    return swapped ? first + 1 : first;
}

} // namespace q3
