// GPL-2.0-or-later. Passes over light grids by bricks: neighboring points share a list of lights and packets of rays.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sources/light_units.h"
#include "q3map2/light/transfer/light_contribution.h"
#include "q3map2/light/transfer/light_kernel.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace q3 {

/// Bounced light that arrives at a point from one direction.
struct IndirectRay {
    Vec3f direction; ///< unit, to the surface that reflects it
    Vec3f light;     ///< on a surface with normal `direction`, byte scale
};

/// Bounced light at points in the open. Const after construction; safe from several threads.
class IndirectLight {
  public:
    virtual ~IndirectLight() = default;
    /// Number of rays that gather light at a point, without shadow rays to bright emitters.
    virtual int RaysPerPoint() const = 0;
    /// Sets `rays` to directional lights that together give the bounced light at the point; `seed` rotates the pattern
    /// of directions.
    virtual void Gather(const Vec3f &point, std::uint64_t seed, std::vector<IndirectRay> &rays) const = 0;
};

/// Bounced light of a style other than 0.
struct StyledIndirect {
    std::uint8_t style = 0;
    std::unique_ptr<IndirectLight> light;
};

/// Directions of the rays of FloodFraction in the hemisphere around +z, at four elevations; half as many if lowQuality.
std::vector<Vec3f> FloodDirections(bool lowQuality);
/// Fraction of the hemisphere around +z or -z (up: +1 or -1) that is open within `distance`, 0 to 1: the mean over rays
/// of min(1, free length / distance).
float FloodFraction(const LightScene &scene, const Vec3f &p, float up, float distance,
                    std::span<const Vec3f> directions, RayCounts &counts);

/// Everything that a grid pass reads.
struct GridInputs {
    const BspSpace &space;
    const LightScene &scene;
    const LightOptions &options;
    const WorldLight &world;
    const JobPool &jobs;
    Log &log;
    const IndirectLight *indirect = nullptr;  ///< bounced light of style 0, or null
    std::span<const StyledIndirect> styled{}; ///< bounced light of other styles: legacy grid only
    UnitStore *units = nullptr;               ///< results that need not be computed; null: none
    /// For FloodFraction.
    std::vector<Vec3f> floodDirections = FloodDirections(options.lowQuality);
};

/// Counts of points and of the work to light them.
struct GridStats {
    std::int64_t points = 0;             ///< of the grid; ambient cubes: places
    std::int64_t open = 0;               ///< lit in place or a small step beside; legacy grid: all points that are lit
    std::int64_t moved = 0;              ///< in a solid, lit from the nearest point in the open
    std::int64_t filled = 0;             ///< in a solid, interpolated from lit neighbors
    std::uint64_t skippedFaint = 0;      ///< brick and light pairs left out: too faint to matter
    std::uint64_t skippedReach = 0;      ///< brick and light pairs out of reach
    std::uint64_t skippedPvs = 0;        ///< brick and light pairs hidden by visibility data
    std::uint64_t skippedSmooth = 0;     ///< points and samples whose weak light is interpolated
    std::map<int, std::int64_t> dropped; ///< legacy grid: points that have no slot left for a style, by style
    ContributionCounts counts;
    double seconds = 0; ///< of passes, by the clock
    /// Adds all counts and seconds.
    void Add(const GridStats &o);
    void Print(Log &log) const;
};

// ---- Bricks: the receivers that share a list of lights, the lights that reach them, and their light ----

/// A grid point of a brick.
struct BrickPoint {
    Vec3f position;
    std::uint32_t index = 0; ///< of the grid point
};

