// GPL-2.0-or-later. Checks that every index, count and float that a stage relies on is in range.
#include "q3map2/bspfile/bsp_validate.h"

#include "common/error.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/entities.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Surfaces without a page have -1 to -4: LIGHTMAP_NONE, _WHITEIMAGE, _BY_VERTEX and _2D of engines.
constexpr int kLeastLightmapNum = -4;

constexpr std::int64_t kMaxAreas = 256; ///< an engine's area mask has 32 bytes
constexpr int kMaxTreeDepth = 4096;     ///< limit of this program, chosen, for code that walks the tree by recursion
constexpr int kMinPatchSide = 3, kMaxPatchSide = 31; ///< control points, odd; MAX_PATCH_SIZE of engines is 32
constexpr std::size_t kBoxSides = 6;
constexpr double kLengthTolerance = 0.01; ///< of normals of planes, which should have length 1
constexpr float kBoxTolerance = 0.001f;   ///< of the component of a box side's normal, which should be 1 or -1
/// Head of the visibility lump: the number of clusters and the bytes of a row, 4 bytes each.
constexpr std::size_t kVisHeadBytes = 8;
// Records may share ranges, as index runs do in valid files. These limits on the sum of all ranges keep a small file
// from expanding into a huge map; real maps stay under a tenth of them.
constexpr std::uint64_t kMaxSharing = 16, kMaxIndexesPerVert = 64, kSharingSlack = 4096;

bool AllFinite(std::span<const float> values) {
    return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
}

double Length(const Float3 &v) {
    return std::sqrt(double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2]);
}

/// A record in messages, such as "leaf 12".
struct RecordRef {
    std::string_view record;
    std::size_t index;
};

class Validator {
  public:
    Validator(const Bsp &bsp, std::string_view name, Log &log) : bsp_(bsp), name_(name), log_(log) {}

    void Run() {
        CheckCounts();
        CheckVisibility();
        CheckPlanes();
        CheckNodes();
        CheckTree();
        CheckLeafs();
        CheckModels();
        CheckBrushes();
        CheckFogs();
        CheckVerts();
        CheckSurfaces();
        CheckAdvertisements();
        CheckEntities();
        CheckBspxNames();
        CheckBspxLumps(bsp_, name_);
    }

  private:
    template <typename... Args>
    [[noreturn]] void Fail(const RecordRef &at, fmt::format_string<Args...> format, Args &&...args) const {
        throw Error("{}: {} {}: {}", name_, at.record, at.index, fmt::format(format, std::forward<Args>(args)...));
    }

    /// low <= value < count, else an error that names the field. `of`: the records that are counted.
    void CheckIndex(const RecordRef &at, std::string_view field, std::int64_t value, std::int64_t low,
                    std::uint64_t count, std::string_view of) const {
        if (value < low || value >= std::int64_t(count))
            Fail(at, "{} {} is outside {}..{} of {} {}", field, value, low, std::int64_t(count) - 1, count, of);
    }

    /// 0 <= first and first + num <= count, else an error that names the fields. `of`: the records that are counted.
    void CheckRange(const RecordRef &at, std::string_view firstField, std::int64_t first, std::string_view numField,
                    std::int64_t num, std::size_t count, std::string_view of) const {
        if (first < 0)
            Fail(at, "{} {} is negative", firstField, first);
        if (num < 0)
            Fail(at, "{} {} is negative", numField, num);
        if (first + num > std::int64_t(count))
            Fail(at, "{} {} + {} {} exceeds {} {}", firstField, first, numField, num, count, of);
    }

    /// `used`, the sum of all ranges of a kind, must not exceed the limit by more than kSharingSlack.
    void CheckSharing(std::string_view users, std::string_view field, std::uint64_t used, std::uint64_t limit) const {
        if (used > limit + kSharingSlack)
            throw Error("{}: {}: the sum of {} is {}, expected at most {}", name_, users, field, used,
                        limit + kSharingSlack);
    }

    void CheckCounts() const {
        const auto required = [this](std::size_t count, std::string_view what) {
            if (count == 0)
                throw Error("{}: the map has no {}, expected at least 1", name_, what);
        };
        required(bsp_.shaders.size(), "shaders");
        required(bsp_.planes.size(), "planes");
        required(bsp_.nodes.size(), "nodes");
        required(bsp_.leafs.size(), "leafs");
        required(bsp_.models.size(), "models");
        if (const std::size_t page = LightmapPageBytes(bsp_.lightmapSide); bsp_.lightmaps.size() % page != 0)
            throw Error("{}: lightmaps: {} bytes are not a multiple of {}", name_, bsp_.lightmaps.size(), page);
    }

