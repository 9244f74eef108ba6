// GPL-2.0-or-later. A map source in memory: entities with brushes and patches.
#pragma once

#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/map/planes.h"
#include "q3map2/shader/shader_table.h"

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Whether the point is within the coordinate range of maps.
inline bool InWorld(const Vec3f &p) {
    return std::abs(double(p.x)) <= kMaxWorldCoord && std::abs(double(p.y)) <= kMaxWorldCoord &&
           std::abs(double(p.z)) <= kMaxWorldCoord;
}

struct IndexMap;

/// Settings of all surfaces of an entity, from its keys.
struct SurfaceSettings {
    int entity = 0;                          ///< number in the map source
    int castShadows = 1, receiveShadows = 1; ///< numbers of shadow groups; 0: none
    int sampleSize = 0;                      ///< 0: unset
    float lightmapScale = 0;                 ///< 0: unset
    float shadeAngle = 0;                    ///< degrees
    Vec3f ambient;                           ///< byte scale
    const ShaderInfo *celShader = nullptr;
    std::shared_ptr<const IndexMap> indexMap; ///< of terrain; see index_map.h
    bool operator==(const SurfaceSettings &) const = default;
};

/// s = vecs[0] . (p, 1), t = vecs[1] . (p, 1), where p is the point plus Brush::textureOrigin. All texture forms of the
/// map format are converted to this; the division by the image size is included.
struct TextureProjection {
    std::array<std::array<double, 4>, 2> vecs{};
};

/// A side of a brush: its plane, its shader, and how its texture lies.
struct BrushSide {
    int planeNum = -1;                  ///< front is outside
    Plane plane;                        ///< through the points of the map source, in double
    bool hasPlane = false;              ///< false: use the plane of planeNum
    const ShaderInfo *shader = nullptr; ///< null: bevels, and backs of generated brushes
    std::uint32_t surfaceFlags = 0, contentFlags = 0, compileFlags = 0;
    TextureProjection texture;
    Polygon winding;     ///< empty for bevels and sides that other sides cut off
    Polygon visibleHull; ///< convex hull of the winding's parts in open leafs; see ClipSidesIntoTree
    bool bevel = false;
    bool culled = false; ///< makes no draw surface: hidden behind another brush
    int surface = -1;    ///< index of the latest draw surface made from the side
};

/// A convex solid. Sides 0 to 5 are the axial ones in the order -x +x -y +y -z +z once AddBrushBevels has run.
struct Brush {
    SurfaceSettings settings;
    int primitive = 0; ///< number in its entity of the map source, for messages
    std::vector<BrushSide> sides;
    Boundsf bounds;
    const ShaderInfo *contentShader = nullptr;
    std::uint32_t contentFlags = 0, compileFlags = 0; ///< of all sides
    bool detail = false, opaque = false;
    bool generated = false; ///< clip brush of a model
    Vec3f textureOrigin;    ///< center of the origin brush: added to points to get texture coordinates
    int bspBrush = -1;      ///< number in the .bsp, set by BspWriter::EmitBrushes
};

/// A curved surface: a grid of control points, of which every 3 x 3 that share borders are a biquadratic Bezier patch.
struct Patch {
    SurfaceSettings settings;
    int primitive = 0; ///< as in Brush
    const ShaderInfo *shader = nullptr;
    int width = 0, height = 0;   ///< odd, 3 to 31
    std::vector<DrawVert> verts; ///< row * width + column
    float longestCurve = 0;      ///< game units; see FinishPatches
    Boundsf lodBounds;           ///< common bounds of patches that share their level of detail; see FinishPatches
    bool patchMeta = false;
    int patchSubdivisions = 0; ///< curve tolerance from keys, game units; 0: the value of -subdivisions
};

/// An entity with its brushes and patches, relative to its origin brush.
struct MapEntity {
    Entity pairs;
    int number = 0;                  ///< in the map source
    std::string location;            ///< FILE:LINE of its "{"; empty: not from a file
    std::deque<Brush> brushes;       ///< opaque brushes first, newest in front; then translucent brushes, oldest first
    std::deque<Patch> patches;       ///< newest in front
    std::vector<Brush> colorVolumes; ///< brushes whose shader modifies vertex colors inside them
    Vec3f origin;                    ///< value of the key origin plus the center of the origin brush
    Vec3f brushOrigin;               ///< center of the origin brush; primitives were moved by its negative
    int model = -1;                  ///< number in the .bsp; 0: the world; -1: none
    /// Start of messages about the entity: "Entity 3: maps/x.map:120".
    std::string MessagePrefix() const;
};

/// A part of the text of a map source, in bytes.
struct TextRange {
    std::size_t begin = 0, end = 0;
};

/// A map source. Brushes and patches of func_groups are those of the world.
struct Map {
    std::string name; ///< of the file, for messages
    /// By MapEntity::number: from behind its "{" to behind its "}". Empty if the source includes other files.
    std::vector<TextRange> texts;
    std::vector<MapEntity> entities;
    PlaneTable planes{0.00005, 0.005};              ///< with the defaults of -ne and -de
    std::array<int, 3> blockSize{1024, 1024, 1024}; ///< <= 0: no forced splits along that axis
    const ShaderInfo *defaultCelShader = nullptr;
    MapEntity &World() { return entities.front(); }
};

/// By side: the convex parts that are drawn instead of its visible hull. Sides that are not listed are in one part.
using SideParts = std::unordered_map<const BrushSide *, std::vector<Polygon>>;

} // namespace q3
