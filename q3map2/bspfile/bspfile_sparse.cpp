// GPL-2.0-or-later. The sparse SH light grid: octrees with quantized SH coefficients at the corners of their cells, and
// its BSPX lump.
#include "q3map2/bspfile/bspfile_sparse.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

// ---- Values of the sparse SH light grid, quantized ----

namespace {

constexpr int kPlainScale = 128; ///< the code of scale 1
constexpr int kScaleSteps = 8;   ///< codes per doubling of the scale
constexpr float kMaxStep = 127;  ///< largest value of the signed bytes of bands 1 and 2, which stands for scale * limit

/// 2^(i / kScaleSteps).
constexpr std::array<float, kScaleSteps> kEighths = {1.0f,        1.09050773f, 1.18920712f, 1.29683955f,
                                                     1.41421356f, 1.54221083f, 1.68179283f, 1.83400809f};

float BandLimit(std::size_t k) {
    return kSparseBandLimits[k < 4 ? 0 : 1];
}

void CheckFinite(const bspGridPointSH_t &value, std::size_t index) {
    for (std::size_t k = 0; k < 9; ++k)
        for (const float c : value.coeffs[k])
            if (!std::isfinite(c))
                throw Error("{}: point {}: coefficient {} is {}, not a finite number", kBspxSparseGridSH, index, k, c);
}

/// The scale that a point needs: the largest |c| / (limit of its band * coefficient 0) of bands 1 and 2. `mean` is
/// coefficient 0 as stored. Where rounding made it smaller than the exact one, the exact one is the divisor; Quantize
/// then clamps c, by no more than the relative error of `mean`.
float NeededScale(const bspGridPointSH_t &value, const Vec3f &mean) {
    float most = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t k = 1; mean[channel] > 0 && k < 9; ++k)
            most = std::max(most, std::abs(value.coeffs[k][channel]) /
                                      (BandLimit(k) * std::max(mean[channel], value.coeffs[0][channel])));
    return most;
}

SparseGridPoint Quantize(const bspGridPointSH_t &value, std::uint8_t scale) {
    SparseGridPoint point;
    point.mean = EncodeE5bgr9(Vec3f(value.coeffs[0]));
    const Vec3f mean = DecodeE5bgr9(point.mean);
    for (std::size_t k = 1; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float unit = SparseScale(scale) * BandLimit(k) * mean[channel];
            const float steps = unit > 0 ? kMaxStep * (value.coeffs[k][channel] / unit) : 0;
            point.bands[3 * (k - 1) + channel] = std::int8_t(std::lround(std::clamp(steps, -kMaxStep, kMaxStep)));
        }
    return point;
}

} // namespace

float SparseScale(std::uint8_t scale) {
    return std::ldexp(kEighths[scale % kScaleSteps], (scale - kPlainScale - scale % kScaleSteps) / kScaleSteps);
}

std::uint8_t SparseScaleCode(float needed) {
    if (!(needed > 0))
        return 0;
    const double code = std::ceil(kPlainScale + kScaleSteps * std::log2(double(needed)));
    int scale = int(std::clamp(code, 0.0, 255.0));
    if (scale < 255 && SparseScale(std::uint8_t(scale)) < needed) // by rounding
        ++scale;
    return std::uint8_t(scale);
}

void NumberSparseNodes(SparseGridSH &grid) {
    std::uint64_t children = 1, points = 0;
    for (const std::int32_t roots : grid.roots)
        children *= std::uint64_t(std::clamp(roots, 0, kMaxSparseCells)); // CheckSparseGrid says what is wrong
    for (SparseGridNode &node : grid.nodes) {
        node.children = std::uint32_t(children);
        node.points = std::uint32_t(points);
        children += std::uint64_t(std::popcount(node.inner));
        points += std::uint64_t(std::popcount(node.stored));
    }
}

SparseGridSH PackSparseGrid(const SparseGridTree &tree) {
    SparseGridSH grid{tree.mins, tree.cell, tree.roots, tree.levels, tree.nodes, {}};
    NumberSparseNodes(grid);
    grid.points.resize(tree.values.size());
    CheckSparseGrid(grid, "packing");
    for (SparseGridNode &node : grid.nodes) {
        const std::size_t count = std::size_t(std::popcount(node.stored));
        float needed = 0;
        for (std::size_t i = node.points; i < node.points + count; ++i) {
            CheckFinite(tree.values[i], i);
            needed = std::max(needed,
                              NeededScale(tree.values[i], DecodeE5bgr9(EncodeE5bgr9(Vec3f(tree.values[i].coeffs[0])))));
        }
        node.scale = SparseScaleCode(needed);
        for (std::size_t i = node.points; i < node.points + count; ++i)
            grid.points[i] = Quantize(tree.values[i], node.scale);
    }
    return grid;
}

