// GPL-2.0-or-later. Explains why points of a map are lit as they are: -explain.
#pragma once

#include "q3map2/lightmap/explain/explain_grid.h"
#include "q3map2/lightmap/explain/explain_luxel.h"
#include "q3map2/lightmap/light_stage.h"

#include <memory>
#include <string>
#include <vector>

namespace q3 {

/// A place before a surface, in the open.
struct SurfacePlace {
    int surface = -1; ///< draw surface
    Vec3f onSurface;
    Vec3f point; ///< on the normal there
};

/// A map whose light is asked for, set up as by the light stage; nothing of it changes. Keeps references.
class Explainer {
  public:
    /// mapText: of the map source, empty without one; mapName: its file, for lines. Errors: as LightWorld.
    Explainer(const Bsp &bsp, const LightInputs &inputs, const std::string &mapText, const std::string &mapName,
              const LightOptions &options, const LightmapOptions &lightmap, ShaderLibrary &library, const Game &game,
              const JobPool &jobs, Log &log);
    Explainer(const Explainer &) = delete;
    Explainer &operator=(const Explainer &) = delete;

    Explanation Explain(const Vec3f &p) const;
    /// Triangles of all surfaces with lightmaps.
    std::vector<SurfaceTriangle> LightmappedTriangles() const { return luxels_.Triangles(); }
    /// A place before p, which is on the triangle: where a player who stands on it is lit if it is a floor, nearer
    /// where something is in the way; none if p is covered.
    std::optional<SurfacePlace> PlaceBefore(const SurfaceTriangle &triangle, const Vec3f &p) const;

  private:
    PlaceAccount PlaceOf(const Vec3f &p) const;

    Log quiet_;
    const LightSetup setup_;
    const LightmapOptions lightmap_;
    MapSource source_;
    const ObstacleFinder obstacles_;
    const LightExplainer lights_;
    const std::vector<PreparedLight> prepared_; ///< for the SH grid
    const GridExplainer grid_;
    const SurfaceInputs in_;
    const LuxelExplainer luxels_;
};

} // namespace q3
