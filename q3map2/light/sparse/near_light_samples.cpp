// GPL-2.0-or-later. Positions near lights.
#include "q3map2/light/sparse/near_light_samples.h"

#include "common/parallel.h"
#include "libs/math/sampling.h"
#include "libs/math/winding.h"
#include "libs/sh/polygon_moments.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sparse/display_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

namespace q3 {

namespace {

/// Least and greatest distance of positions from point lights and spotlights. Nearer ones are inside what a player
/// bumps into; farther ones would take bytes that reduce the error more elsewhere. Game units.
constexpr float kNearPoint = 16, kFarFromPoint = 24;
/// Least and greatest distance from the planes of surface lights. The nearest positions are out of reach of players,
/// but make cells small so that the corners of the next cells, within reach, do not hang on larger ones. Game units.
constexpr float kNearSurface = 8, kFarFromSurface = 34;
/// In front of a surface light, positions lie up to this far beyond its edges. Game units.
constexpr float kBeside = 4;
/// There is no solid in the cube of this half edge around a position. Game units.
constexpr float kSampleClearance = 6;
/// Distance between neighboring positions, game units: at least kLeastStep and at most kMostStep; near a surface
/// light in between kStepPerRadius times its radius.
constexpr float kLeastStep = 8, kMostStep = 32, kStepPerRadius = 1.0f / 16;
/// Point lights and spotlights that give less than this at distance kNearPoint are passed over. Byte scale.
constexpr float kLeastLight = 0.5f;
/// Samples of a brick, which share a list of lights.
constexpr std::size_t kBrickSamples = 256;
/// Cells whose samples one job hands to their children.
constexpr std::size_t kCellsOfJob = 64;
/// The lights of a sample are hidden from it if their mean light without shadows is more than this times the mean of
/// all traced light.
constexpr float kHiddenRatio = 1.25f;
/// Factor of the variance of noise in the squared error at a sample: 1 for its own light, and for the corners the mean
/// over a cell of the sum of the squared trilinear weights, (2/3)^3.
constexpr float kNoiseOfSample = 1.3f;

/// A position near a light.
struct NearLightPosition {
    std::uint64_t code = 0; ///< Morton code, by which neighbors come together
    std::uint64_t key = 0;  ///< of its cell in a lattice of cells of edge kLeastStep; it has one position at most
    Vec3f position;
    int cluster = 0;
    std::uint32_t light = 0; ///< index of the light

