// GPL-2.0-or-later. Which surfaces share a raw lightmap, its size and its projection, and the phong shading of its
// normals.
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "libs/math/elementary.h"

#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_surfaces.h"
#include "q3map2/lightmap/raw/luxel_raster.h"
#include "q3map2/shader/shader_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <unordered_map>

namespace q3 {

// ---- -shade: phong shading of vertex normals ----

namespace {

/// Vertices this near on each axis share a position. Game units.
constexpr float kSamePosition = 0.001f;
/// Normals whose components differ by less count once in the mean.
constexpr float kSameNormal = 0.01f;
/// Rounding of angles: normals at exactly the shading angle are not joined. Radians.
constexpr float kAngleSlack = 1e-6f;
/// Largest number of vertices that share one normal: a limit of this program, chosen.
constexpr std::size_t kMaxGroup = 256;

/// Side of the hash cells that vertices are found by. Game units.
constexpr double kHashCell = 0.125;
/// Cell numbers are clamped to this, so that they fit 64-bit integers.
constexpr double kMaxCell = 1e15;

bool Near(const Vec3f &a, const Vec3f &b, float epsilon) {
    return std::abs(a.x - b.x) < epsilon && std::abs(a.y - b.y) < epsilon && std::abs(a.z - b.z) < epsilon;
}

/// A number for the hash cell of p; several cells may have the same.
std::uint64_t CellKey(const Vec3f &p) {
    constexpr std::uint64_t kMultiplier = 0x9E3779B97F4A7C15u; // 2^64 / golden ratio
    std::uint64_t key = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double cell = std::clamp(std::floor(double(p[i]) / kHashCell), -kMaxCell, kMaxCell);
        key = key * kMultiplier + std::uint64_t(std::int64_t(cell));
    }
    return key;
}

/// Keys of the cells that positions within kSamePosition of p can be in, each once.
std::vector<std::uint64_t> CellsAround(const Vec3f &p) {
    std::vector<std::uint64_t> keys;
    for (const float x : {-kSamePosition, kSamePosition})
        for (const float y : {-kSamePosition, kSamePosition})
            for (const float z : {-kSamePosition, kSamePosition})
                keys.push_back(CellKey(p + Vec3f{x, y, z}));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    return keys;
}

/// Shading angle of every vertex, radians; empty when all are 0.
std::vector<float> ShadeAngles(const SurfaceInputs &in) {
    std::vector<float> angles(in.bsp.drawVerts.size());
    bool any = false;
    for (std::size_t s = 0; s < in.table.size(); ++s) {
        const bspDrawSurface_t &surface = in.bsp.drawSurfaces[s];
        if (surface.surfaceType == MST_TRIANGLE_SOUP)
            continue;
        const float shaderAngle = in.table[s].shader->lightmap.shadeAngle;
        const float degrees = shaderAngle > 0 ? shaderAngle : in.lightmap.shadeAngle;
        any = any || degrees > 0;
        for (int k = 0; k < surface.numVerts; ++k)
            angles[std::size_t(surface.firstVert + k)] = degrees * std::numbers::pi_v<float> / 180;
    }
    if (!any)
        angles.clear();
    return angles;
}

float AngleBetween(const Vec3f &a, const Vec3f &b) {
    return Acos(std::clamp(Dot(a, b), -1.0f, 1.0f));
}

} // namespace

void SmoothNormals(const SurfaceInputs &in, SurfaceLight &surfaces) {
    if (!in.lightmap.shade)
        return;
    const std::vector<float> angles = ShadeAngles(in);
    std::vector<SurfaceVertex> &verts = surfaces.verts;
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < angles.size(); ++i)
        if (angles[i] > 0)
            cells[CellKey(verts[i].xyz)].push_back(i);
    const auto original = [&](std::size_t i) { return Vec3f(in.bsp.drawVerts[i].normal); };
    std::vector<bool> done(verts.size());
    std::vector<std::size_t> group;
    std::vector<Vec3f> distinct;
    std::size_t smoothed = 0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
        if (!(angles[i] > 0) || done[i])
            continue;
        group.clear();
        distinct.clear();
        Vec3f sum;
        for (const std::uint64_t key : CellsAround(verts[i].xyz)) {
            const auto cell = cells.find(key);
            if (cell == cells.end())
                continue;
            for (const std::size_t j : cell->second)
                if (j >= i && !done[j] && Near(verts[i].xyz, verts[j].xyz, kSamePosition) &&
                    (j == i || AngleBetween(original(i), original(j)) + kAngleSlack < std::min(angles[i], angles[j])))
                    group.push_back(j);
        }
        std::sort(group.begin(), group.end());
        group.resize(std::min(group.size(), kMaxGroup));
        for (const std::size_t j : group) {
            const Vec3f normal = original(j);
            if (std::none_of(distinct.begin(), distinct.end(),
                             [&](const Vec3f &other) { return Near(other, normal, kSameNormal); })) {
                distinct.push_back(normal);
                sum += normal;
            }
        }
        if (group.size() < 2 || Normalize(sum) == Vec3f{})
            continue;
        for (const std::size_t j : group) {
            verts[j].normal = Normalize(sum);
            done[j] = true;
        }
        smoothed += group.size();
    }
    in.log.Count(smoothed, "vertices with smoothed normals");
}

