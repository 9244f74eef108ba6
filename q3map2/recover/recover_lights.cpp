// GPL-2.0-or-later. The lamps of a lit map whose light entities are gone, from the light that it stores.
#include "q3map2/recover/recover_lights.h"

#include "common/error.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/recover/lamp_candidates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>

namespace q3 {

namespace {

/// Most rounds with one relative noise.
constexpr int kMostRounds = 24;
/// A new lamp lowers the error by more than kLeastGain times the noise where it shines, in squares of the noise of a
/// place and channel; one that stays by kLeastKept times.
constexpr double kLeastGain = 20, kLeastKept = 200;
/// A cone must lower the error by this much more than a lamp that shines to all sides.
constexpr double kLeastGainOfCone = 1000;
/// Relative noise of light, first while many lamps are missing, then to tell apart those near each other.
constexpr std::array kRelativeNoises{0.06f, 0.02f};
/// The same for the last short steps.
constexpr float kFineNoise = 0.007f;
/// How often factors of known sources are found, at most: bounced light follows them.
constexpr int kSourcePasses = 2;
/// Lamps nearer to each other than this become one. Game units.
constexpr float kTwins = 24;
/// Of the lamps that are dropped together, no two are nearer to each other. Game units.
constexpr float kDroppedApart = 256;

/// Weaker lamps are left out: they light nothing, and light entities of intensity 0 count as 300.
constexpr float kFaintest = 0.1f;

/// One search for lamps.
class Recovery {
  public:
    Recovery(const ObservedMap &map, const LampTracer &tracer, const LampCandidates &candidates, const JobPool &jobs,
             Log &log)
        : map_(map), candidates_(candidates), log_(log), fit_(map, tracer, jobs) {}

    /// Adds lamps for the first relative noise: enough for their bounced light.
    void RunRoughly() { AddAll(kRelativeNoises.front()); }

    /// Finds and fits all lamps.
    void Run() {
        for (const float noise : kRelativeNoises)
            AddAll(noise);
        FindCones();
        DropLamps();
        Settle();
    }

    /// Fits lamps that were found once more, after what is known has changed.
    void Refine(std::span<const Lamp> lamps) {
        fit_.SetRelativeNoise(kRelativeNoises.back());
        fit_.Add(lamps);
        fit_.SolveIntensities(20);
        Move(8);
        DropLamps();
        Settle();
    }

    const LampFit &Fit() const { return fit_; }

  private:
    /// Moves lamps by ever shorter steps.
    void Settle() {
        constexpr float kFine = 4;
        for (const float step : {32.0f, 16.0f, 8.0f, kFine, 2.0f, 1.0f, 0.5f}) {
            if (step == kFine)
                fit_.SetRelativeNoise(kFineNoise);
            fit_.Search(step);
            Move(3);
            if (step == 8)
                FindCones();
        }
        DropCones();
        Move(3);
    }

    void AddAll(float noise) {
        fit_.SetRelativeNoise(noise);
        for (int round = 0; round < kMostRounds && AddLamps(round); ++round) {
        }
    }

    /// A round: adds the lamps that lower the error most, and fits all. Returns whether there may be more.
    bool AddLamps(int round) {
        constexpr int kFewRounds = 5;         // that may not lower the error
        constexpr double kEnough = 0.99;      // factor of the error
        constexpr std::size_t kFewLamps = 64; // of which more steps cost little
        const double before = fit_.Error();
        const std::vector<Lamp> added = candidates_.Best(fit_, 1 + fit_.Lamps().size() / 2, kLeastGain);
        if (added.empty())
            return false;
        fit_.Add(added);
        fit_.SolveIntensities(20);
        Move(fit_.Lamps().size() < kFewLamps ? 10 : 5);
        fit_.Merge(kTwins);
        fit_.SolveIntensities(10);
        fit_.Prune(kLeastGain);
        fit_.SolveIntensities(10);
        log_.Print("{:9} lamps, light on surfaces within {:.2f} bytes RMS\n", fit_.Lamps().size(),
                   fit_.RmsOfSurfaces());
        return fit_.Error() < kEnough * before || round < kFewRounds;
    }

