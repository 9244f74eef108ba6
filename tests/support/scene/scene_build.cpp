// GPL-2.0-or-later. From the parts of a scene to the records of a map.
#include "common/error.h"
#include "tests/support/scene/scene_builder.h"
#include "tests/support/scene/scene_surface.h"
#include "tests/support/scene/scene_tree.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

namespace {

using Box = SceneBuilder::Box;
using Surface = SceneBuilder::Surface;

constexpr std::uint32_t kSurfNoDraw = 0x80; ///< surface flag

Int3 RoundDown(const Vec3f &v) {
    return {int(std::floor(v.x)), int(std::floor(v.y)), int(std::floor(v.z))};
}

Int3 RoundUp(const Vec3f &v) {
    return {int(std::ceil(v.x)), int(std::ceil(v.y)), int(std::ceil(v.z))};
}

Boundsf Intersection(const Boundsf &a, const Boundsf &b) {
    return {Max(a.mins, b.mins), Min(a.maxs, b.maxs)};
}

// Whether a rectangle (a box without thickness along one axis) shares area with the closed box.
bool SharesArea(const Boundsf &rectangle, const Boundsf &box) {
    const Boundsf common = Intersection(rectangle, box);
    if (common.Empty())
        return false;
    for (std::size_t axis = 0; axis < 3; axis++)
        if (common.mins[axis] == common.maxs[axis] && rectangle.mins[axis] != rectangle.maxs[axis])
            return false;
    return true;
}

class BspBuilder {
  public:
    BspBuilder(const Boundsf &interior, const SceneVisibility &visibility)
        : interior_(interior), visibility_(visibility) {}

    void AddWorld(const std::vector<Box> &walls, const std::vector<Box> &boxes, const std::vector<Surface> &surfaces) {
        Boundsf bounds;
        std::vector<Boundsf> solids, filled;
        for (const Box &box : walls) {
            filled.push_back(box.bounds);
            outer_.Add(box.bounds);
        }
        for (const Box &box : boxes)
            if (box.kind == BoxKind::Structural)
                solids.push_back(box.bounds);
        filled.insert(filled.end(), solids.begin(), solids.end());
        for (const auto *list : {&walls, &boxes})
            for (const Box &box : *list) {
                AddBrush(box);
                AddFaces(box, filled);
                bounds.Add(box.bounds);
            }
        for (const Surface &surface : surfaces) {
            AddSurface(surface);
            if (surface.type == MST_PATCH)
                bounds.Add(surfaceBounds_.back());
        }
        EndModel(bounds);
        AddTree(BuildSceneTree(interior_, outer_, solids));
    }

    void AddModel(const Box &box) {
        const auto firstBrush = std::int32_t(bsp_.brushes.size()),
                   firstSurface = std::int32_t(bsp_.drawSurfaces.size());
        AddBrush(box);
        for (std::size_t side = 0; side < 6; side++)
            AddSurface(BoxFaceSurface(box.bounds, BoxFace(side), box.faces[side]));
        EndModel(box.bounds);
        bspLeaf_t leaf{};
        leaf.firstBSPLeafBrush = std::int32_t(bsp_.leafBrushes.size());
        leaf.numBSPLeafBrushes = 1;
        bsp_.leafBrushes.push_back(firstBrush);
        leaf.firstBSPLeafSurface = std::int32_t(bsp_.leafSurfaces.size());
        leaf.numBSPLeafSurfaces = std::int32_t(bsp_.drawSurfaces.size()) - firstSurface;
        for (std::int32_t i = 0; i < leaf.numBSPLeafSurfaces; i++)
            bsp_.leafSurfaces.push_back(firstSurface + i);
        bsp_.leafs.push_back(leaf);
    }

    Bsp Take() { return std::move(bsp_); }
    void SetEntities(const std::vector<Entity> &entities) { bsp_.entities = FormatEntities(entities); }

  private:
    std::int32_t ShaderNumber(const SceneShader &shader) {
        const auto found = std::ranges::find(shaders_, shader);
        if (found != shaders_.end())
            return std::int32_t(found - shaders_.begin());
        bspShader_t record{{}, shader.surfaceFlags, shader.contentFlags};
        std::ranges::copy(shader.name, record.shader.begin());
        bsp_.shaders.push_back(record);
        shaders_.push_back(shader);
        return std::int32_t(shaders_.size()) - 1;
    }

