// GPL-2.0-or-later. Decompiles a .bsp to a map source.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/convert/source/texture_form.h"
#include "q3map2/map/bsp_context.h"

#include <string>
#include <string_view>

namespace q3 {

/// How a .bsp is decompiled.
struct DecompileOptions {
    MapForm form = MapForm::Classic;
    bool withTextures = true;   ///< false: all sides get default texture axes
    bool keepModelClip = false; ///< write the brushes that clip models
    bool markUnknown = false;   ///< sides whose texture axes are unknown get the shader common/WTF
};

/// Map source with the entities, brushes and patches of a valid .bsp; `name`: of the file, for messages. Sides get the
/// texture axes of the surfaces that cover them. Errors: Error, for entity text that cannot be read.
std::string DecompiledSource(const Bsp &bsp, std::string_view name, const DecompileOptions &options,
                             const BspContext &context);

} // namespace q3
