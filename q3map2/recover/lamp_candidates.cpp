// GPL-2.0-or-later. Where lamps may be: places whose light would explain much of what is not explained yet.
#include "q3map2/recover/lamp_candidates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace q3 {

namespace {

/// Intensity as which a candidate is traced.
constexpr float kCandidateIntensity = 150;
/// Spacing of candidates in the open; game units. It grows by kCoarser until there are at most kMostCandidates places,
/// which bounds the memory of large maps.
constexpr float kLattice = 64, kCoarser = 1.25f;
constexpr std::int64_t kMostCandidates = 1 << 18;
/// Candidates are traced to each so many batches of places, or to fewer so that there are about kMostPairs pairs of
/// candidates and places at most, which take 8 bytes each. Each candidate in kSample serves to estimate their number.
constexpr std::size_t kEvery = 6, kSample = 61;
constexpr double kMostPairs = 2e8;
/// Clearance of candidates in the open from solids. Game units.
constexpr float kClear = 4;
/// New lamps are at least this far from each other. Game units.
constexpr float kApart = 96;
/// Of the candidates with the greatest gain, so many are tried as spotlights too. A cone must multiply the gain.
constexpr std::size_t kTriedCones = 128;
constexpr double kConeGain = 1.5;

} // namespace

// ---- Cones ----

ConeSample ConeSampleOf(const Vec3f &origin, const ObservedMap &map, const LampFit &fit, const LampEntry &entry,
                        const Vec3f &residual) {
    return {Normalize(map.positions[entry.place] - origin), entry.light, fit.WeightOf(entry.place), residual};
}

std::optional<ConeGuess> GuessCone(std::vector<ConeSample> samples) {
    constexpr int kPasses = 3;
    constexpr std::size_t kFewest = 12;    // samples in a cone
    constexpr float kLeastCosine = 0.174f; // 80 degrees
    constexpr double kExplained = 0.85;    // share of the squares of residuals in the cone
    ConeGuess best;
    Vec3f axis;
    const auto pull = [](const ConeSample &one) {
        const Vec3f r = Max(one.residual, Vec3f{});
        return one.direction * (one.weight * one.light * (r.x + r.y + r.z));
    };
    for (const ConeSample &one : samples)
        axis += pull(one);
    for (int pass = 0; pass < kPasses && axis != Vec3f{}; ++pass) {
        axis = Normalize(axis);
        std::ranges::stable_sort(samples, std::greater(),
                                 [&](const ConeSample &one) { return Dot(one.direction, axis); });
        Vec3f b, inside, bestInside;
        double a = 0, gain = 0, squares = 0, bestGain = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const ConeSample &one = samples[i];
            b += one.residual * (one.weight * one.light);
            a += double(one.weight * one.light) * double(one.light);
            squares += double(one.weight) * double(Dot(one.residual, one.residual));
            inside += pull(one);
            const Vec3f positive = Max(b, Vec3f{});
            gain = a > 0 ? double(Dot(positive, positive)) / a : 0;
            const float cosine = Dot(one.direction, axis);
            if (i + 1 < kFewest || cosine < kLeastCosine || gain <= bestGain)
                continue;
            bestGain = gain, bestInside = inside;
            if (gain > best.gain && gain > kExplained * squares) {
                const float tangent = std::sqrt(std::max(0.0f, 1 - cosine * cosine)) / cosine;
                best.gain = gain;
                best.cone = {axis, std::max(tangent, kLeastRadiusByDist)};
                best.intensity = positive * float(1 / a);
            }
        }
        best.gainOfAll = gain;
        axis = bestInside;
    }
    return best.gain > 0 ? std::optional(best) : std::nullopt;
}

// ---- Candidates ----

LampCandidates::LampCandidates(const ObservedMap &map, const LightSetup &setup, const LampTracer &tracer,
                               const JobPool &jobs, Log &log)
    : map_(map), setup_(setup), tracer_(tracer), jobs_(jobs), every_(kEvery), fixed_(Lattice()) {
    log.Count(fixed_.size(), "candidates in the open");
    std::vector<Candidate> crossings = Crossings();
    log.Count(crossings.size(), "places where directions of the light grid meet");
    std::ranges::move(crossings, std::back_inserter(fixed_));
    std::vector<Candidate> sample;
    for (std::size_t i = 0; i < fixed_.size(); i += kSample)
        sample.push_back(fixed_[i]);
    Trace(sample);
    double expected = 0;
    for (const Candidate &one : sample)
        expected += double(one.column.size() * kSample);
    every_ = kEvery * std::size_t(std::max(1.0, std::ceil(expected / kMostPairs)));
    Trace(fixed_);
    std::size_t pairs = 0;
    for (const Candidate &one : fixed_)
        pairs += one.column.size();
    log.Count(pairs, "pairs of these that see each other");
}