/// Divides a grid into bricks of 8 x 8 x 4 points, or of another multiple of a block, 4 x 2 x 2 points. Keeps a
/// reference to the layout.
class GridBricks {
  public:
    explicit GridBricks(const GridLayout &layout, const Int3 &brick = {8, 8, 4});
    std::int64_t Count() const { return count_; }
    /// Points of a brick, in blocks of 4 x 2 x 2, so that consecutive points are neighbors.
    std::vector<BrickPoint> Points(std::int64_t brick) const;
    /// Bricks along each axis.
    const Int3 &Bricks() const { return bricks_; }
    /// The number of the brick with these coordinates among bricks, and of the brick of a point.
    std::size_t Number(const Int3 &at) const {
        return (std::size_t(at[2]) * std::size_t(bricks_[1]) + std::size_t(at[1])) * std::size_t(bricks_[0]) +
               std::size_t(at[0]);
    }
    std::size_t NumberOfPoint(const Int3 &point) const {
        return Number({point[0] / brick_[0], point[1] / brick_[1], point[2] / brick_[2]});
    }

  private:
    const GridLayout &layout_;
    Int3 brick_, bricks_{};
    std::int64_t count_ = 0;
};

/// Bounds and clusters of the receivers of a brick.
struct BrickExtent {
    explicit BrickExtent(std::span<const ReceiverBatch> blocks);
    Boundsf box;
    std::vector<int> clusters; ///< each once
};

/// All lights of a pass. The data that decide whether a light can reach a brick (Reach) are contiguous, for the CPU
/// cache.
class PassLights {
  public:
    explicit PassLights(const std::vector<Light> &lights);
    const LightsByCluster &ByCluster() const { return byCluster_; }
    const std::vector<Light> &Lights() const { return byCluster_.Lights(); }
    /// Copies of the members of Light that decide it.
    struct Reach {
        Boundsf bounds;
        Vec3f origin, normal;
        float envelope = 0, dist = 0;
        bool sun = false, oneSided = false;
    };
    const Reach &ReachOf(std::size_t light) const { return reach_[light]; }

  private:
    LightsByCluster byCluster_;
    std::vector<Reach> reach_;
};

/// A light that may reach a brick, with its weight: 1, or more if it represents faint lights (SelectFaintLight).
struct WeightedLight {
    const Light *light = nullptr;
    float weight = 1; ///< factor of its light
    float bound = 0;  ///< LightBound in the brick, byte scale
};

/// The lights that can reach some point of a brick, in the order of the pass.
///
/// If many lights have a bound in the brick below `faint` (byte scale; 0: none), a few represent them, see
/// SelectFaintLight. Lights of one surface are consecutive, so a chosen one stands for its neighbors.
class LightsInReach {
  public:
    struct Choice {
        std::uint64_t seed = 0; ///< of the random choice among faint lights
        float faint = 0;        ///< byte scale; 0: none
        float minBound = -1;    ///< lights whose bound is not above this are left out. Byte scale
    };
    LightsInReach(const PassLights &lights, const BrickExtent &brick, const Choice &choice, const SkipOptions &skip,
                  GridStats &work);
    const std::vector<WeightedLight> &List() const { return list_; }
    /// Whether there were so many faint lights that a few represent them.
    bool HasManyFaint() const { return hasManyFaint_; }

  private:
    std::vector<WeightedLight> list_;
    bool hasManyFaint_ = false;
};

/// Sets ReceiverBatch::faintResidual of each block to a random start value, so that blocks do not all choose the same
/// lights.
void StartFaintResiduals(std::vector<ReceiverBatch> &blocks, float faint);

/// Sees the light of each source as it arrives at the receivers of a brick. From the thread that traces the brick.
class LightObserver {
  public:
    virtual ~LightObserver() = default;
    /// incident: by block.
    virtual void See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
                     std::span<const ProbeIncidentLight> incident) = 0;
};

enum class ShowProgress { No, Yes };

/// Runs `trace(brick, work)` for bricks 0 to count - 1 on all workers, with progress in the log if asked; adds the sum
/// of `work` to `stats`. Here a brick is any set of receivers that share a list of lights.
void RunBricks(const GridInputs &in, std::int64_t count, GridStats &stats,
               const std::function<void(std::int64_t, GridStats &)> &trace, ShowProgress show = ShowProgress::Yes);

