// GPL-2.0-or-later. What a lit map says about its lights: stored light at places whose position is known.
#include "q3map2/recover/observed_light.h"

#include "q3map2/light/grid/light_grid.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/raw/luxel_raster.h"
#include "q3map2/lightmap/store/lightmap_store.h"
#include "q3map2/lightmap/vertex/vertex_light.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Stored bytes of luxels, found by the texture coordinates of lightmaps.
class PageReader {
  public:
    explicit PageReader(const Bsp &bsp) : bsp_(bsp), side_(bsp.lightmapSide) {}

    /// Bytes at a place of a page, blended from the four texels around it; `greatest`: the greatest byte of these.
    bool Read(int page, const std::array<float, 2> &at, Vec3f &bytes, float &greatest) const {
        const std::size_t first = std::size_t(page) * LightmapPageBytes(side_);
        if (page < 0 || first + LightmapPageBytes(side_) > bsp_.lightmaps.size())
            return false;
        const float x = at[0] * float(side_) - 0.5f, y = at[1] * float(side_) - 0.5f;
        if (!(x > -1 && y > -1 && x < float(side_) && y < float(side_)))
            return false;
        const float left = std::floor(x), top = std::floor(y), u = x - left, v = y - top;
        bytes = {}, greatest = 0;
        for (int dy = 0; dy < 2; ++dy)
            for (int dx = 0; dx < 2; ++dx) {
                const float weight = (dx == 0 ? 1 - u : u) * (dy == 0 ? 1 - v : v);
                if (weight < 1e-3f)
                    continue;
                const int tx = std::clamp(int(left) + dx, 0, side_ - 1), ty = std::clamp(int(top) + dy, 0, side_ - 1);
                const std::uint8_t *const texel =
                    &bsp_.lightmaps[first + 3 * (std::size_t(ty) * std::size_t(side_) + std::size_t(tx))];
                const Vec3f one{float(texel[0]), float(texel[1]), float(texel[2])};
                bytes += one * weight;
                greatest = std::max(greatest, MaxComponent(one));
            }
        return true;
    }

  private:
    const Bsp &bsp_;
    int side_;
};

/// A triangle of a surface in the super grid of its lightmap, with coordinates on its page.
struct LuxelTriangle {
    std::array<std::array<float, 2>, 3> luxels, page;

    /// Coordinates on the page of a place in the super grid; nothing outside the triangle.
    bool PageAt(float x, float y, std::array<float, 2> &at) const {
        const auto edge = [&](std::size_t corner, std::size_t axis) { return luxels[corner][axis] - luxels[0][axis]; };
        const float area = edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0);
        if (area == 0)
            return false;
        x -= luxels[0][0], y -= luxels[0][1];
        const float v = (x * edge(2, 1) - y * edge(2, 0)) / area, w = (edge(1, 0) * y - edge(1, 1) * x) / area;
        if (v < 0 || w < 0 || v + w > 1)
            return false;
        for (std::size_t axis = 0; axis < 2; ++axis)
            at[axis] = (1 - v - w) * page[0][axis] + v * page[1][axis] + w * page[2][axis];
        return true;
    }
};

/// Bytes are cut off, not rounded: those above 0 stand for the middle of what they hold.
Vec3f MiddleOf(const Vec3f &bytes) {
    Vec3f middle;
    for (std::size_t i = 0; i < 3; ++i)
        middle[i] = bytes[i] + 0.5f * std::min(1.0f, bytes[i]);
    return middle;
}

/// How light of a surface or of the grid is stored.
class Storing {
  public:
    /// least: the minimum light.
    Storing(float scale, float brightness, const Vec3f &least, const ToneOptions &tone)
        : mapper_(scale, brightness, tone) {
        constexpr float kBright = 1e6f;
        full_ = Greatest(Vec3f{kBright, kBright, kBright}) - 1; // just under the limit it is cut off
        least_ = MaxComponent(least) > 0 ? Greatest(least) : -1;
    }
    Vec3f LightOf(const Vec3f &bytes) const { return mapper_.LightOf(MiddleOf(bytes)); }
    /// What bytes say of which this is the greatest.
    StoredAs As(float greatest) const {
        return greatest >= full_ ? StoredAs::AtLeast : greatest <= least_ ? StoredAs::AtMost : StoredAs::Value;
    }

