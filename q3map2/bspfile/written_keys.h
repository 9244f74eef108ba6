// GPL-2.0-or-later. Keys of worldspawn that tell readers of a .bsp how it was lit.
#pragma once

#include "q3map2/bspfile/bsp_records.h"

#include <string>
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

/// Keys of light style N: _styleNpattern, its pattern; _switchN, the targetnames of its lights; _switchNdark, 1 if they
/// are dark at first.
std::string PatternKey(int style);
std::string SwitchKey(int style);
std::string DarkKey(int style);
/// Whether it is one of these keys.
bool IsStyleKey(std::string_view key);
/// The number N, 1 to 254, of a key like "_styleNrgbgen", with such a beginning and end, ignoring case; -1: it is
/// another key.
int StyleOfKey(std::string_view key, std::string_view beginning, std::string_view end);

} // namespace q3
