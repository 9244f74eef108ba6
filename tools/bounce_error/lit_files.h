// GPL-2.0-or-later. Bounced light in the lightmaps of lit files, of any program, against the reference.
#pragma once

#include "tools/bounce_error/bounce_errors.h"
#include "tools/lightmap_compare/lit_map.h"

namespace q3::bounce {

/// Two lit files of the map that the reference is of.
struct LitFiles {
    const compare::LitMap &direct; ///< without bounces
    const compare::LitMap &all;    ///< with bounces
};

/// A point of a surface that has a lightmap in both files and can be seen.
struct LitPoint {
    std::size_t surface = 0;
    compare::SurfacePoint point;
    Vec3f position, normal; ///< a unit off the surface
};

/// Points by area, none where a texel holds no light of its surface.
std::vector<LitPoint> LitPoints(const SurfaceInputs &in, const PathScene &scene, const LitFiles &files, int count,
                                std::uint64_t seed);
/// As the receivers of a reference.
Receivers ReceiversOf(const std::vector<LitPoint> &points);

/// Light of the files at the points, blended as engines do, against entry `limit` of the reference. Bytes; points where
/// a byte of either file is over kMostLit are left out: programs scale bright colors down in different ways.
inline constexpr double kMostLit = 250;
std::vector<ComparedLight> CompareLit(const std::vector<LitPoint> &points, const Reference &reference,
                                      std::size_t limit, const LitFiles &files);

} // namespace q3::bounce
