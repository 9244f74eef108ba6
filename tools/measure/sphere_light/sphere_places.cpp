// GPL-2.0-or-later. Places of a map where the camera sees the whole sphere.
#include "tools/measure/sphere_light/sphere_places.h"

#include "common/error.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/gridformats/legacy_encode.h"

#include <random>

namespace q3 {

namespace {

constexpr float kClear = 20;       ///< half the width of the box from the eye to the sphere, game units
constexpr float kEntityClear = 64; ///< from things that games draw at entities, game units
constexpr float kFloorReach = 96;  ///< from the box down to a floor, game units
constexpr int kTriesPerPlace = 100000;
/// Contents lava, slime, water and fog, which tint what is seen through them.
constexpr std::uint32_t kTintingContents = 8 | 16 | 32 | 64;

/// Boxes around everything that may hide the sphere: triangles, parts of patches, tinting brushes, entities.
class Obstacles {
  public:
    explicit Obstacles(const Bsp &bsp) {
        for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
            AddSurface(bsp, surface);
        for (std::size_t i = 1; i < bsp.models.size(); ++i)
            boxes_.push_back({Vec3f(bsp.models[i].mins), Vec3f(bsp.models[i].maxs)});
        for (const bspBrush_t &brush : bsp.brushes)
            AddBrush(bsp, brush);
        const Vec3f half{kEntityClear, kEntityClear, kEntityClear};
        for (const Entity &entity : StoredEntities(bsp.entities, "entities"))
            if (const auto origin = entity.Vector({"origin"}); origin && entity.ClassName() != "light")
                boxes_.push_back({*origin - half, *origin + half});
    }

    bool Touch(const Boundsf &box) const {
        for (const Boundsf &obstacle : boxes_)
            if (obstacle.Touches(box))
                return true;
        return false;
    }

  private:
    void AddSurface(const Bsp &bsp, const bspDrawSurface_t &surface) {
        const auto vertex = [&](int i) { return Vec3f(bsp.drawVerts[std::size_t(surface.firstVert + i)].xyz); };
        if (surface.surfaceType == MST_PATCH) {
            for (int y = 0; y + 2 < surface.patchHeight; y += 2)
                for (int x = 0; x + 2 < surface.patchWidth; x += 2) {
                    Boundsf &box = boxes_.emplace_back();
                    for (int i = 0; i < 9; ++i)
                        box.Add(vertex((y + i / 3) * surface.patchWidth + x + i % 3));
                }
            return;
        }
        for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
            Boundsf &box = boxes_.emplace_back();
            for (int corner = 0; corner < 3; ++corner)
                box.Add(vertex(bsp.drawIndexes[std::size_t(surface.firstIndex + i + corner)]));
        }
    }

    /// The first six sides of a brush are those of its box.
    void AddBrush(const Bsp &bsp, const bspBrush_t &brush) {
        if ((bsp.shaders[std::size_t(brush.shaderNum)].contentFlags & kTintingContents) == 0 || brush.numSides < 6)
            return;
        const auto dist = [&](int side) {
            const auto plane = bsp.brushSides[std::size_t(brush.firstSide + side)].planeNum;
            return bsp.planes[std::size_t(plane)].dist;
        };
        boxes_.push_back({{-dist(0), -dist(2), -dist(4)}, {dist(1), dist(3), dist(5)}});
    }

    std::vector<Boundsf> boxes_;
};

} // namespace

std::vector<SpherePlace> FindSpherePlaces(const Bsp &bsp, int count, const std::function<bool(const Vec3f &)> &isLit) {
    const BspSpace space(bsp, SolidBrushes(bsp));
    const Obstacles obstacles(bsp);
    const Vec3f mins(bsp.models.front().mins), size = Vec3f(bsp.models.front().maxs) - mins;
    const Vec3f clear{kClear, kClear, kClear};
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<SpherePlace> places;
    for (std::int64_t tries = 0; int(places.size()) < count; ++tries) {
        if (tries > std::int64_t(count) * kTriesPerPlace)
            throw Error("found only {} of {} places with a free view of a sphere", places.size(), count);
        const float x = unit(random), y = unit(random), z = unit(random);
        const Vec3f p = mins + size * Vec3f{x, y, z};
        const SpherePlace place{{std::round(p.x), std::round(p.y), std::round(p.z)}, 90.0f * float(random() % 4)};
        Boundsf view;
        view.Add(place.center);
        view.Add(place.Eye());
        view = {view.mins - clear, view.maxs + clear};
        const Vec3f below = place.center - Vec3f{0, 0, kClear + kFloorReach};
        if (space.ClusterAt(place.center, 0) >= 0 && space.AnySolid(below, place.center) &&
            !space.AnySolid(view.mins, view.maxs) && !obstacles.Touch(view) && isLit(place.center))
            places.push_back(place);
    }
    return places;
}

} // namespace q3