void LampCandidates::Trace(std::vector<Candidate> &candidates) const {
    jobs_.For(std::int64_t(candidates.size()), [&](std::int64_t i, int) {
        Candidate &one = candidates[std::size_t(i)];
        one.column = tracer_.Trace({one.origin, Vec3f{1, 1, 1} * kCandidateIntensity}, every_);
        one.column.shrink_to_fit();
    });
}

std::vector<LampCandidates::Candidate> LampCandidates::Lattice() const {
    const bspModel_t &world = setup_.bsp.models.front();
    float spacing = kLattice;
    GridLayout layout = LayoutGrid(world.mins, world.maxs, {spacing, spacing, spacing});
    while (layout.Count() > kMostCandidates) {
        spacing *= kCoarser;
        layout = LayoutGrid(world.mins, world.maxs, {spacing, spacing, spacing});
    }
    const Vec3f off{spacing / 2, spacing / 2, spacing / 2}; // brushes often lie on multiples of 64
    std::vector<Candidate> candidates;
    for (std::int64_t i = 0; i < layout.Count(); ++i) {
        const Int3 at = layout.Coordinates(i);
        if (const Vec3f p = Vec3f(layout.Position(at[0], at[1], at[2])) - off;
            setup_.space.ClusterAt(p, kClear) != kSolidCluster)
            candidates.push_back({p, {}});
    }
    return candidates;
}

/// Where rays of neighboring grid points along their directions pass each other: the mean of such places in cells that
/// hold several.
std::vector<LampCandidates::Candidate> LampCandidates::Crossings() const {
    constexpr float kFarthest = 1024, kGap = 16, kCell = 32; // game units
    constexpr float kLeastAngle = 0.05f;                     // sine of the angle between two rays
    constexpr int kFewest = 3;                               // in a cell
    constexpr std::size_t kMost = 8192;
    std::map<std::uint32_t, std::size_t> placeOf; // by number in the .bsp
    for (std::size_t i = 0; i < map_.gridNumbers.size(); ++i)
        placeOf.emplace(map_.gridNumbers[i], map_.firstGrid + i);
    struct Cell {
        Vec3f sum;
        int count = 0;
    };
    std::map<std::array<int, 3>, Cell> cells;
    const auto cross = [&](std::size_t i, std::size_t j) {
        const Vec3f &p = map_.positions[i], &q = map_.positions[j], &d = map_.normals[i], &e = map_.normals[j];
        const Vec3f w = p - q;
        const float along = Dot(d, e), sine2 = 1 - along * along;
        if (sine2 < kLeastAngle * kLeastAngle)
            return;
        const float s = (along * Dot(e, w) - Dot(d, w)) / sine2, t = (Dot(e, w) - along * Dot(d, w)) / sine2;
        const Vec3f a = p + d * s, b = q + e * t, middle = (a + b) * 0.5f;
        if (s <= 0 || t <= 0 || s > kFarthest || t > kFarthest || Length(a - b) > kGap)
            return;
        Cell &cell = cells[{int(std::floor(middle.x / kCell)), int(std::floor(middle.y / kCell)),
                            int(std::floor(middle.z / kCell))}];
        cell.sum += middle, ++cell.count;
    };
    for (const auto &[number, place] : placeOf) {
        const Int3 at = setup_.layout.Coordinates(number);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Int3 next = at;
            if (++next[axis] >= setup_.layout.bounds[axis])
                continue;
            const auto other = placeOf.find(std::uint32_t(setup_.layout.Index(next[0], next[1], next[2])));
            if (other != placeOf.end())
                cross(place, other->second);
        }
    }
    std::vector<std::pair<int, Vec3f>> found;
    for (const auto &[at, cell] : cells)
        if (cell.count >= kFewest)
            found.push_back({cell.count, cell.sum / float(cell.count)});
    std::ranges::stable_sort(found, std::greater(), &std::pair<int, Vec3f>::first);
    std::vector<Candidate> candidates;
    for (const auto &[count, p] : found)
        if (candidates.size() < kMost && setup_.space.ClusterAt(p, 1) != kSolidCluster)
            candidates.push_back({p, {}});
    return candidates;
}