    /// Drops lamps that others can replace, until each is needed.
    void DropLamps() {
        constexpr int kMostPasses = 20;
        for (int pass = 0; pass < kMostPasses && fit_.DropRedundant(kLeastKept, kDroppedApart) > 0; ++pass) {
            fit_.SolveIntensities(20);
            Move(3);
        }
    }

    /// Gives cones to the lamps that explain their surroundings better with one.
    void FindCones() {
        for (std::size_t j = 0; j < fit_.Lamps().size(); ++j) {
            const Lamp lamp = fit_.Lamps()[j];
            if (lamp.cone)
                continue;
            std::vector<ConeSample> samples;
            for (const LampEntry &entry : fit_.ColumnOf(j))
                samples.push_back(ConeSampleOf(lamp.origin, map_, fit_, entry, fit_.ResidualWithout(j, entry)));
            const auto guess = GuessCone(std::move(samples));
            const double noise = double(fit_.SlopeOf(fit_.ColumnOf(j)).noise);
            if (guess && guess->gain > guess->gainOfAll + kLeastGainOfCone * noise)
                fit_.Replace(j, {lamp.origin, guess->intensity, guess->cone}, kLeastGainOfCone);
        }
        fit_.SolveIntensities(10);
    }

    /// Takes cones away that explain little.
    void DropCones() {
        for (std::size_t j = 0; j < fit_.Lamps().size(); ++j)
            if (const Lamp &lamp = fit_.Lamps()[j]; lamp.cone)
                fit_.Replace(j, {lamp.origin, lamp.intensity}, -kLeastGainOfCone);
        fit_.SolveIntensities(10);
    }

    void Move(int steps) {
        for (int step = 0; step < steps; ++step) {
            fit_.MoveLamps();
            fit_.SolveIntensities(6);
        }
    }

    const ObservedMap &map_;
    const LampCandidates &candidates_;
    Log &log_;
    LampFit fit_;
};

void TakeResult(const LampFit &fit, RecoveredLights &result) {
    const std::vector<LampFit::Spread> spreads = fit.Spreads();
    std::vector<std::size_t> order(fit.Lamps().size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t j) { return fit.Lamps()[j].Strength(); });
    result.lamps.clear(), result.spreads.clear();
    for (const std::size_t j : order)
        if (fit.Lamps()[j].Intensity() >= kFaintest)
            result.lamps.push_back(fit.Lamps()[j]), result.spreads.push_back(spreads[j]);
    result.rmsAfter = fit.RmsOfSurfaces();
}

/// Adds to what is known, `known` by place, the bounced light of lamps: what the relit map has besides known light and
/// the direct light of the lamps. Lamps that were found without their bounced light are too strong, so it counts by the
/// factor which scales their direct and bounced light to what is stored, by least squares.
void AddBounced(const RelitMap &relit, const std::vector<Lamp> &lamps, const std::vector<Vec3f> &known,
                const LampTracer &tracer, ObservedMap &map) {
    std::vector<Vec3f> bounced(map.light.size());
    double product = 0, square = 0;
    for (std::size_t i = 0; i < map.light.size(); ++i) {
        const ObservedLight &light = map.light[i];
        const Vec3f ofLamps = relit.light[i] - known[i];
        bounced[i] = ofLamps;
        if (light.as != StoredAs::Value || i >= map.firstGrid)
            continue;
        const double weight = 1 / (1 + double(Dot(light.stored, light.stored)));
        product += weight * double(Dot(ofLamps, light.stored - known[i]));
        square += weight * double(Dot(ofLamps, ofLamps));
    }
    const float factor = square > 0 ? float(std::clamp(product / square, 0.0, 1.0)) : 0;
    for (const Lamp &lamp : lamps)
        for (const auto &[place, light] : tracer.Trace(lamp))
            bounced[place] -= lamp.intensity * light;
    for (std::size_t i = 0; i < map.light.size(); ++i)
        map.light[i].known = known[i] + Max(bounced[i], Vec3f{}) * factor;
}

/// Lights the map by what is known, and reads the light that it stores.
std::unique_ptr<const LightSetup> Observe(const RecoverInputs &in, ObservedMap &map) {
    auto setup = std::make_unique<const LightSetup>(in.bsp, in.inputs, in.options, SurfaceDefaultsOf(in.lightmap),
                                                    in.library, in.log);
    in.library.ReleaseImages(in.images, in.jobs);
    SurfacePasses passes(*setup, in.lightmap, in.jobs, in.log, {.keepLuxels = true});
    passes.Run();
    GridStats stats;
    std::vector<bspGridPoint_t> grid;
    if (in.readsGrid)
        grid = LightLegacyGrid(*setup, passes.ForGrids(), in.jobs, in.log, stats);
    map = ObserveLight(in.bsp, *setup, passes, grid);
    return setup;
}

/// Sets factors of the light that shaders emit. Returns whether any is new.
bool SetFactors(const RecoverInputs &in, const LightSetup &setup, const ObservedMap &map, TexLights &texLights) {
    bool anyNew = false;
    for (const KnownSource &source : FitKnownSources(map, setup, in.lightmap, in.jobs)) {
        if (source.factor == 1)
            continue;
        const float factor = texLights.ScaleOf(source.shader) * source.factor;
        in.log.Print("{}: {:.2f} of the light of its script\n", source.shader, factor);
        texLights.SetScale(source.shader, factor);
        anyNew = true;
    }
    return anyNew;
}

} // namespace

