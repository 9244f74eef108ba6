// GPL-2.0-or-later. The position, normal and cluster at which each luxel is lit.
#include "q3map2/lightmap/raw/luxel_map.h"

#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "q3map2/lightmap/raw/luxel_position.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <utility>

namespace q3 {

namespace {

/// Default of q3map_lightmapSampleOffset: lift of luxels off their surface. Game units.
constexpr float kSampleOffset = 1;
/// Smallest -thresh: samples this dense reach every luxel that a surface covers more than a corner of. Luxels.
constexpr float kLeastThreshold = 1.0f / 32;
/// A quad of a patch counts as flat if its fourth corner is at most this far off the plane of the others. Game units.
constexpr float kQuadFlatness = 0.5f;

/// Counts of one raw lightmap.
struct MapCounts {
    PositionCounts positions;
    std::uint64_t mapped = 0, occluded = 0;
};

/// Memory that a worker keeps from lightmap to lightmap, by luxel.
struct MapScratch {
    std::vector<int> normalCount;     // how many normals are summed up in it
    std::vector<std::uint8_t> passOf; // pass that mapped it: 1: a surface, 2 and more: a ring around surfaces
};

/// The steps in which the triangles of surfaces are mapped. Triangles of a planar lightmap with one normal take Centers
/// and Rest, so that a luxel is lit over the triangle at its center even if others cover part of it; all others take
/// ThinEdges and Rest.
enum class MapStep {
    Centers,   ///< luxels whose center a triangle covers
    ThinEdges, ///< luxels on edges along an axis of the lightmap
    Rest       ///< all others that a triangle touches
};

class LuxelMapper {
  public:
    LuxelMapper(const SurfaceInputs &in, const SurfaceLight &surfaces, RawLightmap &raw, MapScratch &scratch)
        : in_(in), surfaces_(surfaces), raw_(raw), scratch_(scratch), positionFinder_(in, raw) {
        superWidth_ = raw.SuperWidth(), superHeight_ = raw.SuperHeight();
        const float threshold = std::max(kLeastThreshold, std::abs(in.lightmap.threshold));
        threshold2_ = threshold * threshold;
        const auto count = std::size_t(raw.SuperWidth()) * std::size_t(raw.SuperHeight());
        raw.positions.assign(count, {});
        raw.normals.assign(count, {});
        raw.luxelClusters.assign(count, kUnmapped);
        scratch.normalCount.assign(count, 0);
        scratch.passOf.assign(count, 0);
    }

    MapCounts Run() {
        allOneNormal_ = HasOneNormal();
        for (std::size_t i = 0; IsFlat() && i < raw_.surfaces.size(); ++i)
            MapSurface(raw_.surfaces[i], {MapStep::Centers});
        for (const int number : raw_.surfaces)
            MapSurface(number, {MapStep::ThinEdges, MapStep::Rest});
        if (anySums_)
            MakeUnitNormals();
        // The border that bilinear filtering reads is half a luxel wide: super / 2 super luxels, at least one.
        if (raw_.planar)
            for (int pass = 2; pass <= std::max(1, raw_.super / 2) + 1; ++pass)
                MapBorder(pass);
        for (const int cluster : raw_.luxelClusters) {
            counts_.mapped += cluster >= 0 ? 1 : 0;
            counts_.occluded += cluster == kOccluded ? 1 : 0;
        }
        return counts_;
    }

