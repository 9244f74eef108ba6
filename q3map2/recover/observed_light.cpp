// GPL-2.0-or-later. What a lit map says about its lights: stored light at places whose position is known.
#include "q3map2/recover/observed_light.h"

#include "q3map2/light/grid/light_grid.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/raw/luxel_raster.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Least byte that stands for light at its limit: colors above it are scaled down to just under 255, and cut off.
constexpr float kFullByte = 254;

/// Stored bytes of luxels, found by the texture coordinates of lightmaps.
class PageReader {
  public:
    explicit PageReader(const Bsp &bsp) : bsp_(bsp), side_(bsp.lightmapSide) {}

    /// Bytes at a place of a page, blended from the four texels around it; `isFull`: one of them is at its limit.
    bool Read(int page, const std::array<float, 2> &at, Vec3f &bytes, bool &isFull) const {
        const std::size_t first = std::size_t(page) * LightmapPageBytes(side_);
        if (page < 0 || first + LightmapPageBytes(side_) > bsp_.lightmaps.size())
            return false;
        const float x = at[0] * float(side_) - 0.5f, y = at[1] * float(side_) - 0.5f;
        if (!(x > -1 && y > -1 && x < float(side_) && y < float(side_)))
            return false;
        const float left = std::floor(x), top = std::floor(y), u = x - left, v = y - top;
        bytes = {}, isFull = false;
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
                isFull |= MaxComponent(one) >= kFullByte;
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

class Observer {
  public:
    Observer(const Bsp &bsp, const SurfacePasses &passes, ObservedMap &map)
        : in_(passes.Inputs()), pages_(bsp), bsp_(bsp), tone_(StoredTone(in_)), map_(map) {
        // Corners of faces carry texture coordinates; here those of lightmaps.
        onPages_.verts = passes.Surfaces().verts;
        for (std::size_t v = 0; v < onPages_.verts.size(); ++v)
            onPages_.verts[v].st = bsp.drawVerts[v].lightmap[0];
    }

    void AddLightmap(const RawLightmap &raw) {
        if (raw.result[0].empty() || raw.positions.empty())
            return;
        const ToneMapper mapper(1, raw.brightness, tone_);
        ObservedLuxels luxels;
        luxels.settings = LuxelPassOf(in_, {}, raw).settings;
        luxels.settings.faint = 0, luxels.settings.directional = false;
        luxels.first = map_.light.size();
        const int stride = std::max(1, int(std::lround(kLuxelSpacing / std::max(1.0f, raw.actualSampleSize))));
        std::vector<std::uint8_t> done(std::size_t(raw.width) * std::size_t(raw.height));
        for (const int surface : raw.surfaces) {
            const int page = bsp_.drawSurfaces[std::size_t(surface)].lightmapNum[0];
            for (const Face &face : FacesOf(in_, onPages_, std::size_t(surface)))
                for (std::size_t k = 2; k < face.size(); ++k)
                    AddTriangle(raw, {&face[0], &face[k - 1], &face[k]}, page, stride, mapper, done, luxels);
        }
        if (!luxels.batches.empty())
            map_.lightmaps.push_back(std::move(luxels));
    }

  private:
    void AddTriangle(const RawLightmap &raw, const std::array<const FaceCorner *, 3> &corners, int page, int stride,
                     const ToneMapper &mapper, std::vector<std::uint8_t> &done, ObservedLuxels &luxels) {
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
                if (triangle.PageAt((float(x) + 0.5f) * super, (float(y) + 0.5f) * super, at))
                    AddLuxel(raw, x, y, page, at, mapper, done, luxels);
            }
    }

    void AddLuxel(const RawLightmap &raw, int x, int y, int page, const std::array<float, 2> &at,
                  const ToneMapper &mapper, std::vector<std::uint8_t> &done, ObservedLuxels &luxels) {
        const std::size_t middle = raw.SuperIndex(x * raw.super + raw.super / 2, y * raw.super + raw.super / 2);
        const Vec3f &known = raw.result[0][raw.Index(x, y)];
        Vec3f bytes;
        ObservedLight light;
        if (!raw.Mapped(middle) || known.x < 0 || !pages_.Read(page, at, bytes, light.isBound))
            return;
        done[raw.Index(x, y)] = 1;
        light.stored = mapper.LightOf(MiddleOf(bytes)), light.known = known;
        map_.light.push_back(light);
        map_.positions.push_back(raw.positions[middle]);
        map_.normals.push_back(raw.normals[middle]);
        SurfaceReceiverBatch &batch = BatchWithRoom(luxels.batches);
        batch.twoSided = raw.twoSided;
        batch.Add(raw.positions[middle], raw.normals[middle], raw.luxelClusters[middle]);
        luxels.boxes.resize(luxels.batches.size());
        luxels.boxes.back().Add(raw.positions[middle]);
        if (!raw.dirt.empty())
            luxels.dirt.push_back(raw.dirt[middle]);
    }

    const SurfaceInputs &in_;
    SurfaceLight onPages_; ///< the vertices, with coordinates on pages in place of those of textures
    PageReader pages_;
    const Bsp &bsp_;
    ToneOptions tone_;
    ObservedMap &map_;
};

/// Light of a grid point: what is stored as directed, and four times the ambient part (light_grid.cpp, kMeanCosine).
Vec3f TotalLight(const bspGridPoint_t &point, bool &isFull) {
    Vec3f sum;
    for (std::size_t i = 0; i < 3; ++i) {
        sum[i] = float(point.directed[0][i]) + 4 * float(point.ambient[0][i]);
        isFull |= std::max(point.directed[0][i], point.ambient[0][i]) >= kFullByte;
    }
    return sum;
}

void ObserveGrid(const Bsp &bsp, const LightSetup &setup, const std::vector<bspGridPoint_t> &known, ObservedMap &map) {
    if (bsp.gridPoints.size() != std::size_t(setup.layout.Count()) || known.size() != bsp.gridPoints.size())
        return;
    for (std::int64_t i = 0; i < setup.layout.Count(); ++i) {
        const bspGridPoint_t &point = bsp.gridPoints[std::size_t(i)];
        const Int3 at = setup.layout.Coordinates(i);
        const LegacyPlace place =
            PlaceLegacyPoint(setup.space, setup.layout, Vec3f(setup.layout.Position(at[0], at[1], at[2])));
        if (place.cluster == kSolidCluster)
            continue;
        ObservedLight light;
        bool knownIsFull = false;
        light.stored = TotalLight(point, light.isBound), light.known = TotalLight(known[std::size_t(i)], knownIsFull);
        map.light.push_back(light);
        map.positions.push_back(place.position);
        map.normals.push_back({});
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
    for (const RawLightmap &raw : passes.Surfaces().lightmaps)
        observer.AddLightmap(raw);
    map.firstGrid = map.light.size();
    ObserveGrid(bsp, setup, knownGrid, map);
    return map;
}

} // namespace q3
