// GPL-2.0-or-later. Error of bounced light in the lightmaps of .bsp files lit by any program.
#pragma once

#include "tools/measure/bounce_error/bounce_errors.h"
#include "tools/measure/lightmap_compare/lit_map.h"

namespace q3::bounce {

/// Two lit files of the reference's map.
struct LitFiles {
    const compare::LitMap &direct; ///< without bounces
    const compare::LitMap &all;    ///< with bounces
};

/// A point of a surface that has a lightmap in both files and can be seen.
struct LitPoint {
    std::size_t surface = 0;
    compare::SurfacePoint point;
    Vec3f position; ///< 1 unit off the surface
    Vec3f normal;   ///< interpolated, unit
};

/// Points drawn uniformly by area, except where one of the files has no texel for the surface.
std::vector<LitPoint> LitPoints(const SurfaceInputs &in, const PathScene &scene, const LitFiles &files, int count,
                                std::uint64_t seed);
/// The points as receivers of a reference.
Receivers ReceiversOf(const std::vector<LitPoint> &points);

/// Points where a channel of either file is above this are not compared: programs scale bright colors down in different
/// ways. Bytes.
inline constexpr double kMaxComparedLight = 250;
/// Light of the files at the other points, filtered as in engines, with that of the reference for kBounceLimits[limit]
/// bounces. Bytes.
std::vector<ComparedLight> CompareLit(const std::vector<LitPoint> &points, const Reference &reference,
                                      std::size_t limit, const LitFiles &files);

} // namespace q3::bounce
