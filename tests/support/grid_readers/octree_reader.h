// GPL-2.0-or-later. The BSPX lumps LIGHTGRID_OCTREE and LIGHTGRIDS as engines load and blend them.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// An octree of light samples: one color each (LIGHTGRID_OCTREE), or six (LIGHTGRIDS), in the order +x -x +y -y +z -z.
class OctreeReader {
  public:
    /// Nothing if an engine would refuse the lump; `fault` says why.
    static std::optional<OctreeReader> Load(std::span<const std::byte> lump, bool sixSides, std::string &fault);

    /// Blended light, byte scale: occluded corners count as the mean of the others. Nothing outside, or if all corners
    /// are occluded. With one color all six are the same.
    std::optional<std::array<Vec3f, 6>> At(const Vec3f &position) const;
    /// The sample itself. Nothing: occluded or outside.
    std::optional<std::array<Vec3f, 6>> Sample(int x, int y, int z) const;

    const std::array<int, 3> &Size() const { return size_; }
    std::size_t NodeCount() const { return nodes_.size(); }
    std::size_t LeafCount() const { return leafs_.size(); }

    /// Ambient cube: sides weighted by the squares of the normal.
    static Vec3f CubeLight(const std::array<Vec3f, 6> &sides, const Vec3f &normal);

  private:
    friend class OctreeParser;
    using Sides = std::array<Vec3f, 6>;
    struct Node {
        std::array<int, 3> split{};
        std::array<std::uint32_t, 8> children{};
    };
    struct Leaf {
        std::array<int, 3> mins{}, size{};
        std::vector<std::optional<Sides>> samples;
    };

    Vec3f step_, mins_;
    std::array<int, 3> size_{};
    std::uint32_t root_ = 0;
    std::vector<Node> nodes_;
    std::vector<Leaf> leafs_;
};

} // namespace q3