// ---- Which surfaces share a raw lightmap, its size and its projection ----

namespace {

/// Components of equal vectors and distances of equal planes (game units) differ by less than this.
constexpr float kEqualEpsilon = 0.001f;
/// Planes whose normal has a smaller component along the projection axis are edge-on: they cannot be projected.
constexpr float kEdgeOn = 1e-4f;
/// Texture filtering reads luxels up to this far from a surface, counting those that are moved aside. Luxels.
constexpr float kGapLuxels = 2;

bool NearlyEqual(const Vec3f &a, const Vec3f &b) {
    return std::abs(a.x - b.x) < kEqualEpsilon && std::abs(a.y - b.y) < kEqualEpsilon &&
           std::abs(a.z - b.z) < kEqualEpsilon;
}

bool Overlap(const Boundsf &a, const Boundsf &b) {
    return a.mins.x <= b.maxs.x && b.mins.x <= a.maxs.x && a.mins.y <= b.maxs.y && b.mins.y <= a.maxs.y &&
           a.mins.z <= b.maxs.z && b.mins.z <= a.maxs.z;
}

/// A draw surface and the properties that decide which surfaces share its raw lightmap.
struct Candidate {
    int number = 0;
    bool isPatch = false;
    bool planar = false;
    bool getsLightmap = false; ///< else it is lit at its vertices
    bool mergable = false;     ///< q3map_lightmapMergable: shares lightmaps across planes
    Vec3f normal;              ///< of the plane, with dist; zero: not planar
    float dist = 0;
    const SurfaceEntry *entry = nullptr;
    std::array<int, 2> pageSize{};
};

/// The properties that surfaces of one lightmap mostly share.
std::tuple<std::string_view, int, float, float, float, bool> SharedKeys(const Candidate &c) {
    const Vec3f &axis = c.entry->axis;
    return {c.entry->shader->name, c.entry->sampleSize, axis.x, axis.y, axis.z, c.planar};
}

/// Hash cell of a plane distance, 1 game unit wide: distances that differ by kEqualEpsilon are in the same or in
/// neighboring cells.
std::int64_t PlaneCell(float dist) {
    return std::int64_t(std::clamp(std::floor(double(dist)), -kMaxCell, kMaxCell));
}

class LightmapSetup {
  public:
    LightmapSetup(const SurfaceInputs &in, SurfaceLight &surfaces) : in_(in), out_(surfaces) {}

    void Run() {
        MakeVerts();
        CollectClusters();
        MakeCandidates();
        for (std::size_t i = 0; i < candidates_.size(); ++i)
            if (candidates_[i].getsLightmap)
                (candidates_[i].mergable ? mergable_ : onPlanes_[PlaneCell(candidates_[i].dist)]).push_back(i);
        taken_.resize(candidates_.size());
        for (std::size_t i = 0; i < candidates_.size(); ++i)
            if (candidates_[i].getsLightmap && !taken_[i])
                MakeLightmap(i);
        Report();
    }

