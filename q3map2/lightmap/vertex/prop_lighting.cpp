// GPL-2.0-or-later. Light at the vertices of static props, as a lump and as files beside the map.
#include "q3map2/lightmap/vertex/prop_lighting.h"

#include "common/files/files.h"
#include "common/platform/platform.h"
#include "libs/math/packed_color.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/lightmap/ao/ambient_occlusion.h"
#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/store/lightmap_store.h"
#include "q3map2/lightmap/vertex/prop_samples.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace q3 {

// ---- Light of static props as files beside the map ----

namespace {

constexpr std::int32_t kVhvVersion = 2;
constexpr std::int32_t kVhvColorFlag = 4;                           ///< the vertices hold a color
constexpr std::int32_t kVhvVertexSize = 4;                          ///< bytes: blue, green, red, 255
constexpr std::size_t kVhvAlignment = 512;                          ///< the colors begin at a multiple of this
constexpr std::size_t kVhvHeaderSize = 40, kVhvMeshHeaderSize = 28; ///< bytes
/// byte = kVhvFull * light^(1 / kVhvGamma): light 1 is half of the range.
constexpr double kVhvGamma = 2.2, kVhvFull = 127.5;
constexpr std::string_view kPropLightFile = "proplight.raw";

void AppendInt(std::int32_t value, std::vector<std::byte> &bytes) {
    const auto *from = reinterpret_cast<const std::byte *>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}

std::byte VhvByte(float light) {
    const double byte = kVhvFull * std::pow(std::max(double(light), 0.0), 1 / kVhvGamma);
    return std::byte(std::lround(std::min(byte, 255.0)));
}

} // namespace

std::vector<std::byte> EncodeVhv(const PropVertexLight &light) {
    std::int32_t vertices = 0;
    for (const auto &mesh : light.meshes)
        vertices += std::int32_t(mesh.size());
    std::vector<std::byte> file;
    const auto zeros = [&](int count) {
        for (int i = 0; i < count; ++i)
            AppendInt(0, file);
    };
    const std::size_t headers = kVhvHeaderSize + kVhvMeshHeaderSize * light.meshes.size();
    std::size_t at = (headers + kVhvAlignment - 1) / kVhvAlignment * kVhvAlignment;
    for (const std::int32_t value : {kVhvVersion, std::int32_t(light.modelCrc), kVhvColorFlag, kVhvVertexSize, vertices,
                                     std::int32_t(light.meshes.size())})
        AppendInt(value, file);
    zeros(4); // not used
    const std::size_t firstColor = at;
    for (const auto &mesh : light.meshes) {
        // Level of detail, number of vertices, offset of their colors.
        for (const std::int32_t value : {0, std::int32_t(mesh.size()), std::int32_t(at)})
            AppendInt(value, file);
        zeros(4); // not used
        at += kVhvVertexSize * mesh.size();
    }
    file.resize(firstColor);
    for (const auto &mesh : light.meshes)
        for (const Vec3f &color : mesh)
            for (const std::byte byte : {VhvByte(color.z), VhvByte(color.y), VhvByte(color.x), std::byte(255)})
                file.push_back(byte);
    return file;
}

void AddPropFiles(const std::filesystem::path &folder, const std::vector<PropVertexLight> &light, FileSet &written,
                  Log &log) {
    if (light.empty())
        return;
    written.AddFolder(folder);
    std::vector<std::byte> raw;
    for (std::size_t i = 0; i < light.size(); ++i) {
        written.AddFile(folder / fmt::format("sp_{}.vhv", i), EncodeVhv(light[i]));
        for (const auto &mesh : light[i].meshes)
            for (const Vec3f &color : mesh)
                for (const float channel : {color.x, color.y, color.z}) {
                    const auto *from = reinterpret_cast<const std::byte *>(&channel);
                    raw.insert(raw.end(), from, from + sizeof channel);
                }
    }
    written.AddFile(folder / kPropLightFile, raw);
    written.AddLine(log, fmt::format("Wrote {} files of prop light to {}\n", light.size() + 1, folder.string()));
}

// ---- Light at the vertices of static props ----

