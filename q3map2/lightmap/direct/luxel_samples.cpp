// GPL-2.0-or-later. More samples for luxels at the edges of light.
#include "q3map2/lightmap/direct/luxel_samples.h"

#include "libs/math/low_discrepancy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Sums of a stamp up to this need no closer look. Byte scale.
constexpr float kBrightStamp = 4;
/// Samples may not be nearer to solids. Game units.
constexpr float kSampleMargin = 0.25f;
/// First offset of samples from the middle of the luxel, in luxels.
constexpr float kFirstBias = 0.25f;
/// Value in lit_ of luxels whose ray met a see-through surface: their stamps are always looked at.
constexpr std::uint8_t kForced = 16;
constexpr std::uint64_t kSeedSamples = 0x4C7578656Cull;

/// -randomsamples: how many for -samples N.
int RandomCount(int samples, bool exact) {
    if (exact || samples > 4)
        return std::max(samples, 1);
    return samples <= 2 ? 16 : samples == 3 ? 64 : 256;
}

/// Whether some stamp of two rows of luxels is lit in part.
Q3_VECTOR bool AnyMixed(const std::uint8_t *lit, const std::uint8_t *below, const std::uint8_t *mapped, int count) {
    std::uint8_t mixed = 0;
    for (int x = 0; x < count; ++x) {
        const auto sum = std::uint8_t(lit[x] + lit[x + 1] + below[x] + below[x + 1]);
        mixed = std::uint8_t(mixed | (sum != 0 && sum != mapped[x] ? 1 : 0));
    }
    return mixed != 0;
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
    levels_ = std::max(in.lightmap.samples, 1);
    random_ = in.lightmap.randomSamples ? RandomCount(levels_, in.lightmap.samplesExact) : 0;
    box_ = float(std::clamp(in.lightmap.samplesSearchBox, 1, 4));
    allowed_.emplace(in.space, lightmap.clusters);
    const std::size_t luxels = std::size_t(width_) * std::size_t(height_);
    mappedStamp_.assign(luxels, 0);
    for (int y = 0; y + 1 < height_; ++y)
        for (int x = 0; x + 1 < width_; ++x)
            mappedStamp_[lightmap.SuperIndex(x, y)] =
                std::uint8_t(Mapped(x, y) + Mapped(x + 1, y) + Mapped(x, y + 1) + Mapped(x + 1, y + 1));
    lit_.assign(luxels, 0), done_.assign(luxels, 0);
    doneList_.clear();
    first_ = luxels, last_ = 0;
    incident_.resize(blocks.Count());
}

void LuxelSampler::StartLight(const Light &light) {
    light_ = &light;
    if (first_ <= last_)
        std::fill(lit_.data() + first_, lit_.data() + last_ + 1, std::uint8_t(0));
    first_ = lit_.size(), last_ = 0;
    for (const std::uint32_t luxel : doneList_)
        done_[luxel] = 0;
    doneList_.clear();
}

void LuxelSampler::Put(std::size_t block, const LuxelIncidentLight &incident) {
    incident_[block] = incident;
    const auto &luxels = blocks_->Luxels(block);
    const std::size_t count = blocks_->Samples(block).count;
    for (std::size_t i = 0; i < count; ++i) {
        const int value = (incident.lit[i] != 0 ? 1 : 0) + (incident.forced[i] != 0 ? kForced : 0);
        lit_[luxels[i]] = std::uint8_t(value);
        Touch(luxels[i]);
    }
}

bool LuxelSampler::RowIsMixed(int y) const {
    const std::size_t row = lightmap_->SuperIndex(0, y);
    const std::size_t below = row + std::size_t(width_);
    return AnyMixed(lit_.data() + row, lit_.data() + below, mappedStamp_.data() + row, width_ - 1);
}

void LuxelSampler::Refine(LuxelSum &sum, ContributionCounts &counts) {
    if (first_ > last_)
        return;
    const auto row = [&](std::size_t luxel) { return int(luxel / std::size_t(width_)); };
    for (int y = std::max(0, row(first_) - 1); y + 1 < height_ && y <= row(last_); ++y) { // last_ grows on the way
        if (!RowIsMixed(y))
            continue;
        for (int x = 0; x + 1 < width_; ++x) {
            const std::size_t at = lightmap_->SuperIndex(x, y), below = at + std::size_t(width_);
            const int lit = lit_[at] + lit_[at + 1] + lit_[below] + lit_[below + 1];
            if (lit != 0 && lit != mappedStamp_[at])
                RefineStamp(x, y, sum, counts);
        }
    }
}

