// GPL-2.0-or-later. Draw surfaces before they are written: leafs that they reach, last changes to vertices, order of
// triangles.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Adds `number`, the index of the surface in the .bsp, to TreeNode::surfaces of each open leaf that the surface
/// reaches. False: it reaches none. `inSkyBox` becomes true if one of the leafs belongs to the sky box.
bool FilterSurface(const DrawSurface &surface, int number, Tree &tree, const PlaneTable &planes, bool &inSkyBox);

/// Applies tcMod, tcGen, rgbMod and alphaMod directives of the shader, and color volumes.
void ModifySurface(DrawSurface &surface, const MapEntity &entity, const MapEntity &world, const PlaneTable &planes);
/// Subtracts the same whole numbers from s and from t of all vertices, to bring them near 0.
void BiasTexture(DrawSurface &surface);
/// Gives each triangle vertices of its own and moves them one game unit toward its center (-debuginset).
void InsetTriangles(DrawSurface &surface);
/// Reverses orientation: normals and winding order.
void ReverseSurface(DrawSurface &surface);
/// Puts the vertices of an autosprite2 quad into the order by which engines find its long axis. Warns if the surface is
/// not an oblong quad.
void OrderSpriteQuad(DrawSurface &surface, const BspContext &context);

/// Number of indexes of a triangle.
inline constexpr std::size_t kIndexesPerTriangle = 3;

/// Reorders triangles so that vertices are reused while they are in the vertex cache.
std::vector<int> OrderTriangles(const std::vector<int> &indexes);

/// Hash table of the runs of indexes in a list.
class IndexRuns {
  public:
    /// Offset of the first occurrence of the run in `list`; if there is none, the run is appended. The end of the list
    /// for fewer than three indexes.
    int FindOrAppend(std::vector<std::int32_t> &list, std::span<const int> run);

  private:
    void HashNewEntries(const std::vector<std::int32_t> &list);

    /// Offsets in the list, in ascending order, by the hash of the three indexes there (a triangle), or of the six (a
    /// pair of triangles).
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> triangles_, pairs_;
    std::size_t hashedTriangles_ = 0, hashedPairs_ = 0; ///< number of offsets that are in the maps
};

} // namespace q3
