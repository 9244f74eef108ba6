// GPL-2.0-or-later. The points of the light grids around a place: states, where they are lit from, what fills them.
#pragma once

#include "q3map2/lightmap/explain/obstacles.h"

#include <vector>

namespace q3 {

/// Explains points of both grids by lighting a few cells again. Keeps references.
class GridExplainer {
  public:
    GridExplainer(const LightSetup &setup, const ObstacleFinder &obstacles, const JobPool &jobs);

    /// The corners of the cell of the SH grid around p. Layout of the grid in the map if there is one, else that of the
    /// options. Direct light only.
    std::vector<GridPointAccount> CellAt(const Vec3f &p) const;
    /// The corners of the cell of the legacy grid.
    std::vector<LegacyPointAccount> LegacyCellAt(const Vec3f &p) const;

  private:
    const LightSetup &setup_;
    const ObstacleFinder &obstacles_;
    const JobPool &jobs_;
    GridLayout layout_;
    std::vector<Light> lights_, legacyLights_; ///< from SetupEnvelopes
};

} // namespace q3
