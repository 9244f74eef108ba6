// GPL-2.0-or-later. Reference for direct and bounced light in a room of boxes: sums over all of its surfaces.
#pragma once

#include "libs/math/vec.h"

#include <vector>

namespace q3::test {

/// Light that arrives from a direction.
struct ArrivingLight {
    Vec3d direction; ///< unit, to the source
    Vec3d light;     ///< on a surface that faces it; byte scale
};

/// All light at a place.
struct LightField {
    std::vector<ArrivingLight> lights;
    Vec3d ambient; ///< the same on all normals
    /// Light on a matte surface with that normal.
    Vec3d On(const Vec3d &normal) const;
    /// The same by spherical harmonics of bands 0 to `band` (1 or 2), convolved with the clamped cosine.
    Vec3d InBands(int band, const Vec3d &normal) const;
};

/// A point light.
struct ReferenceLamp {
    Vec3d origin;
    double light = 0; ///< value of the light key: 1 gives 7500 at distance 1, byte scale
    Vec3d color{1, 1, 1};
};

/// Matte surfaces with one reflectance each. Bounces are computed by form factors between pieces of the surfaces, at
/// most 16 units on a side for the first bounce, 32 for later ones.
class RoomReference {
  public:
    /// A rectangle corner + [0, 1] u + [0, 1] v that reflects to the side of u x v.
    void AddRectangle(const Vec3d &corner, const Vec3d &u, const Vec3d &v, const Vec3d &reflectance);
    /// A box in the way of light; its four sides and its top reflect.
    void AddPillar(const Boundsd &box, const Vec3d &reflectance);
    void AddLamp(const ReferenceLamp &lamp) { lamps_.push_back(lamp); }
    void SetAmbient(const Vec3d &light) { ambient_ = light; }
    /// Call once, after all functions above. Afterwards the object is const.
    void Solve(int bounces);

    /// Light of bounces at a place.
    LightField Bounced(const Vec3d &p) const;
    /// Adds the light of lamps and ambient light.
    void AddDirect(const Vec3d &p, LightField &field) const;
    /// Whether the same lamps are visible from the whole circle of `radius` around p on a plane: no shadow edge is
    /// near.
    bool IsSmoothAt(const Vec3d &p, const Vec3d &normal, double radius) const;

  private:
    struct Rectangle {
        Vec3d corner, u, v, reflectance;
    };
    struct Piece {
        Vec3d center, normal, u, v; ///< u, v: its edges
        Vec3d reflectance, light;   ///< light: radiosity
        double area = 0;
    };
    bool Sees(const Vec3d &a, const Vec3d &b) const;
    Vec3d Direct(const Vec3d &p, const Vec3d &normal) const;
    std::vector<Piece> Pieces(double size) const;
    void AddPieces(const std::vector<Piece> &pieces, const Vec3d &p, std::vector<ArrivingLight> &lights) const;
    std::vector<Vec3d> Received(const std::vector<Piece> &to, const std::vector<Piece> &from) const;

    std::vector<Rectangle> rectangles_;
    std::vector<Boundsd> pillars_;
    std::vector<ReferenceLamp> lamps_;
    Vec3d ambient_;
    std::vector<Piece> first_, later_;
};

} // namespace q3::test
