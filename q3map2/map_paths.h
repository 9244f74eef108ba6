// GPL-2.0-or-later. The map that a word of the command line means, and the files beside it.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// The path with the extension of a map's file (.map, .bsp, .prt ...) replaced. Any other is a part of the map's name:
/// ctf.1 becomes ctf.1.bsp.
std::filesystem::path WithExtension(const std::filesystem::path &path, std::string_view extension);

/// WithExtension, but in another case (X.BSP) if only that exists.
std::filesystem::path Beside(const std::filesystem::path &map, std::string_view extension);

/// Absolute path of the file with that extension that the word means, whatever extension it has itself. Where it would
/// be, if there is none.
std::filesystem::path MapPath(const std::string &word, std::string_view extension);

/// Error if there is no such file: what is there instead, and what may have been meant, among its neighbors and in the
/// folder maps of the game's folders.
void RequireMap(const std::filesystem::path &path, std::span<const std::filesystem::path> gameFolders = {});

/// MapPath of a .bsp that exists. Errors: those of RequireMap.
std::filesystem::path ExistingBsp(const std::string &word, std::span<const std::filesystem::path> gameFolders = {});

} // namespace q3