RecoveredLights RecoverLights(const RecoverInputs &given) {
    LightInputs inputs = given.inputs;
    inputs.mapEntities.reset();
    const RecoverInputs in{given.bsp,    inputs,     given.options, given.lightmap, given.library,
                           given.images, given.jobs, given.log,     given.readsGrid};
    RecoveredLights result;
    std::unique_ptr<const LightSetup> known = Observe(in, result.map);
    for (int pass = 0; pass < kSourcePasses && SetFactors(in, *known, result.map, inputs.texLights); ++pass)
        known = Observe(in, result.map);
    const LightSetup &setup = *known;
    if (result.map.firstGrid == 0)
        throw Error("{}: none of its lightmaps can be read, so no lamps can be found", given.inputs.name);
    result.sources = inputs.texLights;
    const LampTracer tracer(result.map, setup, in.lightmap.fastPoint);
    in.log.Section("Lamps");
    in.log.Count(result.map.light.size(), "places with stored light");
    const LampCandidates candidates(result.map, setup, tracer, in.jobs, in.log);
    result.rmsBefore = LampFit(result.map, tracer, in.jobs).RmsOfSurfaces();
    const auto search = [&](const auto &run) {
        Recovery recovery(result.map, tracer, candidates, in.jobs, in.log);
        run(recovery);
        TakeResult(recovery.Fit(), result);
    };
    if (in.lightmap.bounces > 0) { // what is known grows by the bounced light of lamps
        std::vector<Vec3f> ofSources;
        for (const ObservedLight &light : result.map.light)
            ofSources.push_back(light.known);
        const auto addBounced = [&] {
            in.log.Section("Bounced light of these lamps");
            AddBounced(Relight(in, result.map, result.lamps), result.lamps, ofSources, tracer, result.map);
            in.log.Section("Lamps, with their bounced light");
        };
        search([](Recovery &recovery) { recovery.RunRoughly(); });
        addBounced();
        search([](Recovery &recovery) { recovery.Run(); });
        addBounced();
        search([lamps = result.lamps](Recovery &recovery) { recovery.Refine(lamps); });
    } else
        search([](Recovery &recovery) { recovery.Run(); });
    in.log.Section("Light of all lamps");
    result.difference = Compare(in.bsp, result.map, Relight(in, result.map, result.lamps));
    return result;
}

} // namespace q3
