// GPL-2.0-or-later. Keys of units of light: the hash of receivers, of the lights that may reach them, and of what each
// of these gives.
#pragma once

#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/units/unit_store.h"

#include <span>
#include <vector>

namespace q3 {

/// Hashes of lights from SetupEnvelopes: of everything that the light at a receiver depends on, except the clusters
/// that see the light, and without names and numbers.
class LightHashes {
  public:
    /// Keeps a reference to the lights. units: null or of another purpose than a cache: computes nothing.
    LightHashes(const std::vector<Light> &lights, const UnitStore *units);
    /// Only for a cache.
    const Hash128 &Of(const Light &light) const { return hashes_[std::size_t(&light - lights_.data())]; }

  private:
    const std::vector<Light> &lights_;
    std::vector<Hash128> hashes_; ///< by light
};

/// The hash of lights in their order, with or without SetupEnvelopes.
Hash128 HashOfLights(const std::vector<Light> &lights);

/// Makes the key of a unit of light for a cache: of its receivers and of each light that may reach them. Numbers of
/// clusters do not count, since they depend on the whole map, but which receivers may see which light.
class LightUnitKey {
  public:
    /// kind: of unit.
    LightUnitKey(std::string_view kind, const LightHashes &hashes, const UnitStore &units)
        : key_(kind), hashes_(hashes), units_(units) {}

    /// Adds the receivers. To be called once, before the lights.
    template <typename Batch> void AddReceivers(std::span<const Batch> batches) {
        for (const Batch &batch : batches) {
            key_.Add(std::uint64_t(batch.count));
            AddLanes(batch.position, batch.count);
            for (std::size_t i = 0; i < batch.count; ++i)
                box_.Add(batch.position[i]);
            if constexpr (std::is_same_v<Batch, SurfaceReceiverBatch>) {
                AddLanes(batch.normal, batch.count);
                key_.Add(batch.twoSided);
            } else {
                AddLanes(batch.rayOrigin, batch.count);
                for (std::size_t i = 0; i < batch.count; ++i)
                    key_.Add(batch.index[i]), box_.Add(batch.rayOrigin[i]);
            }
            clusters_.push_back(batch.clusters);
        }
    }
    /// Adds a light. Lights must come in the order in which they are traced. weight: a factor of its light.
    void AddLight(const Light &light, float weight = 1);
    KeyBuilder &More() { return key_; }

    Hash128 Key() const { return key_.Key(); }
    /// Whether something that may block light on its way to the unit has changed since the run before.
    bool IsTouched() const { return isTouched_; }

  private:
    void AddLanes(const Lanes3 &lanes, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f v = lanes[i];
            key_.Add(v.x, v.y, v.z);
        }
    }

    KeyBuilder key_;
    const LightHashes &hashes_;
    const UnitStore &units_;
    Boundsf box_;                        ///< of receivers and of where their rays start
    std::vector<LaneClusters> clusters_; ///< by batch
    int group_ = -2;                     ///< of the light before
    bool isTouched_ = false;
};

/// Whether the convex hull of two boxes meets a third.
bool HullMeets(const Boundsf &a, const Boundsf &b, const Boundsf &box);

} // namespace q3