namespace {

/// In place of the cosine to the normal, for props that ignore normals: as Source has it.
constexpr float kNoNormalFactor = 0.35f;
/// Points that are lit as one job.
constexpr std::size_t kPointsOfJob = 128;
/// Where light is looked for around a prop without a vertex in the open: steps of this length, game units.
constexpr float kSearchStep = 16;
constexpr int kSearchSteps = 8;

/// A receiver of direct light; several make a point.
struct PropReceiver {
    std::size_t point; ///< within its job
    Vec3f position, normal;
    float weight;
    bool twoSided;
};

/// Which points of props are lit: those in the open, or those in solids, from where FindOpenPlaces put them.
enum class PropPass { Open, Buried };

/// Points of a prop that are lit together.
struct PropJob {
    std::size_t prop;                ///< in StaticProps::props
    std::vector<std::size_t> points; ///< of its model
};

/// What is known of the points of a prop.
struct PropPoints {
    std::vector<Vec3f> light;             ///< byte scale
    std::vector<Vec3f> litAt;             ///< where a point is lit: in the open
    std::vector<std::uint8_t> isFinished; ///< not 0: open, or without a place in the open: no second pass
};

class PropLighter {
  public:
    PropLighter(const SurfaceInputs &in, const StaticProps &props, std::vector<Light> lights, const PropBounce &bounce);
    std::vector<PropVertexLight> Run(ContributionCounts &counts);

  private:
    std::vector<std::uint8_t> FindUnits();
    void KeepUnits(const std::vector<std::uint8_t> &lit) const;
    std::vector<PropJob> AllJobs(const std::vector<std::uint8_t> &wanted) const;
    std::vector<PropJob> BuriedJobs() const;
    void RunJobs(const std::vector<PropJob> &jobs, PropPass pass, ContributionCounts &counts);
    void LightPoints(const PropJob &job, PropPass pass, ContributionCounts &counts);
    std::vector<PropReceiver> Receivers(const PropJob &job, PropPass pass);
    /// All receivers are one-sided, or all are two-sided.
    void AddDirect(const PropJob &job, std::span<const PropReceiver> receivers, PropPass pass, std::vector<Vec3f> &sums,
                   ContributionCounts &counts) const;
    void AddLight(const LightGroup &group, const StaticProp &prop, const SurfaceLightSettings &settings,
                  std::span<SurfaceReceiverBatch> batches, std::span<const PropReceiver> receivers,
                  std::vector<Vec3f> &sums, ContributionCounts &counts) const;
    void AddOcclusion(const PropJob &job, std::vector<Vec3f> &light, ContributionCounts &counts) const;
    Vec3f Bounced(const StaticProp &prop, std::size_t point) const;
    bool TwoSided(const StaticProp &prop, std::size_t point) const;
    void FindOpenPlaces(std::size_t prop);
    std::optional<Vec3f> OpenPlace(const StaticProp &prop, const PropSampler &sampler) const;
    PropVertexLight Result(std::size_t prop) const;

