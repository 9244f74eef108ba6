// GPL-2.0-or-later. Light at the vertices of surfaces, and from where they are lit.
#include "q3map2/lightmap/vertex/vertex_light.h"

#include "common/debug_color.h"
#include "q3map2/light/scene/open_parts.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sources/light_units.h"
#include "q3map2/lightmap/ao/ambient_occlusion.h"
#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

namespace q3 {

// ---- From where the vertices of surfaces without lightmaps are lit ----

namespace {

/// Shadow rays start this far over the vertex and this far inside its surface. Game units.
constexpr float kLift = 1.0f / 8, kInset = 1.0f / 4;
/// A vertex counts as inside a solid from this depth on. Game units.
constexpr float kVertexSolidDepth = 0.125f;
/// Bisections that find where a segment leaves a solid.
constexpr int kPlaceBisections = 12;

} // namespace

VertexPlaces::VertexPlaces(const SurfaceInputs &in, const bspDrawSurface_t &surface,
                           std::span<const SurfaceVertex> verts, bool twoSided, const std::vector<int> &clusters)
    : in_(in), verts_(verts), twoSided_(twoSided), clusters_(in.space, clusters), rayOrigins_(verts.size()),
      middles_(verts.size()) {
    FindEdges(surface);
    std::vector<Vec3f> around(verts.size());
    std::vector<float> counts(verts.size());
    for (const auto &[a, b] : edges_) {
        around[a] += verts[b].xyz, counts[a] += 1;
        around[b] += verts[a].xyz, counts[b] += 1;
    }
    for (std::size_t v = 0; v < verts.size(); ++v) {
        const Vec3f middle = counts[v] > 0 ? around[v] / counts[v] : verts[v].xyz, lift = verts[v].normal * kLift;
        const Vec3f inside = counts[v] > 0 ? Normalize(middle - verts[v].xyz) : Vec3f{};
        rayOrigins_[v] = verts[v].xyz + lift + inside * kInset;
        middles_[v] = middle + lift;
        // The surface may go on into a solid whose face the vertex is on.
        if (const Vec3f above = verts[v].xyz + lift; OpenCluster(rayOrigins_[v]) < 0 && OpenCluster(above) >= 0)
            rayOrigins_[v] = above;
    }
}

void VertexPlaces::FindEdges(const bspDrawSurface_t &surface) {
    if (surface.surfaceType == MST_PATCH) {
        const auto width = std::size_t(surface.patchWidth), height = std::size_t(surface.patchHeight);
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                if (x + 1 < width)
                    edges_.emplace_back(y * width + x, y * width + x + 1);
                if (y + 1 < height)
                    edges_.emplace_back(y * width + x, (y + 1) * width + x);
            }
        return;
    }
    for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
        const int *corner = in_.bsp.drawIndexes.data() + surface.firstIndex + i;
        for (std::size_t k = 0; k < 3; ++k)
            edges_.emplace_back(std::size_t(corner[k]), std::size_t(corner[(k + 1) % 3]));
    }
}

int VertexPlaces::OpenCluster(const Vec3f &p) {
    return clusters_.ClusterIfAllowed(in_.space.ClusterAt(p, -kVertexSolidDepth));
}

int VertexPlaces::ClusterAt(std::size_t vertex, const Vec3f &offset) {
    if (offset == Vec3f{}) {
        const int cluster = OpenCluster(verts_[vertex].xyz);
        return cluster >= 0 ? cluster : OpenCluster(rayOrigins_[vertex]);
    }
    const Vec3f aside = rayOrigins_[vertex] + offset;
    const int cluster = twoSided_ || Dot(offset, verts_[vertex].normal) >= 0 ? OpenCluster(aside) : kSolidCluster;
    return cluster >= 0 && StateOfSegment(in_.space, OpenOrigin(vertex), aside) != SegmentState::Blocked
               ? cluster
               : kSolidCluster;
}