  private:
    void MakeVerts();
    void CollectClusters();
    void MakeCandidates();
    Candidate MakeCandidate(int number) const;
    bool GetsLightmap(const Candidate &c) const;
    void MakeLightmap(std::size_t seedPosition);
    std::vector<std::size_t> MergeCandidates(const Candidate &seed);
    RawLightmap Seed(const Candidate &c) const;
    bool Fits(const RawLightmap &raw, const Candidate &seed, const Candidate &c) const;
    bool IsBehindWall(const RawLightmap &raw, const Candidate &c) const;
    void AddSurface(RawLightmap &raw, const Candidate &c) const;
    bool Project(RawLightmap &raw, const Candidate &first) const;
    bool GrowToFit(RawLightmap &raw) const;
    MeshOf<SurfaceVertex> MeshOfPatch(const Candidate &c) const;
    void MeasurePatch(RawLightmap &raw, const Candidate &c);
    void SetLuxelCoordinates(const RawLightmap &raw);
    void Finish(RawLightmap &raw);
    void Report() const;

    const SurfaceInputs &in_;
    SurfaceLight &out_;
    std::vector<Candidate> candidates_;
    std::vector<bool> taken_;                                             // by position in candidates_
    std::vector<std::size_t> mergable_;                                   // positions in candidates_
    std::unordered_map<std::int64_t, std::vector<std::size_t>> onPlanes_; // others, by PlaneCell
    int grown_ = 0;
};

void LightmapSetup::MakeVerts() {
    const Bsp &bsp = in_.bsp;
    const auto made = [&](std::size_t i, const Vec3f &origin) {
        const bspDrawVert_t &v = bsp.drawVerts[i];
        return SurfaceVertex{Vec3f(v.xyz) + origin, Vec3f(v.normal), v.st, {}};
    };
    out_.verts.resize(bsp.drawVerts.size());
    for (std::size_t i = 0; i < out_.verts.size(); ++i)
        out_.verts[i] = made(i, {});
    out_.bounds.resize(bsp.drawSurfaces.size());
    for (std::size_t s = 0; s < bsp.drawSurfaces.size(); ++s)
        for (int k = 0; k < bsp.drawSurfaces[s].numVerts; ++k) {
            const auto vert = std::size_t(bsp.drawSurfaces[s].firstVert + k);
            out_.verts[vert] = made(vert, in_.table[s].origin);
            out_.bounds[s].Add(out_.verts[vert].xyz);
        }
}

void LightmapSetup::CollectClusters() {
    const Bsp &bsp = in_.bsp;
    out_.clusters.resize(bsp.drawSurfaces.size());
    for (const bspLeaf_t &leaf : bsp.leafs) {
        if (leaf.cluster < 0)
            continue;
        const Boundsf box{{float(leaf.mins[0]), float(leaf.mins[1]), float(leaf.mins[2])},
                          {float(leaf.maxs[0]), float(leaf.maxs[1]), float(leaf.maxs[2])}};
        for (int k = 0; k < leaf.numBSPLeafSurfaces; ++k) {
            const auto surface = std::size_t(bsp.leafSurfaces[std::size_t(leaf.firstBSPLeafSurface + k)]);
            if (Overlap(box, out_.bounds[surface]))
                out_.clusters[surface].push_back(leaf.cluster);
        }
    }
    for (std::vector<int> &clusters : out_.clusters) {
        std::sort(clusters.begin(), clusters.end());
        clusters.erase(std::unique(clusters.begin(), clusters.end()), clusters.end());
    }
}

bool LightmapSetup::GetsLightmap(const Candidate &c) const {
    const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(c.number)];
    return (surface.surfaceType == MST_PLANAR || c.isPatch) && surface.numVerts > 0 && !in_.lightmap.noLightmaps &&
           (c.entry->shader->compileFlags & C_VERTEXLIT) == 0 && c.entry->sampleSize > 0 && c.entry->parent < 0 &&
           (c.isPatch || c.entry->axis != Vec3f{}) &&
           !IsCollisionOnly(in_.bsp, in_.table, std::size_t(c.number), in_.options.noDrawSurfaceFlags);
}

