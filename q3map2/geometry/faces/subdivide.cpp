// GPL-2.0-or-later. Faces cut by a world-aligned grid (tessSize).
#include "q3map2/geometry/faces/subdivide.h"

#include "q3map2/geometry/faces/brush_faces.h"

#include <cmath>
#include <optional>
#include <utility>

namespace q3 {
namespace {

constexpr double kOnEpsilon = 0.1;

/// The lowest grid plane that cuts the polygon, with more than kOnEpsilon of it on both sides.
std::optional<Plane> GridPlane(const Polygon &w, double size) {
    const Boundsf bounds = WindingBounds(w);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double lo = std::floor((double(bounds.mins[axis]) + kOnEpsilon) / size) * size;
        const double hi = std::ceil((double(bounds.maxs[axis]) - kOnEpsilon) / size) * size;
        if (hi - lo > size) {
            Plane plane;
            plane.normal[axis] = 1;
            plane.dist = lo + size;
            return plane;
        }
    }
    return {};
}

/// Pieces of w, none larger than a cell of the grid.
std::vector<Polygon> GridPieces(Polygon w, double size, const DrawSurface &surface, const BspContext &context) {
    const int limit = context.options.maxDrawSurfaces;
    std::vector<Polygon> pieces, open{std::move(w)};
    while (!open.empty()) {
        const Polygon piece = std::move(open.back());
        open.pop_back();
        const std::optional<Plane> plane = GridPlane(piece, size);
        if (!plane) {
            pieces.push_back(piece);
            if (int(pieces.size()) > limit)
                context.FailAt(surface.settings.entity, surface.primitive,
                               fmt::format("shader {}: tessSize {} cuts a face into more than {} pieces, expected a "
                                           "larger size or -maxmapdrawsurfs",
                                           surface.shader->name, int(size), limit));
            continue;
        }
        Polygon front, back;
        ClipPolygonKeepOn(piece, *plane, kOnEpsilon, front, back);
        if (back.size() >= 3)
            open.push_back(std::move(back));
        if (front.size() >= 3)
            open.push_back(std::move(front));
    }
    return pieces;
}

bool IsSubdivided(const DrawSurface &surface) {
    return surface.kind == SurfaceKind::Face && !surface.Empty() && surface.brush >= 0 &&
           surface.shader->geometry.tessSize >= 1 && (surface.shader->compileFlags & C_SKY) == 0;
}

} // namespace

void SubdivideFaces(MapEntity &entity, Geometry &geometry, std::size_t first, const PlaneTable &planes,
                    const BspContext &context) {
    if (context.options.noSubdivide)
        return;
    const std::size_t last = geometry.surfaces.size();
    for (std::size_t i = first; i < last; ++i) {
        if (!IsSubdivided(geometry.surfaces[i]))
            continue;
        const DrawSurface surface = geometry.surfaces[i];
        Polygon w;
        for (const DrawVert &v : surface.verts)
            w.push_back(v.xyz);
        const std::vector<Polygon> pieces = GridPieces(w, double(surface.shader->geometry.tessSize), surface, context);
        if (pieces.size() < 2)
            continue;
        geometry.surfaces[i].verts.clear();
        for (const Polygon &piece : pieces) {
            const int number = MakeFaceSurface(entity, surface.brush, surface.side, piece, geometry, planes, context);
            geometry.surfaces[std::size_t(number)].fogNum = surface.fogNum;
            entity.brushes[std::size_t(surface.brush)].sides[std::size_t(surface.side)].surface = number;
        }
    }
}

} // namespace q3
