// GPL-2.0-or-later. Solves for the radiosity of a map.
#include "q3map2/lightmap/bounce/radiosity_solver.h"

#include "libs/math/elementary.h"
#include "libs/math/vec.h"
#include "q3map2/lightmap/bounce/bounce_gather.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

namespace q3 {

namespace {

/// Rays per vertex in the solver.
constexpr int kSolverVertexRays = 64;
/// The brightest groups: those whose largest unshot radiosity is above this fraction of the largest of all groups.
constexpr float kShootFraction = 0.25f;
/// The first steps shoot everything, to measure how fast light decays from step to step.
constexpr int kFirstJacobiSteps = 4;

/// In dim maps the light that may be estimated instead of solved is this fraction of the mean radiosity of the first
/// bounce.
constexpr float kLeastFraction = 1.0f / 32;

/// Mean over the emitters with light.
float MeanOfLit(const Emission &emission) {
    double sum = 0, count = 0;
    for (const Vec3f &one : emission)
        if (const float most = MaxComponent(one); most > 0)
            sum += double(most), count += 1;
    return count > 0 ? float(sum / count) : 0;
}

float Peak(std::span<const Vec3f> values) {
    float peak = 0;
    for (const Vec3f &value : values)
        peak = std::max(peak, MaxComponent(value));
    return peak;
}

} // namespace

struct RadiositySolver::State {
    Emission unshot, total;
    std::vector<float> peak, power; // by group: maximum and sum of unshot radiosity
    std::vector<Vec3f> sum, decay;  // by group: sum of unshot radiosity, and its ratio to that of the bounce before
    Vec3f allDecay;                 // the same ratio of the sum over all groups
    bool isWholeBounce = true;      // the unshot radiosity is that of one bounce
    std::vector<Vec3f> light;       // by emitter: light that it got in the latest step
    float Peak() const { return peak.empty() ? 0 : *std::max_element(peak.begin(), peak.end()); }
};

RadiositySolver::RadiositySolver(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters,
                                 const BounceScene &scene, const BounceGather &gather)
    : in_(in), surfaces_(surfaces), emitters_(emitters), reflectance_(scene.Reflectance()), gather_(gather),
      maxReflectance_(Peak(scene.Reflectance())) {
    AddGroups();
    std::vector<std::uint32_t> groupOf(emitters.Count());
    for (std::size_t i = 0; i < groups_.size(); ++i)
        std::fill_n(groupOf.begin() + groups_[i].first, groups_[i].count, std::uint32_t(i));
    in.jobs.For(std::int64_t(groups_.size()), [&](std::int64_t i, int) { FindRays(groups_[std::size_t(i)], groupOf); });
    for (const Group &group : groups_)
        rays_ += group.rays;
}

void RadiositySolver::AddGroups() {
    for (std::size_t i = 0; i < surfaces_.lightmaps.size(); ++i) {
        const RawLightmap &raw = surfaces_.lightmaps[i];
        Group group(Group::Kind::Texels, emitters_.FirstOf(i), EmitterId(raw.width * raw.height), i);
        group.mapped.resize(group.count);
        for (int y = 0; y < raw.SuperHeight(); ++y)
            for (int x = 0; x < raw.SuperWidth(); ++x)
                group.mapped[raw.Index(x / raw.super, y / raw.super)] |= raw.Mapped(raw.SuperIndex(x, y));
        if (!raw.dirt.empty())
            group.dirt = LuxelMeans(raw, 1.0f, [&](std::size_t luxel) { return raw.dirt[luxel]; });
        groups_.push_back(std::move(group));
    }
    for (std::size_t i = 0; i < in_.bsp.drawSurfaces.size(); ++i)
        if (const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[i];
            surface.numVerts > 0 && IsLitAtVertices(in_, surfaces_, i))
            groups_.emplace_back(Group::Kind::Vertices, emitters_.Vertex(surface.firstVert),
                                 EmitterId(surface.numVerts), i);
}

/// Traces rays if it is a group of vertices, and finds the groups that the group's rays hit.
void RadiositySolver::FindRays(Group &group, const std::vector<std::uint32_t> &groupOf) const {
    std::vector<std::uint8_t> seen(groups_.size());
    const auto see = [&](EmitterId hit) {
        group.rays += 1;
        if (Emits(hit))
            seen[groupOf[hit]] = 1;
    };
    if (group.kind == Group::Kind::Texels)
        for (const EmitterId hit : gather_.KeptHits(group.number))
            see(hit);
    else if (const auto emits = group.Of(reflectance_);
             std::any_of(emits.begin(), emits.end(), [](const Vec3f &one) { return one != Vec3f{}; })) {
        ForVertexReceivers(in_, surfaces_, group.number, [&](int vertex, const Vec3f &position) {
            const Vec3f &normal = surfaces_.verts[std::size_t(vertex)].normal;
            const bool twoSided = in_.table[group.number].shader->twoSided;
            const std::uint64_t seed = VertexSeed(surfaces_.verts[std::size_t(vertex)].xyz);
            for (const EmitterId hit : gather_.VertexHits(position, normal, twoSided, kSolverVertexRays, seed))
                group.vertexHits.push_back(hit), see(hit);
        });
    }
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen[i] != 0)
            group.sees.push_back(std::uint32_t(i));
}