Candidate LightmapSetup::MakeCandidate(int number) const {
    const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(number)];
    Candidate c;
    c.number = number;
    c.entry = &in_.table[std::size_t(number)];
    c.isPatch = surface.surfaceType == MST_PATCH;
    c.normal = Vec3f(surface.lightmapVecs[2]);
    c.planar = c.normal != Vec3f{} && surface.numVerts > 0;
    if (c.planar)
        c.dist = Dot(out_.verts[std::size_t(surface.firstVert)].xyz, c.normal);
    const LightmapDirectives &shader = c.entry->shader->lightmap;
    c.mergable = shader.mergable;
    for (std::size_t i = 0; i < 2; ++i)
        c.pageSize[i] = shader.pageSize[i] > 0 ? shader.pageSize[i] : in_.lightmap.pageSize[i];
    if (in_.gamePagesOnly && c.pageSize != in_.lightmap.gamePageSize) {
        in_.log.Warn("lightmap size of a shader",
                     "{}: q3map_lightmapSize {} {} is not used: the map has light styles, which the engine shows on "
                     "pages of {} {} only; -external keeps both",
                     c.entry->shader->name, c.pageSize[0], c.pageSize[1], in_.lightmap.gamePageSize[0],
                     in_.lightmap.gamePageSize[1]);
        c.pageSize = in_.lightmap.gamePageSize;
    }
    c.getsLightmap = GetsLightmap(c);
    return c;
}

/// Lists all surfaces in the order in which they become raw lightmaps: descending by shader name, then by the
/// properties that surfaces of one lightmap share.
void LightmapSetup::MakeCandidates() {
    for (std::size_t i = 0; i < in_.table.size(); ++i)
        candidates_.push_back(MakeCandidate(int(i)));
    const auto before = [&](const Candidate &a, const Candidate &b) {
        const auto keysA = SharedKeys(a), keysB = SharedKeys(b);
        if (keysA != keysB)
            return keysA > keysB;
        const auto more = [&](const Candidate &c) {
            const Vec3f &mins = out_.bounds[std::size_t(c.number)].mins;
            return std::tuple(c.normal.x, c.normal.y, c.normal.z, c.dist, mins.x, mins.y, mins.z, -c.number);
        };
        return more(a) > more(b);
    };
    std::sort(candidates_.begin(), candidates_.end(), before);
}

RawLightmap LightmapSetup::Seed(const Candidate &c) const {
    const LightmapDirectives &shader = c.entry->shader->lightmap;
    RawLightmap raw;
    raw.entity = c.entry->entity;
    raw.receiveShadows = c.entry->receiveShadows;
    raw.sampleSize = float(c.entry->sampleSize) * float(std::max(1, in_.lightmap.sampleScale));
    raw.actualSampleSize = raw.sampleSize;
    raw.ambient = c.entry->ambient;
    raw.brightness = in_.lightmap.brightness * shader.brightness;
    raw.filterRadius = c.entry->shader->lightmapFilterRadius;
    raw.splotchFix = shader.splotchFix;
    raw.pageSize = c.pageSize;
    raw.planar = c.planar;
    raw.planeNormal = c.normal;
    raw.planeDist = c.dist;
    raw.axis = c.entry->axis;
    raw.super = in_.lightmap.super;
    return raw;
}

bool LightmapSetup::Fits(const RawLightmap &raw, const Candidate &seed, const Candidate &c) const {
    const bool samePlane = raw.planar && c.planar && std::abs(raw.planeDist - c.dist) < kEqualEpsilon &&
                           NearlyEqual(raw.planeNormal, c.normal);
    if (!(samePlane || c.mergable) || !Overlap(raw.bounds, out_.bounds[std::size_t(c.number)]))
        return false;
    const SurfaceEntry &a = *seed.entry, &b = *c.entry;
    const bool alike = NearlyEqual(raw.axis, b.axis) && a.sampleSize == b.sampleSize && a.ambient == b.ambient &&
                       a.entity == b.entity && a.receiveShadows == b.receiveShadows && a.macroImage == b.macroImage &&
                       seed.pageSize == c.pageSize && a.shader->lightmap.brightness == b.shader->lightmap.brightness &&
                       a.shader->lightmapFilterRadius == b.shader->lightmapFilterRadius &&
                       a.shader->lightmap.splotchFix == b.shader->lightmap.splotchFix;
    return alike && !(samePlane && IsBehindWall(raw, c));
}

/// Whether the surface touches none of the lightmap's surfaces, and a wall that texture filtering would read across
/// parts it from one of them. It needs another lightmap, or light would come through the wall.
bool LightmapSetup::IsBehindWall(const RawLightmap &raw, const Candidate &c) const {
    bool wall = false;
    for (const int number : raw.surfaces)
        switch (GapBetween(in_, out_, number, c.number, c.normal, kGapLuxels * raw.actualSampleSize)) {
        case SurfaceGap::Touching:
            return false;
        case SurfaceGap::Wall:
            wall = true;
            break;
        case SurfaceGap::NoWall:
            break;
        }
    return wall;
}

