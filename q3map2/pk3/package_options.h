// GPL-2.0-or-later. Options of -pk3 and -repack.
#pragma once

#include "common/settings.h"

#include <string>
#include <vector>

namespace q3 {

struct PackOptions {
    bool list = false;                   ///< print what was collected
    bool png = false;                    ///< PNG images count too, and first
    int level = 9;                       ///< of compression, as zlib has it; 10 is 9
    std::string folder;                  ///< of the package; empty: the first base path
    std::vector<std::string> basePaks;   ///< masks of archives that players have
    std::vector<std::string> exclusions; ///< more files of exclusions
};

struct RepackOptions : PackOptions {
    RepackOptions() { level = 1; }
    bool onlyList = false; ///< write nothing
};

std::vector<SettingGroup<PackOptions>> PackSettings();
std::vector<SettingGroup<RepackOptions>> RepackSettings();

} // namespace q3
