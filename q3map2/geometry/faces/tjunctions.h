// GPL-2.0-or-later. T-junction repair: inserts vertices of other surfaces into the edges of faces.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"

#include <array>
#include <cstddef>
#include <vector>

namespace q3 {

/// A line with the vertices on it.
struct EdgeLine {
    struct Point {
        double along; ///< distance from the origin
        Vec3f xyz;
    };
    Vec3d origin, direction;
    std::array<Plane, 2> planes; ///< perpendicular planes that intersect in the line
    std::vector<Point> points;   ///< in order along the line
};

/// Edge lines, looked up in a grid of cells. An edge joins the first line, in order of addition, near both of its ends.
class EdgeLines {
  public:
    /// `bounds` must contain all points. `edges`: estimated number of edges.
    EdgeLines(const Boundsf &bounds, std::size_t edges);
    /// Adds the ends of the edge to an existing or new line and returns its index. `direction` is a unit vector.
    int Add(const Vec3f &a, const Vec3f &b, const Vec3d &direction);
    const EdgeLine &operator[](int line) const { return lines_[std::size_t(line)]; }
    int Count() const { return int(lines_.size()); }

  private:
    int Find(const Vec3d &a, const Vec3d &b) const;
    std::array<int, 3> CellOf(const Vec3d &p) const;
    void EnterCells(int line);

    Boundsd bounds_;
    double cellSize_ = 1;
    std::array<int, 3> size_{};
    std::vector<std::vector<int>> cells_; ///< by cell: lines through it, in order of addition
    std::vector<EdgeLine> lines_;
};

/// Inserts into each face (from `first` on) the vertices of other faces and patches that lie on its edges, so that no
/// cracks show between them.
void FixTJunctions(Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