  private:
    bool HasOneNormal() const;
    /// A planar lightmap of surfaces with one normal: MapFlatTriangle finds its luxels, unless normals are mapped.
    bool IsFlat() const { return allOneNormal_ && raw_.planar && raw_.hasVectors; }
    LuxelPlane PlaneOf(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c) const;
    bool Usable(const LuxelPlane &plane) const;
    using MapSteps = std::initializer_list<MapStep>;
    void MapSurface(int number, MapSteps steps);
    void RetryOccluded(int surface);
    /// None where the engine does the normal mapping, by basis maps.
    const NormalImage &NormalsOf(const SurfaceEntry &entry) const {
        return raw_.channels.basis ? noNormals_ : entry.normals;
    }
    void MapTriangles(const bspDrawSurface_t &surface, const NormalImage &normals, MapSteps steps);
    void MapMesh(const bspDrawSurface_t &surface, const SurfaceEntry &entry);
    void MapTriangle(const std::array<SurfaceVertex, 3> &triangle, const NormalImage &normals, MapStep step);
    void MapFlatTriangle(const std::array<SurfaceVertex, 3> &triangle, const LuxelPlane &plane, MapStep step);
    bool MapQuad(const std::array<SurfaceVertex, 4> &quad, const NormalImage &normals);
    void MapSample(const SurfaceVertex &v, const LuxelPlane &plane, const NormalMap &normals) {
        MapLuxel(LuxelOf(v.luxel[0], superWidth_), LuxelOf(v.luxel[1], superHeight_), v, plane, normals);
    }
    void MapLuxel(int x, int y, const SurfaceVertex &v, const LuxelPlane &plane, const NormalMap &normals);
    void SetLuxel(std::size_t luxel, const LuxelPosition &position, const Vec3f &normal, int pass);
    void MapBorder(int pass);
    template <typename Luxel> void ForEarlierAround(int x, int y, int pass, const Luxel &luxel) const;
    Vec3f NormalAround(int x, int y, int pass) const;
    void MakeUnitNormals();

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    RawLightmap &raw_;
    MapScratch &scratch_;
    const NormalImage noNormals_{};
    LuxelPositionFinder positionFinder_;
    float threshold2_ = 1;
    int superWidth_ = 0, superHeight_ = 0;
    MapCounts counts_;
    bool anyOccluded_ = false, anySums_ = false; // some luxel is occluded, or has the sum of several normals
    int lastSurface_ = -1;                       // the surface that was mapped last
    bool allOneNormal_ = false; // all vertices of all surfaces have the same normal: one sample a luxel is enough

    // Of the surface being mapped.
    float offset_ = kSampleOffset;
    VisibleClusters *filter_ = nullptr;
    bool oneNormal_ = false; // all its vertices have the same normal
};

float SampleOffsetOf(const SurfaceEntry &entry) {
    const float offset = entry.shader->lightmap.sampleOffset;
    return offset == 0 ? kSampleOffset : offset;
}

bool LuxelMapper::HasOneNormal() const {
    const Vec3f *normal = nullptr;
    for (const int number : raw_.surfaces) {
        const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(number)];
        for (int k = 0; k < surface.numVerts; ++k) {
            const Vec3f &vertexNormal = surfaces_.verts[std::size_t(surface.firstVert + k)].normal;
            if (normal && vertexNormal != *normal)
                return false;
            normal = &vertexNormal;
        }
    }
    return true;
}

LuxelPlane LuxelMapper::PlaneOf(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c) const {
    if (raw_.planar)
        return {raw_.planeNormal, raw_.planeDist};
    const Vec3f normal = Normalize(Cross(c.xyz - a.xyz, b.xyz - a.xyz));
    return {normal, Dot(normal, a.xyz), nullptr, raw_.hasVectors ? LuxelSteps{} : LuxelStepsOf(a, b, c)};
}

/// Whether luxels can be projected onto the plane: it has a normal, and is not edge-on along the projection axis.
bool LuxelMapper::Usable(const LuxelPlane &plane) const {
    constexpr float kEdgeOnComponent = 1e-6f;
    return plane.normal != Vec3f{} && IsFinite(plane.normal) &&
           (!raw_.hasVectors || std::abs(plane.normal[AxesOf(raw_.axis).along]) > kEdgeOnComponent);
}

/// Luxels that an earlier surface left in solids are tried again: this one may find an open position.
void LuxelMapper::RetryOccluded(int surface) {
    if (anyOccluded_ && lastSurface_ != surface) {
        std::replace_if(
            raw_.luxelClusters.begin(), raw_.luxelClusters.end(), [](int cluster) { return cluster < 0; },
            int(kUnmapped));
        anyOccluded_ = false;
    }
    lastSurface_ = surface;
}

void LuxelMapper::MapSurface(int number, MapSteps steps) {
    RetryOccluded(number);
    const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(number)];
    const SurfaceEntry &entry = in_.table[std::size_t(number)];
    VisibleClusters filter(in_.space, surfaces_.clusters[std::size_t(number)]);
    filter_ = &filter;
    offset_ = SampleOffsetOf(entry);
    const auto first = surfaces_.verts.begin() + surface.firstVert;
    // Vertices that a damaged map shares among surfaces may lie in another lightmap.
    const auto inside = [&](const SurfaceVertex &v) { // up to one luxel of rounding outside
        return v.luxel[0] > -1 && v.luxel[0] < float(raw_.SuperWidth() + 1) && v.luxel[1] > -1 &&
               v.luxel[1] < float(raw_.SuperHeight() + 1);
    };
    if (!std::all_of(first, first + surface.numVerts, inside))
        return;
    oneNormal_ =
        std::all_of(first, first + surface.numVerts, [&](const SurfaceVertex &v) { return v.normal == first->normal; });
    if (surface.surfaceType != MST_PATCH)
        MapTriangles(surface, NormalsOf(entry), steps);
    else if (*steps.begin() != MapStep::Centers)
        MapMesh(surface, entry);
}