    const SurfaceInputs &in_;
    const StaticProps &props_;
    std::vector<Light> lights_; // of style 0
    const PropBounce &bounce_;
    const AmbientOcclusion occlusion_;
    const FloodSource flood_;
    const bool direct_;              // false: bounced light alone
    std::vector<PropPoints> points_; // by prop
};

PropLighter::PropLighter(const SurfaceInputs &in, const StaticProps &props, std::vector<Light> lights,
                         const PropBounce &bounce)
    : in_(in), props_(props), lights_(std::move(lights)), bounce_(bounce), occlusion_(in), flood_(WorldFlood(in)),
      direct_(!(in.lightmap.bounceOnly && in.lightmap.bounces > 0)), points_(props.props.size()) {
    std::erase_if(lights_,
                  [](const Light &light) { return light.style != 0 || !light.lightsSurfaces || light.envelope <= 0; });
}

std::vector<PropVertexLight> PropLighter::Run(ContributionCounts &counts) {
    for (std::size_t i = 0; i < props_.props.size(); ++i) {
        const std::size_t count = props_.props[i].vertexLight ? props_.props[i].model->points.size() : 0;
        points_[i].light.resize(count), points_[i].litAt.resize(count), points_[i].isFinished.resize(count);
    }
    const std::vector<std::uint8_t> unknown = FindUnits();
    RunJobs(AllJobs(unknown), PropPass::Open, counts);
    in_.jobs.For(std::int64_t(points_.size()), [&](std::int64_t prop, int) {
        if (unknown[std::size_t(prop)] != 0)
            FindOpenPlaces(std::size_t(prop));
    });
    const std::vector<PropJob> buried = BuriedJobs();
    std::vector<PropJob> toLight = buried;
    std::erase_if(toLight, [&](const PropJob &job) { return unknown[job.prop] == 0; });
    RunJobs(toLight, PropPass::Buried, counts);
    KeepUnits(unknown);
    std::vector<PropVertexLight> results;
    long long vertices = 0, moved = 0;
    for (const PropJob &job : buried)
        moved += (long long)(job.points.size());
    for (std::size_t i = 0; i < props_.props.size(); ++i)
        if (props_.props[i].vertexLight) {
            results.push_back(Result(i));
            for (const auto &mesh : results.back().meshes)
                vertices += (long long)(mesh.size());
        }
    in_.log.Count(results.size(), "static props");
    in_.log.Count(vertices, "vertices lit");
    in_.log.Count(moved, "points in walls, lit from the open side");
    return results;
}

// ---- Units: a prop, in parts of a run ----

namespace {

Hash128 KeyOfProp(std::size_t prop) {
    KeyBuilder key("prop");
    key.Add(std::uint64_t(prop));
    return key.Key();
}

} // namespace

/// Reads the props that are known. By prop, whether this process has to light it.
std::vector<std::uint8_t> PropLighter::FindUnits() {
    const UnitStore *const units = in_.units && !in_.units->IsCache() ? in_.units : nullptr;
    std::vector<double> costs;
    for (const PropPoints &points : points_)
        costs.push_back(double(points.light.size()));
    if (!units)
        return std::vector<std::uint8_t>(points_.size(), 1);
    std::vector<std::uint8_t> unknown = units->Own(costs, UnitStore::Division::BySize);
    for (std::size_t prop = 0; prop < points_.size(); ++prop) {
        const auto bytes = units->Find(KeyOfProp(prop));
        if (!bytes)
            continue;
        UnitReader reader(*bytes);
        PropPoints known;
        reader.GetAll(known.light);
        reader.GetAll(known.isFinished);
        if (reader.IsComplete() && known.light.size() == points_[prop].light.size() &&
            known.isFinished.size() == known.light.size()) {
            points_[prop].light = std::move(known.light);
            points_[prop].isFinished = std::move(known.isFinished);
            unknown[prop] = 0;
        }
    }
    return unknown;
}

/// lit: by prop, whether this process has lit it.
void PropLighter::KeepUnits(const std::vector<std::uint8_t> &lit) const {
    if (!in_.units || in_.units->IsCache())
        return;
    for (std::size_t prop = 0; prop < points_.size(); ++prop)
        if (lit[prop] != 0) {
            UnitWriter writer;
            writer.PutAll(points_[prop].light);
            writer.PutAll(points_[prop].isFinished);
            in_.units->Keep(KeyOfProp(prop), writer.Take());
        }
}

/// wanted: by prop.
std::vector<PropJob> PropLighter::AllJobs(const std::vector<std::uint8_t> &wanted) const {
    std::vector<PropJob> jobs;
    for (std::size_t prop = 0; prop < points_.size(); ++prop)
        for (std::size_t point = 0; point < points_[prop].light.size() && wanted[prop] != 0; ++point) {
            if (point % kPointsOfJob == 0)
                jobs.push_back({prop, {}});
            jobs.back().points.push_back(point);
        }
    return jobs;
}

std::vector<PropJob> PropLighter::BuriedJobs() const {
    std::vector<PropJob> jobs;
    for (std::size_t prop = 0; prop < points_.size(); ++prop) {
        bool started = false;
        for (std::size_t point = 0; point < points_[prop].light.size(); ++point) {
            if (points_[prop].isFinished[point] != 0)
                continue;
            if (!started || jobs.back().points.size() == kPointsOfJob)
                jobs.push_back({prop, {}});
            started = true;
            jobs.back().points.push_back(point);
        }
    }
    return jobs;
}

void PropLighter::RunJobs(const std::vector<PropJob> &jobs, PropPass pass, ContributionCounts &counts) {
    std::vector<ContributionCounts> work(std::size_t(in_.jobs.Threads()));
    in_.jobs.For(std::int64_t(jobs.size()), [&](std::int64_t job, int worker) {
        LightPoints(jobs[std::size_t(job)], pass, work[std::size_t(worker)]);
    });
    for (const ContributionCounts &one : work)
        counts += one;
}

bool PropLighter::TwoSided(const StaticProp &prop, std::size_t point) const {
    const ShaderInfo *shader = prop.shaders[prop.model->points[point].mesh];
    return shader != nullptr && shader->twoSided;
}

/// The receivers of all points, those of a point one after another. PropPass::Open: notes which are finished.
std::vector<PropReceiver> PropLighter::Receivers(const PropJob &job, PropPass pass) {
    const StaticProp &prop = props_.props[job.prop];
    PropPoints &points = points_[job.prop];
    const PropSampler sampler(prop, in_.space);
    std::vector<PropReceiver> receivers;
    std::vector<PropSample> samples;
    for (std::size_t i = 0; i < job.points.size(); ++i) {
        const std::size_t point = job.points[i];
        const PropPlace placed = sampler.Place(point);
        if (pass == PropPass::Buried)
            samples.assign(1, {points.litAt[point], 1});
        else
            sampler.Samples(point, samples);
        if (samples.empty())
            continue;
        float total = 0;
        for (const PropSample &sample : samples)
            total += sample.weight;
        for (const PropSample &sample : samples)
            receivers.push_back({i, sample.position, placed.normal, sample.weight / total, TwoSided(prop, point)});
        if (pass == PropPass::Open) {
            points.litAt[point] = sampler.IsOpen(placed.position) ? placed.position : samples.front().position;
            points.isFinished[point] = 1;
        }
    }
    return receivers;
}

void PropLighter::LightPoints(const PropJob &job, PropPass pass, ContributionCounts &counts) {
    const StaticProp &prop = props_.props[job.prop];
    PropPoints &points = points_[job.prop];
    std::vector<PropReceiver> receivers = Receivers(job, pass);
    const auto twoSided = std::stable_partition(receivers.begin(), receivers.end(),
                                                [](const PropReceiver &one) { return !one.twoSided; });
    const Vec3f ambient = direct_ ? in_.world.ambient : Vec3f{};
    std::vector<Vec3f> light(job.points.size(), ambient);
    if (direct_) {
        AddDirect(job, {receivers.begin(), twoSided}, pass, light, counts);
        AddDirect(job, {twoSided, receivers.end()}, pass, light, counts);
        AddOcclusion(job, light, counts);
    }
    for (std::size_t i = 0; i < job.points.size(); ++i) {
        const std::size_t point = job.points[i];
        const bool isLit = pass == PropPass::Buried || points.isFinished[point] != 0;
        points.light[point] = isLit ? light[i] + Bounced(prop, point) : ambient;
    }
}

void PropLighter::AddDirect(const PropJob &job, std::span<const PropReceiver> receivers, PropPass pass,
                            std::vector<Vec3f> &sums, ContributionCounts &counts) const {
    const StaticProp &prop = props_.props[job.prop];
    std::vector<SurfaceReceiverBatch> batches;
    Boundsf bounds;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const PropReceiver &one = receivers[i];
        if (i % kPacketSize == 0)
            batches.emplace_back();
        batches.back().twoSided = one.twoSided;
        batches.back().Add(one.position, one.normal, in_.space.ClusterAt(one.position, -kPropSolidDepth));
        bounds.Add(one.position);
    }
    if (batches.empty())
        return;
    SurfaceLightSettings settings;
    settings.sunOnly = in_.options.sunOnly;
    settings.pointAreas = in_.options.faster;
    settings.halfLambert = in_.lightmap.halfLambert;
    settings.receiveShadows = prop.receiveShadows;
    settings.areaShadows = in_.options.areaShadows;
    // A box is not the shape of the prop, and what is moved out of a wall may be inside of it.
    if (!prop.selfShadows || !in_.options.staticPropPolys || pass == PropPass::Buried)
        settings.ignoredProp = int(job.prop);
    const Vec3f center = bounds.Center();
    const float radius = Length(bounds.maxs - center);
    std::vector<const Light *> reaching;
    for (const Light &light : lights_) {
        const bool misses = light.type != LightType::Sun &&
                            (in_.options.sunOnly || Length(light.origin - center) - light.envelope - radius > 0 ||
                             ConeMisses(light, center, radius));
        if (!misses)
            reaching.push_back(&light);
    }
    // A prop without normals turns to each sample, so it takes them one by one.
    for (const LightGroup &group : LightGroupsOf(reaching, prop.ignoresNormals ? SurfaceLightSettings{} : settings))
        AddLight(group, prop, settings, batches, receivers, sums, counts);
}

