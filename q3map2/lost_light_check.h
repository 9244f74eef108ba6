// GPL-2.0-or-later. Light that relighting a map loses: missing light entities, lumps that are not made again.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/lightmap/options/lightmap_options.h"

namespace q3 {

/// Compares the legacy light grid of a map before and after it is lit. Compilers usually leave light entities out of
/// the .bsp, so lighting it again without its .map gives less light.
class LostLightCheck {
  public:
    explicit LostLightCheck(const Bsp &bsp);
    /// After lighting: warns if the map has no light entities and its grid less than two thirds of the light before.
    /// Errors: less than half; with `force`, that is a warning too.
    void Report(const Bsp &bsp, bool force, Log &log) const;

  private:
    double before_; ///< mean light of the grid before
};

/// Warns of each lump of light in the map that a run with these options neither keeps nor makes again. `formats`: of
/// -gridformats.
void WarnOfDroppedLight(const Bsp &bsp, const LightOptions &options, const LightmapOptions &lightmap,
                        const GridFormats &formats, Log &log);

} // namespace q3
