// GPL-2.0-or-later. Skies along one direction.
#include "q3map2/light/scene/sky_beam.h"

#include <cmath>

namespace q3 {

SkyBeam::SkyBeam(const SkyFaces &skies, const Vec3f &direction, const Boundsf &box) {
    const Box around{Vec3d(box.Center()), Vec3d(box.maxs - box.mins) * 0.5};
    for (const SkyFaces::Face &face : skies.Faces())
        Add(face, Vec3d(direction), around);
}

void SkyBeam::Add(const SkyFaces::Face &face, const Vec3d &direction, const Box &box) {
    // How far a linear function goes up and down from its value in the middle of the box.
    const auto reach = [&](const Vec3d &f) {
        return std::abs(f.x) * box.half.x + std::abs(f.y) * box.half.y + std::abs(f.z) * box.half.z;
    };
    const Vec3d normal(face.plane.normal);
    const double toward = Dot(normal, direction);
    if (std::abs(toward) < 1e-6)
        return;
    const Vec3d way = -normal / toward;
    const double start = -double(face.plane.dist) / toward;
    if (Dot(way, box.center) - start + reach(way) < -kSkyOverlap)
        return;
    Face &added = faces_[faceCount_];
    added = {{Vec3f(way), float(start)}, face.skyIndex, {pieceCount_, 0}};
    bool whole = false;
    for (const SkyFaces::Piece &piece : face.pieces) {
        Range range{edgeCount_, edgeCount_};
        bool outside = false;
        for (const SkyLinear &edge : piece) {
            // Where the ray meets the plane: origin + direction * (way . origin - start).
            const double along = Dot(Vec3d(edge.normal), direction);
            const Vec3d across = Vec3d(edge.normal) + way * along;
            const double dist = double(edge.dist) + start * along;
            const double middle = Dot(across, box.center) - dist, around = reach(across);
            outside = outside || middle + around < -kSkyOverlap;
            if (middle - around < kSkyOverlap)
                edges_[range.to++] = {Vec3f(across), float(dist)};
        }
        if (outside)
            continue;
        whole = whole || range.from == range.to;
        edgeCount_ = range.to;
        pieces_[pieceCount_++] = range;
    }
    if (whole)
        pieceCount_ = added.pieces.from;
    added.pieces.to = pieceCount_;
    if (whole || added.pieces.from != added.pieces.to)
        ++faceCount_;
}

Q3_VECTOR void SkyBeam::Clip(const Lanes3 &origin, int skyIndex, float nearest, Lanes &distance, LaneMask &live) const {
    LaneMask ends{};
    Lanes end = distance;
    for (std::size_t n = 0; n < faceCount_; ++n) {
        const Face &face = faces_[n];
        LaneMask inside;
        inside.fill(face.pieces.from == face.pieces.to ? -1 : 0);
        for (std::size_t piece = face.pieces.from; piece < face.pieces.to; ++piece) {
            const auto [from, to] = pieces_[piece];
            AddInside({edges_.data() + from, to - from}, origin, inside);
        }
        const auto [way, start] = face.distance;
        const std::int32_t wanted = skyIndex < 0 || face.skyIndex == skyIndex ? -1 : 0;
#pragma GCC unroll 1
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float before = end[i];
            const float here = way.x * origin.x[i] + way.y * origin.y[i] + way.z * origin.z[i] - start;
            const std::int32_t met = -std::int32_t((here >= nearest) & (here <= before)) & inside[i];
            ends[i] = (wanted & met) | (ends[i] & ~met);
            end[i] = met != 0 ? here : before;
        }
    }
    distance = end;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        live[i] &= ends[i];
}

} // namespace q3
