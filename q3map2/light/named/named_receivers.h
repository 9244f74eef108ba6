// GPL-2.0-or-later. Receivers of a grid that names lights: what arrives there of all light, and of each light apart.
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
    Vec3f vector;    ///< irradiance vector without shadows, of the brightest channel; 1 = byte 255

    /// Squared irradiance on a surface that faces it.
    float Squared() const { return Dot(vector, vector); }
};

/// Lights that give less than this are not considered. 1 = byte 255.
inline constexpr float kFaintest = 0.5f / 255;

/// A receiver in the open.
struct NamedReceiver {
    Vec3f at;       ///< in smallest cells of the lattice
    Vec3f position; ///< game units
    int cluster = 0;
    SHFloats light{};              ///< all light of style 0, convolved with the cosine
    std::vector<LightHere> lights; ///< lights that were traced there; others are hidden, faint, or out of reach

    /// The entry of a light in `lights`; null: none.
    const LightHere *Find(std::uint32_t light) const;
    /// A light here; nothing if its share is not known. Lights that visibility data hide, and faint ones, have share 0.
    std::optional<LightHere> At(std::uint32_t light, const LightTable &table) const;
};

/// Collects the lights of receivers, which are numbered as those of all blocks of a brick, or by the index of their
/// grid point.
class LightCollector : public LightObserver {
  public:
    enum class Number { InBlocks, ByIndex };
    /// receivers: their number. With ByIndex it may be used from several threads: a grid point is in one brick.
    LightCollector(const LightTable &table, std::size_t receivers, Number number)
        : table_(table), number_(number), sums_(receivers) {}
    void See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
             std::span<const ProbeIncidentLight> incident) override;
    /// The lights of a receiver at that position.
    std::vector<LightHere> Of(std::size_t receiver, const Vec3f &position) const;

  private:
    struct Sum {
        std::uint32_t light;
        float unshadowed, arrived;
    };
    void Add(std::uint32_t light, std::size_t receiver, float unshadowed, float visible);

    const LightTable &table_;
    Number number_;
    std::vector<std::vector<Sum>> sums_; ///< by receiver
};

} // namespace q3
