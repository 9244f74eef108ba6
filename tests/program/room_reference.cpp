// GPL-2.0-or-later. Reference for direct and bounced light in a room of boxes: sums over all of its surfaces.
#include "tests/program/room_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::test {

namespace {

/// Pieces nearer than this many times their size are split.
constexpr double kFarPieces = 3;

/// Whether the segment passes through the inside of the box.
bool PassesThrough(const Vec3d &a, const Vec3d &b, const Boundsd &box) {
    double enters = 0, leaves = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double way = b[axis] - a[axis], low = box.mins[axis] - a[axis], high = box.maxs[axis] - a[axis];
        if (std::abs(way) < 1e-9) {
            if (low >= -1e-6 || high <= 1e-6)
                return false;
            continue;
        }
        enters = std::max(enters, std::min(low / way, high / way));
        leaves = std::min(leaves, std::max(low / way, high / way));
    }
    return enters < leaves - 1e-7;
}

} // namespace

Vec3d LightField::On(const Vec3d &normal) const {
    Vec3d sum = ambient;
    for (const ArrivingLight &one : lights)
        sum += one.light * std::max(0.0, Dot(one.direction, normal));
    return sum;
}

Vec3d LightField::InBands(int band, const Vec3d &normal) const {
    Vec3d sum = ambient;
    for (const ArrivingLight &one : lights) {
        const double c = Dot(one.direction, normal);
        sum += one.light * (0.25 + 0.5 * c + (band == 2 ? (15 * c * c - 5) / 32 : 0));
    }
    return sum;
}

void RoomReference::AddRectangle(const Vec3d &corner, const Vec3d &u, const Vec3d &v, const Vec3d &reflectance) {
    rectangles_.push_back({corner, u, v, reflectance});
}

void RoomReference::AddPillar(const Boundsd &box, const Vec3d &reflectance) {
    const Vec3d size = box.maxs - box.mins, x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
    AddRectangle(box.mins, z, y, reflectance);
    AddRectangle(box.mins + x, y, z, reflectance);
    AddRectangle(box.mins, x, z, reflectance);
    AddRectangle(box.mins + y, z, x, reflectance);
    AddRectangle(box.mins + z, x, y, reflectance);
    pillars_.push_back(box);
}

bool RoomReference::Sees(const Vec3d &a, const Vec3d &b) const {
    return std::none_of(pillars_.begin(), pillars_.end(), [&](const Boundsd &box) { return PassesThrough(a, b, box); });
}

Vec3d RoomReference::Direct(const Vec3d &p, const Vec3d &normal) const {
    Vec3d sum = ambient_;
    for (const ReferenceLamp &lamp : lamps_) {
        const Vec3d way = lamp.origin - p;
        const double d2 = Dot(way, way), cosine = Dot(way, normal) / std::sqrt(d2);
        if (cosine > 0 && Sees(p, lamp.origin))
            sum += lamp.color * (lamp.light * 7500 / d2 * cosine);
    }
    return sum;
}

std::vector<RoomReference::Piece> RoomReference::Pieces(double size) const {
    std::vector<Piece> pieces;
    for (const Rectangle &from : rectangles_) {
        const int across = int(std::lround(std::ceil(Length(from.u) / size)));
        const int up = int(std::lround(std::ceil(Length(from.v) / size)));
        const Vec3d normal = Cross(from.u, from.v), u = from.u / double(across), v = from.v / double(up);
        for (int i = 0; i < across; ++i)
            for (int k = 0; k < up; ++k) {
                const Vec3d center = from.corner + u * (i + 0.5) + v * (k + 0.5);
                pieces.push_back({center, Normalize(normal), u, v, from.reflectance, {}, Length(Cross(u, v))});
            }
    }
    return pieces;
}

void RoomReference::AddPieces(const std::vector<Piece> &pieces, const Vec3d &p,
                              std::vector<ArrivingLight> &lights) const {
    for (const Piece &piece : pieces) {
        const double away = Length(piece.center - p), size = std::sqrt(piece.area);
        const int split = std::clamp(int(std::ceil(kFarPieces * size / std::max(away, 1e-3))), 1, 8);
        for (int i = 0; i < split * split; ++i) {
            const Vec3d at = piece.center + piece.u * ((i % split + 0.5) / split - 0.5) +
                             piece.v * ((double(i / split) + 0.5) / split - 0.5);
            const Vec3d way = at - p;
            const double d2 = Dot(way, way), cosine = -Dot(way, piece.normal) / std::sqrt(d2);
            if (cosine <= 0 || !Sees(p, at))
                continue;
            const double share = piece.area / (split * split) * cosine / (std::numbers::pi * d2);
            lights.push_back({Normalize(way), piece.light * share});
        }
    }
}

std::vector<Vec3d> RoomReference::Received(const std::vector<Piece> &to, const std::vector<Piece> &from) const {
    std::vector<Vec3d> received;
    LightField field;
    for (const Piece &piece : to) {
        field.lights.clear();
        AddPieces(from, piece.center, field.lights);
        received.push_back(field.On(piece.normal));
    }
    return received;
}

void RoomReference::Solve(int bounces) {
    if (bounces == 0)
        return;
    first_ = Pieces(16);
    later_ = Pieces(32);
    constexpr int kSamples = 4;
    for (Piece &piece : first_) {
        Vec3d sum;
        for (int i = 0; i < kSamples * kSamples; ++i)
            sum += Direct(piece.center + piece.u * ((i % kSamples + 0.5) / kSamples - 0.5) +
                              piece.v * ((double(i / kSamples) + 0.5) / kSamples - 0.5),
                          piece.normal);
        piece.light = sum / double(kSamples * kSamples) * piece.reflectance;
    }
    std::vector<Piece> shot = later_;
    std::vector<Vec3d> received = Received(later_, first_);
    for (int bounce = 2; bounce <= bounces; ++bounce) {
        for (std::size_t i = 0; i < shot.size(); ++i) {
            shot[i].light = received[i] * shot[i].reflectance;
            later_[i].light += shot[i].light;
        }
        if (bounce < bounces)
            received = Received(later_, shot);
    }
}

LightField RoomReference::Bounced(const Vec3d &p) const {
    LightField field;
    AddPieces(first_, p, field.lights);
    AddPieces(later_, p, field.lights);
    return field;
}

void RoomReference::AddDirect(const Vec3d &p, LightField &field) const {
    field.ambient += ambient_;
    for (const ReferenceLamp &lamp : lamps_) {
        const Vec3d way = lamp.origin - p;
        if (Sees(p, lamp.origin))
            field.lights.push_back({Normalize(way), lamp.color * (lamp.light * 7500 / Dot(way, way))});
    }
}

bool RoomReference::IsSmoothAt(const Vec3d &p, const Vec3d &normal, double radius) const {
    const Vec3d axis = std::abs(normal.z) > 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
    const Vec3d right = Normalize(Cross(axis, normal)), up = Cross(normal, right);
    return std::all_of(lamps_.begin(), lamps_.end(), [&](const ReferenceLamp &lamp) {
        int seen = 0;
        for (int i = 0; i < 8; ++i) {
            const double angle = i * std::numbers::pi / 4;
            seen += Sees(p + (right * std::cos(angle) + up * std::sin(angle)) * radius, lamp.origin);
        }
        return seen == 0 || seen == 8;
    });
}

} // namespace q3::test
