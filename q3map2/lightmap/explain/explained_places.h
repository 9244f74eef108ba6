// GPL-2.0-or-later. Explanations of places all over a map, for pages that show them.
#pragma once

#include "q3map2/lightmap/explain/explain.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Places before the lightmapped surfaces of the map, spread evenly over their area: at most `count` of them, at least
/// one if a surface has one. They depend on nothing else.
std::vector<SurfacePlace> PlacesBeforeSurfaces(const Explainer &explainer, std::size_t count);

/// The explanations of all `places` as JSON, for the viewer (docs/viewer.md): the reports, and the ways of the
/// strongest lights. map: path of the .bsp in the package; options: of the light run, to be shown.
std::string ExplanationsJson(const Explainer &explainer, std::span<const SurfacePlace> places, std::string_view map,
                             std::string_view options, const JobPool &jobs);

} // namespace q3
