// GPL-2.0-or-later. Models among the surfaces of an entity.
#pragma once

#include "q3map2/geometry/models/model_placement.h"
#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Appends the surfaces of a model, and clip brushes where flags or shaders ask for them. The brushes go to the end of
/// `target`, so indexes of its other brushes stay valid. False: the model cannot be read; a warning names it and the
/// entity.
bool PlaceModel(const ModelPlacement &placement, MapEntity &target, Geometry &geometry, PlaneTable &planes,
                const BspContext &context);

/// Places the models of all misc_model entities whose target is `target`; for the world, of those without a target.
void AddEntityModels(Map &map, MapEntity &target, Geometry &geometry, const BspContext &context);

} // namespace q3