/// What SH coefficients hold: radiance, or irradiance, which is radiance convolved with the cosine lobe.
enum class SHQuantity { Radiance, Irradiance };
/// Whether each light is one, or has a weak and a strong part that can be traced apart; see LightPart.
enum class LightSplit { None, WeakAndStrong };

/// Traces the incident light of all lights at the receivers of bricks, light by light, by the rules of the SH grid.
/// Const after construction; safe from several threads. Keeps references.
class IncidentLightTracer {
  public:
    /// lights: from SetupEnvelopes for the SH grid.
    IncidentLightTracer(const GridInputs &in, const std::vector<Light> &lights, SHQuantity quantity, LightSplit split)
        : in_(in), lights_(lights), hashes_(lights, in.units), settings_(SettingsOf(in.options, quantity)),
          faint_(kFaint / in.options.shSamples) {
        // A faint light must not have a strong part: weakBelow is at least twice the faint limit.
        if (split == LightSplit::WeakAndStrong)
            settings_.weakBelow = std::max(kWeakBelow / in.options.PositiveGridScale(), 2 * faint_);
    }
    /// Settings of the pass for lights that are traced as a whole.
    static LightSettings SettingsOf(const LightOptions &options, SHQuantity quantity) {
        return {.pass = LightPass::GridSH,
                .sunOnly = options.sunOnly,
                .radiance = quantity == SHQuantity::Radiance,
                .samples = options.shSamples,
                .skip = options.skip};
    }
    /// Calls use(light, incident) for each light that may reach the blocks of a brick. incident: its light at the
    /// receivers, by block. seed: of the random choice among faint lights, which is the same for all blocks. part:
    /// other than Whole only if lights are split.
    template <typename Use>
    void Trace(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, LightPart part, GridStats &work,
               const Use &use) const {
        const BrickExtent extent(blocks);
        Trace(blocks, InReach(extent, seed, part, work), part, work, use);
    }
    /// The lights that Trace goes through, for the other Trace.
    LightsInReach InReach(const BrickExtent &extent, std::uint64_t seed, LightPart part, GridStats &work) const {
        // A light has a strong part where it gives more than half of weakBelow.
        const float least = part == LightPart::Strong ? settings_.weakBelow / 2 : -1;
        return {lights_, extent, {seed, faint_, least}, in_.options.skip, work};
    }
    const LightHashes &Hashes() const { return hashes_; }
    template <typename Use>
    void Trace(std::vector<ReceiverBatch> &blocks, const LightsInReach &lights, LightPart part, GridStats &work,
               const Use &use) const {
        StartFaintResiduals(blocks, faint_);
        std::vector<ProbeIncidentLight> incident(blocks.size());
        LightSettings pass = settings_;
        pass.faint = lights.HasManyFaint() ? faint_ : 0;
        pass.part = part;
        LightSettings whole = pass;
        whole.faint = 0, whole.part = LightPart::Whole;
        for (const WeightedLight &one : lights.List()) {
            const bool isStyled = one.light->style != 0; // it changes in the game, so it is never a part of others
            if (isStyled && part == LightPart::Weak)
                continue;
            LightContributionToPoint(*one.light, one.weight, isStyled ? whole : pass, in_.scene, blocks, incident,
                                     work.counts);
            use(one, incident);
        }
    }

  private:
    /// Lights that give less than kFaint / shSamples at every point of a brick, and area lights that give less at every
    /// point of a block, are represented by a random few; more samples ask for less noise. Byte scale: a quarter of the
    /// smallest step that a screen can show.
    static constexpr float kFaint = 1.0f / 4;

    /// LightSettings::weakBelow before grid scale. A higher value leaves more light to interpolation, and makes the
    /// weak light smooth at fewer points. Byte scale.
    static constexpr float kWeakBelow = 8;

    const GridInputs &in_;
    PassLights lights_;
    LightHashes hashes_; ///< for keys of units
    LightSettings settings_;
    float faint_; ///< see SelectFaintLight
};

} // namespace q3