void PropLighter::AddLight(const LightGroup &group, const StaticProp &prop, const SurfaceLightSettings &settings,
                           std::span<SurfaceReceiverBatch> batches, std::span<const PropReceiver> receivers,
                           std::vector<Vec3f> &sums, ContributionCounts &counts) const {
    SurfaceIncidentLight incident;
    const Light &light = group.First();
    const float factor = prop.ignoresNormals && light.angleAttenuation ? kNoNormalFactor : 1;
    for (std::size_t b = 0; b < batches.size(); ++b) {
        SurfaceReceiverBatch &batch = batches[b];
        for (std::size_t i = 0; i < batch.count && prop.ignoresNormals; ++i)
            batch.normal.Set(i, light.type == LightType::Sun ? -light.normal
                                                             : Normalize(light.origin - batch.position[i]));
        GroupContributionToSample(group, settings, in_.scene, batch, incident, counts);
        for (std::size_t i = 0; i < batch.count; ++i) {
            if (incident.live[i] == 0)
                continue;
            const PropReceiver &receiver = receivers[b * kPacketSize + i];
            const float strength = incident.strength[i] * factor * receiver.weight;
            const Vec3f color = group.Color() * (light.negative ? -strength : strength);
            sums[receiver.point] += incident.tinted ? color * incident.tint[i] : color;
        }
    }
}