/// Adds a surface. The lightmap stays planar as long as all surfaces are in one plane.
void LightmapSetup::AddSurface(RawLightmap &raw, const Candidate &c) const {
    raw.surfaces.push_back(c.number);
    raw.bounds.Add(out_.bounds[std::size_t(c.number)]);
    if (!c.planar || std::abs(raw.planeDist - c.dist) >= kEqualEpsilon || !NearlyEqual(raw.planeNormal, c.normal))
        raw.planar = false;
    raw.noDirt = raw.noDirt || c.entry->shader->lightmap.noDirt;
    raw.twoSided = raw.twoSided || c.entry->shader->twoSided;
}

/// Sets width, height and actualSampleSize: sampleSize plus the least whole number of units with which the lightmap
/// fits the page. False if kSteps more units are too few.
bool LightmapSetup::GrowToFit(RawLightmap &raw) const {
    constexpr int kSteps = 4096;
    std::array<float, 2> most{float(raw.pageSize[0]), float(raw.pageSize[1])};
    if (in_.lightmap.rawSizeLimit > 0)
        for (float &m : most)
            m = std::min(m, float(in_.lightmap.rawSizeLimit));
    const float limit = std::min(most[0], most[1]);
    const Vec3f extent = raw.bounds.maxs - raw.bounds.mins;
    float size = raw.sampleSize;
    // Below this the longest side alone is too long for the page.
    if (limit > 1)
        size += std::max(0.0f, std::ceil(MaxComponent(extent) / (limit - 1) - size));
    Boundsf rounded;
    for (int step = 0; step < kSteps; ++step, size += 1) {
        Vec3f count;
        for (std::size_t i = 0; i < 3; ++i) {
            rounded.mins[i] = size * std::floor(raw.bounds.mins[i] / size);
            rounded.maxs[i] = size * std::ceil(raw.bounds.maxs[i] / size);
            count[i] = (rounded.maxs[i] - rounded.mins[i]) / size + 1;
        }
        if (!(MaxComponent(count) <= limit))
            continue;
        const LuxelAxes axes = AxesOf(raw.axis);
        raw.width = int(count[axes.u]);
        raw.height = int(count[axes.v]);
        raw.actualSampleSize = size;
        if (!raw.planar)
            raw.bounds = rounded;
        return true;
    }
    return false;
}

/// Sets size, origin and steps of a projected raw lightmap. False: the surface cannot be projected along its axis, or
/// no size fits the page.
bool LightmapSetup::Project(RawLightmap &raw, const Candidate &first) const {
    const LuxelAxes axes = AxesOf(raw.axis);
    const Vec3f normal = first.planar ? first.normal : raw.axis;
    if (std::abs(normal[axes.along]) < kEdgeOn || !GrowToFit(raw))
        return false;
    const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(first.number)];
    const Vec3f &onPlane = out_.verts[std::size_t(surface.firstVert)].xyz;
    raw.hasVectors = true;
    raw.origin = OntoPlane(raw.bounds.mins, axes.along, normal, Dot(normal, onPlane));
    raw.storedOrigin = raw.origin;
    for (std::size_t i = 0; i < 2; ++i) {
        const std::size_t axis = i == 0 ? axes.u : axes.v;
        raw.step[i] = {};
        raw.step[i][axis] = raw.actualSampleSize;
        raw.step[i][axes.along] = -raw.actualSampleSize * normal[axis] / normal[axes.along];
    }
    return IsFinite(raw.origin) && IsFinite(raw.step[0]) && IsFinite(raw.step[1]);
}

MeshOf<SurfaceVertex> LightmapSetup::MeshOfPatch(const Candidate &c) const {
    const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(c.number)];
    MeshOf<SurfaceVertex> mesh{surface.patchWidth, surface.patchHeight, {}};
    const auto first = out_.verts.begin() + surface.firstVert;
    mesh.verts.assign(first, first + surface.numVerts);
    return mesh;
}