  private:
    float Greatest(const Vec3f &light) const {
        const std::array<std::uint8_t, 3> bytes = mapper_.Bytes(light);
        return float(std::max({bytes[0], bytes[1], bytes[2]}));
    }

    ToneMapper mapper_;
    float full_ = 0, least_ = 0; ///< bytes from which, and up to which, the light is a bound
};

class Observer {
  public:
    Observer(const Bsp &bsp, const SurfacePasses &passes, ObservedMap &map)
        : in_(passes.Inputs()), lit_(passes.Surfaces()), pages_(bsp), bsp_(bsp), map_(map) {
        map_.tone = StoredTone(in_);
        // Corners of faces carry texture coordinates; here those of lightmaps.
        onPages_.verts = lit_.verts;
        for (std::size_t v = 0; v < onPages_.verts.size(); ++v)
            onPages_.verts[v].st = bsp.drawVerts[v].lightmap[0];
    }

    void AddLightmap(std::size_t number) {
        const RawLightmap &raw = lit_.lightmaps[number];
        if (raw.result[0].empty() || raw.positions.empty())
            return;
        ObservedSurface luxels;
        luxels.settings = LuxelPassOf(in_, {}, raw).settings;
        luxels.settings.faint = 0, luxels.settings.directional = false;
        luxels.lightmap = int(number), luxels.brightness = raw.brightness, luxels.least = in_.world.minLight;
        const Storing storing(1, raw.brightness, luxels.least, map_.tone);
        luxels.first = map_.light.size();
        const int stride = std::max(1, int(std::lround(kLuxelSpacing / std::max(1.0f, raw.actualSampleSize))));
        std::vector<std::uint8_t> done(std::size_t(raw.width) * std::size_t(raw.height));
        for (const int surface : raw.surfaces) {
            const int page = bsp_.drawSurfaces[std::size_t(surface)].lightmapNum[0];
            for (const Face &face : FacesOf(in_, onPages_, std::size_t(surface)))
                for (std::size_t k = 2; k < face.size(); ++k)
                    AddTriangle(raw, {&face[0], &face[k - 1], &face[k]}, page, stride, storing, done, luxels);
        }
        if (!luxels.batches.empty())
            map_.surfaces.push_back(std::move(luxels));
    }

    /// The vertices of a surface that has no lightmap.
    void AddVertices(std::size_t surface) {
        const bspDrawSurface_t &record = bsp_.drawSurfaces[surface];
        const SurfaceEntry &entry = in_.table[surface];
        if (lit_.lightmapOf[surface] >= 0 || record.lightmapNum[0] >= 0 || record.numVerts <= 0 || entry.parent >= 0 ||
            entry.shader->lightmap.noVertexLight || lit_.vertex.sum[0].empty())
            return;
        const auto first = std::size_t(record.firstVert), count = std::size_t(record.numVerts);
        const std::span<const SurfaceVertex> verts(lit_.verts.data() + first, count);
        VertexPlaces places(in_, record, verts, entry.shader->twoSided, lit_.clusters[surface]);
        ObservedSurface vertices;
        vertices.settings = VertexSettings(in_, lit_, surface);
        vertices.scale = VertexScale(in_, *entry.shader);
        vertices.first = map_.light.size();
        vertices.least = in_.world.minVertex;
        const Storing storing(vertices.scale, 1, vertices.least, map_.tone);
        for (std::size_t v = 0; v < count; ++v) {
            const int cluster = places.ClusterAt(v, {});
            if (cluster < 0)
                continue;
            const auto &color = bsp_.drawVerts[first + v].color[0];
            const Vec3f bytes{float(color[0]), float(color[1]), float(color[2])};
            const ObservedLight light{storing.LightOf(bytes), lit_.vertex.sum[0][first + v],
                                      storing.As(MaxComponent(bytes))};
            vertices.at.push_back(std::uint32_t(first + v));
            Add(light, places.RayOrigin(v), verts[v].normal, cluster, entry.shader->twoSided, vertices);
        }
        if (!vertices.batches.empty())
            map_.surfaces.push_back(std::move(vertices));
    }

