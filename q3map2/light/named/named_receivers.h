// GPL-2.0-or-later. Receivers of a grid that names lights: all light that arrives there, and the share of each light.
#pragma once

#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/named/light_table.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// A light of the table at a receiver.
struct LightHere {
    std::uint32_t light = 0;
    float share = 0; ///< visible share, 0 to 1
    Vec3f vector;    ///< unshadowed irradiance vector: LightTable::RoughVector

    /// Squared unshadowed irradiance on a surface that faces the light.
    float Squared() const { return Dot(vector, vector); }
};

/// A light with less unshadowed irradiance at a receiver is ignored there: half a byte. 1 = byte 255.
inline constexpr float kFaintest = 0.5f / 255;

/// A receiver in the open, with its light.
struct NamedReceiver {
    Vec3f at;       ///< in smallest cells of the lattice
    Vec3f position; ///< game units
    int cluster = 0;
    SHFloats light{}; ///< all light of style 0, convolved with the cosine; 1 = byte 255
    /// Those traced here and not faint, by number. The others are hidden, faint, or out of reach.
    std::vector<LightHere> lights;
    bool isOnLight = false; ///< as LightCollector::IsOnLight says

    /// The entry of a light in `lights`; null if there is none.
    const LightHere *Find(std::uint32_t number) const;
    /// A light at this receiver. Its share is 0 if it was not traced because the PVS hides it or because it is faint
    /// (kFaintest). Nothing if it was not traced for another reason: then its share is unknown.
    std::optional<LightHere> At(std::uint32_t number, const LightTable &table) const;
};

/// Collects the visible shares of the lights at receivers while they are traced. A receiver has the number block *
/// kPacketSize + lane (InBlocks), or the index of its grid point (ByIndex).
class LightCollector : public LightObserver {
  public:
    enum class Number { InBlocks, ByIndex };
    /// receivers: how many there are. ByIndex allows several threads, since each grid point is in one brick.
    LightCollector(const LightTable &table, std::size_t receivers, Number number)
        : table_(table), number_(number), sums_(receivers) {}
    void See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
             std::span<const ProbeIncidentLight> incident) override;
    /// The lights of a receiver, without faint ones. position: of the receiver.
    std::vector<LightHere> Of(std::size_t receiver, const Vec3f &position) const;
    /// Whether a receiver is on a light: its light says nothing of that around it.
    bool IsOnLight(std::size_t receiver, const Vec3f &position) const;

  private:
    /// Sums over the pieces of a light: strength without shadows, and the part of it that arrives. Byte scale.
    struct Sum {
        std::uint32_t light;
        float unshadowed, arrived;
    };
    /// unshadowed, visible: see ProbeIncidentLight.
    void Add(std::uint32_t light, std::size_t receiver, float unshadowed, float visible);

    const LightTable &table_;
    Number number_;
    std::vector<std::vector<Sum>> sums_; ///< by receiver
};

} // namespace q3