void LuxelMapper::MapTriangles(const bspDrawSurface_t &surface, const NormalImage &normals, MapSteps steps) {
    for (const MapStep step : steps)
        for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
            const auto corner = [&](int k) {
                const int index = in_.bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)];
                return surfaces_.verts[std::size_t(surface.firstVert + index)];
            };
            MapTriangle({corner(0), corner(1), corner(2)}, normals, step);
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
            if (MapQuad(quad, NormalsOf(entry)))
                continue;
            for (const MapStep step : {MapStep::Centers, MapStep::ThinEdges, MapStep::Rest}) {
                MapTriangle({quad[0], quad[1], quad[2]}, NormalsOf(entry), step);
                MapTriangle({quad[0], quad[2], quad[3]}, NormalsOf(entry), step);
            }
        }
}

void LuxelMapper::MapTriangle(const std::array<SurfaceVertex, 3> &triangle, const NormalImage &normals, MapStep step) {
    LuxelPlane plane = PlaneOf(triangle[0], triangle[1], triangle[2]);
    if (!Usable(plane))
        return;
    plane.triangle = &triangle;
    const NormalMap map(normals, triangle[0], triangle[1], triangle[2]);
    if (IsFlat() && !map.Active()) {
        MapFlatTriangle(triangle, plane, step);
        return;
    }
    if (step == MapStep::Centers)
        return;
    const auto sample = [&](const SurfaceVertex &v) { MapSample(v, plane, map); };
    for (const SurfaceVertex &v : triangle)
        sample(v);
    const auto subdivide = [&]<bool kOneNormal>() {
        if (step == MapStep::ThinEdges)
            ForAxisEdges(triangle, [&](const SurfaceVertex &p, const SurfaceVertex &q) {
                SubdivideTriangle<kOneNormal>(p, q, q, threshold2_, sample);
            });
        else
            SubdivideTriangle<kOneNormal>(triangle[0], triangle[1], triangle[2], threshold2_, sample);
    };
    if (oneNormal_)
        subdivide.template operator()<true>();
    else
        subdivide.template operator()<false>();
}

/// A triangle of a planar lightmap with one normal: covered luxels are found row by row.
void LuxelMapper::MapFlatTriangle(const std::array<SurfaceVertex, 3> &triangle, const LuxelPlane &plane, MapStep step) {
    if (step == MapStep::ThinEdges)
        return;
    const LuxelTriangle flat = {triangle[0].luxel, triangle[1].luxel, triangle[2].luxel};
    ForCoveredLuxels(flat, superWidth_, superHeight_, [&](int x, int y) {
        const std::size_t luxel = raw_.SuperIndex(x, y);
        if (raw_.luxelClusters[luxel] == kUnmapped && (step == MapStep::Rest || ContainsCenter(flat, x, y)))
            SetLuxel(luxel, positionFinder_.Find(x, y, nullptr, plane, offset_, *filter_, counts_.positions),
                     triangle[0].normal, 1);
    });
}