    void CheckVisibility() {
        if (bsp_.visibility.empty())
            return;
        const std::uint64_t length = bsp_.visibility.size();
        if (length < kVisHeadBytes)
            throw Error("{}: visibility: {} bytes, expected 0 or at least {}", name_, length, kVisHeadBytes);
        const auto bytes = std::as_bytes(std::span(bsp_.visibility));
        const std::int64_t clusters = LoadRecord<std::int32_t>(bytes, 0);
        const std::int64_t row = LoadRecord<std::int32_t>(bytes, 4);
        if (clusters < 0)
            throw Error("{}: visibility: {} clusters, expected at least 0", name_, clusters);
        if (row < (clusters + 7) / 8)
            throw Error("{}: visibility: {} bytes per row, expected at least {} for {} clusters", name_, row,
                        (clusters + 7) / 8, clusters);
        if (kVisHeadBytes + std::uint64_t(clusters) * std::uint64_t(row) > length)
            throw Error("{}: visibility: {} rows of {} bytes exceed the {} bytes of the lump", name_, clusters, row,
                        length);
        clusters_ = clusters;
    }

    void CheckPlanes() const {
        for (std::size_t i = 0; i < bsp_.planes.size(); i++) {
            const bspPlane_t &plane = bsp_.planes[i];
            const RecordRef at{"plane", i};
            if (!AllFinite(plane.normal))
                Fail(at, "normal {} {} {} is not finite", plane.normal[0], plane.normal[1], plane.normal[2]);
            if (!std::isfinite(plane.dist))
                Fail(at, "dist {} is not finite", plane.dist);
            const double length = Length(plane.normal);
            if (length == 0)
                Fail(at, "normal is zero");
            if (std::abs(length - 1) > kLengthTolerance)
                log_.Warn("plane normal length", "{}: plane {}: normal has length {:.3f}, expected 1", name_, i,
                          length);
        }
    }

    void CheckNodes() const {
        for (std::size_t i = 0; i < bsp_.nodes.size(); i++) {
            const bspNode_t &node = bsp_.nodes[i];
            const RecordRef at{"node", i};
            CheckIndex(at, "planeNum", node.planeNum, 0, bsp_.planes.size(), "planes");
            for (const std::int64_t child : node.children) {
                if (child >= 0)
                    CheckIndex(at, "child", child, 0, bsp_.nodes.size(), "nodes");
                else if (-1 - child >= std::int64_t(bsp_.leafs.size()))
                    Fail(at, "child {} is leaf {} of {} leafs", child, -1 - child, bsp_.leafs.size());
            }
        }
    }

    void CheckTree() const {
        struct Step {
            std::int32_t node;
            int depth;
        };
        std::vector<bool> reached(bsp_.nodes.size());
        std::vector<Step> pending{{0, 1}};
        while (!pending.empty()) {
            const Step step = pending.back();
            pending.pop_back();
            const auto index = std::size_t(step.node);
            if (reached[index])
                Fail({"node", index}, "two children refer to it: the nodes are not a tree");
            if (step.depth > kMaxTreeDepth)
                Fail({"node", index}, "the tree is deeper than {} nodes", kMaxTreeDepth);
            reached[index] = true;
            for (const std::int32_t child : bsp_.nodes[index].children)
                if (child >= 0)
                    pending.push_back({child, step.depth + 1});
        }
    }

    void CheckLeafs() const {
        std::uint64_t surfaces = 0, brushes = 0;
        for (std::size_t i = 0; i < bsp_.leafs.size(); i++) {
            const bspLeaf_t &leaf = bsp_.leafs[i];
            const RecordRef at{"leaf", i};
            CheckIndex(at, "cluster", leaf.cluster, -1, std::uint64_t(clusters_), "clusters");
            CheckIndex(at, "area", leaf.area, -1, kMaxAreas, "areas");
            CheckRange(at, "firstBSPLeafSurface", leaf.firstBSPLeafSurface, "numBSPLeafSurfaces",
                       leaf.numBSPLeafSurfaces, bsp_.leafSurfaces.size(), "leaf surfaces");
            CheckRange(at, "firstBSPLeafBrush", leaf.firstBSPLeafBrush, "numBSPLeafBrushes", leaf.numBSPLeafBrushes,
                       bsp_.leafBrushes.size(), "leaf brushes");
            surfaces += std::uint64_t(leaf.numBSPLeafSurfaces);
            brushes += std::uint64_t(leaf.numBSPLeafBrushes);
            if (leaf.cluster >= 0 && leaf.area < 0)
                log_.Warn("leaf without area", "{}: leaf {}: cluster {}, but area {}", name_, i, leaf.cluster,
                          leaf.area);
        }
        CheckSharing("leafs", "numBSPLeafSurfaces", surfaces, kMaxSharing * bsp_.leafSurfaces.size());
        CheckSharing("leafs", "numBSPLeafBrushes", brushes, kMaxSharing * bsp_.leafBrushes.size());
        for (std::size_t i = 0; i < bsp_.leafSurfaces.size(); i++)
            CheckIndex({"leaf surface", i}, "value", bsp_.leafSurfaces[i], 0, bsp_.drawSurfaces.size(), "surfaces");
        for (std::size_t i = 0; i < bsp_.leafBrushes.size(); i++)
            CheckIndex({"leaf brush", i}, "value", bsp_.leafBrushes[i], 0, bsp_.brushes.size(), "brushes");
    }