bspGridPointSH_t DequantizePoint(const SparseGridPoint &point, std::uint8_t scale) {
    bspGridPointSH_t value{};
    const Vec3f mean = DecodeE5bgr9(point.mean);
    const float factor = SparseScale(scale);
    value.coeffs[0] = mean.Array();
    for (std::size_t k = 1; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float steps = std::max<float>(point.bands[3 * (k - 1) + channel], -kMaxStep);
            value.coeffs[k][channel] = steps / kMaxStep * BandLimit(k) * factor * mean[channel];
        }
    return value;
}

std::vector<bspGridPointSH_t> DequantizePoints(const SparseGridSH &grid) {
    std::vector<bspGridPointSH_t> values(grid.points.size());
    for (const SparseGridNode &node : grid.nodes)
        for (std::size_t i = node.points; i < node.points + std::size_t(std::popcount(node.stored)); ++i)
            values[i] = DequantizePoint(grid.points[i], node.scale);
    return values;
}

// ---- The BSPX lump LIGHTGRID_SH_SPARSE ----

namespace {

/// Errors: a position or size that is not finite, counts out of range. Returns the number of roots.
std::uint64_t CheckSparseHead(const SparseGridSH &grid) {
    if (grid.levels < 1 || grid.levels > kMaxSparseLevels)
        throw Error("levels is {}, expected 1 to {}", std::uint32_t(grid.levels), kMaxSparseLevels);
    const std::int32_t maxRoots = kMaxSparseCells >> grid.levels;
    // The length of the lump is a uint32. A node and a point have 40 bytes; two pairs less leave room for the head, 64.
    constexpr std::size_t kMaxRecords = UINT32_MAX / (sizeof(SparseGridNode) + sizeof(SparseGridPoint)) - 2;
    if (grid.nodes.size() > kMaxRecords || grid.points.size() > kMaxRecords)
        throw Error("{} nodes and {} points, expected at most {}", grid.nodes.size(), grid.points.size(), kMaxRecords);
    std::uint64_t roots = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!std::isfinite(grid.mins[i]))
            throw Error("mins[{}] is {}, not a finite number", i, grid.mins[i]);
        if (!std::isfinite(grid.cell[i]) || grid.cell[i] <= 0)
            throw Error("cell[{}] is {}, expected a number above 0", i, grid.cell[i]);
        if (grid.roots[i] < 1 || grid.roots[i] > maxRoots)
            throw Error("roots[{}] is {}, expected 1 to {} with {} levels", i, grid.roots[i], maxRoots, grid.levels);
        roots *= std::uint64_t(grid.roots[i]); // at most 2^23 each
        const float end = grid.mins[i] + grid.cell[i] * float(grid.roots[i] << grid.levels);
        if (!std::isfinite(end))
            throw Error("the grid ends at {} on axis {}, not a finite number", end, i);
        if (roots > grid.nodes.size())
            throw Error("{} nodes, but roots are {} x {} x {}", grid.nodes.size(), grid.roots[0], grid.roots[1],
                        grid.roots[2]);
    }
    return roots;
}

/// Errors: indexes that are not running sums, masks that contradict each other, another number of nodes or points.
void CheckSparseNodes(const SparseGridSH &grid, std::uint64_t roots) {
    // Running sums of children and points, and the index of the first node of the next level.
    std::uint64_t children = roots, points = 0, levelEnd = roots;
    std::int32_t level = 0;
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        const SparseGridNode &node = grid.nodes[i];
        if (i == levelEnd) {
            ++level;
            levelEnd = children;
        }
        if (i >= children)
            throw Error("{} nodes, but the tree has {}", grid.nodes.size(), children);
        if (node.children != children)
            throw Error("node {}: children is {}, expected {}", i, node.children, children);
        if (node.points != points)
            throw Error("node {}: points is {}, expected {}", i, node.points, points);
        if ((node.inner & node.stored) != 0 || (node.inner & node.hanging) != 0 || (node.stored & node.hanging) != 0)
            throw Error("node {}: inner {}, stored {} and hanging {} share bits", i, node.inner, node.stored,
                        node.hanging);
        if (level == grid.levels - 1 && node.inner != 0)
            throw Error("node {}: inner is {}, expected 0 in the last of {} levels", i, node.inner, grid.levels);
        if (level == 0 && node.hanging != 0)
            throw Error("node {}: hanging is {}, expected 0: no cell is larger than those of a root", i, node.hanging);
        children += std::uint64_t(std::popcount(node.inner));
        points += std::uint64_t(std::popcount(node.stored));
    }
    if (children != grid.nodes.size())
        throw Error("{} nodes, but the tree has {}", grid.nodes.size(), children);
    if (points != grid.points.size())
        throw Error("{} points, but the nodes have {}", grid.points.size(), points);
}

