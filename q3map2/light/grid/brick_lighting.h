// GPL-2.0-or-later. Incident light of all lights at a brick of receivers in the open.
#pragma once

#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/transfer/light_contribution.h"

#include <vector>

namespace q3 {

/// Iterates over the lights that may reach a brick, by the rules of the SH grid. Const after construction; safe from
/// several threads. Keeps references.
class BrickLighting {
  public:
    /// lights: from SetupEnvelopes for the SH grid. radiance: as LightSettings::radiance. split: lights have a weak and
    /// a strong part, which can be traced apart.
    BrickLighting(const GridInputs &in, const std::vector<Light> &lights, bool radiance, bool split)
        : in_(in), lights_(lights), settings_{.pass = LightPass::GridSH,
                                              .sunOnly = in.options.sunOnly,
                                              .radiance = radiance,
                                              .samples = in.options.shSamples,
                                              .skip = in.options.skip},
          faint_(kFaint / in.options.shSamples) {
        if (split)
            settings_.weakBelow =
                std::max(kWeakBelow / (in.options.gridScale > 0 ? in.options.gridScale : 1), 2 * faint_);
    }
    /// Calls use(light, incident) for each light that may reach the blocks of a brick. incident: its light at the
    /// receivers, by block. seed: of the random choice among faint lights, which is the same for all blocks. part:
    /// other than Whole only if lights are split.
    template <typename Use>
    void Trace(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, LightPart part, GridStats &work,
               const Use &use) const {
        StartFaintResiduals(blocks, faint_);
        std::vector<ProbeIncidentLight> incident(blocks.size());
        const float least = part == LightPart::Strong ? settings_.weakBelow / 2 : -1;
        const BrickLights candidates(lights_, BrickView(blocks), {seed, faint_, least}, in_.options.skip, work);
        LightSettings pass = settings_;
        pass.faint = candidates.Many() ? faint_ : 0;
        pass.part = part;
        for (const BrickLight &one : candidates.List()) {
            LightContributionToPoint(*one.light, one.weight, pass, in_.scene, blocks, incident, work.counts);
            use(one, incident);
        }
    }

  private:
    /// Lights that give less than this at every point of a brick, and area lights that give less at every point of a
    /// block, are represented by a random few. Byte scale: a quarter of the smallest step that a screen can show.
    static constexpr float kFaint = 1.0f / 4;

    /// LightSettings::weakBelow before grid scale. Higher, more light is interpolated; lower, the weak light is smooth
    /// at more points. Byte scale.
    static constexpr float kWeakBelow = 8;

    const GridInputs &in_;
    BrickCandidates lights_;
    LightSettings settings_;
    float faint_; ///< see SelectFaintLight
};

} // namespace q3
