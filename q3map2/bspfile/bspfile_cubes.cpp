// GPL-2.0-or-later. The BSPX lump AMBIENT_CUBES.
#include "q3map2/bspfile/bspfile_cubes.h"

#include "common/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace q3 {

namespace {

/// Lowest corner and size of a leaf on an axis; the size is not negative.
struct Extent {
    float from, size;
    Extent(const bspLeaf_t &leaf, std::size_t axis)
        : from(float(leaf.mins[axis])), size(std::max(0.0f, float(leaf.maxs[axis]) - float(leaf.mins[axis]))) {}
};

/// What is wrong with the samples of a leaf; empty: nothing.
std::string LeafFault(const AmbientCubes &cubes, const bspCubeLeaf_t &leaf) {
    const std::size_t count = cubes.samples.size(), last = std::size_t(leaf.first) + leaf.count;
    if (leaf.count > 0 && last > count)
        return fmt::format("samples {}..{} are outside 0..{}", leaf.first, last - 1, std::int64_t(count) - 1);
    if (leaf.count == 0 && leaf.first >= cubes.leafs.size())
        return fmt::format("refers to leaf {}, which is outside 0..{}", leaf.first, cubes.leafs.size() - 1);
    if (leaf.count == 0 && cubes.leafs[leaf.first].count == 0)
        return fmt::format("refers to leaf {}, which has no samples", leaf.first);
    return {};
}

[[noreturn]] void Fail(std::string_view name, const std::string &text) {
    throw Error("{}: BSPX lump {}: {}", name, kBspxAmbientCubes, text);
}

} // namespace

bspCubeHeader_t HeaderOf(const AmbientCubes &cubes) {
    bspCubeHeader_t head;
    head.leafCount = std::uint32_t(cubes.leafs.size());
    head.sampleCount = std::uint32_t(cubes.samples.size());
    return head;
}

AmbientCubes ReadAmbientCubes(const BspxSource &from) {
    bspCubeHeader_t head;
    const std::int64_t length = from.part.length;
    if (length < std::int64_t(sizeof head))
        from.Fail(fmt::format("length {} is under the {} of its head", length, sizeof head));
    std::uint64_t at = std::uint64_t(from.part.offset);
    from.file.Fill(at, std::span(&head, 1));
    if (head.magic != bspCubeHeader_t{}.magic)
        from.Fail("does not start with ACUB");
    if (head.version != 1)
        from.Fail(fmt::format("version {}, expected 1", head.version));
    const std::uint64_t leafBytes = std::uint64_t(head.leafCount) * sizeof(bspCubeLeaf_t);
    const std::uint64_t sampleBytes = std::uint64_t(head.sampleCount) * sizeof(bspCubeSample_t);
    if (std::uint64_t(length) != sizeof head + leafBytes + sampleBytes)
        from.Fail(fmt::format("length {} is not {} + {} leafs x {} + {} samples x {}", length, sizeof head,
                              head.leafCount, sizeof(bspCubeLeaf_t), head.sampleCount, sizeof(bspCubeSample_t)));
    AmbientCubes cubes;
    cubes.leafs.resize(head.leafCount);
    cubes.samples.resize(head.sampleCount);
    at += sizeof head;
    from.file.Fill(at, std::span(cubes.leafs));
    from.file.Fill(at + leafBytes, std::span(cubes.samples));
    return cubes;
}

ByteRanges CubeRanges(const AmbientCubes &cubes) {
    ByteRanges bytes;
    bytes.AddCopy(HeaderOf(cubes));
    bytes.Add(cubes.leafs);
    bytes.Add(cubes.samples);
    return bytes;
}

std::string CubesMisfit(const Bsp &bsp) {
    if (!bsp.ambientCubes || bsp.ambientCubes->leafs.size() == bsp.leafs.size())
        return {};
    return fmt::format("{} leafs, but the map has {}", bsp.ambientCubes->leafs.size(), bsp.leafs.size());
}

void CheckAmbientCubes(const Bsp &bsp, std::string_view name) {
    if (!bsp.ambientCubes)
        return;
    const AmbientCubes &cubes = *bsp.ambientCubes;
    if (const std::string misfit = CubesMisfit(bsp); !misfit.empty())
        Fail(name, misfit);
    for (std::size_t i = 0; i < cubes.leafs.size(); ++i)
        if (const std::string fault = LeafFault(cubes, cubes.leafs[i]); !fault.empty())
            Fail(name, fmt::format("leaf {}: {}", i, fault));
    for (std::size_t i = 0; i < cubes.samples.size(); ++i)
        if (cubes.samples[i].unused != 0)
            Fail(name, fmt::format("sample {}: byte 27 is {}, expected 0", i, cubes.samples[i].unused));
}

Vec3f CubePosition(const bspLeaf_t &leaf, const bspCubeSample_t &sample) {
    Vec3f position;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Extent extent(leaf, axis);
        position[axis] = extent.from + extent.size * (float(sample.position[axis]) / 255);
    }
    return position;
}

std::array<std::uint8_t, 3> EncodeCubePosition(const bspLeaf_t &leaf, const Vec3f &position) {
    std::array<std::uint8_t, 3> bytes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Extent extent(leaf, axis);
        const float share = extent.size > 0 ? (position[axis] - extent.from) / extent.size : 0;
        bytes[axis] = std::uint8_t(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
    }
    return bytes;
}

} // namespace q3