/// Multiplies by dirt, then adds floodlight. Buried points have none.
void PropLighter::AddOcclusion(const PropJob &job, std::vector<Vec3f> &light, ContributionCounts &counts) const {
    if (!in_.lightmap.dirty && flood_.light == Vec3f{})
        return;
    const StaticProp &prop = props_.props[job.prop];
    const PropSampler sampler(prop, in_.space);
    for (std::size_t first = 0; first < job.points.size(); first += kPacketSize) {
        OcclusionReceivers receivers;
        receivers.receiveShadows = prop.receiveShadows;
        receivers.surfaces = prop.surfaces;
        receivers.atVertices = true;
        const std::size_t end = std::min(first + kPacketSize, job.points.size());
        for (std::size_t i = first; i < end; ++i)
            receivers.Add(points_[job.prop].litAt[job.points[i]],
                          prop.ignoresNormals ? Vec3f{0, 0, 1} : sampler.Place(job.points[i]).normal,
                          std::uint32_t(job.points[i]));
        if (in_.lightmap.dirty) {
            std::vector<Lanes> dirt;
            occlusion_.Dirt({&receivers, 1}, dirt, counts);
            for (std::size_t i = first; i < end; ++i)
                light[i] *= dirt[0][i - first];
        }
        if (flood_.light != Vec3f{}) {
            Lanes visibility;
            occlusion_.SkyVisibility(receivers, flood_.distance, visibility, counts);
            for (std::size_t i = first; i < end; ++i)
                light[i] += flood_.light * visibility[i - first];
        }
    }
}

Vec3f PropLighter::Bounced(const StaticProp &prop, std::size_t point) const {
    if (!bounce_.irradiance)
        return {};
    const Vec3f &position = points_[std::size_t(&prop - props_.props.data())].litAt[point];
    if (!prop.ignoresNormals)
        return bounce_.irradiance(position, PropSampler(prop, in_.space).Place(point).normal, TwoSided(prop, point));
    std::vector<IndirectRay> rays;
    bounce_.indirect->Gather(position, point, rays);
    Vec3f sum;
    for (const IndirectRay &ray : rays)
        sum += ray.light;
    return sum * kNoNormalFactor;
}