    /// Number of the plane that faces the positive axis.
    std::int32_t PlaneNumber(std::size_t axis, float dist) {
        const auto [found, isNew] = planes_.try_emplace({axis, dist}, std::int32_t(bsp_.planes.size()));
        if (isNew) {
            bspPlane_t plane{};
            plane.normal[axis] = 1;
            plane.dist = dist;
            bsp_.planes.push_back(plane);
            bsp_.planes.push_back({{-plane.normal[0], -plane.normal[1], -plane.normal[2]}, -plane.dist});
        }
        return found->second;
    }

    void AddBrush(const Box &box) {
        bsp_.brushes.push_back({std::int32_t(bsp_.brushSides.size()), 6, ShaderNumber(box.shader)});
        for (std::size_t side = 0; side < 6; side++) {
            const std::size_t axis = side / 2;
            const bool plus = side % 2 != 0;
            const std::int32_t plane = PlaneNumber(axis, plus ? box.bounds.maxs[axis] : box.bounds.mins[axis]);
            bsp_.brushSides.push_back({plane + (plus ? 0 : 1), ShaderNumber(box.faces[side])});
        }
        brushBounds_.push_back(box.bounds);
    }

    // What can be seen: the part inside the room, unless one box covers all of it.
    void AddFaces(const Box &box, const std::vector<Boundsf> &filled) {
        const Boundsf visible = Intersection(box.bounds, interior_);
        if (visible.Empty())
            return;
        for (std::size_t side = 0; side < 6; side++) {
            const std::size_t axis = side / 2;
            const bool plus = side % 2 != 0;
            const float at = plus ? box.bounds.maxs[axis] : box.bounds.mins[axis];
            if (plus ? at < interior_.mins[axis] || at >= interior_.maxs[axis]
                     : at <= interior_.mins[axis] || at > interior_.maxs[axis])
                continue;
            Boundsf face = visible;
            face.mins[axis] = face.maxs[axis] = at;
            const auto covers = [&](const Boundsf &other) {
                return other.Contains(face.mins) && other.Contains(face.maxs) &&
                       (plus ? other.maxs[axis] > at : other.mins[axis] < at);
            };
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            if (face.mins[u] < face.maxs[u] && face.mins[v] < face.maxs[v] && std::ranges::none_of(filled, covers))
                AddSurface(BoxFaceSurface(face, BoxFace(side), box.faces[side]));
        }
    }

    void AddSurface(const Surface &source) {
        if (source.type != MST_PATCH && (source.shader.surfaceFlags & kSurfNoDraw))
            return;
        Boundsf bounds;
        for (const bspDrawVert_t &vert : source.verts)
            bounds.Add(Vec3f(vert.xyz));
        bspDrawSurface_t surface{};
        surface.shaderNum = ShaderNumber(source.shader);
        surface.fogNum = -1;
        surface.surfaceType = source.type;
        surface.firstVert = std::int32_t(bsp_.drawVerts.size());
        surface.numVerts = std::int32_t(source.verts.size());
        surface.firstIndex = std::int32_t(bsp_.drawIndexes.size());
        surface.numIndexes = std::int32_t(source.indexes.size());
        surface.lightmapNum[0] = kLightmapByVertex;
        surface.patchWidth = source.patchWidth;
        surface.patchHeight = source.patchHeight;
        if (source.type == MST_PATCH) // the level-of-detail group
            surface.lightmapVecs = {bounds.mins.Array(), bounds.maxs.Array(), Float3{}};
        else if (source.type == MST_PLANAR)
            surface.lightmapVecs[2] = source.verts[0].normal;
        bsp_.drawSurfaces.push_back(surface);
        bsp_.drawVerts.insert(bsp_.drawVerts.end(), source.verts.begin(), source.verts.end());
        bsp_.drawIndexes.insert(bsp_.drawIndexes.end(), source.indexes.begin(), source.indexes.end());
        surfaceBounds_.push_back(bounds);
    }

    /// What was added since the last model belongs to this one.
    void EndModel(const Boundsf &bounds) {
        bspModel_t model{bounds.mins.Array(), bounds.maxs.Array(), 0, 0, 0, 0};
        if (!bsp_.models.empty()) {
            const bspModel_t &last = bsp_.models.back();
            model.firstBSPSurface = last.firstBSPSurface + last.numBSPSurfaces;
            model.firstBSPBrush = last.firstBSPBrush + last.numBSPBrushes;
        }
        model.numBSPSurfaces = std::int32_t(bsp_.drawSurfaces.size()) - model.firstBSPSurface;
        model.numBSPBrushes = std::int32_t(bsp_.brushes.size()) - model.firstBSPBrush;
        bsp_.models.push_back(model);
    }

