// GPL-2.0-or-later. The lamps of a lit map whose light entities are gone, from the light that it stores.
#include "q3map2/recover/recover_lights.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace q3 {

namespace {

/// Intensity as which a candidate is traced.
constexpr float kCandidateIntensity = 150;
/// Spacing of candidates in the open; game units. It grows by kCoarser until there are at most kMostCandidates places,
/// which bounds the memory of large maps.
constexpr float kLattice = 64, kCoarser = 1.25f;
constexpr std::int64_t kMostCandidates = 1 << 18;
/// Most rounds with one relative noise.
constexpr int kMostRounds = 24;
/// Candidates are traced to each so many batches of places.
constexpr std::size_t kCandidateEvery = 6;
/// Clearance of candidates in the open from solids. Game units.
constexpr float kClear = 4;
/// New lamps are at least this far from each other. Game units.
constexpr float kApart = 96;
/// A new lamp lowers the error by at least this share of it, and one that stays by at least kLeastKept.
constexpr double kLeastGain = 2e-4, kLeastKept = 6e-4;
/// Both lower it by at least this, in squares of the noise of a place: less may be rounding of bytes.
constexpr double kSignificant = 60;
/// Relative noise of light, first while many lamps are missing, then to tell apart those near each other.
constexpr std::array kRelativeNoises{0.06f, 0.02f};
/// Lamps nearer to each other than this become one. Game units.
constexpr float kTwins = 24;
/// Of the lamps that are dropped together, no two are nearer to each other. Game units.
constexpr float kDroppedApart = 256;

struct Candidate {
    Vec3f origin;
    LampColumn column;
};

class Recovery {
  public:
    Recovery(const ObservedMap &map, const LightSetup &setup, const JobPool &jobs, Log &log)
        : map_(map), setup_(setup), jobs_(jobs), log_(log), tracer_(map, setup), fit_(map, tracer_, jobs) {}

    RecoveredLights Run() {
        RecoveredLights result;
        result.rmsBefore = fit_.RmsOfLuxels();
        lattice_ = Lattice();
        std::size_t pairs = 0;
        for (const Candidate &one : lattice_)
            pairs += one.column.size();
        log_.Count(map_.light.size(), "places with stored light");
        log_.Count(lattice_.size(), "candidates in the open");
        log_.Count(pairs, "pairs of these that see each other");
        for (const float noise : kRelativeNoises) {
            fit_.SetRelativeNoise(noise);
            for (int round = 0; round < kMostRounds && AddLamps(round); ++round) {
            }
        }
        DropLamps();
        for (const float step : {32.0f, 16.0f, 8.0f, 4.0f, 2.0f, 1.0f, 0.5f}) {
            fit_.Search(step);
            Move(3);
        }
        result.rmsAfter = fit_.RmsOfLuxels();
        result.lamps = fit_.Lamps();
        std::ranges::stable_sort(result.lamps, std::greater(), &Lamp::Strength);
        return result;
    }

  private:
    void Trace(std::vector<Candidate> &candidates) const {
        jobs_.For(std::int64_t(candidates.size()), [&](std::int64_t i, int) {
            Candidate &one = candidates[std::size_t(i)];
            one.column = tracer_.Trace({one.origin, Vec3f{1, 1, 1} * kCandidateIntensity}, kCandidateEvery);
            one.column.shrink_to_fit();
        });
    }

    std::vector<Candidate> Lattice() const {
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
        Trace(candidates);
        return candidates;
    }

    /// Candidates in front of the places whose light is least explained, along their normals.
    std::vector<Candidate> SurfaceCandidates() const {
        constexpr std::size_t kMost = 96;
        constexpr float kPeaksApart = 64, kLeastPeak = 4; // game units; byte scale
        constexpr std::array kHeights{12.0f, 32.0f, 72.0f};
        std::vector<std::pair<float, std::size_t>> peaks;
        for (std::size_t i = 0; i < map_.firstGrid; ++i)
            if (const Vec3f r = fit_.EffectiveResidual(i); r.x + r.y + r.z > 3 * kLeastPeak)
                peaks.push_back({(r.x + r.y + r.z) * fit_.WeightOf(i), i});
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

    /// The best lamp at a candidate, and by how much it lowers the error.
    struct Gain {
        double gain = 0;
        Lamp lamp;
    };
    void AddGains(const std::vector<Candidate> &candidates, std::vector<Gain> &gains) const {
        const std::size_t first = gains.size();
        gains.resize(first + candidates.size());
        jobs_.For(std::int64_t(candidates.size()), [&](std::int64_t i, int) {
            const Candidate &candidate = candidates[std::size_t(i)];
            Gain &one = gains[first + std::size_t(i)];
            const auto [b, a] = fit_.SlopeOf(candidate.column);
            if (!(a > 0))
                return;
            one.lamp = {candidate.origin, Max(b * (1 / a), Vec3f{})};
            one.gain = double(Dot(one.lamp.intensity, one.lamp.intensity)) * double(a);
        });
    }

    double LeastGain(double share) const { return std::max(kSignificant, share * fit_.Error()); }

    /// A round: adds the lamps that lower the error most, and fits all. Returns whether there may be more.
    bool AddLamps(int round) {
        constexpr int kFewRounds = 5;         // that may not lower the error
        constexpr double kEnough = 0.99;      // factor of the error
        constexpr std::size_t kFewLamps = 64; // of which more steps cost little
        const double before = fit_.Error();
        std::vector<Gain> gains;
        AddGains(lattice_, gains);
        AddGains(SurfaceCandidates(), gains);
        std::ranges::stable_sort(gains, std::greater(), &Gain::gain);
        std::vector<Lamp> added;
        const double least = LeastGain(kLeastGain);
        for (const Gain &one : gains) {
            if (added.size() > fit_.Lamps().size() / 2 || one.gain <= least)
                break;
            if (std::ranges::all_of(added,
                                    [&](const Lamp &other) { return Length(other.origin - one.lamp.origin) > kApart; }))
                added.push_back(one.lamp);
        }
        if (added.empty())
            return false;
        fit_.Add(added);
        fit_.SolveIntensities(20);
        Move(fit_.Lamps().size() < kFewLamps ? 10 : 5);
        fit_.Merge(kTwins);
        fit_.SolveIntensities(10);
        fit_.Prune(LeastGain(kLeastGain));
        fit_.SolveIntensities(10);
        log_.Print("{:9} lamps, light on luxels within {:.2f} bytes RMS\n", fit_.Lamps().size(), fit_.RmsOfLuxels());
        return fit_.Error() < kEnough * before || round < kFewRounds;
    }

    /// Drops lamps that others can replace, until each is needed.
    void DropLamps() {
        constexpr int kMostPasses = 8;
        for (int pass = 0; pass < kMostPasses && fit_.DropRedundant(LeastGain(kLeastKept), kDroppedApart) > 0; ++pass) {
            fit_.SolveIntensities(20);
            Move(8);
        }
    }

    void Move(int steps) {
        for (int step = 0; step < steps; ++step) {
            fit_.MoveLamps();
            fit_.SolveIntensities(6);
        }
    }

    const ObservedMap &map_;
    const LightSetup &setup_;
    const JobPool &jobs_;
    Log &log_;
    LampTracer tracer_;
    LampFit fit_;
    std::vector<Candidate> lattice_;
};

} // namespace

RecoveredLights RecoverLights(const ObservedMap &map, const LightSetup &setup, const JobPool &jobs, Log &log) {
    return Recovery(map, setup, jobs, log).Run();
}

} // namespace q3
