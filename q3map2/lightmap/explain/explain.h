// GPL-2.0-or-later. Explains why points of a map are lit as they are: those of -explain, and places all over a map for
// pages that show them.
#pragma once

#include "q3map2/lightmap/explain/explain_grid.h"
#include "q3map2/lightmap/explain/explain_luxel.h"
#include "q3map2/lightmap/light_stage.h"

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A place in front of a surface, in the open.
struct PlaceInFront {
    Vec3f onSurface;
    Vec3f point; ///< on the normal there
};

/// A map whose light is asked for, set up as by the light stage; nothing of it changes. Keeps references.
class Explainer {
  public:
    /// mapText: of the map source, empty without one; mapName: its file, which reports name with lines. Errors: as
    /// LightWorld.
    Explainer(const Bsp &bsp, const LightInputs &inputs, const std::string &mapText, const std::string &mapName,
              const LightOptions &options, const LightmapOptions &lightmap, ShaderLibrary &library, const Game &game,
              const JobPool &jobs, Log &log);
    Explainer(const Explainer &) = delete;
    Explainer &operator=(const Explainer &) = delete;

    /// Why the light at p is as it is: lights, grids and the nearest luxel.
    Explanation Explain(const Vec3f &p) const;
    /// Triangles of all surfaces with lightmaps.
    std::vector<SurfaceTriangle> LightmappedTriangles() const { return luxels_.Triangles(); }
    /// A place in front of p, which is on the triangle: 24 units away, where a player on a floor has its origin, or 8
    /// or 2 where something is in the way; none if p is covered.
    std::optional<PlaceInFront> PlaceInFrontOf(const SurfaceTriangle &triangle, const Vec3f &p) const;

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

// ---- Places all over a map ----

/// Places in front of the lightmapped surfaces of the map, spread evenly over their area: at most `count` of them, at
/// least one if a surface has one.
std::vector<PlaceInFront> PlacesInFrontOfSurfaces(const Explainer &explainer, std::size_t count);

/// The explanations of all `places` as JSON, for the viewer (docs/guide/viewer.md): the reports, and the ends of the
/// rays to the strongest lights. map: path of the .bsp in the package; options: of the light run, to be shown. Prints
/// progress.
std::string ExplanationsJson(const Explainer &explainer, std::span<const PlaceInFront> places, std::string_view map,
                             std::string_view options, const JobPool &jobs, Log &log);

} // namespace q3
