// GPL-2.0-or-later. The BSPX lumps LIGHTGRID_OCTREE and LIGHTGRIDS as engines load and blend them.
#include "tests/support/grid_readers/octree_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace q3 {

namespace {

constexpr std::uint32_t kIsLeaf = 0x80000000, kIsOccluded = 0x40000000; ///< bits of references
/// Split and eight references of a node; mins and size of a leaf, before its samples.
constexpr std::size_t kNodeBytes = 44, kLeafBytes = 24;
constexpr int kOccludedSample = 255; ///< in place of a sample's number of styles

} // namespace

/// Parses a lump as strictly as engines do: every node and leaf must be used once.
class OctreeParser {
  public:
    OctreeParser(std::span<const std::byte> bytes, bool sixSides) : bytes_(bytes), sixSides_(sixSides) {}

    OctreeReader Parse() {
        if (sixSides_ && Take<std::uint32_t>() != bytes_.size() - 4)
            throw std::runtime_error("length of the subgrid");
        OctreeReader grid;
        grid.step_ = TakeVector();
        grid.size_ = {Take<int>(), Take<int>(), Take<int>()};
        grid.mins_ = TakeVector();
        styles_ = Take<std::uint8_t>();
        if (styles_ < 1 || styles_ > 4)
            throw std::runtime_error("number of styles");
        grid.root_ = Take<std::uint32_t>();
        grid.nodes_.resize(TakeCount(kNodeBytes));
        for (auto &node : grid.nodes_) {
            node.split = {Take<int>(), Take<int>(), Take<int>()};
            for (std::uint32_t &child : node.children)
                child = Take<std::uint32_t>();
        }
        const std::size_t leafs = TakeCount(kLeafBytes);
        if (leafs == 0)
            throw std::runtime_error("no leafs");
        for (std::size_t i = 0; i < leafs; ++i)
            grid.leafs_.push_back(TakeLeaf());
        if (at_ != bytes_.size())
            throw std::runtime_error("bytes left over");
        nodeUses_.resize(grid.nodes_.size());
        leafUses_.resize(leafs);
        Check(grid, grid.root_, {}, grid.size_);
        if (std::ranges::count(leafUses_, 1) != std::ptrdiff_t(leafs) ||
            std::ranges::count(nodeUses_, 1) != std::ptrdiff_t(nodeUses_.size()))
            throw std::runtime_error("a node or leaf is not used once");
        return grid;
    }

