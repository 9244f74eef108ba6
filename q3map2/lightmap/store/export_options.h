// GPL-2.0-or-later. Options of the stages -export and -import.
#pragma once

#include "common/settings.h"

#include <string>
#include <vector>

namespace q3 {

struct ExportOptions {
    std::string hdrFormat; ///< exr, pfm, hdr, exp32, rend2 or ioquake3; empty: chosen by the stage
};

/// The options of -export and -import, declared.
std::vector<SettingGroup<ExportOptions>> ExportSettings();
/// Removes these options from `arguments`.
ExportOptions ParseExportOptions(Arguments &arguments, Log &log);

} // namespace q3
