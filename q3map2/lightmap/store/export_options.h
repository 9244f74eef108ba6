// GPL-2.0-or-later. Options of the stages -export and -import.
#pragma once

#include "common/settings.h"

#include <string>
#include <vector>

namespace q3 {

struct ExportOptions {
    std::string hdrFormat; ///< a form of ExportHdrLight; empty: see ExportSettings
};

/// The options of -export and -import, declared.
std::vector<SettingGroup<ExportOptions>> ExportSettings();
/// Takes them off `arguments`.
ExportOptions ParseExportOptions(Arguments &arguments, Log &log);

} // namespace q3
