// GPL-2.0-or-later. Where each luxel is lit from.
#include "q3map2/lightmap/raw/luxel_map.h"

#include "q3map2/lightmap/raw/luxel_masks.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "q3map2/lightmap/raw/luxel_place.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace q3 {

namespace {

/// Lift of luxels off their surface where the shader does not say. Game units.
constexpr float kSampleOffset = 1;
/// The finest -thresh that counts; finer ones would only take time. Luxels.
constexpr float kLeastThreshold = 1.0f / 32;
/// The fourth corner of a quad of a patch may be so far off the plane of the others. Game units.
constexpr float kQuadFlatness = 0.5f;

/// Counts of one raw lightmap.
struct MapCounts {
    PlacementCounts placed;
    std::uint64_t mapped = 0, occluded = 0;
};

/// The reusable memory of one worker.
struct MapScratch {
    std::vector<int> hits;            // samples in each luxel
    std::vector<std::uint8_t> passes; // that mapped each luxel
};

Boundsf BoundsOfLuxels(const RawLightmap &raw, float margin) {
    Boundsf box = raw.bounds;
    if (raw.hasVectors)
        for (const int x : {-1, raw.SuperWidth()})
            for (const int y : {-1, raw.SuperHeight()})
                box.Add(raw.origin + raw.step[0] * float(x) + raw.step[1] * float(y));
    box.mins -= {margin, margin, margin};
    box.maxs += {margin, margin, margin};
    return box;
}

class LuxelMapper {
  public:
    LuxelMapper(const SurfaceInputs &in, const SurfaceLight &surfaces, RawLightmap &raw, MapScratch &scratch)
        : in_(in), surfaces_(surfaces), raw_(raw), scratch_(scratch), placer_(in, raw, BoundsOfLuxels(raw, Reach())) {
        superWidth_ = raw.SuperWidth(), superHeight_ = raw.SuperHeight();
        const float threshold = std::max(kLeastThreshold, std::abs(in.lightmap.threshold));
        threshold2_ = threshold * threshold;
        const auto count = std::size_t(raw.SuperWidth()) * std::size_t(raw.SuperHeight());
        raw.positions.assign(count, {});
        raw.normals.assign(count, {});
        raw.luxelClusters.assign(count, kUnmapped);
        scratch.hits.assign(count, 0);
        scratch.passes.assign(count, 0);
    }

    MapCounts Run() {
        allOneNormal_ = HasOneNormal();
        for (std::size_t i = 0; i < raw_.surfaces.size(); ++i) {
            if (std::exchange(anyClosed_, false)) // for one surface; the next may find a place
                std::replace_if(
                    raw_.luxelClusters.begin(), raw_.luxelClusters.end(), [](int code) { return code < 0; },
                    int(kUnmapped));
            MapSurface(raw_.surfaces[i]);
        }
        if (anySums_)
            MakeUnitNormals();
        if (raw_.planar)
            for (int pass = 2; pass <= std::max(1, raw_.super / 2) + 1; ++pass)
                MapRing(pass);
        for (const int code : raw_.luxelClusters) {
            counts_.mapped += code >= 0 ? 1 : 0;
            counts_.occluded += code == kOccluded ? 1 : 0;
        }
        return counts_;
    }

  private:
    float Reach() const;
    bool HasOneNormal() const;
    LuxelPlane PlaneOf(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c) const;
    bool Usable(const LuxelPlane &plane) const;
    void MapSurface(int number);
    void MapTriangles(const bspDrawSurface_t &surface, const Image *normals);
    void MapMesh(const bspDrawSurface_t &surface, const SurfaceEntry &entry);
    void MapTriangle(const std::array<SurfaceVertex, 3> &triangle, const Image *normals, bool thinEdges);
    void MapFlatTriangle(const std::array<SurfaceVertex, 3> &triangle, const LuxelPlane &plane);
    bool MapQuad(const std::array<SurfaceVertex, 4> &quad, const Image *normals);
    void MapSample(const SurfaceVertex &v, const LuxelPlane &plane, const NormalMap &normals) {
        MapLuxel(LuxelOf(v.luxel[0], superWidth_), LuxelOf(v.luxel[1], superHeight_), v, plane, normals);
    }
    void MapLuxel(int x, int y, const SurfaceVertex &v, const LuxelPlane &plane, const NormalMap &normals);
    void Take(std::size_t luxel, const LuxelPlacer::Place &place, const Vec3f &normal, int pass);
    void MapRing(int pass);
    Vec3f NormalAround(int x, int y, int pass) const;
    void MakeUnitNormals();

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    RawLightmap &raw_;
    MapScratch &scratch_;
    LuxelPlacer placer_;
    float threshold2_ = 1;
    int superWidth_ = 0, superHeight_ = 0;
    MapCounts counts_;
    bool anyClosed_ = false, anySums_ = false; // some luxel is closed, or has the sum of several normals

