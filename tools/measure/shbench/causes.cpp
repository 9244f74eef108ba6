// GPL-2.0-or-later. Why a grid is wrong at a position.
#include "tools/measure/shbench/causes.h"

#include "tools/measure/shbench/cell_sight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::bench {

namespace {

constexpr double kFloorShare = 0.7;                         ///< of the error: above it, the projection is the cause
constexpr double kCauseShare = 0.5;                         ///< of the grid error, which a cause must exceed
constexpr double kNearCells = 2;                            ///< lights within this distance are near
constexpr double kLeftOutShare = 0.05;                      ///< of the grid error: sum of the faintest lights left out
constexpr double kManyRaysAbove = 1, kSomeRaysAbove = 0.25; ///< area lights above this get more rays, bytes
constexpr int kManyRays = 16, kSomeRays = 4;

constexpr std::array<std::string_view, kCauses> kNames = {"L2 limit", "shadow edge between points", "near light", "wall",
                                                          "interpolation"};

/// Change of the nine SH coefficients, 1.0 = byte 255.
using Change = std::array<Vec3d, 9>;

/// A light that matters at the position or beside it.
struct Candidate {
    const Light *light;
    bool isNear = false; ///< within kNearCells of the position
    SHVector here{};     ///< at the position without shadows, for color 1 1 1
    Vec3d color;         ///< with sign, times scale, 1.0 = byte 255
    double strength = 0; ///< RMS over directions, bytes; of near lights the largest over position and corners
};

/// RMS over all directions of a sum over the basis.
double RmsOf(const SHVector &c) {
    double sum = 0;
    for (const double value : c)
        sum += value * value;
    return std::sqrt(sum / (4 * std::numbers::pi));
}

/// Displayed RMS difference that a change of the projection makes at the position. Bytes.
double ShownChange(const TruthPoint &point, const Change &change) {
    TruthPoint changed = point;
    for (std::size_t k = 0; k < 9; ++k)
        changed.projection[k] += Vec3f(change[k]);
    return ErrorsAt(point, ProjectedLight(changed), ProjectedLight(point)).grid;
}

/// Lights with any effect, strongest first, without the faintest.
std::vector<Candidate> LightsThatMatter(const BenchMap &map, const CellSight &sight, const Vec3f &cell,
                                        double gridError) {
    const double scale = double(map.options.PositiveGridScale()) / 255;
    const Vec3f &position = sight.Receivers()[CellSight::kSelf];
    std::vector<Candidate> all;
    for (const Light &light : map.lights) {
        if (map.options.sunOnly && light.type != LightType::Sun)
            continue;
        Candidate one{&light, CellsToLight(light, position, cell) < kNearCells, UnshadowedLight(light, Vec3d(position)),
                      Vec3d(light.color) * scale};
        double strongest = RmsOf(one.here);
        for (std::size_t corner = 0; one.isNear && corner < CellSight::kCorners; ++corner)
            strongest = std::max(strongest, RmsOf(UnshadowedLight(light, Vec3d(sight.Receivers()[corner]))));
        one.strength = 255 * strongest * MaxComponent(one.color);
        one.color = one.color * (light.negative ? -1.0 : 1.0);
        if (one.strength > 0)
            all.push_back(one);
    }
    std::stable_sort(all.begin(), all.end(), [](const auto &a, const auto &b) { return a.strength > b.strength; });
    double allowance = kLeftOutShare * gridError;
    while (!all.empty() && all.back().strength <= allowance) {
        allowance -= all.back().strength;
        all.pop_back();
    }
    return all;
}

/// Blend of the corners minus the light at the position. A light that gives h at the position and c at a corner without
/// shadows, with visible shares s and t, adds t c - s h = (t - s) h + t (c - h).
struct CellChanges {
    Change shadows{};  ///< the first term
    Change nearness{}; ///< the second term, of near lights
};

void AddChanges(const Candidate &one, const CellSight &sight, CellChanges &changes) {
    const int samples = one.strength > kManyRaysAbove ? kManyRays : one.strength > kSomeRaysAbove ? kSomeRays : 1;
    const CellSight::Shares shares = sight.Seen(*one.light, samples);
    for (std::size_t corner = 0; corner < CellSight::kCorners; ++corner) {
        const double weight = sight.Weights()[corner];
        if (weight == 0)
            continue;
        const Vec3d seen = one.color * shares[corner] * weight,
                    missed = one.color * (shares[corner] - shares[CellSight::kSelf]) * weight;
        for (std::size_t k = 0; k < 9; ++k)
            changes.shadows[k] += missed * one.here[k];
        if (!one.isNear)
            continue;
        const SHVector there = UnshadowedLight(*one.light, Vec3d(sight.Receivers()[corner]));
        for (std::size_t k = 0; k < 9; ++k)
            changes.nearness[k] += seen * (there[k] - one.here[k]);
    }
}

} // namespace

std::string_view NameOf(Cause cause) {
    return kNames[std::size_t(cause)];
}

Cause FindCause(const BenchMap &map, const GridLayout &layout, const TruthPoint &point, const PositionErrors &errors) {
    if (errors.floor > kFloorShare * errors.shown)
        return Cause::Floor;
    const CellSight sight(map, layout, point.position);
    const auto &weights = sight.Weights();
    if (std::any_of(weights.begin(), weights.end(), [](double weight) { return weight > 0; })) {
        const Vec3f cell{layout.size[0], layout.size[1], layout.size[2]};
        CellChanges changes;
        for (const Candidate &one : LightsThatMatter(map, sight, cell, errors.grid))
            AddChanges(one, sight, changes);
        if (ShownChange(point, changes.shadows) > kCauseShare * errors.grid)
            return Cause::ShadowEdge;
        if (ShownChange(point, changes.nearness) > kCauseShare * errors.grid)
            return Cause::NearLight;
    }
    return sight.AnyHidden() ? Cause::Wall : Cause::Interpolation;
}

std::vector<Cause> FindCauses(const BenchMap &map, const GridLayout &layout, const Truth &truth,
                              std::span<const PositionErrors> errors, const JobPool &jobs) {
    std::vector<Cause> causes(truth.points.size());
    jobs.For(std::int64_t(causes.size()), [&](std::int64_t i, int) {
        causes[std::size_t(i)] = FindCause(map, layout, truth.points[std::size_t(i)], errors[std::size_t(i)]);
    });
    return causes;
}

std::array<CauseShare, kCauses> SharesByCause(std::span<const Cause> causes, std::span<const PositionErrors> errors) {
    std::array<CauseShare, kCauses> shares{};
    double sum = 0;
    for (std::size_t i = 0; i < causes.size(); ++i) {
        const double squared = errors[i].grid * errors[i].grid;
        shares[std::size_t(causes[i])].positions += 1;
        shares[std::size_t(causes[i])].error += squared;
        sum += squared;
    }
    for (CauseShare &share : shares) {
        share.positions /= std::max(1.0, double(causes.size()));
        share.error = sum > 0 ? share.error / sum : 0;
    }
    return shares;
}

} // namespace q3::bench