/// Luxels along the rows: 1 + (sum over columns of the longest step to the next column) / sampleSize, from `least` (one
/// per control point) to `most` (a page).
int LuxelsAlong(const MeshOf<SurfaceVertex> &mesh, float sampleSize, int least, int most) {
    float length = 0;
    for (int x = 0; x + 1 < mesh.width; ++x) {
        float longest = 0;
        for (int y = 0; y < mesh.height; ++y)
            longest = std::max(longest, Length(mesh.At(x + 1, y).xyz - mesh.At(x, y).xyz));
        length += longest;
    }
    return std::min(std::max(int(std::min(std::ceil(length / sampleSize), float(most))) + 1, least), most);
}

/// Whether the patch closes on itself along its rows.
bool FirstColumnIsLast(const MeshOf<SurfaceVertex> &mesh) {
    bool same = true;
    for (int y = 0; y < mesh.height && same; ++y)
        same = NearlyEqual(mesh.At(0, y).xyz, mesh.At(mesh.width - 1, y).xyz);
    return same;
}

/// Sets the size of a patch without a projection axis, and luxel coordinates of its control points proportional to
/// their column and row.
void LightmapSetup::MeasurePatch(RawLightmap &raw, const Candidate &c) {
    const MeshOf<SurfaceVertex> control = MeshOfPatch(c), turned = patch::Transposed(control);
    const MeshOf<SurfaceVertex> mesh = Tessellated(control, c.entry->longestCurve);
    raw.width = LuxelsAlong(mesh, raw.sampleSize, control.width, raw.pageSize[0]);
    raw.height = LuxelsAlong(patch::Transposed(mesh), raw.sampleSize, control.height, raw.pageSize[1]);
    raw.wrapS = FirstColumnIsLast(control);
    raw.wrapT = FirstColumnIsLast(turned);
    const auto super = float(raw.super);
    const auto firstVert = std::size_t(in_.bsp.drawSurfaces[std::size_t(c.number)].firstVert);
    for (std::size_t i = 0; i < control.verts.size(); ++i) {
        const auto x = float(int(i) % control.width), y = float(int(i) / control.width);
        out_.verts[firstVert + i].luxel = {(x * float(raw.width - 1) / float(control.width - 1) + 0.5f) * super,
                                           (y * float(raw.height - 1) / float(control.height - 1) + 0.5f) * super};
    }
}

void LightmapSetup::SetLuxelCoordinates(const RawLightmap &raw) {
    const LuxelAxes axes = AxesOf(raw.axis);
    const auto super = float(raw.super);
    for (const int number : raw.surfaces) {
        const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(number)];
        for (int k = 0; k < surface.numVerts; ++k) {
            SurfaceVertex &v = out_.verts[std::size_t(surface.firstVert + k)];
            const Vec3f from = v.xyz - raw.bounds.mins;
            v.luxel = {(from[axes.u] / raw.actualSampleSize + 0.5f) * super,
                       (from[axes.v] / raw.actualSampleSize + 0.5f) * super};
        }
    }
}

/// Positions in candidates_ of surfaces without a lightmap yet that are in the plane of the seed, or mergable.
std::vector<std::size_t> LightmapSetup::MergeCandidates(const Candidate &seed) {
    const auto isTaken = [&](std::size_t position) { return taken_[position]; };
    std::erase_if(mergable_, isTaken);
    std::vector<std::size_t> positions = mergable_;
    if (seed.planar)
        for (std::int64_t cell = PlaneCell(seed.dist - kEqualEpsilon); cell <= PlaneCell(seed.dist + kEqualEpsilon);
             ++cell)
            if (const auto found = onPlanes_.find(cell); found != onPlanes_.end()) {
                std::erase_if(found->second, isTaken);
                positions.insert(positions.end(), found->second.begin(), found->second.end());
            }
    std::sort(positions.begin(), positions.end());
    return positions;
}

void LightmapSetup::MakeLightmap(std::size_t seedPosition) {
    const Candidate &seed = candidates_[seedPosition];
    taken_[seedPosition] = true;
    RawLightmap raw = Seed(seed);
    AddSurface(raw, seed);
    const bool parametric = seed.isPatch && raw.axis == Vec3f{};
    bool fits = true;
    if (parametric) {
        raw.planar = false;
        MeasurePatch(raw, seed);
    } else {
        fits = Project(raw, seed);
        const std::vector<std::size_t> sharers = MergeCandidates(seed);
        for (bool added = true; added;) {
            added = false;
            for (const std::size_t position : sharers) {
                if (taken_[position] || !Fits(raw, seed, candidates_[position]))
                    continue;
                AddSurface(raw, candidates_[position]);
                fits = Project(raw, seed);
                taken_[position] = added = true;
            }
        }
    }
    if (fits)
        Finish(raw);
    else
        in_.log.Warn("surface without a lightmap projection",
                     "surface {} ({}): no lightmap fits it along its lightmapAxis, it is lit at its vertices",
                     seed.number, seed.entry->shader->name);
}