  private:
    void AddTriangle(const RawLightmap &raw, const std::array<const FaceCorner *, 3> &corners, int page, int stride,
                     const Storing &storing, std::vector<std::uint8_t> &done, ObservedSurface &luxels) {
        LuxelTriangle triangle;
        std::array<float, 2> low{1e30f, 1e30f}, high{-1e30f, -1e30f};
        for (std::size_t i = 0; i < 3; ++i) {
            triangle.luxels[i] = corners[i]->luxel, triangle.page[i] = corners[i]->st;
            for (std::size_t axis = 0; axis < 2; ++axis)
                low[axis] = std::min(low[axis], corners[i]->luxel[axis]),
                high[axis] = std::max(high[axis], corners[i]->luxel[axis]);
        }
        const auto super = float(raw.super);
        const int x0 = LuxelOf(low[0] / super, raw.width), x1 = LuxelOf(high[0] / super, raw.width);
        const int y0 = LuxelOf(low[1] / super, raw.height), y1 = LuxelOf(high[1] / super, raw.height);
        // Thin lightmaps keep the luxels in their middle.
        const auto start = [stride](int size) { return std::min(stride / 2, (size - 1) / 2); };
        const int sx = start(raw.width), sy = start(raw.height);
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                if (x % stride != sx % stride || y % stride != sy % stride || done[raw.Index(x, y)] != 0)
                    continue;
                std::array<float, 2> at{};
                if (triangle.PageAt((float(x) + 0.5f) * super, (float(y) + 0.5f) * super, at) &&
                    AddLuxel(raw, x, y, page, at, storing, luxels))
                    done[raw.Index(x, y)] = 1;
            }
    }

    bool AddLuxel(const RawLightmap &raw, int x, int y, int page, const std::array<float, 2> &at,
                  const Storing &storing, ObservedSurface &luxels) {
        const std::size_t middle = raw.SuperIndex(x * raw.super + raw.super / 2, y * raw.super + raw.super / 2);
        const Vec3f &known = raw.result[0][raw.Index(x, y)];
        Vec3f bytes;
        float greatest = 0;
        if (!raw.Mapped(middle) || known.x < 0 || !pages_.Read(page, at, bytes, greatest))
            return false;
        const ObservedLight light{storing.LightOf(bytes), known, storing.As(greatest)};
        luxels.at.push_back(std::uint32_t(raw.Index(x, y)));
        if (!raw.dirt.empty())
            luxels.dirt.push_back(raw.dirt[middle]);
        Add(light, raw.positions[middle], raw.normals[middle], raw.luxelClusters[middle], raw.twoSided, luxels);
        return true;
    }

    void Add(const ObservedLight &light, const Vec3f &position, const Vec3f &normal, int cluster, bool twoSided,
             ObservedSurface &to) {
        map_.light.push_back(light);
        map_.positions.push_back(position);
        map_.normals.push_back(normal);
        SurfaceReceiverBatch &batch = BatchWithRoom(to.batches);
        batch.twoSided = twoSided;
        batch.Add(position, normal, cluster);
        to.boxes.resize(to.batches.size());
        to.boxes.back().Add(position);
    }

    const SurfaceInputs &in_;
    const SurfaceLight &lit_;
    SurfaceLight onPages_; ///< the vertices, with coordinates on pages in place of those of textures
    PageReader pages_;
    const Bsp &bsp_;
    ObservedMap &map_;
};

Vec3f BytesOf(const std::array<std::uint8_t, 3> &bytes) {
    return {float(bytes[0]), float(bytes[1]), float(bytes[2])};
}

