// GPL-2.0-or-later. Path tracer: the reference for the light stage's bounced light.
#include "tools/measure/bounce_error/path_tracer.h"

#include "common/error.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/bounce/bounce_scene.h"

#include <algorithm>
#include <cmath>

namespace q3::bounce {

namespace {

/// Luxels are lit this far off their surface, unless the shader sets another offset. Game units.
constexpr float kReceiverLift = 1;
/// Reflected rays start this far off the surface. Game units.
constexpr float kPathLift = 1.0f / 32;
constexpr int kFirstRoulette = 3;     ///< surface of a path from which on it may end by Russian roulette
constexpr float kMaxSurvival = 0.95f; ///< largest probability that it goes on
constexpr int kMaxVertices = 1000;    ///< a path ends here in any case

/// Light that a path adds at its vertex `depth` if the shadow ray is not blocked.
struct PathLight {
    std::uint32_t path = 0;
    int depth = 0;
    Vec3f color;
};

/// Index of the first of kBounceLimits that includes light reflected `depth` times.
std::size_t FirstLimit(int depth) {
    std::size_t limit = 0;
    while (limit < kAllBounces && kBounceLimits[limit] < depth)
        ++limit;
    return limit;
}

} // namespace

std::size_t LimitIndexOf(int bounces) {
    if (bounces < 1 || bounces > kBounceLimits[kAllBounces - 1])
        return kAllBounces;
    const auto found = std::find(kBounceLimits.begin(), kBounceLimits.end(), bounces);
    if (found == kBounceLimits.end())
        throw Error("{} bounces: expected 1 to 6, 8, 12, 16 or more", bounces);
    return std::size_t(found - kBounceLimits.begin());
}

struct PathTracer::Path {
    std::uint32_t number = 0;
    Vec3f origin, direction, throughput{1, 1, 1};
    PathRandom random;
};

/// A group of paths, traced together vertex by vertex; adds their light times `weights` ([normal][path]) to `sums`.
class PathTracer::Group {
  public:
    using Sums = std::vector<std::array<Vec3d, kBounceLimits.size()>>; ///< by normal and first limit

    Group(const PathTracer &tracer, Sums &sums, std::span<const std::vector<float>> weights)
        : tracer_(tracer), sums_(sums), weights_(weights) {}

    void Trace(std::vector<Path> &paths) {
        for (int depth = 1; !paths.empty() && depth < kMaxVertices; ++depth) {
            for (std::size_t first = 0; first < paths.size(); first += kPacketSize)
                Step(std::span(paths).subspan(first, std::min(kPacketSize, paths.size() - first)), depth);
            for (auto &queue : queues_)
                queue->rays.Flush();
            std::erase_if(paths, [](const Path &path) { return path.throughput == Vec3f{}; });
        }
    }

  private:
    /// Traces the shadow rays of a queue.
    struct Cast {
        Group &group;
        int sky = 0, receiveShadows = 1; ///< the sky counts if toSky
        bool toSky = false;
        void operator()(RayPacket &packet, std::span<const PathLight> lights) const {
            const LightScene &scene = group.tracer_.in_.scene;
            if (toSky)
                scene.TraceSurfaceToSky(packet, sky, receiveShadows, group.counts_);
            else
                scene.TraceSurfaceToLight(packet, receiveShadows, group.counts_);
            for (std::size_t i = 0; i < lights.size(); ++i)
                if (packet.live[i] != 0)
                    group.Add(lights[i], packet.tinted ? lights[i].color * packet.tint[i] : lights[i].color);
        }
    };
    /// Shadow rays to lights of one kind; `key` says which.
    struct Queue {
        explicit Queue(const Cast &cast) : key(cast), rays(cast) {}
        Cast key;
        RayBatcher<PathLight, Cast> rays;
    };

    void Add(const PathLight &light, const Vec3f &color) {
        const std::size_t limit = FirstLimit(light.depth);
        for (std::size_t i = 0; i < sums_.size(); ++i)
            if (const float weight = weights_[i][light.path]; weight > 0)
                sums_[i][limit] += Vec3d(color) * double(weight);
    }

    Queue &QueueFor(const Light &light, int receiveShadows) {
        const bool sun = light.type == LightType::Sun;
        const int sky = sun ? light.skyIndex : 0;
        for (auto &queue : queues_)
            if (queue->key.toSky == sun && queue->key.sky == sky && queue->key.receiveShadows == receiveShadows)
                return *queue;
        return *queues_.emplace_back(std::make_unique<Queue>(Cast{*this, sky, receiveShadows, sun}));
    }

    void Step(std::span<Path> paths, int depth) {
        RayPacket rays;
        rays.live = {};
        for (std::size_t i = 0; i < paths.size(); ++i)
            rays.Set(i, paths[i].origin, paths[i].direction, kRayLength);
        PathScene::Hits hits;
        tracer_.scene_.FirstHits(rays, hits);
        for (std::size_t i = 0; i < paths.size(); ++i)
            if (hits[i])
                Reflect(paths[i], *hits[i], depth);
            else
                paths[i].throughput = {};
    }

