// GPL-2.0-or-later. Moves brushes and patches relative to the origin of their entity.
#include "q3map2/map/map_origin.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace q3 {

namespace {

void MoveBounds(Boundsf &bounds, const Vec3f &by) {
    bounds.mins += by, bounds.maxs += by;
}

void MoveBrush(Brush &brush, const Vec3f &by, PlaneTable &planes) {
    for (BrushSide &side : brush.sides) {
        side.plane.dist += Dot(side.plane.normal, Vec3d(by));
        const Plane plane = planes[side.planeNum];
        side.planeNum = planes.Find(plane.normal, plane.dist + Dot(plane.normal, Vec3d(by)));
        for (Vec3f &p : side.winding)
            p += by;
    }
    MoveBounds(brush.bounds, by);
}

bool InWorld(const Brush &brush) {
    return InWorld(brush.bounds.mins) && InWorld(brush.bounds.maxs);
}

bool InWorld(const Patch &patch) {
    return std::ranges::all_of(patch.verts, [](const DrawVert &v) { return InWorld(v.xyz); });
}

/// Undoes the translation by the origin brush and applies the key origin.
void MoveBack(MapEntity &group, PlaneTable &planes, const BspContext &context) {
    if (group.origin == Vec3f{})
        return;
    const bool far = !InWorld(group.origin);
    if (far || group.brushOrigin == Vec3f{})
        context.WarnAt("group with an origin", group.number, 0,
                       far ? "the origin of a func_group is outside the world: it has no effect"
                           : "a func_group has the key origin but no origin brush: it is moved by the key");
    MoveEntity(group, far ? group.brushOrigin : group.origin, planes);
    const auto leaves = [&](const auto &primitive) {
        if (!InWorld(primitive))
            context.WarnAt("moved out of the world", group.number, primitive.primitive,
                           "the origin of its func_group moves it out of the world: it is left out");
        return !InWorld(primitive);
    };
    std::erase_if(group.brushes, leaves);
    std::erase_if(group.colorVolumes, leaves);
    std::erase_if(group.patches, leaves);
}

} // namespace

void MoveEntity(MapEntity &entity, const Vec3f &by, PlaneTable &planes) {
    for (Brush &brush : entity.brushes)
        MoveBrush(brush, by, planes);
    for (Brush &brush : entity.colorVolumes)
        MoveBrush(brush, by, planes);
    for (Patch &patch : entity.patches)
        for (DrawVert &v : patch.verts)
            v.xyz += by;
}

void JoinWorld(MapEntity &group, MapEntity &world, PlaneTable &planes, const BspContext &context) {
    MoveBack(group, planes, context);
    for (Brush &brush : group.brushes) {
        brush.mergedGroup = true;
        brush.textureOrigin = {};
        if (brush.opaque)
            world.brushes.push_front(std::move(brush));
        else
            world.brushes.push_back(std::move(brush));
    }
    for (Brush &brush : group.colorVolumes) {
        brush.mergedGroup = true;
        world.colorVolumes.push_back(std::move(brush));
    }
    world.patches.insert(world.patches.begin(), std::make_move_iterator(group.patches.begin()),
                         std::make_move_iterator(group.patches.end()));
}

} // namespace q3