/// Where the segment from a vertex in a solid towards its neighbors comes out; the ray origin if it does not.
Vec3f VertexPlaces::OpenOrigin(std::size_t vertex) {
    Vec3f inside = rayOrigins_[vertex], outside = middles_[vertex];
    if (OpenCluster(outside) < 0)
        return inside;
    for (int step = 0; step < kPlaceBisections; ++step) {
        const Vec3f middle = (inside + outside) * 0.5f;
        (OpenCluster(middle) < 0 ? inside : outside) = middle;
    }
    return outside;
}

// ---- Light at the vertices of surfaces ----

SurfaceLightSettings VertexSettings(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t surface) {
    SurfaceLightSettings settings;
    settings.sunOnly = in.options.sunOnly;
    settings.pointAreas = in.options.faster;
    settings.halfLambert = in.lightmap.halfLambert;
    settings.receiveShadows = in.table[surface].receiveShadows;
    settings.areaShadows = in.options.areaShadows;
    settings.shadows = surfaces.lightmapOf[surface] < 0; // -cpma lights lightmapped surfaces without shadows
    settings.sunShadows = settings.shadows && !in.table[surface].shader->forceSunlight;
    return settings;
}

namespace {

/// Vertices in solids are lit from kNudgeSteps times this aside on each axis, whichever is in the open first. Game
/// units.
constexpr float kNudge = 4;
constexpr std::array<int, 5> kNudgeSteps = {0, 1, -1, 2, -2};
/// -cheap: vertices this bright in all channels get no more lights. Byte scale.
constexpr float kWhite = 255;
/// Constant vertex light (-novertex 1, shaders without vertex light). Byte scale.
constexpr float kConstantLight = 127.5f;

/// Light at the vertices of one surface.
struct SurfaceVertexLight {
    Styles styles = kOnlyStyle0;
    std::array<std::vector<Vec3f>, kStyles> values; ///< empty for styles that are not used
    bool constant = false;                          ///< the same in all passes
    std::vector<std::string> dropped;               ///< names of lights that found no slot
};

/// Lights the vertices of a surface that has no lightmap.
class VertexLighter {
  public:
    VertexLighter(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                  const SurfaceLight &surfaces, std::size_t surface, const AmbientOcclusion &occlusion,
                  ContributionCounts &counts);
    SurfaceVertexLight Run();
    /// Run, unless the result is known. hashes: of `lights`.
    SurfaceVertexLight FindOrRun(const LightHashes &hashes);

  private:
    Hash128 KeyOfUnit(const LightHashes &hashes) const;
    using VertexIndices = std::vector<std::size_t>; // of the surface, from 0
    void FindLights(const std::vector<Light> &lights);
    void ChooseStyles();
    std::vector<SurfaceReceiverBatch> OpenVertices(const VertexIndices &vertices, const Vec3f &offset,
                                                   VertexIndices &open);
    /// Lights the vertices moved by `offset`; returns those that are not occluded there.
    VertexIndices LightAt(const VertexIndices &vertices, const Vec3f &offset);
    void AddLights(std::span<SurfaceReceiverBatch> batches, const VertexIndices &vertices);
    void AddAmbientOcclusion(const SurfaceReceiverBatch &batch, std::span<const std::size_t> vertices);
    void AddTo(std::size_t slot, std::size_t vertex, const Vec3f &light);
    void FillWithoutPlace(const std::vector<bool> &lit);

