// GPL-2.0-or-later. Whether bot files still fit a map after it was written.
#pragma once

#include "common/log.h"
#include "q3map2/edit/bot_files.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// Reads the bot navigation files beside a map before a stage writes it, and reports afterwards which no longer fit.
class BotCheck {
  public:
    /// What a stage changes in the map.
    enum Change { SameGeometry, OtherGeometry };

    /// A file that cannot be read is a warning, and no file is checked then.
    BotCheck(std::filesystem::path bspPath, Log &log);
    /// Warns about each file that names another map than the written one. With `fix` and SameGeometry, files get the
    /// checksum of the written map instead.
    void Report(Change change, bool fix) const;

  private:
    void Fix(const BotFile &file, std::uint32_t checksum) const;

    std::filesystem::path bspPath_;
    Log &log_;
    std::vector<BotFile> files_;
    std::uint32_t before_ = 0; ///< checksum of the map; 0 without one
};

/// Warns if a bot file found at `origin`, such as an archive, is for another version of the packed map, or is damaged.
void WarnOfPackedBotFile(const std::filesystem::path &bspPath, std::span<const std::byte> botFile,
                         const std::string &origin, Log &log);

} // namespace q3
