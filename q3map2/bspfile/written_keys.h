// GPL-2.0-or-later. Keys of worldspawn that tell readers of a .bsp how it was lit.
#pragma once

#include <string_view>

namespace q3 {

/// How to read the SH grid: kRadiance after -shradiance, absent otherwise.
inline constexpr std::string_view kGridSHKey = "_q3map2_sh", kRadiance = "radiance";
/// Tone of the lightmaps as ToneText gives it (light/tone/light_tone.h), absent if plain. shgrid_parse_tone reads it.
inline constexpr std::string_view kToneKey = "_q3map2_tone";

} // namespace q3
