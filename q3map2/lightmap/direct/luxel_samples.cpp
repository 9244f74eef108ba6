// GPL-2.0-or-later. -samples: adaptive supersampling of luxels at shadow edges.
#include "q3map2/lightmap/direct/luxel_samples.h"

#include "q3map2/light/scene/open_parts.h"

#include "libs/math/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Cells are refined only if the light of their luxels adds up to more. Byte scale.
constexpr float kDarkCell = 4;
/// Samples keep this distance from solids. Game units.
constexpr float kSampleMargin = 0.25f;
/// Offset of the first subsamples from the center of the luxel on each axis; halved at each level. Luxels.
constexpr float kFirstOffset = 0.25f;
/// In hitFlags_: the shadow ray of the luxel passed a transparent surface. Makes the sum of its cell differ from the
/// count of mapped luxels, so the cell is always refined.
constexpr std::uint8_t kTransparentHit = 16;
constexpr std::uint64_t kSeedSamples = 0x4C7578656Cull; ///< "Luxel" in ASCII

/// -randomsamples: number of random samples of a luxel for -samples N. N up to 4 is a depth, and 4^N samples, at least
/// 16, stand for it; above, or with exact (-samples +N), it is the number of samples itself.
int RandomCount(int samples, bool exact) {
    constexpr int kDeepest = 4, kLeastDepth = 2;
    if (exact || samples > kDeepest)
        return std::max(samples, 1);
    return 1 << 2 * std::max(samples, kLeastDepth);
}

/// Whether any of the 2 x 2 cells of two rows of luxels is partly lit.
bool AnyPartlyLit(const std::uint8_t *lit, const std::uint8_t *below, const std::uint8_t *mapped, int count) {
    return Vectorize([&, count]() Q3_INLINE {
        std::uint8_t mixed = 0;
        for (int x = 0; x < count; ++x) {
            const auto sum = std::uint8_t(lit[x] + lit[x + 1] + below[x] + below[x + 1]);
            mixed = std::uint8_t(mixed | (sum != 0 && sum != mapped[x] ? 1 : 0));
        }
        return mixed != 0;
    });
}

} // namespace

bool LuxelSampler::Mapped(int x, int y) const {
    return lightmap_->Mapped(lightmap_->SuperIndex(x, y));
}

void LuxelSampler::Start(const SurfaceInputs &in, const RawLightmap &lightmap, const LuxelBlocks &blocks,
                         const LuxelPass &pass) {
    in_ = &in, lightmap_ = &lightmap, blocks_ = &blocks, pass_ = pass;
    pass_.settings.faint = 0;
    width_ = lightmap.SuperWidth(), height_ = lightmap.SuperHeight();
    maxDepth_ = std::max(in.lightmap.samples, 1);
    randomSamples_ = in.lightmap.randomSamples ? RandomCount(maxDepth_, in.lightmap.samplesExact) : 0;
    offsetScale_ = float(std::clamp(in.lightmap.samplesSearchBox, 1, kMaxSearchBox));
    allowed_.emplace(in.space, lightmap.clusters);
    const std::size_t luxels = std::size_t(width_) * std::size_t(height_);
    mappedInCell_.assign(luxels, 0);
    for (int y = 0; y + 1 < height_; ++y)
        for (int x = 0; x + 1 < width_; ++x)
            mappedInCell_[lightmap.SuperIndex(x, y)] =
                std::uint8_t(Mapped(x, y) + Mapped(x + 1, y) + Mapped(x, y + 1) + Mapped(x + 1, y + 1));
    hitFlags_.assign(luxels, 0), refined_.assign(luxels, 0);
    refinedList_.clear();
    firstTouched_ = luxels, lastTouched_ = 0;
    incident_.resize(blocks.Count());
    channels_.resize(pass.channels.Any() ? blocks.Count() : 0);
}

void LuxelSampler::StartLight(const LightGroup &group) {
    group_ = &group;
    if (firstTouched_ <= lastTouched_)
        std::fill(hitFlags_.data() + firstTouched_, hitFlags_.data() + lastTouched_ + 1, std::uint8_t(0));
    firstTouched_ = hitFlags_.size(), lastTouched_ = 0;
    for (const std::uint32_t luxel : refinedList_)
        refined_[luxel] = 0;
    refinedList_.clear();
}

void LuxelSampler::SetBlock(std::size_t block, const LuxelIncidentLight &incident, const ChannelLanes &channels) {
    incident_[block] = incident;
    if (pass_.channels.Any())
        channels_[block] = channels;
    const auto &luxels = blocks_->Luxels(block);
    const std::size_t count = blocks_->Receivers(block).count;
    for (std::size_t i = 0; i < count; ++i) {
        const int value = (incident.lit[i] != 0 ? 1 : 0) + (incident.filtered[i] != 0 ? kTransparentHit : 0);
        hitFlags_[luxels[i]] = std::uint8_t(value);
        Touch(luxels[i]);
    }
}