LuxelSampler::Sample LuxelSampler::ReadLuxel(std::size_t luxel) const {
    Sample sample;
    sample.place = lightmap_->positions[luxel];
    if (lit_[luxel] == 0)
        return sample;
    const auto slot = std::size_t(blocks_->SlotOf(luxel));
    const LuxelIncidentLight &incident = incident_[slot / kPacketSize];
    sample.color = incident.color[slot % kPacketSize];
    if (pass_.deluxe)
        sample.direction = incident.direction[slot % kPacketSize];
    return sample;
}

void LuxelSampler::RefineStamp(int x, int y, LuxelSum &sum, ContributionCounts &counts) {
    const std::size_t at = lightmap_->SuperIndex(x, y), below = at + std::size_t(width_);
    Vec3f total;
    for (const std::size_t luxel : {at, at + 1, below, below + 1})
        total += ReadLuxel(luxel).color;
    if (MaxComponent(total) <= kBrightStamp)
        return;
    std::array<Sample, kMostCloser> after;
    std::array<Closer, kMostCloser> closer;
    std::size_t count = 0;
    for (const std::size_t luxel : {at, at + 1, below, below + 1})
        if (lightmap_->Mapped(luxel) && done_[luxel] == 0) {
            after[count] = ReadLuxel(luxel);
            closer[count] = {int(luxel % std::size_t(width_)), int(luxel / std::size_t(width_)), &after[count]};
            ++count;
        }
    if (random_ == 0)
        Subsample({closer.data(), count}, kFirstBias * box_, counts);
    for (const Closer &one : std::span(closer).first(count))
        SetLuxel(lightmap_->SuperIndex(one.x, one.y), random_ > 0 ? RandomSamples(one.x, one.y, counts) : *one.sample,
                 sum);
}

/// What a closer look at the luxel gave.
void LuxelSampler::SetLuxel(std::size_t luxel, const Sample &after, LuxelSum &sum) {
    done_[luxel] = 1;
    Touch(luxel);
    doneList_.push_back(std::uint32_t(luxel));
    const Sample before = ReadLuxel(luxel);
    const auto slot = std::size_t(blocks_->SlotOf(luxel));
    const std::size_t block = slot / kPacketSize, lane = slot % kPacketSize;
    LuxelIncidentLight &incident = incident_[block];
    incident.color.Set(lane, after.color);
    const float sign = light_->negative ? -1.0f : 1.0f;
    sum.color[block].Set(lane, sum.color[block][lane] + (after.color - before.color) * sign);
    if (pass_.deluxe) {
        incident.direction.Set(lane, after.direction);
        sum.direction[block].Set(lane, sum.direction[block][lane] + after.direction - before.direction);
    }
    const bool lit = after.color.x + after.color.y + after.color.z > 0;
    lit_[luxel] = std::uint8_t((lit_[luxel] & kForced) | (lit ? 1 : 0));
}

