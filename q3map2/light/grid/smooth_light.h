// GPL-2.0-or-later. Light at any position in the open: strong light traced, weak light interpolated where it is smooth.
#pragma once

#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/grid/weak_field.h"

#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// A position in the open whose light is wanted.
struct ProbeReceiver {
    Vec3f position;
    int cluster = 0;
    std::uint32_t seed = 0; ///< of its sample patterns
};

/// Computes light at positions: strong light is traced, weak light interpolated in a WeakField, or traced where that
/// has none. Const after construction; safe from several threads. Keeps references.
class SmoothLight {
  public:
    /// weak: of a grid around the positions, complete; null: all light is traced.
    SmoothLight(const ProbeIntegrator &integrator, const WeakField *weak) : integrator_(integrator), weak_(weak) {}

    /// Light at receivers that are near to each other, as in a brick. seed: see ProbeIntegrator::Trace.
    std::vector<bspGridPointSH_t> At(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                     GridStats &work) const;
    /// The two steps of At, for callers that know some of the weak light. The first traces the weak light of receivers
    /// for which `weak` has nothing. Only with weak light.
    void AddWeak(std::span<const ProbeReceiver> receivers, std::uint64_t seed, std::span<std::optional<WeakLight>> weak,
                 GridStats &work) const;
    /// The second traces the strong light and adds the weak light, which must be there for all receivers.
    std::vector<bspGridPointSH_t> AddStrong(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                            std::span<const std::optional<WeakLight>> weak, GridStats &work) const;
    const WeakField *Weak() const { return weak_; }

  private:
    const ProbeIntegrator &integrator_;
    const WeakField *weak_;
};

} // namespace q3
