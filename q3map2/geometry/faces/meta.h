// GPL-2.0-or-later. The meta step: triangles of faces with smoothed normals, merged into draw surfaces.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"

#include <array>
#include <cstddef>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Triangles with equal keys may be merged.
struct MetaKey {
    int shaderOrder = 0; ///< order of first appearance
    int fogNum = -1, entity = 0, castShadows = 0, receiveShadows = 0, sampleSize = 0;
    Vec3f ambient;
    bool backSide = false;
    bool operator==(const MetaKey &) const = default;
};

/// Vertex of the mesh. Vertices at the same position form a group.
struct MetaVert {
    DrawVert vert;
    int group = 0;
    std::vector<int> triangles; ///< in order of addition
};

/// Triangle of the mesh.
struct MetaTriangle {
    std::array<int, 3> verts{}; ///< indexes in Verts(), clockwise seen from the front
    int key = 0;                ///< index in Keys()
    int surface = 0;            ///< index in Geometry::surfaces of its source
    int planeNum = -1;          ///< of a planar source; -1: not in the plane table
    Plane plane;
    Vec3f lightmapAxis; ///< zero: lit at its vertices
};

/// The triangles of an entity's faces and ForcedMeta surfaces, with shared vertices, before they are merged.
class MetaMesh {
  public:
    /// Adds the triangles of a surface; `number`: its index in Geometry::surfaces. `planes`: what planeNum refers to.
    void Add(const DrawSurface &surface, int number, const PlaneTable &planes, const BspContext &context);

    const std::vector<MetaTriangle> &Triangles() const { return triangles_; }
    const std::vector<MetaVert> &Verts() const { return verts_; }
    const std::vector<MetaKey> &Keys() const { return keys_; }
    /// Numbers of the vertices of a group, in order of addition.
    const std::vector<int> &Group(int group) const { return groups_[std::size_t(group)]; }
    int GroupCount() const { return int(groups_.size()); }
    /// Replaces the corner normals and finds the shared vertices again.
    void ReplaceNormals(const std::vector<std::array<Vec3f, 3>> &normals);

  private:
    int KeyOf(const DrawSurface &surface);
    int VertOf(const DrawVert &vert);
    bool HasTriangle(const MetaTriangle &triangle) const;
    /// The triangle with the numbers of these vertices, which are added if they are new.
    MetaTriangle WithVerts(MetaTriangle triangle, const std::array<DrawVert, 3> &corners);
    void Append(const MetaTriangle &triangle);

    PointTable positions_{0.001}; ///< tolerance in game units
    std::vector<std::vector<int>> groups_;
    std::vector<MetaVert> verts_;
    std::vector<MetaTriangle> triangles_;
    std::vector<MetaKey> keys_;
    std::unordered_map<const ShaderInfo *, int> shaderOrder_;
};

/// Tolerance of SameVector, per component.
inline constexpr double kSameVectorEpsilon = 0.001;
/// Whether no component differs by more than kSameVectorEpsilon.
bool SameVector(const Vec3f &a, const Vec3f &b);

/// Triangulates the faces (from `first` on) that take part in the meta step and replaces them and the ForcedMeta
/// surfaces by merged triangle surfaces.
void MakeMetaSurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context);

/// Gives the corners of triangles that meet at a point a common normal, where their normals differ by less than the
/// shade angle of both.
void SmoothNormals(MetaMesh &mesh, const Geometry &geometry, const BspContext &context);

/// Appends surfaces grown from triangles that agree in their MetaKey and share vertices.
void MergeTriangles(const MetaMesh &mesh, Geometry &geometry, PlaneTable &planes, const BspContext &context);

} // namespace q3
