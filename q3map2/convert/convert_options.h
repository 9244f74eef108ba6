// GPL-2.0-or-later. Options of the stages -json and -analyze.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"

namespace q3 {

struct JsonOptions {
    bool pack = false, unpack = false;
    bool useFlagNames = false, dropUnknownFlags = false;
};

/// The options of the -json stage, declared.
std::vector<SettingGroup<JsonOptions>> JsonSettings();
/// Takes them off `arguments`. Errors: -pack with -unpack.
JsonOptions ParseJsonOptions(Arguments &arguments, Log &log);

struct AnalyzeOptions {
    bool lumpSwap = false;
};

/// The options of the -analyze stage, declared.
std::vector<SettingGroup<AnalyzeOptions>> AnalyzeSettings();

} // namespace q3
