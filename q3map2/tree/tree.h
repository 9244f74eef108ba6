// GPL-2.0-or-later. The BSP tree of the world: splits, portals, what is inside.
#pragma once

#include "q3map2/map/map.h"

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

namespace q3 {

/// A polygon that may split the tree.
struct TreeFace {
    Polygon polygon;
    int planeNum = 0; ///< even
    int priority = 0;
    std::uint32_t compileFlags = 0;
};

struct TreePortal {
    Polygon polygon;
    Plane plane; ///< front is nodes[0]
    int planeNum = -1;
    int onNode = -1;                  ///< the node that made it; -1: a border of the world
    std::array<int, 2> nodes{-1, -1}; ///< front, back
    std::uint32_t compileFlags = 0;
};

/// A node, or a leaf when planeNum is -1.
struct TreeNode {
    int planeNum = -1;
    std::array<int, 2> children{-1, -1}; ///< front, back
    int parent = -1;
    std::uint32_t compileFlags = 0; ///< of the face that chose the plane
    bool structural = false;        ///< a split that is not detail's, here or below
    Boundsf bounds;                 ///< of its portals, once there are portals
    std::vector<int> portals;       ///< numbers of TreePortal

    // Leafs.
    bool opaque = false, areaPortal = false, skyBox = false;
    int cluster = -1, area = -1;
    int occupied = 0;          ///< steps from an entity; 0: not reached
    int occupant = -1;         ///< entity (index in the map) the flood came from
    std::vector<int> brushes;  ///< indexes in the entity's brush list; last pushed first
    std::vector<int> surfaces; ///< of the .bsp, in order of addition
    bool IsLeaf() const { return planeNum < 0; }
};

/// Nodes by number; node 0 is the head, `outside` the leaf around everything.
struct Tree {
    std::vector<TreeNode> nodes;
    std::vector<TreePortal> portals; ///< removed ones have no polygon
    int head = 0, outside = -1;
    Boundsf bounds;
    std::int64_t sideTests = 0; ///< how often a face was held against a plane to choose splits
    int LeafAt(const Vec3f &p, const PlaneTable &planes) const;
};

enum class Sealing { Sealed, Leaked, Empty };

/// Faces of the structural brushes' windings, for the first tree. Brushes of fewer than four sides become detail.
std::vector<TreeFace> StructuralFaces(MapEntity &world, const BspContext &context);
/// Faces of the visible hulls, for the second.
std::vector<TreeFace> VisibleFaces(const MapEntity &world, const BspContext &context);
/// tree.cpp. The tree of these faces.
Tree BuildTree(std::vector<TreeFace> faces, const std::array<int, 3> &blockSize, PlaneTable &planes,
               const BspContext &context);
/// A tree of one leaf, for the other models.
Tree SingleLeafTree(const Boundsf &bounds);
/// portals.cpp. Portals between leafs, bounds of nodes.
void MakePortals(Tree &tree, const PlaneTable &planes, const BspContext &context);
bool IsPassable(const Tree &tree, const TreePortal &portal);
/// brush_filter.cpp. Puts the brushes (structural ones, or detail ones) into the leafs that they reach; opaque
/// structural ones make their leafs opaque, area portals mark portals.
void FilterStructuralBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context);
void FilterDetailBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context);
/// flood.cpp. Floods from all entities that stand in the open; `warn` of those in solid (once is enough a map).
Sealing FloodEntities(Tree &tree, const Map &map, const BspContext &context, bool warn = true);
/// Makes opaque what no entity reaches.
void FillOutside(Tree &tree, const BspContext &context);
/// The line from outside to the entity that reached it: centres of portals, then its origin. Empty: sealed.
std::vector<Vec3f> LeakLine(const Tree &tree, const Map &map);
/// The entity at the end of that line (index in the map); -1: sealed.
int LeakedEntity(const Tree &tree);
void WriteLeakFile(const std::filesystem::path &path, const std::vector<Vec3f> &line);
/// hidden_sides.cpp. Marks sides that others cover.
void CullSides(MapEntity &entity, const PlaneTable &planes, const BspContext &context);
/// Sets the visible hull of each side from its parts in leafs that are not opaque.
void ClipSidesIntoTree(MapEntity &entity, const Tree &tree, const PlaneTable &planes, const BspContext &context);
/// areas.cpp. Cluster and area numbers; how many there are. Error: more clusters than a .bsp may have.
int NumberClusters(Tree &tree, bool deep);
int FloodAreas(Tree &tree);
/// prtfile.cpp. The text of the portal file.
std::string PortalFileText(const Tree &tree, const PlaneTable &planes, int clusters);

} // namespace q3
