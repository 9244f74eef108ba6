// GPL-2.0-or-later. -samples: adaptive supersampling of luxels at shadow edges.
#pragma once

#include "q3map2/lightmap/direct/luxel_contribution.h"
#include "q3map2/lightmap/raw/luxel_position.h"

#include <algorithm>
#include <optional>

namespace q3 {

/// Adaptive supersampling (-samples, -randomsamples): where a source lights some luxels of a 2 x 2 cell but not all,
/// each luxel of the cell takes 4 more samples around it, which are refined likewise.
class LuxelSampler {
  public:
    /// To be called before the first light of a lightmap. Keeps references until the next Start.
    void Start(const SurfaceInputs &in, const RawLightmap &lightmap, const LuxelBlocks &blocks, const LuxelPass &pass);
    /// To be called before each light.
    void StartLight(const LightGroup &group);
    /// Sets the light of the source at a block, one sample per luxel.
    void SetBlock(std::size_t block, const LuxelIncidentLight &incident, const ChannelLanes &channels);
    /// Supersamples the cells that are partly lit, and adds the change of their luxels to `sum`.
    void Refine(LuxelSum &sum, ContributionCounts &counts);

    /// A place at which a luxel takes a sample, if the samples around it differ.
    struct SamplePlace {
        Vec3f position;
        int cluster = kSolidCluster; ///< kSolidCluster: in a solid, or on the other side of a wall; not used
    };
    static constexpr std::size_t kSubsamples = 4;
    /// The first samples of a mapped super luxel beside that at its position; none without -samples. After Start.
    std::vector<SamplePlace> FirstSamples(int x, int y) const;

  private:
    struct Sample {
        Vec3f position;
        Vec3f color, direction;
        std::array<Vec3f, kMaxChannels> channels{};
        int depth = 1;         ///< 1 for the sample of a luxel, one more for each level of subsamples; at most -samples
        bool lit = false;      ///< light arrives
        bool filtered = false; ///< light arrives by a shadow ray that met a transparent surface
    };
    /// A sample of luxel (x, y) that is refined.
    struct Refinement {
        int x = 0, y = 0;
        Sample *sample = nullptr;
    };
    /// Subsamples of a sample. The four luxels of a cell are refined together: their subsamples fill a packet of rays.
    static constexpr std::size_t kMaxRefinements = kPacketSize / kSubsamples;
    using SubsamplePositions = std::array<Vec3f, kPacketSize>;
    bool Mapped(int x, int y) const;
    Vec3f NeighborStep(int x, int y, int dx, int dy) const;
    Vec3f Offset(int x, int y, float across, float down) const;
    bool FindOpenCluster(std::size_t luxel, const Vec3f &position, int &cluster) const;
    SubsamplePositions PositionsOfSubsamples(std::span<const Refinement> samples, float offset) const;
    void RefineCell(int x, int y, LuxelSum &sum, ContributionCounts &counts);
    void ReplaceLuxel(std::size_t luxel, const Sample &after, LuxelSum &sum);
    Sample ReadLuxel(std::size_t luxel) const;
    void Subsample(std::span<const Refinement> samples, float offset, ContributionCounts &counts) const;
    bool Contribution(SurfaceReceiverBatch &receivers, std::span<const std::size_t> luxels, std::span<Sample> samples,
                      ContributionCounts &counts) const;
    void Accumulate(const Sample &one, Sample &sum) const;
    void Scale(float factor, Sample &sample) const;
    void AverageSubsamples(const Refinement &whole, std::span<Sample> subsamples, float offset,
                           ContributionCounts &counts) const;
    Sample RandomSamples(int x, int y, ContributionCounts &counts) const;
    bool RowIsPartlyLit(int y) const;
    void Touch(std::size_t luxel) {
        firstTouched_ = std::min(firstTouched_, luxel), lastTouched_ = std::max(lastTouched_, luxel);
    }

    const SurfaceInputs *in_ = nullptr;
    const RawLightmap *lightmap_ = nullptr;
    const LuxelBlocks *blocks_ = nullptr;
    const LightGroup *group_ = nullptr;
    LuxelPass pass_;
    int width_ = 0, height_ = 0;
    int maxDepth_ = 1;                               ///< of subsamples: -samples; 1: none
    int randomSamples_ = 0;                          ///< samples of a refined luxel under -randomsamples; else 0
    float offsetScale_ = 1;                          ///< factor of the offsets of samples: -samplessearchboxsize
    mutable std::optional<VisibleClusters> allowed_; ///< clusters that may hold samples
    std::vector<std::uint8_t> mappedInCell_;         ///< mapped luxels of the cell with this upper left luxel
    std::vector<std::uint8_t> hitFlags_, refined_;   ///< by luxel; hitFlags_: 1 if lit, plus kTransparentHit
    std::vector<std::uint32_t> refinedList_;
    std::size_t firstTouched_ = 0, lastTouched_ = 0; ///< range of luxels that the light has set; first > last: none
    std::vector<LuxelIncidentLight> incident_;       ///< by block; valid for luxels whose hitFlags_ are not 0
    std::vector<ChannelLanes> channels_;             ///< of incident_; empty without channels
};

} // namespace q3