    void CheckModels() const {
        std::uint64_t surfaces = 0, brushes = 0;
        for (std::size_t i = 0; i < bsp_.models.size(); i++) {
            const bspModel_t &model = bsp_.models[i];
            const RecordRef at{"model", i};
            CheckRange(at, "firstBSPSurface", model.firstBSPSurface, "numBSPSurfaces", model.numBSPSurfaces,
                       bsp_.drawSurfaces.size(), "surfaces");
            CheckRange(at, "firstBSPBrush", model.firstBSPBrush, "numBSPBrushes", model.numBSPBrushes,
                       bsp_.brushes.size(), "brushes");
            surfaces += std::uint64_t(model.numBSPSurfaces);
            brushes += std::uint64_t(model.numBSPBrushes);
            for (std::size_t axis = 0; axis < 3; axis++) {
                if (!std::isfinite(model.mins[axis]))
                    Fail(at, "mins[{}] {} is not finite", axis, model.mins[axis]);
                if (!std::isfinite(model.maxs[axis]))
                    Fail(at, "maxs[{}] {} is not finite", axis, model.maxs[axis]);
                if (i == 0 && model.mins[axis] > model.maxs[axis])
                    Fail(at, "mins[{}] {} is above maxs[{}] {}", axis, model.mins[axis], axis, model.maxs[axis]);
            }
        }
        CheckSharing("models", "numBSPSurfaces", surfaces, kMaxSharing * bsp_.drawSurfaces.size());
        CheckSharing("models", "numBSPBrushes", brushes, kMaxSharing * bsp_.brushes.size());
    }

    void CheckBrushes() const {
        for (std::size_t i = 0; i < bsp_.brushSides.size(); i++) {
            const RecordRef at{"brush side", i};
            CheckIndex(at, "planeNum", bsp_.brushSides[i].planeNum, 0, bsp_.planes.size(), "planes");
            CheckIndex(at, "shaderNum", bsp_.brushSides[i].shaderNum, 0, bsp_.shaders.size(), "shaders");
            CheckIndex(at, "surfaceNum", bsp_.brushSides[i].surfaceNum, -1, bsp_.drawSurfaces.size(), "surfaces");
        }
        std::uint64_t sides = 0;
        for (std::size_t i = 0; i < bsp_.brushes.size(); i++) {
            const bspBrush_t &brush = bsp_.brushes[i];
            const RecordRef at{"brush", i};
            CheckRange(at, "firstSide", brush.firstSide, "numSides", brush.numSides, bsp_.brushSides.size(), "sides");
            if (brush.numSides < std::int32_t(kBoxSides))
                Fail(at, "numSides {} is under {}", brush.numSides, kBoxSides);
            CheckIndex(at, "shaderNum", brush.shaderNum, 0, bsp_.shaders.size(), "shaders");
            sides += std::uint64_t(brush.numSides);
            CheckBox(i);
        }
        CheckSharing("brushes", "numSides", sides, kMaxSharing * bsp_.brushSides.size());
    }

    // Engines take a brush's box from its first six sides without looking at their normals.
    void CheckBox(std::size_t brush) const {
        for (std::size_t side = 0; side < kBoxSides; side++) {
            const auto &record = bsp_.brushSides[std::size_t(bsp_.brushes[brush].firstSide) + side];
            const float along = bsp_.planes[std::size_t(record.planeNum)].normal[side / 2];
            if (std::abs(along - (side % 2 == 0 ? -1.0f : 1.0f)) > kBoxTolerance)
                log_.Warn("brush without box", "{}: brush {}: side {} does not face {}{}", name_, brush, side,
                          side % 2 == 0 ? '-' : '+', "XYZ"[side / 2]);
        }
    }