    void AddTree(const SceneTree &tree) {
        for (const SceneTreeNode &node : tree.nodes)
            bsp_.nodes.push_back({PlaneNumber(node.axis, node.dist),
                                  {node.children[0], node.children[1]},
                                  RoundDown(node.region.mins),
                                  RoundUp(node.region.maxs)});
        bsp_.leafs.push_back({}); // the dummy
        for (std::size_t i = 1; i < tree.leafs.size(); i++)
            AddLeaf(tree.leafs[i]);
        if (clusters_.empty())
            throw Error("scene: the boxes leave no open space");
        if (visibility_.writeLump)
            AddVisibility();
    }

    void AddLeaf(const SceneTreeLeaf &source) {
        const Boundsf &region = source.region;
        bspLeaf_t leaf{-1, -1, RoundDown(region.mins), RoundUp(region.maxs), 0, 0, 0, 0};
        if (!source.solid) {
            leaf.cluster = AddToCluster(region);
            leaf.area = 0;
            leaf.firstBSPLeafSurface = std::int32_t(bsp_.leafSurfaces.size());
            for (std::size_t i = 0; i < surfaceBounds_.size(); i++)
                if (SharesArea(surfaceBounds_[i], region))
                    bsp_.leafSurfaces.push_back(std::int32_t(i));
            leaf.numBSPLeafSurfaces = std::int32_t(bsp_.leafSurfaces.size()) - leaf.firstBSPLeafSurface;
        }
        leaf.firstBSPLeafBrush = std::int32_t(bsp_.leafBrushes.size());
        for (std::size_t i = 0; i < brushBounds_.size(); i++)
            if (Overlap(brushBounds_[i], region))
                bsp_.leafBrushes.push_back(std::int32_t(i));
        leaf.numBSPLeafBrushes = std::int32_t(bsp_.leafBrushes.size()) - leaf.firstBSPLeafBrush;
        bsp_.leafs.push_back(leaf);
    }

    std::int32_t AddToCluster(const Boundsf &region) {
        if (clusters_.empty() || visibility_.clusterPerLeaf)
            clusters_.emplace_back();
        clusters_.back().Add(region);
        return std::int32_t(clusters_.size()) - 1;
    }

    void AddVisibility() {
        // Two integers, then a row for each cluster: a bit per cluster, rounded up to 64.
        const std::size_t count = clusters_.size(), row = ((count + 63) & ~std::size_t(63)) / 8;
        bsp_.visibility.assign(8 + count * row, 0);
        for (std::size_t byte = 0; byte < 4; byte++) {
            bsp_.visibility[byte] = std::uint8_t(count >> (8 * byte));
            bsp_.visibility[4 + byte] = std::uint8_t(row >> (8 * byte));
        }
        for (std::size_t from = 0; from < count; from++)
            for (std::size_t to = 0; to < count; to++)
                if (from == to || !visibility_.sees || visibility_.sees(clusters_[from], clusters_[to])) {
                    auto &cell = bsp_.visibility[8 + from * row + to / 8];
                    cell = std::uint8_t(cell | (1 << (to % 8)));
                }
    }

    const Boundsf &interior_;
    const SceneVisibility &visibility_;
    Boundsf outer_;
    Bsp bsp_;
    std::vector<SceneShader> shaders_; ///< as in the lump
    std::map<std::pair<std::size_t, float>, std::int32_t> planes_;
    std::vector<Boundsf> brushBounds_, surfaceBounds_, clusters_;
};

} // namespace

Bsp SceneBuilder::Build() const {
    if (walls_.empty())
        throw Error("scene: Build needs SetInterior first");
    BspBuilder builder(interior_, visibility_);
    builder.AddWorld(walls_, boxes_, surfaces_);
    for (const Box &model : models_)
        builder.AddModel(model);
    std::vector<Entity> entities{world_};
    entities.insert(entities.end(), entities_.begin(), entities_.end());
    builder.SetEntities(entities);
    return builder.Take();
}

} // namespace q3
