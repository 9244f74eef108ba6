// GPL-2.0-or-later. What stages that write a map check: the format for it, bot files beside it, the memory of engines.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/edit/bot_files.h"
#include "q3map2/shader/games.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// The format of a map that was read, to write it in. Errors: -game was given, and files of that game have another
/// format.
BspFormat FormatOfMap(const Bsp &bsp, const std::filesystem::path &path, const GlobalOptions &options);
/// For stages that follow rules of the game. Errors: files of the game have another format than the map.
void RequireFormatOfGame(const Bsp &bsp, const std::filesystem::path &path, const GlobalOptions &options);

/// Reads the bot navigation files beside a map before a stage writes it, and reports afterwards which no longer fit.
class BotCheck {
  public:
    /// What a stage changes in the map.
    enum Change { SameGeometry, OtherGeometry };
    /// Whether bot files that no longer fit get the checksum of the written map, or a warning.
    enum Remedy { OnlyWarn, FixFiles };

    /// A file that cannot be read is a warning, and no file is checked then.
    BotCheck(std::filesystem::path bspPath, Log &log);
    /// Warns about each file that names another map than the written one. With FixFiles and SameGeometry, files get
    /// the checksum of the written map instead.
    void Report(Change change, Remedy remedy) const;

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

/// Bytes of hunk memory (com_hunkMegs) that an engine needs while it loads the file. It reads the whole file into the
/// hunk and copies the lumps that it knows, which excludes BSPX lumps. docs/guide/troubleshooting.md has the
/// measurement.
std::uint64_t EngineMemoryFor(const Bsp &bsp, std::uint64_t fileBytes);

/// Warns if the file that was just written has more lightmaps, or sets of light styles on surfaces, than engines of the
/// game take. Calls WarnOfEngineMemory.
void WarnOfEngineLimits(const std::filesystem::path &bspPath, const Bsp &bsp, const Game &game, Log &log);

/// Warns if the file that was just written needs more than engines of the game have by default, and says how to make it
/// smaller.
void WarnOfEngineMemory(const std::filesystem::path &bspPath, const Bsp &bsp, const Game &game, Log &log);

} // namespace q3