bool RadiositySolver::SeesAny(const Group &group, const GroupMask &shot) const {
    return std::any_of(group.sees.begin(), group.sees.end(), [&](std::uint32_t seen) { return shot[seen] != 0; });
}

/// The groups to shoot: the brightest if they shoot more power per gather ray than all groups together, else all.
RadiositySolver::GroupMask RadiositySolver::Brightest(const State &state) const {
    GroupMask bright(groups_.size()), everyGroup(groups_.size(), 1);
    const float least = kShootFraction * state.Peak();
    double brightPower = 0, power = 0;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        bright[i] = state.peak[i] > least;
        power += double(state.power[i]);
        brightPower += bright[i] != 0 ? double(state.power[i]) : 0;
    }
    std::uint64_t rays = 0;
    for (const Group &group : groups_)
        rays += SeesAny(group, bright) ? group.rays : 0;
    return brightPower * double(rays_) > power * double(rays) ? bright : everyGroup;
}

void RadiositySolver::GatherGroup(const Group &group, const Emission &shot, std::span<Vec3f> light) const {
    if (group.kind == Group::Kind::Texels)
        return gather_.GatherTexels(shot, group.number, surfaces_.lightmaps[group.number], light);
    for (std::size_t v = 0; v < light.size() && !group.vertexHits.empty(); ++v) {
        Vec3f sum;
        for (const EmitterId hit : std::span(group.vertexHits).subspan(v * kSolverVertexRays, kSolverVertexRays))
            if (Emits(hit))
                sum += shot[hit];
        light[v] = sum / float(kSolverVertexRays);
    }
}

/// Fills texels without mapped luxels from their neighbors, as FinishLuxels does, then applies dirt.
void RadiositySolver::FinishLight(const Group &group, std::span<Vec3f> light) const {
    if (group.kind != Group::Kind::Texels)
        return;
    const RawLightmap &raw = surfaces_.lightmaps[group.number];
    LuxelMask known = group.mapped;
    std::vector<Vec3f> filled(light.begin(), light.end());
    FillFromNeighbors(raw.width, raw.height, known, filled);
    for (std::size_t i = 0; i < light.size(); ++i)
        light[i] = filled[i] * (group.dirt.empty() ? 1 : group.dirt[i]);
}

/// Shoots the unshot radiosity of the groups in `shot`.
void RadiositySolver::Step(const GroupMask &shot, State &state) const {
    const bool shootsAll = std::find(shot.begin(), shot.end(), 0) == shot.end(),
               isNextBounce = shootsAll && state.isWholeBounce;
    const Vec3f sumBefore = std::accumulate(state.sum.begin(), state.sum.end(), Vec3f{});
    Emission emission(state.unshot.size());
    for (std::size_t i = 0; i < groups_.size(); ++i)
        if (shot[i] != 0) {
            const auto unshot = groups_[i].Of(state.unshot);
            std::copy(unshot.begin(), unshot.end(), groups_[i].Of(emission).begin());
            std::fill(unshot.begin(), unshot.end(), Vec3f{});
        }
    in_.jobs.For(std::int64_t(groups_.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const Group &group = groups_[i];
        const auto light = group.Of(state.light), unshot = group.Of(state.unshot), total = group.Of(state.total);
        const auto reflectance = group.Of(reflectance_);
        std::fill(light.begin(), light.end(), Vec3f{});
        if (SeesAny(group, shot))
            GatherGroup(group, emission, light);
        FinishLight(group, light);
        Vec3f sum;
        for (std::size_t k = 0; k < light.size(); ++k) {
            const Vec3f reflected = light[k] * reflectance[k];
            unshot[k] += reflected, total[k] += reflected;
            sum += unshot[k];
        }
        if (isNextBounce)
            for (std::size_t c = 0; c < 3; ++c)
                state.decay[i][c] = state.sum[i][c] > 0 ? sum[c] / state.sum[i][c] : maxReflectance_;
        state.peak[i] = Peak(unshot);
        state.power[i] = Luminance(sum);
        state.sum[i] = sum;
    });
    state.isWholeBounce = shootsAll;
    if (const Vec3f after = std::accumulate(state.sum.begin(), state.sum.end(), Vec3f{}); isNextBounce)
        for (std::size_t c = 0; c < 3; ++c)
            state.allDecay[c] = sumBefore[c] > 0 ? after[c] / sumBefore[c] : 0;
}