    bool operator<(const NearLightPosition &other) const {
        return std::tie(code, key, light) < std::tie(other.code, other.key, other.light);
    }
};

/// Whether a position is in front of a surface light: at the right distance from its plane, and not far beside it.
bool IsInFront(const Light &light, const Vec3f &p) {
    double distance = Dot(light.shape.normal, Vec3d(p)) - light.shape.dist;
    if (light.twoSided)
        distance = std::abs(distance);
    if (distance < double(kNearSurface) || distance > double(kFarFromSurface))
        return false;
    const Vec3f normal(light.shape.normal);
    for (std::size_t i = 0; i < light.polygon.size(); ++i) {
        const Vec3f &a = light.polygon[i], edge = light.polygon[(i + 1) % light.polygon.size()] - a;
        if (Length(edge) == 0)
            continue;
        const Vec3f out = Normalize(Cross(edge, normal));
        const float side = Dot(light.shape.center - a, out) > 0 ? -1.0f : 1.0f;
        if (side * Dot(p - a, out) > kBeside)
            return false;
    }
    return true;
}

/// Whether a position is at the right distance from a light, and in front of it unless it is a point light.
bool IsNear(const Light &light, const Vec3f &p) {
    if (light.type == LightType::Area)
        return IsInFront(light, p);
    const Vec3f away = p - light.origin;
    const float distance = Length(away);
    return distance >= kNearPoint && distance <= kFarFromPoint &&
           (light.type == LightType::Point || Dot(away, light.normal) > 0);
}

/// Whether cells in front of the light are measured: not for suns, lights without intensity, and faint ones.
bool HasNearPositions(const Light &light) {
    if (light.type == LightType::Sun || light.photons <= 0)
        return false;
    return light.type == LightType::Area || Falloff(light).At(kNearPoint) * MaxComponent(light.color) > kLeastLight;
}

/// Appends the positions near a light: jittered ones, a step apart, that are in the open and see its clusters.
void AddPositions(const BspSpace &space, const SparseLattice &lattice, const Light &light, std::uint32_t lightIndex,
                  std::vector<NearLightPosition> &positions) {
    // Steps count from the first point of the uniform grid, so that a map that is moved has the same positions.
    const Vec3f origin = lattice.UniformMins();
    constexpr std::int32_t kKeyMask = (1 << 21) - 1; // KeyOf takes 21 bits of each coordinate
    const bool area = light.type == LightType::Area;
    const float radius = area ? light.shape.radius : 0;
    const float step = kLeastStep * std::round(std::clamp(kStepPerRadius * radius, kLeastStep, kMostStep) / kLeastStep);
    Boundsf box;
    if (area)
        box = WindingBounds(light.polygon);
    else
        box.Add(light.origin);
    // Lights may be anywhere, but nothing is near those outside the world: an int need not hold the steps to them.
    if (!(MaxAbsComponent(box.mins) <= kMaxWorldCoord && MaxAbsComponent(box.maxs) <= kMaxWorldCoord))
        return;
    Int3 low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = int(std::floor((box.mins[axis] - origin[axis] - kFarFromSurface) / step));
        high[axis] = int(std::floor((box.maxs[axis] - origin[axis] + kFarFromSurface) / step));
    }
    const Vec3f clear{kSampleClearance, kSampleClearance, kSampleClearance};
    for (int z = low[2]; z <= high[2]; ++z)
        for (int y = low[1]; y <= high[1]; ++y)
            for (int x = low[0]; x <= high[0]; ++x) {
                const LatticePoint cell{int(float(x) * step / kLeastStep), int(float(y) * step / kLeastStep),
                                        int(float(z) * step / kLeastStep)};
                const std::uint64_t key =
                    KeyOf({cell[0] & kKeyMask, cell[1] & kKeyMask, cell[2] & kKeyMask}); // coordinates may be negative
                const Sample3 jitter = R3Sample(0, key);
                const Vec3f p = origin + Vec3f{float(cell[0]) + float(jitter.u), float(cell[1]) + float(jitter.v),
                                               float(cell[2]) + float(jitter.w)} *
                                             kLeastStep;
                if (!IsNear(light, p) || space.AnySolid(p - clear, p + clear))
                    continue;
                const int cluster = space.ClusterAt(p, kClearance);
                if (light.SeenFrom(cluster))
                    positions.push_back({MortonOf(CellAt(lattice.InCells(p))), key, p, cluster, lightIndex});
            }
}

/// The positions near all lights, sorted; one that is near several lights occurs once for each.
std::vector<NearLightPosition> FindPositions(const GridInputs &in, const SparseLattice &lattice,
                                             const std::vector<Light> &lights) {
    std::vector<std::vector<NearLightPosition>> found(lights.size());
    in.jobs.For(std::int64_t(lights.size()), [&](std::int64_t i, int) {
        if (const Light &light = lights[std::size_t(i)]; HasNearPositions(light))
            AddPositions(in.space, lattice, light, std::uint32_t(i), found[std::size_t(i)]);
    });
    std::size_t count = 0;
    for (const std::vector<NearLightPosition> &some : found)
        count += some.size();
    std::vector<NearLightPosition> positions;
    ReserveInParallel(count, in.jobs, positions);
    for (const std::vector<NearLightPosition> &some : found)
        positions.insert(positions.end(), some.begin(), some.end());
    SortInParallel(positions, in.jobs);
    return positions;
}

/// Indexes of the first ones of equal positions. maxCount: of more different positions, random ones are left out so
/// that about this many are left.
std::vector<std::uint32_t> ChooseSamples(const std::vector<NearLightPosition> &positions, std::size_t maxCount) {
    std::vector<std::uint32_t> firsts;
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (i == 0 || positions[i].key != positions[i - 1].key)
            firsts.push_back(std::uint32_t(i));
    if (firsts.size() > maxCount) {
        const double fraction = double(maxCount) / double(firsts.size());
        std::erase_if(firsts, [&](std::uint32_t i) { return UnitFromHash(HashIndex(positions[i].key)) > fraction; });
    }
    return firsts;
}

/// Light of a light as if nothing cast shadows, convolved with the cosine; spotlights count as point lights.
SHFloats UnshadowedLight(const Light &light, const Vec3f &position) {
    SHVector projection{};
    double scale = light.negative ? -1.0 / 255 : 1.0 / 255;
    if (light.type == LightType::Area) {
        if (!light.twoSided && Dot(light.shape.normal, Vec3d(position)) <= light.shape.dist)
            return {};
        projection = MomentsOfPolygon(light.polygon, Vec3d(position)).Projection();
        scale *= double(light.radiosity) / std::numbers::pi;
    } else {
        const Vec3f to = light.origin - position;
        const float distance = Length(to);
        projection = SHBasis(Vec3d(distance > 0 ? Normalize(to) : Vec3f{0, 0, 1}));
        scale *= double(std::max(0.0f, Falloff(light).At(distance)));
    }
    SHFloats shown;
    for (std::size_t i = 0; i < kSHFloats; ++i)
        shown[i] = float(projection[i / 3] * kCosineLobe[i / 3] * scale) * light.color[i % 3];
    return shown;
}

/// A cell of the tree and the samples in it.
struct SampledCell {
    std::size_t cell = 0;
    std::vector<std::uint32_t> samples;
};

/// Hands the samples of an inner node to its children.
void Distribute(const Octree &tree, std::span<const NearLightSample> samples, const SampledCell &from,
                std::vector<SampledCell> &to) {
    const OctreeCell &cell = tree[from.cell];
    std::array<SampledCell, 8> children;
    const Vec3f middle = LatticePosition(cell.origin) + Vec3f{1, 1, 1} * (0.5f * float(cell.Edge()));
    for (const std::uint32_t i : from.samples) {
        const Vec3f &at = samples[i].at;
        const std::size_t child =
            std::size_t(at.x >= middle.x) | std::size_t(at.y >= middle.y) << 1 | std::size_t(at.z >= middle.z) << 2;
        children[child].samples.push_back(i);
    }
    for (std::size_t c = 0; c < 8; ++c)
        if (!children[c].samples.empty() && tree[cell.child + c].openFraction > 0) {
            children[c].cell = cell.child + c;
            to.push_back(std::move(children[c]));
        }
}

} // namespace