/// World step from the luxel to its neighbour in that direction, or from the one on the other side where there is
/// none; zero if that is not mapped.
Vec3f LuxelSampler::Step(int x, int y, int dx, int dy) const {
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

/// World offset of so many luxels across and down.
Vec3f LuxelSampler::Offset(int x, int y, float across, float down) const {
    return Step(x, y, across >= 0 ? 1 : -1, 0) * std::abs(across) + Step(x, y, 0, down >= 0 ? 1 : -1) * std::abs(down);
}

bool LuxelSampler::PlaceInOpen(const BspRegion &space, const Vec3f &place, int &cluster) const {
    cluster = allowed_->Allowed(space.ClusterAt(place, kSampleMargin));
    return cluster >= 0;
}

/// Where the four parts of each sample lie, sample by sample.
LuxelSampler::PartPlaces LuxelSampler::PlacesOfParts(std::span<const Closer> samples, float bias) const {
    PartPlaces receivers;
    std::size_t count = 0;
    for (const Closer &one : samples)
        for (const float down : {-bias, bias})
            for (const float across : {-bias, bias})
                receivers[count++] = one.sample->place + Offset(one.x, one.y, across, down);
    return receivers;
}

void LuxelSampler::Subsample(std::span<const Closer> samples, float bias, ContributionCounts &counts) const {
    if (samples.empty() || samples.front().sample->count >= levels_)
        return;
    const PartPlaces at = PlacesOfParts(samples, bias);
    Boundsf box;
    for (std::size_t i = 0; i < samples.size() * kParts; ++i)
        box.Add(at[i]);
    const BspRegion space = in_->space.Whole().Around(box);
    std::array<Sample, kPacketSize> parts;
    std::array<std::size_t, kMostCloser + 1> first{}; // part of each sample
    SurfaceReceiverBatch receivers;
    receivers.twoSided = lightmap_->twoSided;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const Vec3f normal = lightmap_->normals[lightmap_->SuperIndex(samples[k].x, samples[k].y)];
        for (std::size_t i = k * kParts; i < (k + 1) * kParts; ++i) {
            int cluster = 0;
            if (!PlaceInOpen(space, at[i], cluster))
                continue;
            parts[receivers.count].place = at[i];
            parts[receivers.count].count = samples[k].sample->count + 1;
            receivers.Add(at[i], normal, cluster);
        }
        first[k + 1] = receivers.count;
    }
    if (receivers.count == 0)
        return;
    LuxelIncidentLight incident;
    if (LuxelContribution(*light_, pass_, in_->scene, receivers, incident, counts))
        for (std::size_t i = 0; i < receivers.count; ++i) {
            parts[i].color = incident.color[i];
            parts[i].direction = incident.direction[i];
            parts[i].lit = incident.lit[i] != 0, parts[i].forced = incident.forced[i] != 0;
        }
    for (std::size_t k = 0; k < samples.size(); ++k)
        TakeParts(samples[k], std::span(parts).subspan(first[k], first[k + 1] - first[k]), bias, counts);
}

/// A sample becomes the mean of itself and its parts, which are looked at in their turn where the light reaches some of
/// them only.
void LuxelSampler::TakeParts(const Closer &whole, std::span<Sample> parts, float bias,
                             ContributionCounts &counts) const {
    if (parts.empty())
        return;
    Vec3f total;
    std::size_t mapped = parts.size(), lit = 0;
    for (const Sample &part : parts) {
        total += part.color;
        lit += part.lit ? 1 : 0;
        if (part.forced)
            lit += 1, mapped += 2;
    }
    if (MaxComponent(total) > kBrightStamp && lit != 0 && lit != mapped) {
        std::array<Closer, kParts> closer;
        for (std::size_t i = 0; i < parts.size(); ++i)
            closer[i] = {whole.x, whole.y, &parts[i]};
        Subsample({closer.data(), parts.size()}, bias / 2, counts);
    }
    Sample &sample = *whole.sample;
    for (const Sample &part : parts)
        sample.color += part.color, sample.direction += part.direction;
    const float share = 1.0f / float(1 + parts.size());
    sample.color *= share, sample.direction *= share;
    ++sample.count;
}

LuxelSampler::Sample LuxelSampler::RandomSamples(int x, int y, ContributionCounts &counts) const {
    const std::size_t luxel = lightmap_->SuperIndex(x, y);
    const float sigma = 0.5f * box_;
    Sample mean;
    int used = 0;
    for (int first = 0; first < random_; first += int(kPacketSize)) {
        SurfaceReceiverBatch receivers;
        receivers.twoSided = lightmap_->twoSided;
        for (int i = first; i < std::min(random_, first + int(kPacketSize)); ++i) {
            // Offsets whose density falls off as a normal distribution of that width does, but with an end.
            const Sample2 s = PlasticSample(std::uint32_t(i), kSeedSamples + luxel);
            const double angle = s.u * 2 * std::numbers::pi;
            const double length = double(sigma) * 2.738612787525831 * (1 - std::sqrt(1 - std::sqrt(s.v)));
            const Vec3f place = lightmap_->positions[luxel] +
                                Offset(x, y, float(std::cos(angle) * length), float(std::sin(angle) * length));
            int cluster = 0;
            if (PlaceInOpen(in_->space.Whole(), place, cluster))
                receivers.Add(place, lightmap_->normals[luxel], cluster);
        }
        used += int(receivers.count);
        LuxelIncidentLight incident;
        if (receivers.count == 0 || !LuxelContribution(*light_, pass_, in_->scene, receivers, incident, counts))
            continue;
        for (std::size_t i = 0; i < receivers.count; ++i)
            mean.color += incident.color[i], mean.direction += incident.direction[i];
    }
    if (used == 0)
        return ReadLuxel(luxel);
    mean.color *= 1.0f / float(used), mean.direction *= 1.0f / float(used);
    return mean;
}

} // namespace q3