  private:
    template <typename T> T Take() {
        if (bytes_.size() - at_ < sizeof(T))
            throw std::runtime_error("too short");
        T value;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    Vec3f TakeVector() {
        const float x = Take<float>(), y = Take<float>(), z = Take<float>();
        return {x, y, z};
    }
    /// A number of records that have at least so many bytes each.
    std::size_t TakeCount(std::size_t bytes) {
        const auto count = Take<std::uint32_t>();
        if (count > (bytes_.size() - at_) / bytes)
            throw std::runtime_error("count");
        return count;
    }

    OctreeReader::Leaf TakeLeaf() {
        OctreeReader::Leaf leaf;
        leaf.mins = {Take<int>(), Take<int>(), Take<int>()};
        leaf.size = {Take<int>(), Take<int>(), Take<int>()};
        if (sixSides_ && Take<std::uint8_t>() > styles_)
            throw std::runtime_error("styles of a leaf");
        const std::size_t count = std::size_t(leaf.size[0]) * std::size_t(leaf.size[1]) * std::size_t(leaf.size[2]);
        for (std::size_t i = 0; i < count; ++i)
            leaf.samples.push_back(TakeSample());
        return leaf;
    }

    std::optional<OctreeReader::Sides> TakeSample() {
        const int count = Take<std::uint8_t>();
        if (count == kOccludedSample)
            return std::nullopt;
        if (count > styles_)
            throw std::runtime_error("styles of a sample");
        OctreeReader::Sides sides{};
        for (int i = 0; i < count; ++i) {
            Take<std::uint8_t>(); // style
            const unsigned present = sixSides_ ? Take<std::uint8_t>() : 0;
            for (unsigned side = 0; side < (sixSides_ ? 6u : 1u); ++side) {
                if (sixSides_ && (present >> side & 1) == 0)
                    continue;
                for (std::size_t channel = 0; channel < 3; ++channel)
                    sides[side][channel] += float(Take<std::uint8_t>());
            }
        }
        if (!sixSides_)
            sides.fill(Vec3f(sides[0]));
        return sides;
    }

    /// Checks what a reference to that part of the grid leads to, and counts its uses.
    void Check(const OctreeReader &grid, std::uint32_t reference, const std::array<int, 3> &mins,
               const std::array<int, 3> &size) {
        if ((reference & kIsOccluded) != 0)
            return;
        if ((reference & kIsLeaf) != 0) {
            const std::uint32_t index = reference & ~kIsLeaf;
            if (index >= grid.leafs_.size() || grid.leafs_[index].mins != mins || grid.leafs_[index].size != size)
                throw std::runtime_error("reference to a leaf");
            ++leafUses_[index];
            return;
        }
        if (reference >= grid.nodes_.size() || ++nodeUses_[reference] > 1)
            throw std::runtime_error("reference to a node");
        const OctreeReader::Node &node = grid.nodes_[reference];
        for (unsigned child = 0; child < 8; ++child) {
            std::array<int, 3> childMins = mins, childSize{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const bool upper = (child & (4u >> axis)) != 0; // bits of a child's number: 4 x, 2 y, 1 z
                childMins[axis] = upper ? node.split[axis] : mins[axis];
                childSize[axis] = upper ? mins[axis] + size[axis] - node.split[axis] : node.split[axis] - mins[axis];
            }
            Check(grid, node.children[child], childMins, childSize);
        }
    }

    std::span<const std::byte> bytes_;
    bool sixSides_;
    std::size_t at_ = 0;
    int styles_ = 0;
    std::vector<int> nodeUses_, leafUses_;
};

std::optional<OctreeReader> OctreeReader::Load(std::span<const std::byte> lump, bool sixSides, std::string &fault) {
    try {
        return OctreeParser(lump, sixSides).Parse();
    } catch (const std::runtime_error &error) {
        fault = error.what();
        return std::nullopt;
    }
}

std::optional<std::array<Vec3f, 6>> OctreeReader::Sample(int x, int y, int z) const {
    const std::array<int, 3> at{x, y, z};
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (at[axis] < 0 || at[axis] >= size_[axis])
            return std::nullopt;
    std::uint32_t reference = root_;
    while ((reference & (kIsLeaf | kIsOccluded)) == 0) {
        const Node &node = nodes_[reference];
        const bool up[3] = {x >= node.split[0], y >= node.split[1], z >= node.split[2]};
        reference = node.children[(up[0] ? 4u : 0u) | (up[1] ? 2u : 0u) | (up[2] ? 1u : 0u)];
    }
    if ((reference & kIsOccluded) != 0)
        return std::nullopt;
    const Leaf &leaf = leafs_[reference & ~kIsLeaf];
    const int index = (x - leaf.mins[0]) + leaf.size[0] * ((y - leaf.mins[1]) + leaf.size[1] * (z - leaf.mins[2]));
    return leaf.samples[std::size_t(index)];
}

std::optional<std::array<Vec3f, 6>> OctreeReader::At(const Vec3f &position) const {
    int low[3];
    float fraction[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float at = (position[axis] - mins_[axis]) / step_[axis];
        low[axis] = int(std::floor(at));
        fraction[axis] = at - std::floor(at);
    }
    std::array<std::optional<Sides>, 8> corners;
    Sides mean{}, sum{};
    int valid = 0;
    for (int i = 0; i < 8; ++i) {
        auto &corner = corners[std::size_t(i)];
        corner = Sample(low[0] + (i & 1), low[1] + (i >> 1 & 1), low[2] + (i >> 2));
        if (!corner)
            continue;
        ++valid;
        for (std::size_t side = 0; side < 6; ++side)
            mean[side] += (*corner)[side];
    }
    if (valid == 0)
        return std::nullopt;
    for (int i = 0; i < 8; ++i) {
        const float weight = ((i & 1) != 0 ? fraction[0] : 1 - fraction[0]) *
                             ((i & 2) != 0 ? fraction[1] : 1 - fraction[1]) *
                             ((i & 4) != 0 ? fraction[2] : 1 - fraction[2]);
        const auto &corner = corners[std::size_t(i)];
        for (std::size_t side = 0; side < 6; ++side)
            sum[side] += (corner ? (*corner)[side] : mean[side] / float(valid)) * weight;
    }
    return sum;
}

Vec3f OctreeReader::CubeLight(const std::array<Vec3f, 6> &sides, const Vec3f &normal) {
    Vec3f sum;
    for (std::size_t axis = 0; axis < 3; ++axis)
        sum += sides[2 * axis + (normal[axis] < 0 ? 1 : 0)] * (normal[axis] * normal[axis]);
    return sum;
}

} // namespace q3
