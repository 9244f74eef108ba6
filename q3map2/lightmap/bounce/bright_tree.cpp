// GPL-2.0-or-later. A light tree over small patches.
#include "q3map2/lightmap/bounce/bright_tree.h"

#include "libs/math/color.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// A node is opened if its radius is above kMaxOpening times its distance, or the cosine between its axis and one of
/// its normals is below kMinNodeCosine.
constexpr float kMaxOpening = 0.25f, kMinNodeCosine = 0.8f;

/// Patches with the same facing share a root. Facing: the axis nearest to the normal, and its sign or two-sidedness.
int FacingOf(const BrightPatch &patch) {
    const Vec3f size = Max(patch.normal, -patch.normal);
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return int(axis) + (patch.twoSided ? 6 : patch.normal[axis] < 0 ? 3 : 0);
}

/// Whether no receiver of the view can get light from the node.
bool IsHidden(const BrightTree::Node &node, const TreeView &view, const BspSpace &space) {
    const Vec3f way = node.center - view.center;
    const float reach = node.radius + view.radius;
    if (view.normal != Vec3f{} && Dot(view.normal, way) < -reach)
        return true;
    if (!node.twoSided && node.minCosine > 0.999f && Dot(node.axis, way) > reach)
        return true;
    return node.cluster != BrightPatch::kNoCluster && !view.clusters.empty() &&
           std::none_of(view.clusters.begin(), view.clusters.end(),
                        [&](int cluster) { return space.Visible(cluster, node.cluster); });
}

} // namespace

BrightTree::BrightTree(std::vector<BrightPatch> patches) : patches_(std::move(patches)) {
    std::stable_sort(patches_.begin(), patches_.end(),
                     [](const BrightPatch &a, const BrightPatch &b) { return FacingOf(a) < FacingOf(b); });
    nodes_.reserve(2 * patches_.size());
    for (std::size_t first = 0; first < patches_.size();) {
        std::size_t end = first;
        while (end < patches_.size() && FacingOf(patches_[end]) == FacingOf(patches_[first]))
            ++end;
        roots_.push_back(Build(std::uint32_t(first), std::uint32_t(end - first)));
        first = end;
    }
    powerBefore_.push_back(0);
    for (const BrightPatch &patch : patches_)
        powerBefore_.push_back(powerBefore_.back() + double(Luminance(patch.radiosity)) * double(patch.area));
}

BrightTree::Node BrightTree::Sum(std::uint32_t first, std::uint32_t count) const {
    const std::span<const BrightPatch> patches(patches_.data() + first, count);
    Node node;
    node.first = first, node.count = count;
    node.cluster = patches[0].cluster, node.twoSided = patches[0].twoSided;
    float weights = 0;
    for (const BrightPatch &patch : patches) {
        const float weight = Luminance(patch.radiosity) * patch.area;
        node.center += patch.center * weight;
        node.axis += patch.normal * weight;
        node.power += patch.radiosity * patch.area;
        node.area += patch.area;
        weights += weight;
        if (patch.cluster != node.cluster)
            node.cluster = BrightPatch::kNoCluster;
    }
    node.center = node.center / weights;
    node.axis = Normalize(node.axis);
    for (const BrightPatch &patch : patches) {
        node.radius = std::max(node.radius, Length(patch.center - node.center) + std::sqrt(patch.area) / 2);
        node.minCosine = std::min(node.minCosine, Dot(patch.normal, node.axis));
    }
    return node;
}

std::uint32_t BrightTree::Build(std::uint32_t first, std::uint32_t count) {
    const auto number = std::uint32_t(nodes_.size());
    nodes_.push_back(Sum(first, count));
    if (count == 1)
        return number;
    Boundsf bounds;
    const auto begin = patches_.begin() + first;
    for (auto patch = begin; patch != begin + count; ++patch)
        bounds.Add(patch->center);
    const Vec3f size = bounds.maxs - bounds.mins;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, begin + count, [&](const BrightPatch &a, const BrightPatch &b) {
        return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.emitter < b.emitter;
    });
    Build(first, half);
    nodes_[number].right = Build(first + half, count - half);
    return number;
}

void BrightTree::Cut(const TreeView &view, const BspSpace &space, float faint, std::vector<std::uint32_t> &cut) const {
    std::vector<std::uint32_t> open(roots_.rbegin(), roots_.rend());
    while (!open.empty()) {
        const std::uint32_t number = open.back();
        open.pop_back();
        const Node &node = nodes_[number];
        if (IsHidden(node, view, space))
            continue;
        const float distance = Length(node.center - view.center) - view.radius;
        if (node.right == 0 || MostLight(node, view) < faint ||
            (node.radius < kMaxOpening * distance && node.minCosine > kMinNodeCosine))
            cut.push_back(number);
        else
            open.push_back(node.right), open.push_back(number + 1);
    }
}

float BrightTree::MostLight(const Node &node, const TreeView &view) {
    const float nearest = std::max(Length(node.center - view.center) - view.radius - node.radius, 1.0f);
    return Luminance(node.power) / (std::numbers::pi_v<float> * nearest * nearest);
}

const BrightPatch &BrightTree::PatchAt(const Node &node, float u) const {
    const auto first = powerBefore_.begin() + node.first + 1, end = first + (node.count - 1);
    const double from = powerBefore_[node.first], to = powerBefore_[node.first + node.count];
    return patches_[std::size_t(std::upper_bound(first, end, from + double(u) * (to - from)) - first) + node.first];
}

} // namespace q3