bool LuxelSampler::RowIsPartlyLit(int y) const {
    const std::size_t row = lightmap_->SuperIndex(0, y);
    const std::size_t below = row + std::size_t(width_);
    return AnyPartlyLit(hitFlags_.data() + row, hitFlags_.data() + below, mappedInCell_.data() + row, width_ - 1);
}

void LuxelSampler::Refine(LuxelSum &sum, ContributionCounts &counts) {
    if (firstTouched_ > lastTouched_)
        return;
    const auto row = [&](std::size_t luxel) { return int(luxel / std::size_t(width_)); };
    // RefineCell may raise lastTouched_.
    for (int y = std::max(0, row(firstTouched_) - 1); y + 1 < height_ && y <= row(lastTouched_); ++y) {
        if (!RowIsPartlyLit(y))
            continue;
        for (int x = 0; x + 1 < width_; ++x) {
            const std::size_t at = lightmap_->SuperIndex(x, y), below = at + std::size_t(width_);
            const int lit = hitFlags_[at] + hitFlags_[at + 1] + hitFlags_[below] + hitFlags_[below + 1];
            if (lit != 0 && lit != mappedInCell_[at])
                RefineCell(x, y, sum, counts);
        }
    }
}

LuxelSampler::Sample LuxelSampler::ReadLuxel(std::size_t luxel) const {
    Sample sample;
    if (blocks_->LaneIndexOf(luxel) < 0) // not mapped
        return sample;
    const auto laneIndex = std::size_t(blocks_->LaneIndexOf(luxel));
    sample.position = blocks_->Receivers(laneIndex / kPacketSize).position[laneIndex % kPacketSize];
    if (hitFlags_[luxel] == 0)
        return sample;
    const LuxelIncidentLight &incident = incident_[laneIndex / kPacketSize];
    sample.color = incident.color[laneIndex % kPacketSize];
    if (pass_.deluxe)
        sample.direction = incident.direction[laneIndex % kPacketSize];
    for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
        sample.channels[c] = channels_[laneIndex / kPacketSize][c][laneIndex % kPacketSize];
    return sample;
}

void LuxelSampler::RefineCell(int x, int y, LuxelSum &sum, ContributionCounts &counts) {
    const std::size_t at = lightmap_->SuperIndex(x, y), below = at + std::size_t(width_);
    Vec3f total;
    for (const std::size_t luxel : {at, at + 1, below, below + 1})
        total += ReadLuxel(luxel).color;
    if (MaxComponent(total) <= kDarkCell)
        return;
    std::array<Sample, kMaxRefinements> after;
    std::array<Refinement, kMaxRefinements> refinements;
    std::size_t count = 0;
    for (const std::size_t luxel : {at, at + 1, below, below + 1})
        if (lightmap_->Mapped(luxel) && refined_[luxel] == 0) {
            after[count] = ReadLuxel(luxel);
            refinements[count] = {int(luxel % std::size_t(width_)), int(luxel / std::size_t(width_)), &after[count]};
            ++count;
        }
    if (randomSamples_ == 0)
        Subsample({refinements.data(), count}, kFirstOffset * offsetScale_, counts);
    for (const Refinement &one : std::span(refinements).first(count))
        ReplaceLuxel(lightmap_->SuperIndex(one.x, one.y),
                     randomSamples_ > 0 ? RandomSamples(one.x, one.y, counts) : *one.sample, sum);
}

/// Replaces the light of the source at the luxel by its refined sample.
void LuxelSampler::ReplaceLuxel(std::size_t luxel, const Sample &after, LuxelSum &sum) {
    refined_[luxel] = 1;
    Touch(luxel);
    refinedList_.push_back(std::uint32_t(luxel));
    const Sample before = ReadLuxel(luxel);
    const auto laneIndex = std::size_t(blocks_->LaneIndexOf(luxel));
    const std::size_t block = laneIndex / kPacketSize, lane = laneIndex % kPacketSize;
    LuxelIncidentLight &incident = incident_[block];
    incident.color.Set(lane, after.color);
    const float sign = group_->First().negative ? -1.0f : 1.0f;
    sum.color[block].Set(lane, sum.color[block][lane] + (after.color - before.color) * sign);
    if (pass_.deluxe) {
        incident.direction.Set(lane, after.direction);
        sum.direction[block].Set(lane, sum.direction[block][lane] + after.direction - before.direction);
    }
    for (std::size_t c = 0; c < pass_.channels.Count(); ++c) {
        channels_[block][c].Set(lane, after.channels[c]);
        Lanes3 &total = sum.channels[block][c];
        total.Set(lane, total[lane] + (after.channels[c] - before.channels[c]) * sign);
    }
    const bool lit = after.color.x + after.color.y + after.color.z > 0;
    hitFlags_[luxel] = std::uint8_t((hitFlags_[luxel] & kTransparentHit) | (lit ? 1 : 0));
}