    const SurfaceInputs &in_;
    const SurfacePass &pass_;
    const SurfaceEntry &entry_;
    const bspDrawSurface_t &surface_;
    const Boundsf &bounds_;
    std::span<const SurfaceVertex> verts_;
    const AmbientOcclusion &occlusion_;
    ContributionCounts &counts_;
    VertexPlaces places_;
    const std::vector<int> &surfaceClusters_;
    int surfaceNumber_;
    Vec3f ambient_;
    FloodSource flood_;
    SurfaceLightSettings settings_;
    std::vector<const Light *> lights_;
    SurfaceVertexLight result_;
};

VertexLighter::VertexLighter(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                             const SurfaceLight &surfaces, std::size_t surface, const AmbientOcclusion &occlusion,
                             ContributionCounts &counts)
    : in_(in), pass_(pass), entry_(in.table[surface]), surface_(in.bsp.drawSurfaces[surface]),
      bounds_(surfaces.bounds[surface]),
      verts_(surfaces.verts.data() + surface_.firstVert, std::size_t(surface_.numVerts)), occlusion_(occlusion),
      counts_(counts), places_(in, surface_, verts_, entry_.shader->twoSided, surfaces.clusters[surface]),
      surfaceClusters_(surfaces.clusters[surface]), surfaceNumber_(int(surface)),
      ambient_(pass.bounce ? Vec3f{} : entry_.ambient), flood_(pass.bounce ? FloodSource{} : WorldFlood(in)) {
    settings_ = VertexSettings(in, surfaces, surface);
    FindLights(lights);
}

void VertexLighter::FindLights(const std::vector<Light> &lights) {
    const Vec3f center = bounds_.Center();
    const float radius = Length(bounds_.maxs - center);
    for (const Light &light : lights) {
        if (!light.lightsSurfaces || light.envelope <= 0)
            continue;
        if (light.type != LightType::Sun) {
            const bool seen = surfaceClusters_.empty() || light.seenFrom.empty() ||
                              std::any_of(surfaceClusters_.begin(), surfaceClusters_.end(),
                                          [&](int cluster) { return light.SeenFrom(cluster); });
            if (in_.options.sunOnly || !seen || Length(light.origin - center) - light.envelope - radius > 0 ||
                ConeMisses(light, center, radius))
                continue;
        }
        lights_.push_back(&light);
    }
}

SurfaceVertexLight VertexLighter::Run() {
    result_.values[0].assign(verts_.size(), ambient_);
    if (StyleChoice::IsNeeded(lights_))
        ChooseStyles();
    std::vector<bool> lit(verts_.size()); // in the open at some offset
    VertexIndices hidden(verts_.size());
    std::iota(hidden.begin(), hidden.end(), std::size_t(0));
    const bool anyLight = !lights_.empty() || flood_.light != Vec3f{};
    for (const int x : kNudgeSteps)
        for (const int y : kNudgeSteps)
            for (const int z : kNudgeSteps) {
                if (hidden.empty() || (!anyLight && (x != 0 || y != 0 || z != 0)))
                    continue;
                for (const std::size_t v : LightAt(hidden, Vec3f{float(x), float(y), float(z)} * kNudge))
                    lit[v] = true;
                std::erase_if(hidden, [&](std::size_t v) { return lit[v]; });
            }
    FillWithoutPlace(lit);
    return std::move(result_);
}

// ---- Units: the vertices of a surface ----

/// Where vertices are lit from depends on much of the map, so in a cache all of its geometry counts.
Hash128 VertexLighter::KeyOfUnit(const LightHashes &hashes) const {
    LightUnitKey key("vertices", hashes, *in_.units);
    key.More().Add(surfaceNumber_, pass_.bounce);
    if (!in_.units->IsCache())
        return key.Key();
    key.More().Add(in_.units->geometry.low, in_.units->geometry.high);
    for (const Light *light : lights_) {
        key.AddLight(*light);
        key.More().AddText(light->style != 0 ? light->label : std::string());
        for (const int cluster : surfaceClusters_)
            key.More().Add(light->seenFrom.empty() || light->SeenFrom(cluster));
    }
    return key.Key();
}

SurfaceVertexLight VertexLighter::FindOrRun(const LightHashes &hashes) {
    if (!in_.units || pass_.bounce)
        return Run();
    const Hash128 key = KeyOfUnit(hashes);
    if (const auto bytes = in_.units->Find(key)) {
        SurfaceVertexLight known;
        UnitReader reader(*bytes);
        std::uint8_t isConstant = 0;
        reader.Get(known.styles);
        reader.Get(isConstant);
        known.constant = isConstant != 0;
        bool fit = true;
        for (std::vector<Vec3f> &values : known.values) {
            reader.GetAll(values);
            fit = fit && (values.empty() || values.size() == verts_.size());
        }
        std::uint64_t count = 0;
        reader.Get(count);
        for (std::uint64_t i = 0; i < count && reader.Fits(); ++i)
            reader.GetText(known.dropped.emplace_back());
        if (reader.IsComplete() && fit)
            return known;
    }
    SurfaceVertexLight result = Run();
    UnitWriter writer;
    writer.Put(result.styles);
    writer.Put(std::uint8_t(result.constant ? 1 : 0));
    for (const std::vector<Vec3f> &values : result.values)
        writer.PutAll(values);
    writer.Put(std::uint64_t(result.dropped.size()));
    for (const std::string &name : result.dropped)
        writer.PutText(name);
    in_.units->Keep(key, writer.Take());
    return result;
}

/// Receivers at the vertices moved by `offset` that are not occluded there, and their indices.
std::vector<SurfaceReceiverBatch> VertexLighter::OpenVertices(const VertexIndices &vertices, const Vec3f &offset,
                                                              VertexIndices &open) {
    std::vector<SurfaceReceiverBatch> batches;
    for (const std::size_t v : vertices) {
        const int cluster = places_.ClusterAt(v, offset);
        if (cluster < 0)
            continue;
        if (open.size() % kPacketSize == 0) {
            batches.emplace_back();
            batches.back().twoSided = entry_.shader->twoSided;
        }
        open.push_back(v);
        batches.back().Add(places_.RayOrigin(v) + offset, verts_[v].normal, cluster);
    }
    return batches;
}

/// Leaves out lights of styles that find no slot.
void VertexLighter::ChooseStyles() {
    VertexIndices every(verts_.size()), open;
    std::iota(every.begin(), every.end(), std::size_t(0));
    std::vector<SurfaceReceiverBatch> batches = OpenVertices(every, {}, open);
    StyleChoice choice;
    SurfaceIncidentLight incident;
    for (const LightGroup &group : LightGroupsOf(lights_, settings_)) {
        double energy = 0;
        const Vec3f &color = group.Color();
        for (SurfaceReceiverBatch &batch : batches) {
            if (group.First().style == 0)
                continue;
            GroupContributionToSample(group, settings_, in_.scene, batch, incident, counts_);
            for (std::size_t i = 0; i < batch.count; ++i)
                if (incident.live[i] != 0)
                    energy += double(incident.strength[i]) * double(color.x + color.y + color.z);
        }
        choice.Add(group.First(), energy);
    }
    choice.Choose();
    result_.dropped = choice.DroppedLightNames();
    std::erase_if(lights_, [&](const Light *light) { return choice.Drops(light->style); });
}

VertexLighter::VertexIndices VertexLighter::LightAt(const VertexIndices &vertices, const Vec3f &offset) {
    VertexIndices open;
    std::vector<SurfaceReceiverBatch> batches = OpenVertices(vertices, offset, open);
    for (const std::size_t v : open)
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (!result_.values[slot].empty())
                result_.values[slot][v] = slot == 0 ? ambient_ : Vec3f{};
    AddLights(batches, open);
    for (std::size_t b = 0; b < batches.size(); ++b)
        AddAmbientOcclusion(batches[b], std::span(open).subspan(b * kPacketSize, batches[b].count));
    return open;
}

void VertexLighter::AddLights(std::span<SurfaceReceiverBatch> batches, const VertexIndices &vertices) {
    SurfaceIncidentLight incident;
    for (const LightGroup &group : LightGroupsOf(lights_, settings_)) {
        const Light *light = &group.First();
        const std::size_t slot = StyleSlotFor(result_.styles, light->style);
        if (slot == kStyles) // its light arrived beside vertices in solids only, where ChooseStyles did not look
            continue;
        for (std::size_t b = 0; b < batches.size(); ++b) {
            GroupContributionToSample(group, settings_, in_.scene, batches[b], incident, counts_);
            for (std::size_t i = 0; i < batches[b].count; ++i) {
                if (incident.live[i] == 0)
                    continue;
                const std::size_t v = vertices[b * kPacketSize + i];
                const Vec3f color = group.Color() * (light->negative ? -incident.strength[i] : incident.strength[i]);
                AddTo(slot, v, incident.tinted ? color * incident.tint[i] : color);
                result_.styles[slot] = std::uint8_t(light->style);
                const Vec3f &soFar = result_.values[0][v];
                if (in_.lightmap.cheap && std::min({soFar.x, soFar.y, soFar.z}) >= kWhite)
                    batches[b].wanted[i] = 0;
            }
        }
    }
}

void VertexLighter::AddTo(std::size_t slot, std::size_t vertex, const Vec3f &light) {
    std::vector<Vec3f> &values = result_.values[slot];
    if (values.empty())
        values.resize(verts_.size());
    values[vertex] += light;
}

/// Multiplies by dirt, then adds floodlight.
void VertexLighter::AddAmbientOcclusion(const SurfaceReceiverBatch &batch, std::span<const std::size_t> vertices) {
    const bool dirty = in_.lightmap.dirty && !pass_.bounce && !entry_.shader->lightmap.noDirt;
    if (!dirty && flood_.light == Vec3f{})
        return;
    OcclusionReceivers receivers;
    receivers.receiveShadows = entry_.receiveShadows;
    receivers.surfaces = {&surfaceNumber_, 1};
    receivers.atVertices = true;
    for (std::size_t i = 0; i < batch.count; ++i)
        receivers.Add(batch.position[i], batch.normal[i],
                      std::uint32_t(surface_.firstVert) + std::uint32_t(vertices[i]));
    const bool anyLight = std::any_of(vertices.begin(), vertices.end(), [&](std::size_t v) {
        return std::any_of(result_.values.begin(), result_.values.end(),
                           [&](const auto &values) { return !values.empty() && values[v] != Vec3f{}; });
    });
    if (dirty && anyLight) {
        std::vector<Lanes> dirt;
        occlusion_.Dirt({&receivers, 1}, dirt, counts_);
        for (std::vector<Vec3f> &values : result_.values)
            for (std::size_t i = 0; i < batch.count && !values.empty(); ++i)
                values[vertices[i]] *= dirt[0][i];
    }
    if (flood_.light != Vec3f{}) {
        Lanes visibility;
        occlusion_.SkyVisibility(receivers, flood_.distance, visibility, counts_);
        for (std::size_t i = 0; i < batch.count; ++i)
            result_.values[0][vertices[i]] += flood_.light * visibility[i];
    }
}

Vec3f MeanOf(const std::vector<Vec3f> &values, const std::set<std::size_t> &vertices) {
    Vec3f sum;
    for (const std::size_t v : vertices)
        sum += values[v];
    return sum / float(vertices.size());
}

/// Vertices that are occluded at all offsets get the mean of the others that they share edges with, or of all others.
void VertexLighter::FillWithoutPlace(const std::vector<bool> &lit) {
    if (std::find(lit.begin(), lit.end(), false) == lit.end())
        return;
    std::vector<std::set<std::size_t>> around(lit.size()); // lit vertices at the other ends of edges
    for (const auto &[a, b] : places_.Edges()) {
        if (lit[a] && !lit[b])
            around[b].insert(a);
        if (lit[b] && !lit[a])
            around[a].insert(b);
    }
    for (std::size_t slot = 0; slot < kStyles; ++slot) {
        std::vector<Vec3f> &values = result_.values[slot];
        if (values.empty())
            continue;
        Vec3f sum;
        float count = 0;
        for (std::size_t v = 0; v < values.size(); ++v)
            if (lit[v])
                sum += values[v], count += 1;
        const Vec3f mean = count > 0 ? sum / count : slot == 0 ? ambient_ : Vec3f{};
        for (std::size_t v = 0; v < values.size(); ++v)
            if (!lit[v])
                values[v] = around[v].empty() ? mean : MeanOf(values, around[v]);
    }
}

/// The light of surfaces whose vertices show a constant or a debug view; none for others.
std::optional<SurfaceVertexLight> ConstantLight(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                                std::size_t surface) {
    const bspDrawSurface_t &record = in.bsp.drawSurfaces[surface];
    const std::span<const SurfaceVertex> verts(surfaces.verts.data() + record.firstVert, std::size_t(record.numVerts));
    SurfaceVertexLight result;
    result.constant = true;
    std::vector<Vec3f> &values = result.values[0];
    values.resize(verts.size());
    const auto fill = [&](float light) { std::fill(values.begin(), values.end(), Vec3f{light, light, light}); };
    const Boundsf &bounds = surfaces.bounds[surface];
    const bool litAtVertices = surfaces.lightmapOf[surface] < 0 || in.lightmap.cpma;
    if (in.lightmap.show == DebugView::Surfaces)
        std::fill(values.begin(), values.end(), DebugColor(int(surface)));
    else if (in.lightmap.show == DebugView::Origin && litAtVertices)
        for (std::size_t v = 0; v < verts.size(); ++v)
            values[v] = PositionColor(verts[v].xyz, bounds);
    else if (in.lightmap.show == DebugView::NormalMap)
        for (std::size_t v = 0; v < verts.size(); ++v)
            values[v] = VectorColor(verts[v].normal);
    else if (in.table[surface].shader->lightmap.noVertexLight)
        fill(kConstantLight);
    else if (in.lightmap.noVertex)
        fill(kConstantLight * *in.lightmap.noVertex);
    else
        return std::nullopt;
    return result;
}

/// Mean light of the mapped luxels nearest to a position in the super grid: on the smallest square around it that has
/// any.
Vec3f NearestLight(const RawLightmap &raw, const std::vector<Vec3f> &light, const std::array<float, 2> &position,
                   const Vec3f &otherwise) {
    const int width = raw.SuperWidth(), height = raw.SuperHeight();
    const auto at = [](float coordinate, int size) {
        return std::isfinite(coordinate) ? int(std::clamp(std::floor(coordinate), 0.0f, float(size - 1))) : 0;
    };
    const int x = at(position[0], width), y = at(position[1], height);
    for (int radius = 0; radius < std::max(width, height); ++radius) {
        Vec3f sum;
        float count = 0;
        for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v)
            for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u)
                // Only the rim of the square: smaller squares had none.
                if (const std::size_t luxel = raw.SuperIndex(u, v);
                    std::max(std::abs(u - x), std::abs(v - y)) == radius && raw.Mapped(luxel))
                    sum += light[luxel], count += 1;
        if (count > 0)
            return sum / count;
    }
    return otherwise;
}