/// Adds an estimate of `bounces` more bounces, or of all for kEndlessBounces: unshot * (q + q^2 + ... + q^bounces). q
/// is the decay of a group, limited to the larger of peakDecay, the decay of the largest radiosity, and the decay of
/// all light: a group that has just got its first light from others has no decay of its own yet.
void RadiositySolver::AddRest(int bounces, float peakDecay, State &state) const {
    Vec3f maxDecay;
    for (std::size_t c = 0; c < 3; ++c)
        maxDecay[c] = std::min(std::max(peakDecay, state.allDecay[c]), maxReflectance_);
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        Vec3f factor;
        for (std::size_t c = 0; c < 3; ++c) {
            const float q = std::min(state.decay[i][c], maxDecay[c]);
            factor[c] = q / (1 - q) * (bounces == kEndlessBounces ? 1 : 1 - Pow(q, float(bounces)));
        }
        const auto unshot = groups_[i].Of(state.unshot), total = groups_[i].Of(state.total);
        for (std::size_t k = 0; k < total.size(); ++k)
            total[k] += unshot[k] * factor;
    }
}

RadiositySolution RadiositySolver::Solve(Emission first, const RadiosityLimits &limits) const {
    const auto start = std::chrono::steady_clock::now();
    State state;
    const float leastLight = std::min(limits.leastLight, kLeastFraction * MeanOfLit(first));
    state.unshot = first;
    state.total = std::move(first);
    state.light.resize(state.total.size());
    state.peak.resize(groups_.size()), state.power.resize(groups_.size());
    for (const Group &group : groups_) {
        const auto unshot = group.Of(state.unshot);
        state.sum.push_back(std::accumulate(unshot.begin(), unshot.end(), Vec3f{}));
    }
    state.decay.resize(groups_.size());
    RadiositySolution solution;
    const GroupMask everyGroup(groups_.size(), 1);
    float decay = maxReflectance_; // largest ratio of peak unshot radiosity after to before a step that shoots all
    for (bool shootAll = true; solution.steps + 1 < limits.bounces && !solution.timedOut;) {
        const GroupMask shot = shootAll ? everyGroup : Brightest(state);
        const bool shotAll = shot == everyGroup;
        const float before = state.Peak();
        Step(shot, state);
        ++solution.steps;
        if (shotAll && solution.steps > 1 && before > 0) {
            const float ratio = std::min(state.Peak() / before, maxReflectance_);
            decay = solution.steps == 2 ? ratio : std::max(decay, ratio);
        }
        // The rest of a geometric series: peak (decay + decay^2 + ...).
        solution.stillToCome = state.Peak() * decay / std::max(1 - decay, 1e-3f);
        in_.log.Print("bounce {}{}: max {:.1f}, remaining {:.1f} (0-255)\n", solution.steps + 1,
                      shotAll ? "" : " (brightest surfaces)", Peak(state.light), solution.stillToCome);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        solution.timedOut = limits.seconds > 0 && elapsed.count() > limits.seconds;
        const bool little = solution.stillToCome < leastLight;
        if (little && shotAll) {
            const int more = limits.bounces == kEndlessBounces ? kEndlessBounces : limits.bounces - solution.steps - 1;
            AddRest(more, decay, state);
            break;
        }
        // Only a step that shoots everything measures the decay, so one such step confirms that little light is left.
        shootAll = limits.bounces != kEndlessBounces || solution.steps < kFirstJacobiSteps || little;
    }
    solution.total = std::move(state.total);
    return solution;
}

} // namespace q3