void CheckSparseTree(const SparseGridSH &grid) {
    CheckSparseNodes(grid, CheckSparseHead(grid));
}

} // namespace

bspSparseGridHeader_t HeaderOf(const SparseGridSH &grid) {
    bspSparseGridHeader_t head;
    head.nodes = std::uint32_t(grid.nodes.size());
    head.points = std::uint32_t(grid.points.size());
    head.bytes = std::uint32_t(SparseGridBytes(grid.nodes.size(), grid.points.size()));
    head.mins = grid.mins;
    head.cell = grid.cell;
    head.roots = grid.roots;
    head.levels = std::uint32_t(grid.levels);
    return head;
}

std::vector<SparseLevelCounts> CountSparseLevels(const SparseGridSH &grid) {
    std::vector<SparseLevelCounts> levels;
    std::size_t levelEnd = 0;
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        const SparseGridNode &node = grid.nodes[i];
        if (i == levelEnd || i == 0) {
            levels.emplace_back();
            levelEnd = node.children; // the first child of the first node of a level: where the next level begins
        }
        const std::size_t stored = std::size_t(std::popcount(node.stored));
        const std::size_t hanging = std::size_t(std::popcount(node.hanging));
        levels.back().stored += stored;
        levels.back().hanging += hanging;
        levels.back().empty += 8 - stored - hanging - std::size_t(std::popcount(node.inner));
    }
    return levels;
}

void CheckSparseGrid(const SparseGridSH &grid, std::string_view name) {
    try {
        CheckSparseTree(grid);
    } catch (const Error &error) {
        throw Error("{}: BSPX lump {}: {}", name, kBspxSparseGridSH, error.what());
    }
}

SparseGridSH ReadSparseGrid(const BspxSource &from) {
    try {
        return DecodeSparseGrid(from.Bytes());
    } catch (const Error &error) {
        from.Fail(error.what());
    }
}

ByteRanges SparseRanges(const SparseGridSH &grid) {
    ByteRanges bytes;
    bytes.AddCopy(HeaderOf(grid));
    bytes.Add(grid.nodes);
    bytes.Add(grid.points);
    return bytes;
}

std::vector<std::byte> EncodeSparseGrid(const SparseGridSH &grid) {
    CheckSparseTree(grid);
    return SparseRanges(grid).Bytes();
}

SparseGridSH DecodeSparseGrid(std::span<const std::byte> lump) {
    bspSparseGridHeader_t head;
    if (lump.size() < sizeof head)
        throw Error("length {} is under the {} of its head", lump.size(), sizeof head);
    head = LoadRecord<bspSparseGridHeader_t>(lump, 0);
    if (head.magic != bspSparseGridHeader_t{}.magic)
        throw Error("does not start with SHGS");
    if (head.version != 1)
        throw Error("version {}, expected 1", head.version);
    if (head.bytes != lump.size())
        throw Error("bytes is {}, but the length is {}", head.bytes, lump.size());
    const std::uint64_t nodeBytes = std::uint64_t(head.nodes) * sizeof(SparseGridNode);
    const std::uint64_t pointBytes = std::uint64_t(head.points) * sizeof(SparseGridPoint);
    if (lump.size() != sizeof head + nodeBytes + pointBytes)
        throw Error("length {} is not {} + {} nodes x {} + {} points x {}", lump.size(), sizeof head, head.nodes,
                    sizeof(SparseGridNode), head.points, sizeof(SparseGridPoint));
    if (head.reserved != 0)
        throw Error("reserved is {}, expected 0", head.reserved);
    SparseGridSH grid{head.mins, head.cell, head.roots, std::int32_t(head.levels), {}, {}};
    grid.nodes.resize(head.nodes);
    grid.points.resize(head.points);
    const auto fill = [&](std::span<std::byte> to, std::uint64_t at) {
        if (!to.empty())
            std::memcpy(to.data(), lump.data() + at, to.size());
    };
    fill(std::as_writable_bytes(std::span(grid.nodes)), sizeof head);
    fill(std::as_writable_bytes(std::span(grid.points)), sizeof head + nodeBytes);
    CheckSparseTree(grid);
    return grid;
}

} // namespace q3