NearLightSet::NearLightSet(const GridInputs &in, const std::vector<Light> &lights, const LightAtPositions &light,
                           const SparseLattice &lattice, std::size_t maxSamples, GridStats &stats)
    : lights_(lights), lattice_(lattice) {
    const std::vector<NearLightPosition> positions = FindPositions(in, lattice, lights);
    firstLight_ = ChooseSamples(positions, maxSamples);
    samples_ = VectorInParallel<NearLightSample>(firstLight_.size(), in.jobs);
    lightCounts_.resize(samples_.size());
    lightNumbers_.resize(positions.size());
    std::vector<GridStats> work(std::size_t(in.jobs.Threads()));
    const std::size_t bricks = (samples_.size() + kBrickSamples - 1) / kBrickSamples;
    in.jobs.For(std::int64_t(bricks), [&](std::int64_t brick, int worker) {
        const std::size_t from = std::size_t(brick) * kBrickSamples,
                          end = std::min(samples_.size(), from + kBrickSamples);
        std::vector<ProbeReceiver> receivers;
        for (std::size_t i = from; i < end; ++i) {
            const NearLightPosition &near = positions[firstLight_[i]];
            receivers.push_back({near.position, near.cluster, std::uint32_t(HashIndex(~near.key))});
            samples_[i].at = lattice.InCells(near.position);
            for (std::size_t n = firstLight_[i]; n < positions.size() && positions[n].key == near.key; ++n)
                lightNumbers_[n] = positions[n].light, ++lightCounts_[i];
        }
        const auto values = light.At(receivers, HashIndex(receivers.front().seed), work[std::size_t(worker)]);
        for (std::size_t i = 0; i < values.size(); ++i)
            samples_[from + i].light = ToDisplayed(values[i], in.options.shRadiance);
    });
    for (const GridStats &part : work)
        stats.Add(part);
}

