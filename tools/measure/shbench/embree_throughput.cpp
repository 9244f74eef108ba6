// GPL-2.0-or-later. Ray throughput of bare Embree on a map: the most that a bake can reach.
#include "tools/measure/shbench/embree_throughput.h"

#include "q3map2/light/scene/light_embree.h"
#include "q3map2/light/scene/shadow_casters.h"
#include "q3map2/light/sources/light_sources.h"
#include "tools/measure/shbench/truth_lights.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <random>

namespace q3::bench {

namespace {

constexpr int kPacket = 16; ///< rays
/// Number of bricks of points to trace from, and limit of lights for each.
constexpr int kBricks = 256, kLightsPerBrick = 64;
/// Points of a brick, and of the blocks in it, each of which is a packet.
constexpr std::array<int, 3> kBrickSize = {8, 8, 4}, kBlockSize = {4, 2, 2};
/// Blocks of a brick.
constexpr std::array<int, 3> kBlocks = {kBrickSize[0] / kBlockSize[0], kBrickSize[1] / kBlockSize[1],
                                        kBrickSize[2] / kBlockSize[2]};
/// Points this near to a brush count as in it, as in the bake. Game units.
constexpr float kBrushEpsilon = 0.125f;
/// Shorter ways to a light count as this long, for the division by the length. Game units.
constexpr float kLeastDistance = 1e-3f;

/// Coordinates of a number in rows of `size`, x fastest.
std::array<int, 3> InRows(int number, const std::array<int, 3> &size) {
    return {number % size[0], number / size[0] % size[1], number / (size[0] * size[1])};
}

/// CPU time of this thread.
double ThreadSeconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Corners of all triangles that shadow rays are traced against, nine floats per triangle.
std::vector<float> Triangles(const BenchMap &map) {
    const TrianglesByKind casters = ShadowCasters(map.bsp, map.table, map.options);
    std::vector<float> corners;
    for (const GeometryId id : {kSolids, kSurfaces, kPatches})
        corners.insert(corners.end(), casters[id].corners.begin(), casters[id].corners.end());
    return corners;
}

} // namespace

struct EmbreeThroughput::State {
    std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene> scene;
    /// Rays from points of a brick to one light.
    struct Task {
        std::size_t first, count; ///< of points
        Vec3f target;
        bool isDirection; ///< whether the target is a direction, of a sun
    };
    std::vector<Vec3f> points;
    std::vector<Task> tasks;

    void MakeScene(const std::vector<float> &corners);
    void AddBrick(const BenchMap &map, const std::vector<Light> &lights, const bspGridSHHeader_t &layout,
                  const std::array<int, 3> &brick, Random &random);
    std::uint64_t Trace(const Task &task) const;
};

void EmbreeThroughput::State::MakeScene(const std::vector<float> &corners) {
    const RTCDevice device = SharedDevice();
    scene = NewScene(device);
    const GeometryPtr geometry = NewTriangles(device, corners);
    rtcAttachGeometry(scene.get(), geometry.get());
    CommitScene(device, scene.get());
}

void EmbreeThroughput::State::AddBrick(const BenchMap &map, const std::vector<Light> &lights,
                                       const bspGridSHHeader_t &layout, const std::array<int, 3> &brick,
                                       Random &random) {
    const std::size_t first = points.size();
    int cluster = kSolidCluster;
    for (int block = 0; block < kBlocks[0] * kBlocks[1] * kBlocks[2]; ++block)
        for (int n = 0; n < kPacket; ++n) {
            const std::array<int, 3> base = InRows(block, kBlocks), within = InRows(n, kBlockSize);
            Vec3f p;
            bool inside = true;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const int at = brick[axis] * kBrickSize[axis] + base[axis] * kBlockSize[axis] + within[axis];
                inside = inside && at < layout.gridBounds[axis];
                p[axis] = layout.gridMins[axis] + float(at) * layout.gridSize[axis];
            }
            const int found = inside ? map.space.ClusterAt(p, kBrushEpsilon) : kSolidCluster;
            if (found >= 0)
                points.push_back(p), cluster = found;
        }
    if (points.size() == first)
        return;
    std::vector<Task> ofBrick;
    for (const Light &light : lights) {
        if (!light.SeenFrom(cluster))
            continue;
        const bool area = light.type == LightType::Area, sun = light.type == LightType::Sun;
        const double height = area ? Dot(light.shape.normal, Vec3d(points[first])) - light.shape.dist : 1;
        if (height <= 0 && !light.twoSided)
            continue;
        const Vec3f target = sun    ? -light.normal
                             : area ? light.shape.center + Vec3f(light.shape.normal) * float(kEmitterGap)
                                    : light.origin;
        ofBrick.push_back({first, points.size() - first, target, sun});
    }
    std::shuffle(ofBrick.begin(), ofBrick.end(), random);
    ofBrick.resize(std::min(ofBrick.size(), std::size_t(kLightsPerBrick)));
    tasks.insert(tasks.end(), ofBrick.begin(), ofBrick.end());
}