    // Of the surface being mapped.
    float offset_ = kSampleOffset;
    ClusterFilter *filter_ = nullptr;
    bool oneNormal_ = false;    // all its vertices have the same
    bool allOneNormal_ = false; // so have those of the other surfaces: one sample a luxel tells all
};

float OffsetOf(const SurfaceEntry &entry) {
    const float offset = entry.shader->lightmap.sampleOffset;
    return offset == 0 ? kSampleOffset : offset;
}

/// How far from its surfaces a luxel may be placed.
float LuxelMapper::Reach() const {
    float offset = kSampleOffset;
    for (const int number : raw_.surfaces)
        offset = std::max(offset, std::abs(OffsetOf(in_.table[std::size_t(number)])));
    return offset + 1 + raw_.actualSampleSize;
}

bool LuxelMapper::HasOneNormal() const {
    const Vec3f *normal = nullptr;
    for (const int number : raw_.surfaces) {
        const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(number)];
        for (int k = 0; k < surface.numVerts; ++k) {
            const Vec3f &own = surfaces_.verts[std::size_t(surface.firstVert + k)].normal;
            if (normal && own != *normal)
                return false;
            normal = &own;
        }
    }
    return true;
}

LuxelPlane LuxelMapper::PlaneOf(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c) const {
    if (raw_.planar)
        return {raw_.planeNormal, raw_.planeDist, nullptr};
    const Vec3f normal = Normalize(Cross(c.xyz - a.xyz, b.xyz - a.xyz));
    return {normal, Dot(normal, a.xyz), nullptr};
}

/// Luxels can be placed on it: it has a normal, and is not seen edge-on along the projection.
bool LuxelMapper::Usable(const LuxelPlane &plane) const {
    return plane.normal != Vec3f{} && IsFinite(plane.normal) &&
           (!raw_.hasVectors || std::abs(plane.normal[AxesOf(raw_.axis).along]) > 1e-6f);
}

void LuxelMapper::MapSurface(int number) {
    const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(number)];
    const SurfaceEntry &entry = in_.table[std::size_t(number)];
    ClusterFilter filter(in_.space, surfaces_.clusters[std::size_t(number)]);
    filter_ = &filter;
    offset_ = OffsetOf(entry);
    const auto first = surfaces_.verts.begin() + surface.firstVert;
    // Vertices that a damaged map shares among surfaces may lie in another lightmap.
    const auto inside = [&](const SurfaceVertex &v) {
        return v.luxel[0] > -1 && v.luxel[0] < float(raw_.SuperWidth() + 1) && v.luxel[1] > -1 &&
               v.luxel[1] < float(raw_.SuperHeight() + 1);
    };
    if (!std::all_of(first, first + surface.numVerts, inside))
        return;
    oneNormal_ =
        std::all_of(first, first + surface.numVerts, [&](const SurfaceVertex &v) { return v.normal == first->normal; });
    if (surface.surfaceType == MST_PATCH)
        MapMesh(surface, entry);
    else
        MapTriangles(surface, entry.normalImage.get());
}

void LuxelMapper::MapTriangles(const bspDrawSurface_t &surface, const Image *normals) {
    for (const bool thinEdges : {true, false})
        for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
            const auto corner = [&](int k) {
                const int index = in_.bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)];
                return surfaces_.verts[std::size_t(surface.firstVert + index)];
            };
            MapTriangle({corner(0), corner(1), corner(2)}, normals, thinEdges);
        }
}

void LuxelMapper::MapMesh(const bspDrawSurface_t &surface, const SurfaceEntry &entry) {
    MeshOf<SurfaceVertex> mesh{surface.patchWidth, surface.patchHeight, {}};
    const auto first = surfaces_.verts.begin() + surface.firstVert;
    mesh.verts.assign(first, first + surface.numVerts);
    mesh = Tessellated(std::move(mesh), entry.longestCurve);
    for (int y = 0; y + 1 < mesh.height; ++y)
        for (int x = 0; x + 1 < mesh.width; ++x) {
            const auto quad = MeshQuad(mesh, x, y);
            if (MapQuad(quad, entry.normalImage.get()))
                continue;
            for (const bool thinEdges : {true, false}) {
                MapTriangle({quad[0], quad[1], quad[2]}, entry.normalImage.get(), thinEdges);
                MapTriangle({quad[0], quad[2], quad[3]}, entry.normalImage.get(), thinEdges);
            }
        }
}

