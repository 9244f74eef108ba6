// GPL-2.0-or-later. Light at any position in the open, with weak light interpolated where it is smooth.
#pragma once

#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/grid/weak_field.h"

#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// A position in the open that is to be lit.
struct ProbeReceiver {
    Vec3f position;
    int cluster = 0;
    std::uint32_t seed = 0; ///< of its sample patterns
};

/// Lights positions with strong light traced and weak light interpolated, or all traced where that is not smooth. Const
/// after construction; safe from several threads. Keeps its arguments.
class SmoothLight {
  public:
    /// weak: of a grid around the positions, complete; null: all light is traced everywhere.
    SmoothLight(const ProbeIntegrator &integrator, const WeakField *weak) : integrator_(integrator), weak_(weak) {}

    /// Light at receivers that are near to each other, as in a brick. seed: see ProbeIntegrator::Trace.
    std::vector<bspGridPointSH_t> At(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                     GridStats &work) const;
    /// The parts of At where weak light is interpolated. Traces the weak light that is not known.
    void AddWeak(std::span<const ProbeReceiver> receivers, std::uint64_t seed, std::span<std::optional<WeakLight>> weak,
                 GridStats &work) const;
    /// Adds the strong light to known weak light.
    std::vector<bspGridPointSH_t> AddStrong(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                            std::span<const std::optional<WeakLight>> weak, GridStats &work) const;
    const WeakField *Weak() const { return weak_; }

  private:
    const ProbeIntegrator &integrator_;
    const WeakField *weak_;
};

} // namespace q3
