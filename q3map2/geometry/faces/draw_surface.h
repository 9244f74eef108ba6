// GPL-2.0-or-later. Draw surfaces of the bsp stage: their record, plane, lightmap axis and sample size.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Where a surface comes from and how it is processed. ForcedMeta: triangles that go through the meta step, Meta: what
/// it makes. Bad: not written. Shader: a kind of .srf files that no step makes.
enum class SurfaceKind { Bad, Face, Patch, Triangles, ForcedMeta, Meta, FogHull, Decal, Flare, Foliage, Shader };

/// A side of a brush of an entity.
struct SideNumber {
    int brush = 0, side = 0;
    auto operator<=>(const SideNumber &) const = default;
};

/// One draw surface. Indexes are relative to its first vertex. Faces are polygons until they are triangulated.
struct DrawSurface {
    SurfaceKind kind = SurfaceKind::Bad;
    const ShaderInfo *shader = nullptr;
    SurfaceSettings settings;
    int brush = -1, side = -1;           ///< of the entity; -1: not from a brush
    int patch = -1;                      ///< index in the entity; -1: not from a patch
    std::vector<SideNumber> mergedSides; ///< of a surface that the meta step made: see SidesOf
    int primitive = -1;                  ///< number in its entity of the map source, for messages
    int planeNum = -1;                   ///< in the plane table; -1: none
    bool planar = false;                 ///< all vertices are in one plane
    int fogNum = -1;                     ///< index in Geometry::fogs; -1: none
    Vec3f lightmapAxis;                  ///< zero: none
    int sampleSize = 0;                  ///< edge of a luxel, game units; 0: lit at vertices
    /// As in the .bsp: the normal of a planar surface is the last; patches have the bounds of their level of detail
    /// first, flares their color.
    std::array<Vec3f, 3> lightmapVecs{};
    Vec3f lightmapOrigin;        ///< of a flare: its position
    std::uint8_t lightStyle = 0; ///< of a flare: style of its light
    float longestCurve = 0;      ///< Patch::longestCurve
    Boundsf bounds;
    std::vector<DrawVert> verts;
    std::vector<int> indexes;
    int width = 0, height = 0;  ///< of a patch; foliage: numbers of instances and of model vertices
    bool backSide = false;      ///< written reversed
    int parent = -1;            ///< copies of sky box surfaces: number of the original in the .bsp; -1: no such copy
    bool furred = false;        ///< its fur has been made
    bool isCopy = false;        ///< by a cel, clone or back shader, or a layer of fur
    bool collisionOnly = false; ///< patches drawn as triangles instead: written with the nodraw and pointlight flags
    bool Empty() const { return verts.empty(); }
};

/// Fog volume of the map.
struct MapFog {
    const ShaderInfo *shader = nullptr;
    int entity = -1, brush = -1; ///< indexes in the map; -1: the global fog
    int visibleSide = -1;        ///< -1: chosen by BspWriter::EmitFogs
};

class ModelLibrary;

/// Surfaces and fogs of the map.
struct Geometry {
    std::vector<DrawSurface> surfaces; ///< of all entities, in order of creation
    std::vector<MapFog> fogs;
    int defaultFog = -1;                  ///< index of the global fog; -1: none
    std::shared_ptr<ModelLibrary> models; ///< models read so far; see model_load.h
    std::deque<ShaderInfo> ownShaders;    ///< shaders of terrain layers with properties of the indexed shader
};

/// The signed unit axis nearest to `normal`. Ties go to z, then to x.
Vec3f DominantAxis(const Vec3f &normal);
/// True for a surface without a lightmap: its shader says so, or its kind is Triangles (models that are not
/// ForcedMeta).
bool IsVertexLit(const DrawSurface &surface);

/// The side of a brush that an unmerged surface shows; none for copies, decals and what is not made of brushes.
std::optional<SideNumber> SideOf(const DrawSurface &surface);
/// The same for all surfaces: the sides that a surface shows, ascending, each once.
std::vector<SideNumber> SidesOf(const DrawSurface &surface);

/// Sets bounds, plane, lightmap axis and sample size. A surface other than a face or patch that has more than
/// BspOptions::maxVertexLitVerts vertices becomes ForcedMeta.
void ClassifySurface(DrawSurface &surface, PlaneTable &planes, const BspContext &context);
/// ClassifySurface for all surfaces from `first` on.
void ClassifySurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context);

/// A translucent convex polygon of at least three points; polygons with consecutive numbers have different colors.
DrawSurface DebugSurface(const Polygon &polygon, const Vec3f &normal, const ShaderInfo &shader, std::size_t number);

/// Spatial hash of points. Finds what a linear search in order of addition would find.
class PointTable {
  public:
    /// Points are equal if no coordinate differs by more than `tolerance`, which should be below 1/8.
    explicit PointTable(double tolerance) : tolerance_(tolerance) {}
    /// Index of the first equal point; if there is none, `p` is added.
    int FindOrAdd(const Vec3f &p);
    int Count() const { return int(points_.size()); }

  private:
    struct Cell {
        long long x, y, z;
        bool operator==(const Cell &) const = default;
    };
    struct CellHash {
        std::size_t operator()(const Cell &c) const;
    };
    Cell CellOf(const Vec3f &p, double x, double y, double z) const;
    int FindIn(const Cell &cell, const Vec3f &p) const;

    double tolerance_;
    std::vector<Vec3f> points_;
    std::unordered_map<Cell, std::vector<int>, CellHash> cells_;
};

} // namespace q3
