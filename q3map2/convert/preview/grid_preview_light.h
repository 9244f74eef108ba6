// GPL-2.0-or-later. Light of the SH grid and the legacy grid at a position. Internal to the grid preview.
#pragma once

#include "libs/math/vec.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile_grid.h"

#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// What an engine keeps of the SH grid for one object.
struct ShSample {
    shgrid_coeffs coeffs;
    std::optional<shgrid_tone> tone; ///< tone of lightmaps and legacy grid; nothing if it is plain
};
/// Light on a surface with this unit normal; 1.0 is lightmap byte 255. With a tone: as a lightmap stores it. Without:
/// linear and unclamped.
Vec3f LightOn(const ShSample &sample, const Vec3f &normal);

/// The SH grid through the engine-side reader, the sparse one if the map has it. Reads the points of the Bsp in place:
/// the Bsp must outlive this.
class ShPreview {
  public:
    /// Errors: no SH grid.
    explicit ShPreview(const Bsp &bsp);
    ShPreview(const ShPreview &) = delete; // the grid points into the lump
    ShPreview &operator=(const ShPreview &) = delete;
    ShSample At(const Vec3f &position) const;
    const shgrid_grid &Grid() const { return grid_; }
    bool HasTone() const { return tone_.has_value(); }

  private:
    std::vector<std::byte> sparseLump_;
    shgrid_grid grid_{};
    bool radiance_ = false; ///< not convolved yet
    std::optional<shgrid_tone> tone_;
};

/// What an engine keeps of the legacy grid for one object.
struct LegacySample {
    Vec3f ambient, directed;
    Vec3f direction; ///< toward the light, unit or zero
};
Vec3f LightOn(const LegacySample &sample, const Vec3f &normal);

/// The legacy grid as an engine blends it: corners without ambient light are left out, the rest is renormalized.
class LegacyPreview {
  public:
    /// Nothing if the map has no legacy grid, or one whose point count engines reject. The Bsp must
    /// outlive the result.
    static std::optional<LegacyPreview> Make(const Bsp &bsp);
    LegacySample At(const Vec3f &position) const;

  private:
    GridLayout layout_;
    std::span<const bspGridPoint_t> points_;
};

} // namespace q3