std::uint64_t EmbreeThroughput::State::Trace(const Task &task) const {
    alignas(64) RTCRay16 rays;
    alignas(64) std::array<int, kPacket> valid;
    EmbreeContext context;
    InitContext(context);
    for (std::size_t start = 0; start < task.count; start += kPacket) {
        for (std::size_t i = 0; i < std::size_t(kPacket); ++i) {
            valid[i] = start + i < task.count ? -1 : 0;
            const Vec3f &p = points[task.first + (start + i < task.count ? start + i : start)];
            const Vec3f way = task.isDirection ? task.target * kSunDistance : task.target - p;
            const float distance = std::max(Length(way), kLeastDistance);
            rays.org_x[i] = p.x, rays.org_y[i] = p.y, rays.org_z[i] = p.z;
            rays.dir_x[i] = way.x / distance, rays.dir_y[i] = way.y / distance, rays.dir_z[i] = way.z / distance;
            rays.tnear[i] = 0, rays.tfar[i] = distance;
            rays.time[i] = 0, rays.mask[i] = ~0u, rays.id[i] = unsigned(i), rays.flags[i] = 0;
        }
        Occluded16(valid.data(), scene.get(), context, rays);
    }
    return task.count;
}

EmbreeThroughput::EmbreeThroughput(const BenchMap &map, const bspGridSHHeader_t &layout, std::uint64_t seed)
    : state_(std::make_unique<State>()) {
    const std::vector<float> corners = Triangles(map);
    if (corners.empty() || map.lights.empty())
        return;
    state_->MakeScene(corners);
    Random random(seed);
    LightOptions options = map.options;
    options.skip.reach = true; // computes which clusters see each light
    int culled = 0;
    const auto lights =
        SetupEnvelopes(map.created, LightPass::GridSH, options, map.space, SkySeenFrom(map.space, map.table), culled);
    std::array<int, 3> bricks;
    for (std::size_t axis = 0; axis < 3; ++axis)
        bricks[axis] = (layout.gridBounds[axis] + kBrickSize[axis] - 1) / kBrickSize[axis];
    const int total = bricks[0] * bricks[1] * bricks[2];
    std::vector<int> order(static_cast<std::size_t>(total));
    for (int i = 0; i < total; ++i)
        order[std::size_t(i)] = i;
    std::shuffle(order.begin(), order.end(), random);
    int used = 0;
    for (const int i : order) {
        const std::size_t before = state_->tasks.size();
        state_->AddBrick(map, lights, layout, InRows(i, bricks), random);
        used += state_->tasks.size() > before ? 1 : 0;
        if (used == kBricks)
            break;
    }
}

EmbreeThroughput::~EmbreeThroughput() = default;

double EmbreeThroughput::PerSecond(double cpuSeconds) const {
    if (state_->tasks.empty())
        return 0;
    constexpr int kTasksPerReading = 64; // of the clock
    std::uint64_t rays = 0;
    double elapsed = 0;
    const double start = ThreadSeconds();
    for (std::size_t next = 0; elapsed < cpuSeconds; elapsed = ThreadSeconds() - start)
        for (int n = 0; n < kTasksPerReading; ++n) {
            rays += state_->Trace(state_->tasks[next]);
            next = next + 1 < state_->tasks.size() ? next + 1 : 0;
        }
    return double(rays) / elapsed;
}

} // namespace q3::bench
