// GPL-2.0-or-later. Where files of a package come from.
#pragma once

#include "common/files/vfs.h"
#include "q3map2/pk3/engine_scripts.h"
#include "q3map2/shader/games.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

enum class Whereabouts {
    Nowhere,
    InBase, ///< in an archive that players have
    Here
};

/// The folders that the maps are in, then the game's files.
class PackageSource {
  public:
    /// `folders`: those that hold folders maps, scripts and so on. `basePaks`: masks of archives that players have.
    PackageSource(const VirtualFileSystem &vfs, std::vector<std::filesystem::path> folders,
                  const std::vector<std::string> &basePaks);

    Whereabouts Find(std::string_view name) const;
    /// Nothing if there is no such file or, with a warning, it is damaged.
    std::optional<std::vector<std::byte>> Read(std::string_view name) const;
    /// Where Read finds it, for messages: a file, or an archive and the name in it. Empty: nowhere.
    std::string Location(std::string_view name) const;
    /// The same as Read, as text.
    std::optional<std::string> ReadText(std::string_view name) const;
    /// Names in the folder that end so, each once, sorted: first those of the maps' folders.
    std::vector<std::string> List(std::string_view folder, std::string_view extension) const;

  private:
    /// Empty: not in the maps' folders.
    std::filesystem::path LooseFile(std::string_view name) const;

    const VirtualFileSystem &vfs_;
    std::vector<std::filesystem::path> folders_;
    std::vector<std::string> basePaks_; ///< lower case
};

/// All shader scripts of the game. Prints their number.
EngineScripts ReadScripts(const PackageSource &source, const Game &game, Log &log);

} // namespace q3