/// Candidates in front of the places that are lighter than explained by most, along their normals.
std::vector<LampCandidates::Candidate> LampCandidates::InFrontOfPeaks(const LampFit &fit) const {
    constexpr std::size_t kMost = 96;
    constexpr float kPeaksApart = 64, kLeastPeak = 4; // game units; byte scale
    constexpr std::array kHeights{12.0f, 32.0f, 72.0f};
    std::vector<std::pair<float, std::size_t>> peaks;
    for (std::size_t i = 0; i < map_.firstGrid; ++i)
        if (const Vec3f r = fit.EffectiveResidual(i); r.x + r.y + r.z > 3 * kLeastPeak)
            peaks.push_back({Dot(r, r) * fit.WeightOf(i), i});
    std::ranges::stable_sort(peaks, std::greater(), &std::pair<float, std::size_t>::first);
    std::vector<std::size_t> chosen;
    for (const auto &[strength, place] : peaks) {
        if (chosen.size() == kMost)
            break;
        if (std::ranges::all_of(chosen, [&, place = place](std::size_t other) {
                return Length(map_.positions[other] - map_.positions[place]) > kPeaksApart;
            }))
            chosen.push_back(place);
    }
    std::vector<Candidate> candidates;
    for (const std::size_t place : chosen)
        for (const float height : kHeights)
            if (const Vec3f p = map_.positions[place] + map_.normals[place] * height;
                setup_.space.ClusterAt(p, 1) != kSolidCluster)
                candidates.push_back({p, {}});
    Trace(candidates);
    return candidates;
}

void LampCandidates::AddGains(const LampFit &fit, const std::vector<Candidate> &candidates,
                              std::vector<Gain> &gains) const {
    const std::size_t first = gains.size();
    gains.resize(first + candidates.size());
    jobs_.For(std::int64_t(candidates.size()), [&](std::int64_t i, int) {
        const Candidate &candidate = candidates[std::size_t(i)];
        Gain &one = gains[first + std::size_t(i)];
        const LampFit::Slope slope = fit.SlopeOf(candidate.column);
        if (!(slope.a > 0))
            return;
        one.lamp = {candidate.origin, Max(slope.b * (1 / slope.a), Vec3f{})};
        one.gain = double(Dot(one.lamp.intensity, one.lamp.intensity)) * double(slope.a);
        one.noise = double(slope.noise);
        one.at = &candidate;
    });
}

std::vector<Lamp> LampCandidates::Best(const LampFit &fit, std::size_t most, double leastGain) const {
    std::vector<Gain> gains;
    const std::vector<Candidate> inFront = InFrontOfPeaks(fit);
    AddGains(fit, fixed_, gains);
    AddGains(fit, inFront, gains);
    std::ranges::stable_sort(gains, std::greater(), &Gain::gain);
    jobs_.For(std::int64_t(std::min(gains.size(), kTriedCones)), [&](std::int64_t i, int) {
        Gain &one = gains[std::size_t(i)];
        if (!(one.gain > 0))
            return;
        std::vector<ConeSample> samples;
        for (const LampEntry &entry : one.at->column)
            samples.push_back(ConeSampleOf(one.at->origin, map_, fit, entry, fit.EffectiveResidual(entry.place)));
        if (const auto guess = GuessCone(std::move(samples)); guess && guess->gain > kConeGain * guess->gainOfAll) {
            one.gain = guess->gain;
            one.lamp = {one.at->origin, guess->intensity, guess->cone};
        }
    });
    std::ranges::stable_sort(gains, std::greater(), &Gain::gain);
    std::vector<Lamp> best;
    for (const Gain &one : gains) {
        if (best.size() == most)
            break;
        if (one.gain > leastGain * one.noise && std::ranges::all_of(best, [&](const Lamp &other) {
                return Length(other.origin - one.lamp.origin) > kApart;
            }))
            best.push_back(one.lamp);
    }
    return best;
}

} // namespace q3
