// GPL-2.0-or-later. Direct light at receivers by brute force: the reference for the light stage's direct light.
//
// An area light gives its radiosity times the form factor of its polygon's part above the receiver's horizon, in closed
// form and double precision, times the share of that part that is seen. The share is the mean over jittered points of
// the part, each weighted by cos(receiver) cos(emitter) / distance^2. Point lights, spotlights and suns follow
// direct_light.h, with one shadow ray each. The PVS is not used, no receiver is moved off the plane of an emitter, and
// no light is left out but those that give less than 1e-4 byte without shadows.
#pragma once

#include "libs/math/winding.h"
#include "tools/measure/bounce_error/direct_light.h"

#include <filesystem>
#include <span>
#include <vector>

namespace q3::bounce {

/// The part of a convex polygon above the horizon of a receiver at p: the points q with normal . (q - p) >= 0. Its
/// corners are relative to p.
Winding<double> AboveHorizon(std::span<const Vec3f> polygon, const Vec3d &p, const Vec3d &normal);

/// Cosine-weighted fraction of the hemisphere around the unit normal that a polygon above the horizon covers, 0 to 1,
/// by Lambert's formula. polygon: relative to the receiver.
double FormFactorAbove(const Winding<double> &polygon, const Vec3d &normal);

/// A point, uniform by area, in each of side * side parts of equal area of a convex polygon, row by row.
std::vector<Vec3d> JitteredPoints(const Winding<double> &polygon, int side, PathRandom &random);

/// A luxel, or a point of a surface, whose direct light is wanted.
struct TruthReceiver {
    std::vector<SurfacePoint> places; ///< its light is the mean over them; at least one
    Vec3f ambient;                    ///< is added. Byte scale
    std::vector<Vec3f> around;        ///< positions of the luxels up to 2 luxels away
};

/// Direct light of a receiver and what it depends on. Contributions are those of one light, of the channel that gets
/// most.
struct LuxelTruth {
    Vec3f light, error; ///< byte scale, not clamped, and its standard error
    /// At least 2 % of an area light of at least 1 byte unshadowed are hidden by a surface that emits.
    bool crossedLamps = false;
    /// Within kAreaPush of the plane of an area light, in front of it if it is one-sided, that gives at least 1 byte.
    bool contact = false;
    /// An area light of at least 1 byte unshadowed is between 2 % and 98 % visible.
    bool penumbra = false;
    /// A light of at least 1 byte unshadowed is not equally visible at the receiver and around it, by 16 points of each
    /// area light and one of others.
    bool nearEdge = false;
    bool operator==(const LuxelTruth &) const = default;
};

/// Computes direct light of style 0. Const after construction; safe from several threads.
class DirectTruth {
  public:
    /// Keeps references.
    DirectTruth(const SurfaceInputs &in, const DirectLights &lights);

    /// seed: of the points on area lights.
    LuxelTruth At(const TruthReceiver &receiver, std::uint64_t seed) const;

  private:
    struct Part;
    struct Seen;
    struct Sum;
    Seen SeenOf(const Part &part, const SurfacePoint &at, int side, PathRandom &random) const;
    Seen SeenOf(const Part &part, const SurfacePoint &at, PathRandom &random) const;
    LaneMask HiddenByLamps(const RayPacket &blocked, int receiveShadows, RayCounts &counts) const;
    void AddArea(std::size_t number, const SurfacePoint &at, PathRandom &random, Sum &sum) const;
    void AddOther(std::size_t number, const SurfacePoint &at, Sum &sum) const;
    unsigned SeenFrom(const Light &light, std::span<const Vec3d> points, const Vec3f &position,
                      int receiveShadows) const;
    bool ShadowsChange(const TruthReceiver &receiver, std::span<const std::size_t> strong) const;

    const SurfaceInputs &in_;
    const std::vector<Light> &lights_;
    std::vector<bool> emits_; ///< by draw surface: whether it has an area light
};

/// Direct light of receivers, in their order.
struct DirectReference {
    std::vector<LuxelTruth> luxels;
    double cpuSeconds = 0;
    bool fromCache = false;
};
/// Computes it on all worker threads; it does not depend on their number. cache: as for MakeReference.
DirectReference MakeDirectReference(const SurfaceInputs &in, const DirectLights &lights,
                                    const std::vector<TruthReceiver> &receivers, const std::filesystem::path &cache);

} // namespace q3::bounce
