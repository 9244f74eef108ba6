// GPL-2.0-or-later. Where lamps may be: places whose light would explain much of what is not explained yet.
#pragma once

#include "common/log.h"
#include "q3map2/recover/lamp_fit.h"

#include <optional>
#include <vector>

namespace q3 {

/// Candidates for lamps: a lattice in the open, places where the directions of grid points meet, and places in front
/// of surfaces that are lighter than explained. The first two are traced once.
class LampCandidates {
  public:
    /// Keeps references.
    LampCandidates(const ObservedMap &map, const LightSetup &setup, const LampTracer &tracer, const JobPool &jobs,
                   Log &log);

    /// Up to `most` lamps that lower the error of the fit most, at least kApart from each other, the best first. Each
    /// lowers it by more than leastGain times the noise where it shines.
    std::vector<Lamp> Best(const LampFit &fit, std::size_t most, double leastGain) const;

  private:
    struct Candidate {
        Vec3f origin;
        LampColumn column;
    };
    /// The best lamp at a candidate, and by how much it lowers the error.
    struct Gain {
        double gain = 0, noise = 1;
        Lamp lamp;
        const Candidate *at = nullptr;
    };
    std::vector<Candidate> Lattice() const;
    std::vector<Candidate> Crossings() const;
    std::vector<Candidate> InFrontOfPeaks(const LampFit &fit) const;
    void Trace(std::vector<Candidate> &candidates) const;
    void AddGains(const LampFit &fit, const std::vector<Candidate> &candidates, std::vector<Gain> &gains) const;

    const ObservedMap &map_;
    const LightSetup &setup_;
    const LampTracer &tracer_;
    const JobPool &jobs_;
    std::size_t every_;            ///< of LampTracer::Trace
    std::vector<Candidate> fixed_; ///< lattice and crossings
};

/// The part of a lamp's light that a place sees, and what is there.
struct ConeSample {
    Vec3f direction; ///< from the lamp to the place; unit vector
    float light;     ///< for intensity 1
    float weight;
    Vec3f residual; ///< without the lamp
};
/// A cone that holds the places which a lamp explains best.
struct ConeGuess {
    LampCone cone;
    double gain = 0;      ///< by how much a lamp with the cone lowers the error
    double gainOfAll = 0; ///< the same without
    Vec3f intensity;      ///< of the lamp with the cone
};
/// What a lamp at `origin` gives to a place; residual: of that place without the lamp.
ConeSample ConeSampleOf(const Vec3f &origin, const ObservedMap &map, const LampFit &fit, const LampEntry &entry,
                        const Vec3f &residual);
/// The best cone, of half angles under 80 degrees, of those in which the lamp explains nearly all light that is left;
/// nothing if there is none.
std::optional<ConeGuess> GuessCone(std::vector<ConeSample> samples);

} // namespace q3
