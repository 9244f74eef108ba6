// GPL-2.0-or-later. Options of the stages -json, -analyze and -convert.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"

#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// Values of the options of -json.
struct JsonOptions {
    bool pack = false, unpack = false;
    bool useFlagNames = false, dropUnknownFlags = false; ///< see PackJsonOptions
};

/// The options of the -json stage, declared.
std::vector<SettingGroup<JsonOptions>> JsonSettings();
/// Takes the options of -json off `arguments`. Errors: -pack with -unpack.
JsonOptions ParseJsonOptions(Arguments &arguments, Log &log);

/// Values of the options of -analyze.
struct AnalyzeOptions {
    bool lumpSwap = false; ///< entries of the directory have the length first
};

/// The options of the -analyze stage, declared.
std::vector<SettingGroup<AnalyzeOptions>> AnalyzeSettings();

/// Values of the options of -convert.
struct ConvertOptions {
    std::string format; ///< empty: ase
    bool readBsp = false, readMap = false;
    bool meta = false, patchMeta = false;
    std::optional<double> normalEpsilon, distanceEpsilon; ///< nothing: the option was not given
    bool fast = false;                                    ///< sides of a .bsp get default texture axes
    bool keepModelClip = false;                           ///< keep the brushes that the compiler made to clip models
    bool markUnknown = false;                             ///< -wtf: mark sides whose texture axes are unknown
    bool shadersAsBitmap = false, lightmapsAsTexCoord = false, deluxemapsAsTexCoord = false;
};

/// The options of the -convert stage, declared.
std::vector<SettingGroup<ConvertOptions>> ConvertSettings();
/// Takes the options of -convert off `arguments`. Errors: -readbsp with -readmap.
ConvertOptions ParseConvertOptions(Arguments &arguments, Log &log);

} // namespace q3