SurfaceVertexLight FromLightmap(const SurfaceInputs &in, const SurfacePass &pass, const SurfaceLight &surfaces,
                                std::size_t surface) {
    const bspDrawSurface_t &record = in.bsp.drawSurfaces[surface];
    const RawLightmap &raw = surfaces.lightmaps[std::size_t(surfaces.lightmapOf[surface])];
    const Vec3f ambient = pass.bounce ? Vec3f{} : in.table[surface].ambient;
    SurfaceVertexLight result;
    result.styles = raw.styles;
    for (std::size_t slot = 0; slot < kStyles; ++slot) {
        if (raw.light[slot].empty())
            continue;
        result.values[slot].resize(std::size_t(record.numVerts));
        for (std::size_t v = 0; v < result.values[slot].size(); ++v)
            result.values[slot][v] =
                NearestLight(raw, raw.light[slot], surfaces.verts[std::size_t(record.firstVert) + v].luxel,
                             slot == 0 ? ambient : Vec3f{});
    }
    return result;
}

/// Adds the light at the vertices of a surface to `vertex`.
void Store(const SurfaceInputs &in, const SurfacePass &pass, std::size_t surface, const SurfaceVertexLight &from,
           VertexLight &vertex) {
    // -bounceonly keeps direct light out of the result, not out of the radiosity, which bounces on. Constant light
    // counts in the first pass only.
    const bool direct = !pass.bounce;
    const bool addsToResult = from.constant ? direct : !(direct && in.lightmap.bounceOnly && in.lightmap.bounces > 0);
    const bool setsRadiosity = !from.constant || direct;
    const auto first = std::size_t(in.bsp.drawSurfaces[surface].firstVert);
    Styles &styles = vertex.styles[surface];
    for (std::size_t slot = 0; slot < kStyles; ++slot) {
        if (from.values[slot].empty())
            continue;
        const std::size_t to = StyleSlotFor(styles, from.styles[slot]);
        if (to == kStyles)
            continue;
        styles[to] = from.styles[slot];
        for (auto *values : {&vertex.sum[to], &vertex.radiosity[to]})
            if (values->empty())
                values->resize(in.bsp.drawVerts.size());
        for (std::size_t v = 0; v < from.values[slot].size(); ++v) {
            if (addsToResult)
                vertex.sum[to][first + v] += from.values[slot][v];
            if (setsRadiosity)
                vertex.radiosity[to][first + v] = from.values[slot][v];
        }
    }
}

