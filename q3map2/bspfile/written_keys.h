// GPL-2.0-or-later. Keys of worldspawn that tell readers of a .bsp how it was lit.
#pragma once

#include "q3map2/bspfile/bsp_records.h"

#include <string_view>

namespace q3 {

/// How to read the SH grid: kRadiance after -shradiance, absent otherwise.
inline constexpr std::string_view kGridSHKey = "_q3map2_sh", kRadiance = "radiance";
/// Tone mapping of the lightmaps, written by ToneText (light/tone/light_tone.h) and read by shgrid_parse_tone. Absent
/// if all settings are at their defaults.
inline constexpr std::string_view kToneKey = "_q3map2_tone";
/// How the basis maps of -rnm are stored, in the file and beside it: "raw" or "rescaled". Absent without such maps.
inline constexpr std::string_view kRnmKey = "_q3map2_rnm";
constexpr std::string_view RnmStorageWord(RnmStorage storage) {
    return storage == RnmStorage::Raw ? "raw" : "rescaled";
}

} // namespace q3
