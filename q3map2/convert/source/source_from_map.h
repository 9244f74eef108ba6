// GPL-2.0-or-later. Rewrites a map source with another form of texture axes.
#pragma once

#include "q3map2/convert/source/texture_form.h"
#include "q3map2/map/bsp_context.h"

#include <string>
#include <string_view>

namespace q3 {

/// The text of a map with the texture axes of all sides in one form. Everything else stays: entities, keys, the order
/// and the points of brushes, flags, patches, groups, origin brushes. Warns of textures that the form cannot hold.
/// Errors: those of ReadMap.
std::string ConvertedSource(std::string_view text, std::string_view name, MapForm form, const BspContext &context);

} // namespace q3