/// World step from the luxel to its neighbor at (dx, dy), or where there is none, from its neighbor on the other side;
/// zero if the neighbor is not mapped.
Vec3f LuxelSampler::NeighborStep(int x, int y, int dx, int dy) const {
    const auto inside = [&](int ox, int oy) {
        return x + ox >= 0 && y + oy >= 0 && x + ox < width_ && y + oy < height_;
    };
    const bool there = inside(dx, dy);
    const int ox = there ? dx : -dx, oy = there ? dy : -dy;
    if (!inside(ox, oy) || !Mapped(x + ox, y + oy))
        return {};
    const Vec3f step =
        lightmap_->positions[lightmap_->SuperIndex(x + ox, y + oy)] - lightmap_->positions[lightmap_->SuperIndex(x, y)];
    return there ? step : -step;
}

/// World offset of `across` columns and `down` rows.
Vec3f LuxelSampler::Offset(int x, int y, float across, float down) const {
    return NeighborStep(x, y, across >= 0 ? 1 : -1, 0) * std::abs(across) +
           NeighborStep(x, y, 0, down >= 0 ? 1 : -1) * std::abs(down);
}

/// Whether a sample of the luxel may be at the position: in the open, and on the luxel's side of walls.
bool LuxelSampler::FindOpenCluster(std::size_t luxel, const Vec3f &position, int &cluster) const {
    cluster = allowed_->ClusterIfAllowed(in_->space.ClusterAt(position, kSampleMargin));
    return cluster >= 0 && (cluster == lightmap_->luxelClusters[luxel] ||
                            StateOfSegment(in_->space, lightmap_->positions[luxel], position) == SegmentState::Open);
}

/// Positions of the four subsamples of each sample, sample by sample.
LuxelSampler::SubsamplePositions LuxelSampler::PositionsOfSubsamples(std::span<const Refinement> samples,
                                                                     float offset) const {
    SubsamplePositions receivers;
    std::size_t count = 0;
    for (const Refinement &one : samples)
        for (const float down : {-offset, offset})
            for (const float across : {-offset, offset})
                receivers[count++] = one.sample->position + Offset(one.x, one.y, across, down);
    return receivers;
}

std::vector<LuxelSampler::SamplePlace> LuxelSampler::FirstSamples(int x, int y) const {
    std::vector<SamplePlace> places;
    const std::size_t luxel = lightmap_->SuperIndex(x, y);
    if (maxDepth_ <= 1 || randomSamples_ > 0 || !lightmap_->Mapped(luxel))
        return places;
    Sample center;
    center.position = lightmap_->positions[luxel];
    const Refinement one{x, y, &center};
    const SubsamplePositions at = PositionsOfSubsamples({&one, 1}, kFirstOffset * offsetScale_);
    for (std::size_t i = 0; i < kSubsamples; ++i) {
        SamplePlace place{at[i]};
        if (int cluster = 0; FindOpenCluster(luxel, at[i], cluster))
            place.cluster = cluster;
        places.push_back(place);
    }
    return places;
}

/// Sets `samples` to the light of the source at the receivers. luxels: of each receiver. False: no light arrives.
bool LuxelSampler::Contribution(SurfaceReceiverBatch &receivers, std::span<const std::size_t> luxels,
                                std::span<Sample> samples, ContributionCounts &counts) const {
    BasisLanes basis;
    for (std::size_t i = 0; pass_.channels.basis && i < receivers.count; ++i)
        SetLane(i, lightmap_->BasisOf(luxels[i]), basis);
    LuxelIncidentLight incident;
    ChannelLanes channels;
    if (!LuxelContribution(*group_, pass_, in_->scene, {receivers, pass_.channels.basis ? &basis : nullptr}, incident,
                           channels, counts))
        return false;
    for (std::size_t i = 0; i < receivers.count; ++i) {
        samples[i].color = incident.color[i];
        samples[i].direction = incident.direction[i];
        samples[i].lit = incident.lit[i] != 0, samples[i].filtered = incident.filtered[i] != 0;
        for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
            samples[i].channels[c] = channels[c][i];
    }
    return true;
}

void LuxelSampler::Accumulate(const Sample &one, Sample &sum) const {
    sum.color += one.color, sum.direction += one.direction;
    for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
        sum.channels[c] += one.channels[c];
}

void LuxelSampler::Scale(float factor, Sample &sample) const {
    sample.color *= factor, sample.direction *= factor;
    for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
        sample.channels[c] *= factor;
}

