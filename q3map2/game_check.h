// GPL-2.0-or-later. Checks that the game is known and its files exist.
#pragma once

#include "q3map2/global_options.h"

#include <filesystem>
#include <string_view>
#include <vector>

namespace q3 {

/// Error (with -force a warning) that -game names no game of the table, with the nearest names.
void ReportUnknownGame(std::string_view name, const GlobalOptions &options, Log &log);

/// For stages that read shaders and images. Error (with -force a warning), naming the folders searched and the option
/// to change, when an -fs_basepath is no folder, an -fs_game is in none of the roots, or no game folder holds game
/// files: an archive, or one of the folders scripts, textures and models. `folders`: from GameFolders; `words`: the
/// command line, whose map may tell where the game is.
void RequireGameFiles(const GlobalOptions &options, const std::vector<std::filesystem::path> &folders,
                      const std::vector<std::string> &words, Log &log);

} // namespace q3
