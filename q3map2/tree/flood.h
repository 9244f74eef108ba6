// GPL-2.0-or-later. Flood fill from entities: leaks, leafs outside, numbers of clusters and areas.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Result of FloodEntities.
enum class Sealing {
    Sealed, ///< or it leaks and the world has the key _ignoreleaks
    Leaked, ///< the flood from an entity reaches the outside
    Empty   ///< no entity stands in the open
};

/// Whether FloodEntities warns of entities in solid and of lights in detail brushes; once per map is enough.
enum class SolidWarnings { Omit, Print };
/// Floods from all point entities in open leafs.
Sealing FloodEntities(Tree &tree, const Map &map, const BspContext &context,
                      SolidWarnings warnings = SolidWarnings::Print);
/// The connected regions of open leafs of a tree, and which of them are flooded: tells whether the same leafs become
/// opaque if entities stand elsewhere.
struct FloodRegions {
    struct Node {
        Plane plane;
        std::array<std::int32_t, 2> children{-1, -1}; ///< front, back; -1: a leaf
        std::int32_t region = -1;                     ///< of a leaf; -1: opaque
        std::int32_t unused = 0;                      ///< so that no byte is undefined
    };
    std::vector<Node> nodes;           ///< 0 is the head
    std::vector<std::uint8_t> flooded; ///< by region
    /// The region at a point; -1: opaque.
    int RegionAt(const Vec3f &p) const;
};
/// Call it after FloodEntities and before FillOutside.
FloodRegions FloodRegionsOf(const Tree &tree, const PlaneTable &planes);
/// Whether the entities of the map flood the regions that are flooded, and no other.
bool FloodsSameRegions(const FloodRegions &regions, const Map &map);
/// The warnings that FloodEntities prints, of these kinds. regions: of the first tree.
void WarnOfEntitiesInSolid(const FloodRegions &regions, const Map &map, const BspContext &context);
inline constexpr std::string_view kEntityInSolid = "entity in solid", kLightInDetail = "light in detail brush";

/// Makes all leafs opaque that no flood reached.
void FillOutside(Tree &tree, const BspContext &context);
/// The shortest line from outside to an entity: centers of portals, then the entity's origin. Empty: sealed.
std::vector<Vec3f> LeakLine(const Tree &tree, const Map &map);
/// The entity at the end of the leak line (index in the map); -1: sealed.
int LeakedEntity(const Tree &tree);
/// The leak line as text of a .lin file: one point per text line.
std::string LeakFileText(const std::vector<Vec3f> &line);

/// Numbers the clusters and returns their count. `deep`: leafs below a detail split share a cluster. Throws Error for
/// more clusters than a .bsp may have.
int NumberClusters(Tree &tree, bool deep);
/// Numbers the areas, the regions between area portals, and returns their count.
int FloodAreas(Tree &tree);
/// The area portals of the world that have the same area on both sides or lie in a solid, as indexes of its brushes.
/// Call it after FloodAreas.
std::vector<int> IdleAreaPortals(const Tree &tree, const MapEntity &world);

} // namespace q3
