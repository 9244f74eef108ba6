// GPL-2.0-or-later. Worlds of boxes, and what the tree makes of them.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/flood.h"

#include <deque>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

/// Both trees of a world and what was counted on the way.
struct Compiled {
    Tree first, second;
    std::vector<TreeFace> firstFaces, secondFaces;
    SideParts parts;
    Sealing sealing = Sealing::Empty;
    int clusters = 0, areas = 0, visiblePortals = 0, solidFaces = 0;
    std::string portalFile;
};

/// A world under construction: entity 0, boxes and point entities.
class World {
  public:
    World();
    /// A convex solid; `flags` for all its sides, added to those of a solid. Its number as a primitive.
    int AddBrush(const std::vector<Plane> &planes, std::uint32_t flags = 0);
    int AddBox(const Vec3d &mins, const Vec3d &maxs, std::uint32_t flags = 0);
    int IndexOf(int primitive); ///< in the world's list
    /// Six walls around a box, none overlapping another.
    void AddRoom(const Vec3d &mins, const Vec3d &maxs, double thickness = 16);
    void AddEntity(std::string_view className, const Vec3f &origin);
    void SetKey(std::string_view key, std::string_view value) { map.World().pairs.Set(key, value); }
    Compiled Compile();
    BspContext Context() { return {options, *FindGame("quake3"), shaders_, log}; }
    std::deque<Brush> &Brushes() { return map.World().brushes; }

    Map map;
    BspOptions options;
    std::string text; ///< printed so far
    Log log;

  private:
    const ShaderInfo &Shader(std::uint32_t flags);

    VirtualFileSystem files_;
    ShaderLibrary shaders_;
    std::deque<ShaderInfo> own_;
};

std::vector<Plane> BoxPlanes(const Vec3d &mins, const Vec3d &maxs);
/// Leafs of the tree without the one around it, front first.
std::vector<int> Leafs(const Tree &tree);
/// Volume of a leaf or box-shaped node, as far as its portals reach: sum over its portals.
double VolumeOf(const Tree &tree, int leaf);
int CountLeafs(const Tree &tree, bool (*wanted)(const TreeNode &));

} // namespace q3::test