    void Reflect(Path &path, const PathHit &hit, int depth) {
        path.throughput = path.throughput * hit.reflectance;
        const SurfacePoint at = tracer_.ReceiverAt(hit);
        const Vec3f ambient = tracer_.in_.table[std::size_t(hit.surface)].ambient;
        if (ambient != Vec3f{})
            Add({path.number, depth, {}}, path.throughput * ambient);
        if (const UnshadowedLight light = tracer_.lights_.Sample(at, path.random); light.light) {
            const PathLight add{path.number, depth, path.throughput * light.color};
            if (at.receiveShadows == 0)
                Add(add, add.color);
            else
                QueueFor(*light.light, at.receiveShadows).rays.Add(add, at.position, light.direction, light.distance);
        }
        const float survival = depth < kFirstRoulette ? 1 : std::min(kMaxSurvival, MaxComponent(path.throughput));
        if (path.random.Unit() >= double(survival)) {
            path.throughput = {};
            return;
        }
        path.throughput = path.throughput / survival;
        path.origin = hit.position + hit.facingNormal * kPathLift;
        path.direction = CosineDirection(hit.behind ? -hit.normal : hit.normal, path.random.Unit2());
        if (Dot(path.direction, hit.facingNormal) <= 0)
            path.throughput = {};
    }

    const PathTracer &tracer_;
    Sums &sums_;
    std::span<const std::vector<float>> weights_;
    std::vector<std::unique_ptr<Queue>> queues_;
    RayCounts counts_;
};

namespace {

/// Mean of group means, and its standard error.
class EstimateSum {
  public:
    void Add(const std::array<Vec3d, kBounceLimits.size()> &byFirstLimit) {
        Vec3d light;
        for (std::size_t limit = 0; limit < kBounceLimits.size(); ++limit) {
            light += byFirstLimit[limit] / double(kPathGroup);
            sum_[limit] += light;
            squares_[limit] += light * light;
        }
        ++groups_;
    }
    Estimate Get() const {
        Estimate estimate;
        for (std::size_t limit = 0; limit < kBounceLimits.size(); ++limit) {
            const Vec3d mean = sum_[limit] / groups_;
            estimate.light[limit] = Vec3f(mean);
            for (std::size_t c = 0; groups_ > 1 && c < 3; ++c) {
                const double variance = std::max(0.0, squares_[limit][c] / groups_ - mean[c] * mean[c]);
                // The squared standard error of the mean: the biased variance over n - 1.
                estimate.error[limit][c] = float(std::sqrt(variance / (groups_ - 1)));
            }
        }
        return estimate;
    }

  private:
    double groups_ = 0;
    std::array<Vec3d, kBounceLimits.size()> sum_{}, squares_{};
};

} // namespace

SurfacePoint PathTracer::ReceiverAt(const PathHit &hit) const {
    const SurfaceEntry &entry = in_.table[std::size_t(hit.surface)];
    const float offset = entry.shader->lightmap.sampleOffset;
    SurfacePoint at;
    const Vec3f outward = hit.behind ? -hit.facingNormal : hit.facingNormal;
    at.position = hit.position + outward * (offset != 0 ? offset : kReceiverLift);
    at.normal = hit.normal;
    at.cluster = in_.space.ClusterAt(at.position, 0);
    at.twoSided = entry.shader->twoSided;
    at.receiveShadows = entry.receiveShadows;
    return at;
}

namespace {

int GroupsOf(int paths) {
    return std::max(1, (paths + kPathGroup - 1) / kPathGroup);
}

} // namespace

Estimate PathTracer::OnSurface(std::span<const Vec3f> positions, const Vec3f &normal, int paths,
                               std::uint64_t seed) const {
    const std::vector<float> weights(kPathGroup, 1);
    EstimateSum sum;
    for (int g = 0; g < GroupsOf(paths); ++g) {
        const std::uint64_t groupSeed = HashIndex(seed) + std::uint64_t(g);
        std::vector<Path> group(kPathGroup);
        for (std::uint32_t i = 0; i < std::uint32_t(kPathGroup); ++i)
            group[i] = {i,
                        positions[i % positions.size()],
                        CosineDirection(normal, PlasticSample(i, groupSeed)),
                        {1, 1, 1},
                        PathRandom(HashIndex(groupSeed) + i)};
        Group::Sums sums(1);
        Group(*this, sums, {&weights, 1}).Trace(group);
        sum.Add(sums[0]);
    }
    return sum.Get();
}

std::vector<Estimate> PathTracer::InSpace(const Vec3f &position, std::span<const Vec3f> normals, int paths,
                                          std::uint64_t seed) const {
    std::vector<EstimateSum> sums(normals.size());
    std::vector<std::vector<float>> weights(normals.size(), std::vector<float>(kPathGroup));
    for (int g = 0; g < GroupsOf(paths); ++g) {
        const std::uint64_t groupSeed = HashIndex(seed) + std::uint64_t(g);
        std::vector<Path> group(kPathGroup);
        for (std::uint32_t i = 0; i < std::uint32_t(kPathGroup); ++i) {
            const Vec3f direction = SphereDirection(PlasticSample(i, groupSeed));
            group[i] = {i, position, direction, {1, 1, 1}, PathRandom(HashIndex(groupSeed) + i)};
            // Estimator (cosine / pi) / density, with density 1 / (4 pi).
            for (std::size_t n = 0; n < normals.size(); ++n)
                weights[n][i] = 4 * std::max(0.0f, Dot(direction, normals[n]));
        }
        Group::Sums groupSums(normals.size());
        Group(*this, groupSums, weights).Trace(group);
        for (std::size_t n = 0; n < normals.size(); ++n)
            sums[n].Add(groupSums[n]);
    }
    std::vector<Estimate> found;
    for (const EstimateSum &sum : sums)
        found.push_back(sum.Get());
    return found;
}

} // namespace q3::bounce