/// False if the quad is not flat.
bool LuxelMapper::MapQuad(const std::array<SurfaceVertex, 4> &quad, const NormalImage &normals) {
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

/// Maps luxel (x, y), which the surface passes through at v; if it is mapped already, adds the normal at v to its sum.
void LuxelMapper::MapLuxel(int x, int y, const SurfaceVertex &v, const LuxelPlane &plane, const NormalMap &normals) {
    const std::size_t luxel = raw_.SuperIndex(x, y);
    const int cluster = raw_.luxelClusters[luxel];
    if (cluster >= 0 ? allOneNormal_ && !normals.Active() : cluster == kOccluded && raw_.planar)
        return; // no normal to add; or a planar lightmap, whose other faces give the same positions to try
    const auto normal = [&] { return normals.Active() ? normals.Perturbed(v) : v.normal; };
    if (cluster >= 0) {
        raw_.normals[luxel] += normal();
        ++scratch_.normalCount[luxel];
        anySums_ = true;
        return;
    }
    SetLuxel(luxel, positionFinder_.Find(x, y, &v, plane, offset_, *filter_, counts_.positions), normal(), 1);
}

/// Stores the position that was found for the luxel in this pass.
void LuxelMapper::SetLuxel(std::size_t luxel, const LuxelPosition &position, const Vec3f &normal, int pass) {
    if (position.Occluded()) {
        raw_.luxelClusters[luxel] = kOccluded;
        anyOccluded_ = true;
        return;
    }
    raw_.luxelClusters[luxel] = position.cluster;
    raw_.positions[luxel] = position.xyz;
    raw_.normals[luxel] = normal;
    scratch_.normalCount[luxel] = 1;
    scratch_.passOf[luxel] = std::uint8_t(pass);
}

void LuxelMapper::MakeUnitNormals() {
    for (std::size_t i = 0; i < raw_.luxelClusters.size(); ++i)
        if (raw_.Mapped(i) && scratch_.normalCount[i] > 1)
            raw_.normals[i] = Normalize(raw_.normals[i]);
}

/// Calls luxel(index) for neighbors that a pass before `pass` mapped.
template <typename Luxel> void LuxelMapper::ForEarlierAround(int x, int y, int pass, const Luxel &luxel) const {
    ForNeighborhood(x, y, superWidth_, superHeight_, [&](int nx, int ny) {
        if (const std::size_t at = raw_.SuperIndex(nx, ny); raw_.Mapped(at) && scratch_.passOf[at] < pass)
            luxel(at);
    });
}

/// Mean normal of neighbors that an earlier pass mapped; zero if there are none. The mean of equal normals is exactly
/// that normal, since blocks of luxels with one normal are cheaper to light.
Vec3f LuxelMapper::NormalAround(int x, int y, int pass) const {
    Vec3f sum;
    const Vec3f *one = nullptr;
    bool equal = true;
    ForEarlierAround(x, y, pass, [&](std::size_t luxel) {
        sum += raw_.normals[luxel];
        equal = equal && (!one || *one == raw_.normals[luxel]);
        one = &raw_.normals[luxel];
    });
    return one && equal ? *one : Normalize(sum);
}

/// Maps a ring of luxels around luxels that earlier passes mapped, as texture filtering reads them.
void LuxelMapper::MapBorder(int pass) {
    const std::vector<int> anywhere;
    VisibleClusters filter(in_.space, anywhere);
    const LuxelPlane plane{raw_.planeNormal, raw_.planeDist};
    std::vector<Vec3f> neighbors;
    LuxelMask earlier(raw_.luxelClusters.size());
    for (std::size_t i = 0; i < earlier.size(); ++i)
        earlier[i] = raw_.Mapped(i) && scratch_.passOf[i] < pass;
    const LuxelMask touching = Dilate(earlier, superWidth_, superHeight_);
    for (int y = 0; y < superHeight_; ++y)
        for (int x = 0; x < superWidth_; ++x) {
            const std::size_t luxel = raw_.SuperIndex(x, y);
            if (raw_.luxelClusters[luxel] != kUnmapped || touching[luxel] == 0)
                continue;
            const Vec3f normal = NormalAround(x, y, pass);
            if (normal == Vec3f{})
                continue;
            neighbors.clear();
            ForEarlierAround(x, y, pass, [&](std::size_t from) { neighbors.push_back(raw_.positions[from]); });
            SetLuxel(luxel,
                     positionFinder_.FindBeside(x, y, neighbors, plane, kSampleOffset, filter, counts_.positions),
                     normal, pass);
        }
}

void Report(const SurfaceLight &surfaces, const std::vector<MapCounts> &counts, Log &log) {
    MapCounts sum;
    std::size_t luxels = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        luxels += surfaces.lightmaps[i].luxelClusters.size();
        sum.mapped += counts[i].mapped;
        sum.occluded += counts[i].occluded;
        sum.positions.atSample += counts[i].positions.atSample;
        sum.positions.failed += counts[i].positions.failed;
        for (std::size_t k = 0; k < sum.positions.nudges.size(); ++k)
            sum.positions.nudges[k] += counts[i].positions.nudges[k];
    }
    log.Count(luxels, "luxels");
    log.Count(sum.mapped, "luxels mapped");
    log.Count(sum.occluded, "luxels occluded");
    log.Verbose("{:9} luxels lit at their center, {} nudged, {} at a vertex; {} attempts failed\n",
                sum.positions.nudges[0],
                std::accumulate(sum.positions.nudges.begin() + 1, sum.positions.nudges.end(), std::uint64_t(0)),
                sum.positions.atSample, sum.positions.failed);
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