    void CheckFogs() const {
        for (std::size_t i = 0; i < bsp_.fogs.size(); i++) {
            const bspFog_t &fog = bsp_.fogs[i];
            const RecordRef at{"fog", i};
            CheckIndex(at, "brushNum", fog.brushNum, -1, bsp_.brushes.size(), "brushes");
            const std::int32_t sides = fog.brushNum < 0 ? 0 : bsp_.brushes[std::size_t(fog.brushNum)].numSides;
            CheckIndex(at, "visibleSide", fog.visibleSide, -1, std::uint64_t(sides), "sides");
        }
    }

    void CheckVerts() const {
        for (std::size_t i = 0; i < bsp_.drawVerts.size(); i++) {
            const bspDrawVert_t &vert = bsp_.drawVerts[i];
            if (!AllFinite(vert.xyz))
                Fail({"draw vert", i}, "xyz {} {} {} is not finite", vert.xyz[0], vert.xyz[1], vert.xyz[2]);
            if (!AllFinite(vert.normal))
                Fail({"draw vert", i}, "normal {} {} {} is not finite", vert.normal[0], vert.normal[1], vert.normal[2]);
        }
    }

    void CheckSurfaces() const {
        std::uint64_t verts = 0, indexes = 0;
        for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); i++) {
            const bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
            const RecordRef at{"surface", i};
            CheckIndex(at, "shaderNum", surface.shaderNum, 0, bsp_.shaders.size(), "shaders");
            CheckIndex(at, "fogNum", surface.fogNum, -1, bsp_.fogs.size(), "fogs");
            CheckIndex(at, "surfaceType", surface.surfaceType, MST_BAD, MST_FOLIAGE + 1, "surface types");
            CheckRange(at, "firstVert", surface.firstVert, "numVerts", surface.numVerts, bsp_.drawVerts.size(),
                       "verts");
            CheckRange(at, "firstIndex", surface.firstIndex, "numIndexes", surface.numIndexes, bsp_.drawIndexes.size(),
                       "indexes");
            verts += std::uint64_t(surface.numVerts);
            indexes += std::uint64_t(surface.numIndexes);
            if (surface.surfaceType == MST_PATCH)
                CheckPatch(at, surface);
            CheckLightmap(at, surface);
        }
        CheckSharing("surfaces", "numVerts", verts, kMaxSharing * bsp_.drawVerts.size());
        CheckSharing("surfaces", "numIndexes", indexes, kMaxIndexesPerVert * verts);
        for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); i++)
            CheckTriangles({"surface", i}, bsp_.drawSurfaces[i]);
    }

    void CheckPatch(const RecordRef &at, const bspDrawSurface_t &surface) const {
        const auto side = [&](std::string_view field, std::int32_t value) {
            if (value < kMinPatchSide || value > kMaxPatchSide || value % 2 == 0)
                Fail(at, "{} {} is not an odd number in {}..{}", field, value, kMinPatchSide, kMaxPatchSide);
        };
        side("patchWidth", surface.patchWidth);
        side("patchHeight", surface.patchHeight);
        if (surface.patchWidth * surface.patchHeight != surface.numVerts)
            Fail(at, "patchWidth {} x patchHeight {} is not numVerts {}", surface.patchWidth, surface.patchHeight,
                 surface.numVerts);
    }

    void CheckLightmap(const RecordRef &at, const bspDrawSurface_t &surface) const {
        if (!AllFinite(surface.lightmapOrigin))
            Fail(at, "lightmapOrigin is not finite");
        for (const Float3 &vector : surface.lightmapVecs)
            if (!AllFinite(vector))
                Fail(at, "lightmapVecs are not finite");
        if (surface.surfaceType == MST_FLARE)
            return; // flares have no lightmap
        const auto pages = std::int64_t(bsp_.LightmapPages());
        const auto inPage = [this](std::int64_t start, std::int64_t length) {
            return start >= 0 && length >= 0 && start + length <= bsp_.lightmapSide;
        };
        for (std::size_t slot = 0; slot < kStyles; slot++) {
            if (slot > 0 && surface.lightmapStyles[slot] == kNoStyle)
                break; // free slots may hold anything
            // Without pages in the file, lightmapNum refers to external images.
            const std::int32_t page = surface.lightmapNum[slot];
            if (page < kLeastLightmapNum || (pages > 0 && page >= pages))
                log_.Warn("lightmapNum",
                          "{}: surface {}: lightmapNum {} is not one of {} pages: taken as lit by vertex", name_,
                          at.index, page, pages);
            const std::int32_t x = surface.lightmapX[slot], y = surface.lightmapY[slot];
            if (!inPage(x, surface.lightmapWidth) || !inPage(y, surface.lightmapHeight))
                log_.Warn("lightmap rectangle",
                          "{}: surface {}: the lightmap rectangle {} {} {} {} leaves the page: ignored", name_,
                          at.index, x, y, surface.lightmapWidth, surface.lightmapHeight);
        }
    }

    void CheckTriangles(const RecordRef &at, const bspDrawSurface_t &surface) const {
        const bool isTriangles = surface.surfaceType == MST_PLANAR || surface.surfaceType == MST_TRIANGLE_SOUP;
        if (isTriangles && surface.numIndexes % 3 != 0)
            Fail(at, "numIndexes {} is not a multiple of 3", surface.numIndexes);
        const auto run =
            std::span(bsp_.drawIndexes).subspan(std::size_t(surface.firstIndex), std::size_t(surface.numIndexes));
        for (std::size_t i = 0; i < run.size(); i++)
            if (run[i] < 0 || run[i] >= surface.numVerts)
                Fail(at, "index {} of its {} is {}, but numVerts is {}", i, run.size(), run[i], surface.numVerts);
    }

    void CheckAdvertisements() const {
        for (std::size_t i = 0; i < bsp_.advertisements.size(); i++) {
            const bspAdvertisement_t &ad = bsp_.advertisements[i];
            if (!AllFinite(ad.normal))
                Fail({"advertisement", i}, "normal is not finite");
            if (!std::ranges::all_of(ad.rect, [](const Float3 &corner) { return AllFinite(corner); }))
                Fail({"advertisement", i}, "rect is not finite");
        }
    }

    // Bad entity text is only a warning here: stages that need the entities fail, others can repair the map.
    void CheckEntities() const {
        std::vector<Entity> entities;
        try {
            entities = ParseEntities(bsp_.entities, name_);
        } catch (const Error &error) {
            log_.Warn("entity text", "{}", error.what());
            return;
        }
        for (std::size_t i = 0; i < entities.size(); i++)
            CheckModelKey(i, entities[i]);
        CheckLightGrid(entities.empty() ? Entity{} : entities[0]);
    }

    void CheckModelKey(std::size_t index, const Entity &entity) const {
        const std::string_view model = entity.Value("model");
        if (!model.starts_with('*'))
            return;
        const double number = NumberFromText(model.substr(1));
        if (number < 1 || number >= double(bsp_.models.size()) || number != std::floor(number))
            log_.Warn("model key", "{}: entity {}: model {} is not one of *1..*{}", name_, index, model.substr(0, 16),
                      bsp_.models.size() - 1);
    }

    // Engines ignore a grid of unexpected length, and so does this program.
    void CheckLightGrid(const Entity &world) const {
        Float3 size = kDefaultGridSize;
        if (world.Has("gridsize")) {
            if (const auto given = world.Vector({"gridsize"}))
                size = {given->x, given->y, given->z};
            else
                log_.Warn("gridsize", "{}: gridsize {} is not three numbers", name_,
                          world.Value("gridsize").substr(0, 40));
        }
        try {
            const GridLayout grid = LayoutGrid(bsp_.models[0].mins, bsp_.models[0].maxs, size);
            if (!bsp_.gridPoints.empty() && grid.Count() != std::int64_t(bsp_.gridPoints.size()))
                log_.Warn("light grid", "{}: the light grid has {} points, expected {} x {} x {}: engines ignore it",
                          name_, bsp_.gridPoints.size(), grid.bounds[0], grid.bounds[1], grid.bounds[2]);
        } catch (const Error &error) {
            log_.Warn("light grid", "{}: {}", name_, error.what());
        }
    }

    void CheckBspxNames() const {
        for (std::size_t i = 0; i < bsp_.bspx.size(); i++) {
            const std::string &lump = bsp_.bspx[i].name;
            if (lump.size() > kBspxNameBytes)
                Fail({"BSPX lump", i}, "the name has {} bytes, expected at most {}", lump.size(), kBspxNameBytes);
            if (const BspxRow *row = FindBspxRow(lump))
                Fail({"BSPX lump", i}, "the name {} belongs to {}", lump, row->content);
        }
    }

    const Bsp &bsp_;
    std::string_view name_;
    Log &log_;
    std::int64_t clusters_ = kMaxClusters; ///< limit without a visibility lump
};

} // namespace

void ValidateBsp(const Bsp &bsp, std::string_view name, Log &log) {
    Validator(bsp, name, log).Run();
}

} // namespace q3