/// How the legacy grid is stored.
struct GridStoring {
    explicit GridStoring(const LightSetup &setup)
        : ambient(setup.options.gridScale * setup.options.gridAmbientScale, 1, setup.world.minGrid, setup.options.tone),
          directed(setup.options.gridScale, 1, {}, setup.options.tone) {}

    /// Light of a point: what is stored as directed, and four times the ambient part (light_grid.cpp, kMeanCosine).
    Vec3f LightOf(const bspGridPoint_t &point) const {
        return directed.LightOf(BytesOf(point.directed[0])) + ambient.LightOf(BytesOf(point.ambient[0])) * 4;
    }
    StoredAs As(const bspGridPoint_t &point) const {
        const StoredAs ofAmbient = ambient.As(MaxComponent(BytesOf(point.ambient[0])));
        return ofAmbient != StoredAs::Value ? ofAmbient : directed.As(MaxComponent(BytesOf(point.directed[0])));
    }

    Storing ambient, directed;
};

void ObserveGrid(const Bsp &bsp, const LightSetup &setup, const std::vector<bspGridPoint_t> &known, ObservedMap &map) {
    if (bsp.gridPoints.size() != std::size_t(setup.layout.Count()) || known.size() != bsp.gridPoints.size())
        return;
    const GridStoring storing(setup);
    for (std::int64_t i = 0; i < setup.layout.Count(); ++i) {
        const bspGridPoint_t &point = bsp.gridPoints[std::size_t(i)];
        const Int3 at = setup.layout.Coordinates(i);
        const LegacyPlace place =
            PlaceLegacyPoint(setup.space, setup.layout, Vec3f(setup.layout.Position(at[0], at[1], at[2])));
        if (place.cluster == kSolidCluster)
            continue;
        map.light.push_back({storing.LightOf(point), storing.LightOf(known[std::size_t(i)]), storing.As(point)});
        map.positions.push_back(place.position);
        map.normals.push_back(DirectionTowardsLight(point));
        map.gridNumbers.push_back(std::uint32_t(i));
        ReceiverBatch &batch = BatchWithRoom(map.grid);
        batch.Add(place.position, place.rayOrigin, place.cluster, std::uint32_t(i));
        map.gridBoxes.resize(map.grid.size());
        map.gridBoxes.back().Add(place.position);
    }
}

} // namespace

ObservedMap ObserveLight(const Bsp &bsp, const LightSetup &setup, const SurfacePasses &passes,
                         const std::vector<bspGridPoint_t> &knownGrid) {
    ObservedMap map;
    Observer observer(bsp, passes, map);
    for (std::size_t i = 0; i < passes.Surfaces().lightmaps.size(); ++i)
        observer.AddLightmap(i);
    for (std::size_t i = 0; i < bsp.drawSurfaces.size() && !passes.Inputs().lightmap.dirty; ++i)
        observer.AddVertices(i);
    map.firstGrid = map.light.size();
    ObserveGrid(bsp, setup, knownGrid, map);
    return map;
}

std::vector<Vec3f> LightAtPlaces(const ObservedMap &map, const LightSetup &setup, const SurfacePasses &passes,
                                 const std::vector<bspGridPoint_t> &grid) {
    const SurfaceLight &lit = passes.Surfaces();
    std::vector<Vec3f> light(map.light.size());
    for (const ObservedSurface &surface : map.surfaces)
        for (std::size_t i = 0; i < surface.at.size(); ++i)
            light[surface.first + i] = surface.lightmap < 0
                                           ? lit.vertex.sum[0][surface.at[i]]
                                           : lit.lightmaps[std::size_t(surface.lightmap)].result[0][surface.at[i]];
    const GridStoring storing(setup);
    for (std::size_t i = 0; i < map.gridNumbers.size() && !grid.empty(); ++i)
        light[map.firstGrid + i] = storing.LightOf(grid[map.gridNumbers[i]]);
    return light;
}

} // namespace q3