/// A place in the open for a prop all of whose vertices are buried.
std::optional<Vec3f> PropLighter::OpenPlace(const StaticProp &prop, const PropSampler &sampler) const {
    if (prop.lightingOrigin && sampler.IsOpen(*prop.lightingOrigin))
        return prop.lightingOrigin;
    if (prop.lightingOrigin)
        in_.log.Warn("lighting origin in a wall", "Entity {}: its lightingorigin at {:.0f} {:.0f} {:.0f} is in a wall",
                     prop.entity, prop.lightingOrigin->x, prop.lightingOrigin->y, prop.lightingOrigin->z);
    const Vec3f center = prop.bounds.Center(), half = prop.bounds.maxs - center;
    for (const Vec3f &place : {center, Vec3f(prop.transform.origin)})
        if (sampler.IsOpen(place))
            return place;
    for (int step = 1; step <= kSearchSteps; ++step)
        for (const int z : {1, 0, -1})
            for (const int y : {0, 1, -1})
                for (const int x : {0, 1, -1}) {
                    const Vec3f reach = half + Vec3f{1, 1, 1} * (kSearchStep * float(step));
                    const Vec3f place = center + Vec3f{float(x), float(y), float(z)} * reach;
                    if (sampler.IsOpen(place))
                        return place;
                }
    in_.log.Warn("prop in a wall", "Entity {}: the model {} is inside of a wall: it gets ambient light only",
                 prop.entity, prop.name);
    return std::nullopt;
}

/// Sets from where buried points are lit. If there is no place for any, the points are finished: they keep the ambient
/// light of the first pass.
void PropLighter::FindOpenPlaces(std::size_t number) {
    PropPoints &points = points_[number];
    if (std::find(points.isFinished.begin(), points.isFinished.end(), 0) == points.isFinished.end())
        return;
    const StaticProp &prop = props_.props[number];
    const PropSampler sampler(prop, in_.space);
    std::vector<NearestPoints::Entry> entries;
    for (std::size_t i = 0; i < points.light.size(); ++i)
        if (points.isFinished[i] != 0)
            entries.push_back({points.litAt[i], sampler.Place(i).normal});
    const NearestPoints nearest(std::move(entries));
    const std::optional<Vec3f> place = nearest.Empty() ? OpenPlace(prop, sampler) : std::nullopt;
    for (std::size_t i = 0; i < points.light.size(); ++i) {
        if (points.isFinished[i] != 0)
            continue;
        const PropPlace placed = sampler.Place(i);
        if (nearest.Empty() && !place)
            points.isFinished[i] = 1;
        else
            points.litAt[i] =
                sampler.OpenPlaceToward(placed.position, place ? *place : nearest.Find(placed.position, placed.normal));
    }
}

PropVertexLight PropLighter::Result(std::size_t number) const {
    const StaticProp &prop = props_.props[number];
    const ToneOptions tone = StoredTone(in_);
    PropVertexLight result;
    result.prop = number;
    result.modelCrc = prop.model->crc;
    for (std::size_t mesh = 0; mesh < prop.model->meshes.size(); ++mesh) {
        std::vector<Vec3f> &colors = result.meshes.emplace_back();
        if (prop.shaders[mesh] == nullptr)
            continue;
        for (const std::uint32_t point : prop.model->pointOf[mesh])
            colors.push_back(VertexLightOf(in_, *prop.shaders[mesh], points_[number].light[point], tone));
    }
    return result;
}

} // namespace

std::vector<PropVertexLight> LightProps(const SurfaceInputs &in, const StaticProps &props, std::vector<Light> lights,
                                        const PropBounce &bounce, ContributionCounts &counts) {
    const CpuTimer timer;
    PropLighter lighter(in, props, std::move(lights), bounce);
    auto results = lighter.Run(counts);
    in.log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
    return results;
}

std::optional<PropLight> PackPropLight(const StaticProps &props, const std::vector<PropVertexLight> &light) {
    if (light.empty())
        return std::nullopt;
    PropLight packed;
    for (const PropVertexLight &one : light) {
        const StaticProp &prop = props.props[one.prop];
        packed.props.push_back({std::uint32_t(prop.entity), ModelNameCrc(prop.name), prop.model->crc,
                                std::uint32_t(packed.meshes.size()), std::uint32_t(one.meshes.size())});
        for (const std::vector<Vec3f> &mesh : one.meshes) {
            packed.meshes.push_back({std::uint32_t(packed.colors.size()), std::uint32_t(mesh.size())});
            const std::vector<std::uint32_t> codes = EncodeE5bgr9(mesh);
            packed.colors.insert(packed.colors.end(), codes.begin(), codes.end());
        }
    }
    return packed;
}

} // namespace q3
