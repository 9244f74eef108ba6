// GPL-2.0-or-later. The map that a word of the command line means, and the files beside it.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// Replaces the extension of a map file (.map, .bsp, .prt ...). Any other extension is part of the map's name and
/// stays: ctf.1 becomes ctf.1.bsp.
std::filesystem::path WithExtension(const std::filesystem::path &path, std::string_view extension);

/// WithExtension, or the existing file whose extension differs only in case (x.BSP).
std::filesystem::path Beside(const std::filesystem::path &map, std::string_view extension);

/// Absolute path of the file with that extension that a word of the command line means, whatever extension the word
/// has. If there is no such file: where it would be.
std::filesystem::path MapPath(const std::string &word, std::string_view extension);

/// Throws Error if there is no such file. It says what is there instead, and proposes similar names from the folder of
/// `path` and from the folders maps of `gameFolders`.
void RequireMap(const std::filesystem::path &path, std::span<const std::filesystem::path> gameFolders = {});

/// MapPath of a .bsp that exists. Errors: those of RequireMap.
std::filesystem::path ExistingBsp(const std::string &word, std::span<const std::filesystem::path> gameFolders = {});

} // namespace q3