void LuxelMapper::MapTriangle(const std::array<SurfaceVertex, 3> &triangle, const Image *normals, bool thinEdges) {
    LuxelPlane plane = PlaneOf(triangle[0], triangle[1], triangle[2]);
    if (!Usable(plane))
        return;
    plane.triangle = &triangle;
    const NormalMap map(normals, triangle[0], triangle[1], triangle[2]);
    if (allOneNormal_ && !map.Active() && raw_.planar && raw_.hasVectors) {
        if (!thinEdges)
            MapFlatTriangle(triangle, plane);
        return;
    }
    const auto sample = [&](const SurfaceVertex &v) { MapSample(v, plane, map); };
    for (const SurfaceVertex &v : triangle)
        sample(v);
    const auto subdivide = [&]<bool kFlat>() {
        if (thinEdges)
            ForThinEdges(triangle, [&](const SurfaceVertex &p, const SurfaceVertex &q) {
                SubdivideTriangle<kFlat>(p, q, q, threshold2_, sample);
            });
        else
            SubdivideTriangle<kFlat>(triangle[0], triangle[1], triangle[2], threshold2_, sample);
    };
    if (oneNormal_)
        subdivide.template operator()<true>();
    else
        subdivide.template operator()<false>();
}

/// A triangle of a planar lightmap where one sample a luxel tells all.
void LuxelMapper::MapFlatTriangle(const std::array<SurfaceVertex, 3> &triangle, const LuxelPlane &plane) {
    const LuxelTriangle flat = {triangle[0].luxel, triangle[1].luxel, triangle[2].luxel};
    ForLuxels(flat, superWidth_, superHeight_, [&](int x, int y) {
        const std::size_t luxel = raw_.SuperIndex(x, y);
        if (raw_.luxelClusters[luxel] == kUnmapped)
            Take(luxel, placer_.Find(x, y, nullptr, plane, offset_, true, *filter_, counts_.placed), triangle[0].normal,
                 1);
    });
}

/// False if the quad is not flat.
bool LuxelMapper::MapQuad(const std::array<SurfaceVertex, 4> &quad, const Image *normals) {
    const LuxelPlane plane = PlaneOf(quad[0], quad[1], quad[2]);
    if (!Usable(plane) || std::abs(Dot(plane.normal, quad[3].xyz) - plane.dist) > kQuadFlatness)
        return false;
    const NormalMap map(normals, quad[0], quad[1], quad[2]);
    const auto sample = [&](const SurfaceVertex &v) { MapSample(v, plane, map); };
    for (const SurfaceVertex &v : quad)
        sample(v);
    if (oneNormal_)
        SubdivideQuad<true>(quad[0], quad[1], quad[2], quad[3], threshold2_, sample);
    else
        SubdivideQuad<false>(quad[0], quad[1], quad[2], quad[3], threshold2_, sample);
    return true;
}

/// What a surface that passes through the luxel at v makes of it.
void LuxelMapper::MapLuxel(int x, int y, const SurfaceVertex &v, const LuxelPlane &plane, const NormalMap &normals) {
    const std::size_t luxel = raw_.SuperIndex(x, y);
    const int code = raw_.luxelClusters[luxel];
    if (code >= 0 ? allOneNormal_ && !normals.Active() : code == kOccluded && raw_.planar)
        return; // nothing would change
    const auto normal = [&] { return normals.Active() ? normals.Bent(v) : v.normal; };
    if (code >= 0) {
        raw_.normals[luxel] += normal();
        ++scratch_.hits[luxel];
        anySums_ = true;
        return;
    }
    Take(luxel, placer_.Find(x, y, &v, plane, offset_, true, *filter_, counts_.placed), normal(), 1);
}

