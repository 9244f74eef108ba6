// GPL-2.0-or-later. Where the vertices of static props are lit.
#pragma once

#include "q3map2/light/props/static_props.h"
#include "q3map2/light/scene/light_space.h"

#include <span>
#include <vector>

namespace q3 {

/// One of the samples whose weighted mean is the light at a point of a prop.
struct PropSample {
    Vec3f position;
    float weight = 1; ///< area that it stands for
};

/// A point of a prop (PropModel::Point) in the world.
struct PropPlace {
    Vec3f position; ///< slightly off the surface
    Vec3f normal;   ///< unit
};

/// Samples count as in a solid from this depth on. Game units.
inline constexpr float kPropSolidDepth = 1.0f / 8;

/// Places the points and samples of one prop. Const after construction. Keeps references.
class PropSampler {
  public:
    PropSampler(const StaticProp &prop, const BspSpace &space) : prop_(prop), space_(space) {}

    PropPlace Place(std::size_t point) const;
    /// Sets `samples` to the samples of a point that are in the open: on its triangles, at most 8 units away, within
    /// the third of each triangle that is nearest to it, and on the same side of walls. Empty: the point is buried.
    void Samples(std::size_t point, std::vector<PropSample> &samples) const;

    /// Whether light can be there.
    bool IsOpen(const Vec3f &p) const;
    /// The place nearest to `buried`, up to a precision of 2^-20, on the segment to `open` that is open itself; a
    /// little farther on if that is open too.
    Vec3f OpenPlaceToward(const Vec3f &buried, const Vec3f &open) const;

  private:
    const StaticProp &prop_;
    const BspSpace &space_;
};

/// Finds the nearest of some open points for buried ones.
class NearestPoints {
  public:
    struct Entry {
        Vec3f position, normal;
    };
    explicit NearestPoints(std::vector<Entry> entries);
    bool Empty() const { return entries_.empty(); }
    /// The nearest position; points that face elsewhere than `normal` count as up to three times as far.
    Vec3f Find(const Vec3f &position, const Vec3f &normal) const;

  private:
    std::vector<Entry> entries_; // by x
};

} // namespace q3