void LuxelSampler::Subsample(std::span<const Refinement> samples, float offset, ContributionCounts &counts) const {
    if (samples.empty() || samples.front().sample->depth >= maxDepth_)
        return;
    const SubsamplePositions at = PositionsOfSubsamples(samples, offset);
    std::array<Sample, kPacketSize> subsamples;
    std::array<std::size_t, kMaxRefinements + 1> first{}; // first[k]: first subsample of sample k
    std::array<std::size_t, kPacketSize> luxels{};
    SurfaceReceiverBatch receivers;
    receivers.twoSided = lightmap_->twoSided;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const std::size_t luxel = lightmap_->SuperIndex(samples[k].x, samples[k].y);
        const Vec3f normal = lightmap_->normals[luxel];
        for (std::size_t i = k * kSubsamples; i < (k + 1) * kSubsamples; ++i) {
            int cluster = 0;
            if (!FindOpenCluster(luxel, at[i], cluster))
                continue;
            subsamples[receivers.count].position = at[i];
            subsamples[receivers.count].depth = samples[k].sample->depth + 1;
            luxels[receivers.count] = luxel;
            receivers.Add(at[i], normal, cluster);
        }
        first[k + 1] = receivers.count;
    }
    if (receivers.count == 0)
        return;
    Contribution(receivers, luxels, subsamples, counts);
    for (std::size_t k = 0; k < samples.size(); ++k)
        AverageSubsamples(samples[k], std::span(subsamples).subspan(first[k], first[k + 1] - first[k]), offset, counts);
}

/// A sample becomes the mean of itself and its subsamples, which are first refined themselves if they are partly lit.
void LuxelSampler::AverageSubsamples(const Refinement &whole, std::span<Sample> subsamples, float offset,
                                     ContributionCounts &counts) const {
    if (subsamples.empty())
        return;
    Vec3f total;
    std::size_t lit = 0;
    bool anyFiltered = false;
    for (const Sample &subsample : subsamples) {
        total += subsample.color;
        lit += subsample.lit ? 1 : 0;
        anyFiltered = anyFiltered || subsample.filtered;
    }
    const bool partlyLit = anyFiltered || (lit != 0 && lit != subsamples.size());
    if (MaxComponent(total) > kDarkCell && partlyLit) {
        std::array<Refinement, kSubsamples> refinements;
        for (std::size_t i = 0; i < subsamples.size(); ++i)
            refinements[i] = {whole.x, whole.y, &subsamples[i]};
        Subsample({refinements.data(), subsamples.size()}, offset / 2, counts);
    }
    Sample &sample = *whole.sample;
    for (const Sample &subsample : subsamples)
        Accumulate(subsample, sample);
    Scale(1.0f / float(1 + subsamples.size()), sample);
}

LuxelSampler::Sample LuxelSampler::RandomSamples(int x, int y, ContributionCounts &counts) const {
    const std::size_t luxel = lightmap_->SuperIndex(x, y);
    const float sigma = 0.5f * offsetScale_;
    Sample mean;
    int used = 0;
    for (int first = 0; first < randomSamples_; first += int(kPacketSize)) {
        SurfaceReceiverBatch receivers;
        receivers.twoSided = lightmap_->twoSided;
        for (int i = first; i < std::min(randomSamples_, first + int(kPacketSize)); ++i) {
            // Density per area proportional to (1 - q)(2 - q), q = r / R: like a normal distribution, but bounded. The
            // CDF of r is q^2 (2 - q)^2, and R = sqrt(7.5) sigma makes the standard deviation on each axis sigma.
            const Sample2 s = PlasticSample(std::uint32_t(i), kSeedSamples + luxel);
            const double angle = s.u * 2 * std::numbers::pi;
            const double length = double(sigma) * std::sqrt(7.5) * (1 - std::sqrt(1 - std::sqrt(s.v)));
            const Vec3f position = lightmap_->positions[luxel] +
                                   Offset(x, y, float(std::cos(angle) * length), float(std::sin(angle) * length));
            int cluster = 0;
            if (FindOpenCluster(luxel, position, cluster))
                receivers.Add(position, lightmap_->normals[luxel], cluster);
        }
        used += int(receivers.count);
        std::array<std::size_t, kPacketSize> luxels;
        luxels.fill(luxel);
        std::array<Sample, kPacketSize> samples;
        if (receivers.count == 0 || !Contribution(receivers, luxels, samples, counts))
            continue;
        for (std::size_t i = 0; i < receivers.count; ++i)
            Accumulate(samples[i], mean);
    }
    if (used == 0)
        return ReadLuxel(luxel);
    Scale(1.0f / float(used), mean);
    return mean;
}

} // namespace q3
