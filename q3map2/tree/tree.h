// GPL-2.0-or-later. The BSP tree of the bsp stage: faces, choice of planes, recursion.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"
#include "q3map2/map/planes.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// Points up to this far from a plane count as on it. Game units.
inline constexpr double kSideEpsilon = 0.1;

/// A polygon that may split the tree.
struct TreeFace {
    Polygon polygon;
    int planeNum = 0; ///< even
    int priority = 0; ///< faces with higher priority split earlier
    std::uint32_t compileFlags = 0;
};

/// A polygon between two leafs.
struct TreePortal {
    Polygon polygon;
    Plane plane; ///< front is nodes[0]
    int planeNum = -1;
    int onNode = -1;                  ///< the node whose plane holds the portal; -1: a border of the world
    std::array<int, 2> nodes{-1, -1}; ///< front, back
    std::uint32_t compileFlags = 0;
};

/// A node, or a leaf when planeNum is -1.
struct TreeNode {
    int planeNum = -1;
    std::array<int, 2> children{-1, -1}; ///< front, back
    int parent = -1;
    std::uint32_t compileFlags = 0; ///< of the face that chose the plane
    bool structural = false;        ///< split by a structural face, here or below
    Boundsf bounds;                 ///< of its portals, once there are portals
    std::vector<int> portals;       ///< numbers of TreePortal

    // Leafs.
    bool opaque = false, skyBox = false;
    int cluster = -1, area = -1;
    int floodSteps = 0;       ///< number of leafs on the shortest path to an entity, this leaf included; 0: not reached
    int floodEntity = -1;     ///< an entity in this leaf where a flood started (index in the map)
    std::vector<int> brushes; ///< indexes in the entity's brush list, newest first
    std::vector<int> surfaces; ///< draw surfaces (index in the .bsp), in order of addition
    bool IsLeaf() const { return planeNum < 0; }
};

/// Nodes by number; node 0 is the head, `outside` the leaf around everything.
struct Tree {
    std::vector<TreeNode> nodes;
    std::vector<TreePortal> portals; ///< removed portals have no polygon
    int head = 0, outside = -1;
    Boundsf bounds;
    std::int64_t sideTests = 0; ///< plane-face tests made to choose split planes
    /// Number of the leaf that holds the point; points on a plane are in front of it.
    int LeafAt(const Vec3f &p, const PlaneTable &planes) const;
};

/// Builds a tree split by the faces. `blockSize`: distance of forced splits, game units; see Map::blockSize.
Tree BuildTree(std::vector<TreeFace> faces, const std::array<int, 3> &blockSize, PlaneTable &planes,
               const BspContext &context);
/// A tree of one leaf, for brush entities.
Tree SingleLeafTree(const Boundsf &bounds);

/// Whether a structural brush becomes detail, since it has fewer than four sides with an area.
bool HasFewSides(const Brush &brush);
/// Whole sides of structural brushes (and of detail brushes with -deep), for the first tree. Structural brushes that
/// HasFewSides become detail.
std::vector<TreeFace> StructuralFaces(MapEntity &world, const BspContext &context);
/// Visible hulls of the same sides, for the second tree.
std::vector<TreeFace> VisibleFaces(const MapEntity &world, const BspContext &context);

} // namespace q3