/// The luxel's place, found in that pass.
void LuxelMapper::Take(std::size_t luxel, const LuxelPlacer::Place &place, const Vec3f &normal, int pass) {
    if (place.Closed()) {
        raw_.luxelClusters[luxel] = kOccluded;
        anyClosed_ = true;
        return;
    }
    raw_.luxelClusters[luxel] = place.cluster;
    raw_.positions[luxel] = place.xyz;
    raw_.normals[luxel] = normal;
    scratch_.hits[luxel] = 1;
    scratch_.passes[luxel] = std::uint8_t(pass);
}

void LuxelMapper::MakeUnitNormals() {
    for (std::size_t i = 0; i < raw_.luxelClusters.size(); ++i)
        if (raw_.Mapped(i) && scratch_.hits[i] > 1)
            raw_.normals[i] = Normalize(raw_.normals[i]);
}

/// Mean normal of neighbours that an earlier pass mapped; zero without any. Of equal ones not a bit differs: blocks of
/// luxels that all face the same way take less time.
Vec3f LuxelMapper::NormalAround(int x, int y, int pass) const {
    Vec3f sum;
    const Vec3f *one = nullptr;
    bool equal = true;
    for (int v = std::max(0, y - 1); v <= std::min(raw_.SuperHeight() - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(raw_.SuperWidth() - 1, x + 1); ++u) {
            const std::size_t luxel = raw_.SuperIndex(u, v);
            if (!raw_.Mapped(luxel) || scratch_.passes[luxel] >= pass)
                continue;
            sum += raw_.normals[luxel];
            equal = equal && (!one || *one == raw_.normals[luxel]);
            one = &raw_.normals[luxel];
        }
    return one && equal ? *one : Normalize(sum);
}

/// Luxels beside the surface that touch mapped ones: texture filtering reads them.
void LuxelMapper::MapRing(int pass) {
    const std::vector<int> anywhere;
    ClusterFilter filter(in_.space, anywhere);
    const LuxelPlane plane{raw_.planeNormal, raw_.planeDist, nullptr};
    LuxelMask earlier(raw_.luxelClusters.size());
    for (std::size_t i = 0; i < earlier.size(); ++i)
        earlier[i] = raw_.Mapped(i) && scratch_.passes[i] < pass;
    const LuxelMask touching = Spread(earlier, superWidth_, superHeight_);
    for (int y = 0; y < superHeight_; ++y)
        for (int x = 0; x < superWidth_; ++x) {
            const std::size_t luxel = raw_.SuperIndex(x, y);
            if (raw_.luxelClusters[luxel] != kUnmapped || touching[luxel] == 0)
                continue;
            if (const Vec3f normal = NormalAround(x, y, pass); normal != Vec3f{})
                Take(luxel, placer_.Find(x, y, nullptr, plane, kSampleOffset, false, filter, counts_.placed), normal,
                     pass);
        }
}

void Report(const SurfaceLight &surfaces, const std::vector<MapCounts> &counts, Log &log) {
    MapCounts sum;
    std::size_t luxels = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        luxels += surfaces.lightmaps[i].luxelClusters.size();
        sum.mapped += counts[i].mapped;
        sum.occluded += counts[i].occluded;
        sum.placed.atVertex += counts[i].placed.atVertex;
        sum.placed.failed += counts[i].placed.failed;
        for (std::size_t k = 0; k < sum.placed.nudges.size(); ++k)
            sum.placed.nudges[k] += counts[i].placed.nudges[k];
    }
    log.Count((long long)(luxels), "luxels");
    log.Count((long long)(sum.mapped), "luxels mapped");
    log.Count((long long)(sum.occluded), "luxels occluded");
    log.Verbose("{:9} luxels placed at their centre, {} nudged, {} at a vertex; {} attempts failed\n",
                sum.placed.nudges[0],
                std::accumulate(sum.placed.nudges.begin() + 1, sum.placed.nudges.end(), std::uint64_t(0)),
                sum.placed.atVertex, sum.placed.failed);
}

} // namespace

void MapLuxels(const SurfaceInputs &in, SurfaceLight &surfaces) {
    std::vector<MapCounts> counts(surfaces.lightmaps.size());
    std::vector<MapScratch> scratch(std::size_t(in.jobs.Threads()));
    in.jobs.For(std::int64_t(counts.size()), [&](std::int64_t i, int worker) {
        RawLightmap &raw = surfaces.lightmaps[std::size_t(i)];
        counts[std::size_t(i)] = LuxelMapper(in, surfaces, raw, scratch[std::size_t(worker)]).Run();
    });
    Report(surfaces, counts, in.log);
}

} // namespace q3