/// Light at any position of those lights that are near a sample, without shadows.
SHFloats NearLightSet::NearLightsAt(std::uint32_t sample, const Vec3f &position) const {
    SHFloats sum{};
    for (const std::uint32_t light : std::span(lightNumbers_).subspan(firstLight_[sample], lightCounts_[sample]))
        AddScaled(1, UnshadowedLight(lights_[light], position), sum);
    return sum;
}

float NearLightSet::ErrorIn(const OctreeCell &cell, std::span<const std::uint32_t> samples, const LatticePoints &points,
                            const BounceNoise &noise) const {
    const CornerLight corners = CornersOf(points, cell);
    if (std::find(corners.begin(), corners.end(), nullptr) != corners.end())
        return std::numeric_limits<float>::infinity();
    float traced = 0, unshadowed = 0;
    for (const std::uint32_t i : samples)
        traced += screen_.Squared(InterpolatedLight(cell, corners, samples_[i].at), samples_[i].light);
    for (const std::uint32_t i : samples) {
        SHFloats replaced = samples_[i].light; // in the end: minus its near lights, plus these interpolated
        const SHFloats exact = NearLightsAt(i, lattice_.PositionOf(samples_[i].at));
        if (MeanLight(exact) > kHiddenRatio * MeanLight(replaced))
            continue; // its lights are hidden: unshadowed they would give more than all light there
        for (std::size_t c = 0; c < 8; ++c)
            AddScaled(cell.Weight(c, samples_[i].at), NearLightsAt(i, lattice_.PositionOf(cell.Corner(c))), replaced);
        AddScaled(-1, exact, replaced);
        unshadowed += screen_.Squared(replaced, samples_[i].light);
    }
    const float count = float(samples.size());
    return std::min(unshadowed / count, std::max(0.0f, traced / count - kNoiseOfSample * noise.At(cell.origin)));
}

void SplitNearLights(const NearLightSet &samples, float maxError, const BounceNoise &noise, const JobPool &jobs,
                     Octree &tree, const LatticePoints &points, OctreeRefiner &refiner, const LatticeTracer &tracer,
                     GridStats &stats) {
    const std::span<const NearLightSample> all = samples.All();
    std::vector<SampledCell> cells, next;
    std::vector<std::vector<std::uint32_t>> byRoot(tree.RootCount());
    for (std::size_t i = 0; i < all.size(); ++i)
        if (const std::size_t root = tree.RootAt(all[i].at); root != Octree::kNone)
            byRoot[root].push_back(std::uint32_t(i));
    for (std::size_t root = 0; root < byRoot.size(); ++root)
        if (!byRoot[root].empty() && tree[root].openFraction > 0)
            cells.push_back({root, std::move(byRoot[root])});
    for (; !cells.empty(); cells = std::move(next), next.clear()) {
        jobs.For(std::int64_t(cells.size()), [&](std::int64_t i, int) {
            const SampledCell &at = cells[std::size_t(i)];
            tree[at.cell].nearLightError = samples.ErrorIn(tree[at.cell], at.samples, points, noise);
        });
        std::vector<std::size_t> split;
        for (const SampledCell &at : cells)
            if (tree[at.cell].child == 0 && tree[at.cell].level > 0 && tree[at.cell].nearLightError > maxError)
                split.push_back(at.cell);
        if (!split.empty())
            refiner.Split(split, tracer, stats);
        std::vector<std::vector<SampledCell>> children((cells.size() + kCellsOfJob - 1) / kCellsOfJob);
        jobs.For(std::int64_t(children.size()), [&](std::int64_t job, int) {
            const std::size_t first = std::size_t(job) * kCellsOfJob;
            for (std::size_t i = first; i < std::min(cells.size(), first + kCellsOfJob); ++i)
                if (tree[cells[i].cell].child != 0)
                    Distribute(tree, all, cells[i], children[std::size_t(job)]);
        });
        for (std::vector<SampledCell> &some : children)
            std::ranges::move(some, std::back_inserter(next));
    }
}

} // namespace q3
