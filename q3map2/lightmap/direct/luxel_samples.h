// GPL-2.0-or-later. -samples: adaptive supersampling of luxels at shadow edges.
#pragma once

#include "q3map2/lightmap/direct/luxel_contribution.h"
#include "q3map2/lightmap/raw/luxel_place.h"
#include <algorithm>
#include <optional>

namespace q3 {

/// Adaptive subsampling (-samples, -randomsamples): where one light lights some luxels of a stamp of 2 x 2 but not all,
/// more receivers are looked at around each.
class LuxelSampler {
  public:
    /// Before the first light of a lightmap. `blocks` must outlive the lights.
    void Start(const SurfaceInputs &in, const RawLightmap &lightmap, const LuxelBlocks &blocks, const LuxelPass &pass);
    /// Before each light.
    void StartLight(const Light &light);
    /// What the light gives to a block.
    void Put(std::size_t block, const LuxelIncidentLight &incident);
    /// Looks closer and adds what changes to `sum`.
    void Refine(LuxelSum &sum, ContributionCounts &counts);

  private:
    struct Sample {
        Vec3f place;
        Vec3f color, direction;
        int count = 1;
        bool lit = false, forced = false;
    };
    /// A sample of luxel (x, y) to look at more closely.
    struct Closer {
        int x = 0, y = 0;
        Sample *sample = nullptr;
    };
    /// Of each sample; as many samples as fill a packet with theirs are looked at together.
    static constexpr std::size_t kParts = 4, kMostCloser = kPacketSize / kParts;
    using PartPlaces = std::array<Vec3f, kPacketSize>;
    bool Mapped(int x, int y) const;
    Vec3f Step(int x, int y, int dx, int dy) const;
    Vec3f Offset(int x, int y, float across, float down) const;
    bool PlaceInOpen(const BspRegion &space, const Vec3f &place, int &cluster) const;
    PartPlaces PlacesOfParts(std::span<const Closer> samples, float bias) const;
    void RefineStamp(int x, int y, LuxelSum &sum, ContributionCounts &counts);
    void SetLuxel(std::size_t luxel, const Sample &after, LuxelSum &sum);
    Sample ReadLuxel(std::size_t luxel) const;
    void Subsample(std::span<const Closer> samples, float bias, ContributionCounts &counts) const;
    void TakeParts(const Closer &whole, std::span<Sample> parts, float bias, ContributionCounts &counts) const;
    Sample RandomSamples(int x, int y, ContributionCounts &counts) const;
    bool RowIsMixed(int y) const;
    void Touch(std::size_t luxel) { first_ = std::min(first_, luxel), last_ = std::max(last_, luxel); }

    const SurfaceInputs *in_ = nullptr;
    const RawLightmap *lightmap_ = nullptr;
    const LuxelBlocks *blocks_ = nullptr;
    const Light *light_ = nullptr;
    LuxelPass pass_;
    int width_ = 0, height_ = 0, levels_ = 1, random_ = 0;
    float box_ = 1;
    mutable std::optional<ClusterFilter> allowed_; ///< where samples may lie
    std::vector<std::uint8_t> mappedStamp_;        ///< mapped luxels of the stamp from each luxel on
    std::vector<std::uint8_t> lit_, done_;         ///< by luxel
    std::vector<std::uint32_t> doneList_;
    std::size_t first_ = 0, last_ = 0;         ///< of the luxels that the light has set; first_ > last_: none
    std::vector<LuxelIncidentLight> incident_; ///< by block; only where lit_ says so
};

} // namespace q3