void LightmapSetup::Finish(RawLightmap &raw) {
    const int first = raw.surfaces.front();
    const auto name = [&](int surface) { return std::string_view(in_.table[std::size_t(surface)].shader->name); };
    std::stable_sort(raw.surfaces.begin(), raw.surfaces.end(), [&](int a, int b) { return name(a) < name(b); });
    for (const int number : raw.surfaces) {
        const std::vector<int> &clusters = out_.clusters[std::size_t(number)];
        raw.clusters.insert(raw.clusters.end(), clusters.begin(), clusters.end());
        out_.lightmapOf[std::size_t(number)] = int(out_.lightmaps.size());
    }
    raw.channels.sh = in_.lightmap.NeedsSH();
    raw.channels.basis = in_.lightmap.rnm && std::any_of(raw.surfaces.begin(), raw.surfaces.end(), [&](int number) {
                             return in_.table[std::size_t(number)].normalMapped;
                         });
    std::sort(raw.clusters.begin(), raw.clusters.end());
    raw.clusters.erase(std::unique(raw.clusters.begin(), raw.clusters.end()), raw.clusters.end());
    if (raw.hasVectors) {
        SetLuxelCoordinates(raw);
        // From the center of luxel (0, 0) to that of its first super luxel.
        const auto super = float(raw.super);
        raw.origin -= (raw.step[0] + raw.step[1]) * (0.5f - 0.5f / super);
        raw.step[0] *= 1 / super;
        raw.step[1] *= 1 / super;
    }
    if (raw.actualSampleSize != raw.sampleSize) {
        ++grown_;
        if (in_.lightmap.debugSampleSize)
            in_.log.Print("surface {} at ({} {} {}): sample size {} increased to {} to fit the lightmap\n", first,
                          raw.bounds.mins.x, raw.bounds.mins.y, raw.bounds.mins.z, raw.sampleSize,
                          raw.actualSampleSize);
    }
    out_.lightmaps.push_back(std::move(raw));
}

void LightmapSetup::Report() const {
    int lightmapped = 0, planar = 0, patches = 0, planarPatches = 0;
    for (const Candidate &c : candidates_) {
        if (out_.lightmapOf[std::size_t(c.number)] < 0)
            continue;
        ++lightmapped;
        planar += c.planar && !c.isPatch ? 1 : 0;
        patches += c.isPatch ? 1 : 0;
        planarPatches += c.isPatch && c.planar ? 1 : 0;
    }
    Log &log = in_.log;
    log.Count(candidates_.size(), "surfaces");
    log.Count(out_.lightmaps.size(), "raw lightmaps");
    log.Count(candidates_.size() - lightmapped, "surfaces vertex lit");
    log.Count(lightmapped, "surfaces lightmapped");
    log.Count(planar, "planar surfaces lightmapped");
    log.Count(lightmapped - planar - patches, "non-planar surfaces lightmapped");
    log.Count(patches, "patches lightmapped");
    log.Count(planarPatches, "planar patches lightmapped");
    if (grown_ > 0)
        log.Count(grown_, "raw lightmaps with a sample size increased to fit");
}

} // namespace

SurfaceDefaults SurfaceDefaultsOf(const LightmapOptions &options) {
    return {.sampleSize = options.sampleSize,
            .minSampleSize = options.minSampleSize,
            .noLightmaps = options.noLightmaps,
            .ambient = {},
            .normalMaps = options.rnmAll ? NormalMaps::All
                          : options.rnm  ? NormalMaps::OfShaders
                                         : NormalMaps::None,
            .macroTexture = WithoutExtension(options.macroTexture)};
}

SurfaceLight SetupSurfaceLight(const SurfaceInputs &in) {
    SurfaceLight surfaces;
    surfaces.lightmapOf.assign(in.bsp.drawSurfaces.size(), -1);
    surfaces.vertex.styles.assign(in.bsp.drawSurfaces.size(), kOnlyStyle0);
    LightmapSetup(in, surfaces).Run();
    return surfaces;
}

} // namespace q3
