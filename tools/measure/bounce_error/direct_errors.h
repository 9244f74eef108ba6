// GPL-2.0-or-later. Error of baked direct light against brute force, and its causes.
#pragma once

#include "tools/measure/bounce_error/area_truth.h"
#include "tools/measure/bounce_error/bounce_errors.h"
#include "tools/measure/bounce_error/lit_files.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace q3::bounce {

/// What the error of a luxel is put down to: the first that applies.
enum class ErrorCause {
    CrossedLamps, ///< LuxelTruth::crossedLamps
    Contact,      ///< LuxelTruth::contact
    Penumbra,     ///< LuxelTruth::penumbra
    Seams,        ///< beside a luxel that is not mapped, or at the edge of its lightmap
    Rest
};
inline constexpr std::array<std::string_view, 5> kCauseNames{"crossed lamps", "contact", "penumbra", "seams", "rest"};

/// Baked and true direct light of a receiver.
struct ComparedDirect {
    ComparedLight light; ///< `direct` is 0, `bounced` and `traced` are baked and true direct light
    ErrorCause cause = ErrorCause::Rest;
    bool nearEdge = false; ///< LuxelTruth::nearEdge
    bool isClear = true;   ///< the truth is that at the receiver's own position, not at clear places of its luxel
};

/// Displayed errors of a setting over receivers.
struct DirectErrors {
    BounceErrors all;
    double rmseClear = 0;  ///< of receivers that are clear
    double grossShare = 0; ///< of receivers: an error over kGrossError outside two luxels of a shadow edge
    std::array<double, kCauseNames.size()> receivers{}, squares{}; ///< shares by cause: of receivers, of squared error
};
/// Of a channel. Bytes.
inline constexpr double kGrossError = 10;
DirectErrors DirectErrorsOf(std::span<const ComparedDirect> light);

/// What the truth needs of a luxel. `luxel` may be a point beside it.
TruthReceiver TruthReceiverOf(const SurfaceLight &surfaces, const LuxelReceiver &luxel);
/// The cause of errors at a luxel with this truth.
ErrorCause CauseOf(const SurfaceLight &surfaces, const LuxelReceiver &luxel, const LuxelTruth &truth);

/// A place that is asked for, and the normal there; zero: any.
struct AskedPlace {
    Vec3f position, normal;
};
/// The mapped luxel nearest to a place whose normal is within 26 degrees of the place's, clear of walls if there is
/// such a luxel within 64 units; none without luxels.
std::optional<LuxelReceiver> NearestLuxel(const SurfaceInputs &in, const SurfaceLight &surfaces, const PathScene &scene,
                                          const AskedPlace &place);
/// The luxel with the place itself as receiver, 1 unit off the surface, like luxels.
LuxelReceiver AtPlace(LuxelReceiver luxel, const AskedPlace &place);
/// Points of a lit file as luxels at these points, each with the nearest luxel of its surface's lightmap. Points on
/// surfaces without one are removed from `points`.
std::vector<LuxelReceiver> LuxelsOf(const SurfaceLight &surfaces, std::vector<LitPoint> &points);

/// The receivers with their truth, and the light of a bake, or of a lit file, at each.
std::vector<ComparedDirect> CompareDirect(const SurfaceLight &surfaces, std::span<const LuxelReceiver> luxels,
                                          std::span<const LuxelTruth> truth, std::span<const Vec3f> baked);
/// Removes the points of a lit file whose light is above kMaxComparedLight.
void RemoveTooBright(std::vector<LuxelReceiver> &luxels, std::vector<ComparedDirect> &light);
/// Light of a bake at luxels. Errors: a bake whose lightmaps differ from those of `surfaces`.
std::vector<Vec3f> LightAt(const SurfaceLight &surfaces, std::span<const LuxelReceiver> luxels,
                           const BakedLuxels &baked);

/// A line of the tables. seconds: CPU time of the bake; below 0: not known.
struct DirectRow {
    std::string map, setting;
    double seconds = -1;
    DirectErrors errors;
};
/// Markdown tables of errors and of their causes.
std::string DirectTables(std::span<const DirectRow> rows);
/// Text on a receiver: place, light, surface, cause.
std::string DirectText(const Bsp &bsp, const LuxelReceiver &luxel, const ComparedDirect &light);

} // namespace q3::bounce