/// By surface, whether this process lights its vertices.
std::vector<std::uint8_t> OwnSurfaces(const SurfaceInputs &in) {
    std::vector<double> costs;
    for (const bspDrawSurface_t &surface : in.bsp.drawSurfaces)
        costs.push_back(double(surface.numVerts));
    const bool isPart = in.units && in.units->IsPartOfFirstRound();
    return isPart ? in.units->Own(costs, UnitStore::Division::BySize) : std::vector<std::uint8_t>(costs.size(), 1);
}

} // namespace

void LightVertices(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                   SurfaceLight &surfaces, ContributionCounts &counts) {
    const std::size_t count = in.bsp.drawSurfaces.size();
    VertexLight &vertex = surfaces.vertex;
    vertex.styles.resize(count, kOnlyStyle0);
    vertex.sum[0].resize(in.bsp.drawVerts.size());
    vertex.radiosity[0].resize(in.bsp.drawVerts.size());
    for (std::vector<Vec3f> &values : vertex.radiosity)
        std::fill(values.begin(), values.end(), Vec3f{});

    const AmbientOcclusion occlusion(in);
    const LightHashes hashes(lights, in.units);
    const std::vector<std::uint8_t> own = OwnSurfaces(in);
    std::vector<SurfaceVertexLight> results(count);
    std::vector<ContributionCounts> work(std::size_t(in.jobs.Threads()));
    in.jobs.For(std::int64_t(count), [&](std::int64_t number, int worker) {
        const auto surface = std::size_t(number);
        if (in.bsp.drawSurfaces[surface].numVerts <= 0 || in.table[surface].parent >= 0)
            return;
        if (auto shown = ConstantLight(in, surfaces, surface))
            results[surface] = std::move(*shown);
        else if (surfaces.lightmapOf[surface] >= 0 && !in.lightmap.cpma)
            results[surface] = FromLightmap(in, pass, surfaces, surface);
        else if (own[surface] != 0)
            results[surface] = VertexLighter(in, lights, pass, surfaces, surface, occlusion, work[std::size_t(worker)])
                                   .FindOrRun(hashes);
    });
    long long vertices = 0;
    DroppedLights dropped(count);
    for (std::size_t surface = 0; surface < count; ++surface) {
        Store(in, pass, surface, results[surface], vertex);
        dropped[surface] = std::move(results[surface].dropped);
        vertices += (long long)(results[surface].values[0].size());
    }
    for (const ContributionCounts &one : work)
        counts += one;
    in.log.Count(vertices, "vertices lit");
    WarnOfDroppedLights(dropped, "light", "surfaces lit at vertices", in.log);
}

} // namespace q3
