// GPL-2.0-or-later. The BSPX lumps LIGHTGRID_OCTREE and LIGHTGRIDS: points in boxes, boxes in solids left out.
#include "q3map2/gridformats/grid_octree.h"

#include "common/error.h"
#include "q3map2/gridformats/grid_source.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

namespace q3 {

// ---- The octree of LIGHTGRID_OCTREE and LIGHTGRIDS ----

namespace {

/// References to boxes are numbers of nodes; with the first bit, numbers of leafs; the second alone is any box whose
/// points are all occluded.
constexpr std::uint32_t kLeafReference = 1u << 31, kOccludedReference = 1u << 30;
constexpr int kMinSplitPoints = 4; ///< boxes with fewer on an axis are not split
constexpr int kMaxSplits = 5;
constexpr std::int64_t kMinSplitOccluded = 8; ///< boxes with fewer occluded points are not split
constexpr std::uint8_t kStyleCount = 1;       ///< of a point

template <typename T> void Append(const T &value, std::vector<std::byte> &bytes) {
    const auto *from = reinterpret_cast<const std::byte *>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}

/// Points from mins to before mins + size, in lattice steps.
struct Box {
    Int3 mins{}, size{};
};

/// Part of a box that is below (0) or above (1) its middle on each axis; bits 2, 1, 0 of `child` are x, y, z.
Box ChildOf(const Box &box, unsigned child) {
    Box part;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t below = box.size[axis] / 2;
        const bool upper = (child >> (2 - axis) & 1) != 0;
        part.mins[axis] = box.mins[axis] + (upper ? below : 0);
        part.size[axis] = upper ? box.size[axis] - below : below;
    }
    return part;
}

class OctreeWriter {
  public:
    explicit OctreeWriter(const OctreePoints &points) : points_(points) {}

    std::vector<std::byte> Run() {
        const std::uint32_t root = AddBox({{}, points_.layout.bounds}, 0);
        if (root == kOccludedReference)
            throw Error("light grid octree: no point of the grid has light");
        std::vector<std::byte> bytes;
        Append(points_.layout.size, bytes);
        Append(points_.layout.bounds, bytes);
        Append(points_.layout.mins, bytes);
        Append(kStyleCount, bytes);
        Append(root, bytes);
        Append(nodeCount_, bytes);
        bytes.insert(bytes.end(), nodes_.begin(), nodes_.end());
        Append(leafCount_, bytes);
        bytes.insert(bytes.end(), leafs_.begin(), leafs_.end());
        return bytes;
    }

  private:
    template <typename F> void EachPointOf(const Box &box, const F &f) const {
        for (std::int32_t z = 0; z < box.size[2]; ++z)
            for (std::int32_t y = 0; y < box.size[1]; ++y)
                for (std::int32_t x = 0; x < box.size[0]; ++x)
                    f(std::size_t(points_.layout.Index(box.mins[0] + x, box.mins[1] + y, box.mins[2] + z)));
    }

    /// Adds a box, its parts first. Returns the reference to it.
    std::uint32_t AddBox(const Box &box, int splits) {
        std::int64_t occluded = 0;
        EachPointOf(box, [&](std::size_t point) { occluded += points_.occluded[point]; });
        const std::int64_t count = std::int64_t(box.size[0]) * box.size[1] * box.size[2];
        if (occluded == count)
            return kOccludedReference;
        const bool isThin =
            box.size[0] < kMinSplitPoints || box.size[1] < kMinSplitPoints || box.size[2] < kMinSplitPoints;
        if (isThin || splits == kMaxSplits || occluded < kMinSplitOccluded)
            return AddLeaf(box);
        std::array<std::uint32_t, 8> children{};
        for (unsigned child = 0; child < 8; ++child)
            children[child] = AddBox(ChildOf(box, child), splits + 1);
        Append(ChildOf(box, 7).mins, nodes_); // the middle: where the upper parts begin
        Append(children, nodes_);
        return nodeCount_++;
    }

    std::uint32_t AddLeaf(const Box &box) {
        Append(box.mins, leafs_);
        Append(box.size, leafs_);
        if (points_.leafHasStyles)
            Append(kStyleCount, leafs_);
        EachPointOf(box, [&](std::size_t point) {
            if (points_.occluded[point])
                leafs_.push_back(kOccludedPoint);
            else
                points_.append(point, leafs_);
        });
        return kLeafReference | leafCount_++;
    }

    const OctreePoints &points_;
    std::vector<std::byte> nodes_, leafs_;
    std::uint32_t nodeCount_ = 0, leafCount_ = 0;
};

} // namespace

std::vector<std::byte> EncodeGridOctree(const OctreePoints &points) {
    return OctreeWriter(points).Run();
}

// ---- The BSPX lump LIGHTGRID_OCTREE: light without direction ----

std::vector<std::byte> EncodeOctreeLump(const GridSource &source, const GridTone &tone) {
    OctreePoints points{.layout = source.Layout(), .occluded = source.Voids(), .append = {}};
    points.append = [&](std::size_t point, std::vector<std::byte> &bytes) {
        bytes.push_back(std::byte(kStyleCount));
        bytes.push_back(kGridStyle);
        for (const std::uint8_t value : tone.Bytes(MeanLight(source.Point(point))))
            bytes.push_back(std::byte(value));
    };
    return EncodeGridOctree(points);
}

// ---- The BSPX lump LIGHTGRIDS: light on six sides ----

namespace {

/// Appends the count of styles, the style, a bit for each side that is not black, and those sides.
void AppendSides(const bspGridPointSH_t &light, const GridTone &tone, std::vector<std::byte> &bytes) {
    bytes.push_back(std::byte(kStyleCount));
    bytes.push_back(kGridStyle);
    const std::size_t flags = bytes.size();
    bytes.push_back(std::byte(0));
    for (unsigned side = 0; side < 6; ++side) {
        Vec3d normal;
        normal[side / 2] = side % 2 == 0 ? 1 : -1;
        const auto color = tone.Bytes(LightOn(light, normal));
        if (color == std::array<std::uint8_t, 3>{})
            continue;
        bytes[flags] |= std::byte(1u << side);
        for (const std::uint8_t value : color)
            bytes.push_back(std::byte(value));
    }
}

} // namespace

std::vector<std::byte> EncodeGridsLump(const GridSource &source, const GridTone &tone) {
    OctreePoints points{.layout = source.Layout(), .occluded = source.Voids(), .append = {}, .leafHasStyles = true};
    points.append = [&](std::size_t point, std::vector<std::byte> &bytes) {
        AppendSides(source.Point(point), tone, bytes);
    };
    const std::vector<std::byte> grid = EncodeGridOctree(points);
    if (grid.size() > std::numeric_limits<std::uint32_t>::max())
        throw Error("{}: the grid has {} bytes, expected less than 2^32", kBspxGrids, grid.size());
    const auto length = std::uint32_t(grid.size());
    std::vector<std::byte> lump(sizeof length + grid.size());
    std::memcpy(lump.data(), &length, sizeof length);
    std::memcpy(lump.data() + sizeof length, grid.data(), grid.size());
    return lump;
}

} // namespace q3
