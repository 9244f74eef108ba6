// GPL-2.0-or-later. Whole files, and their safe replacement.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace q3 {

/// The whole file. Errors: Error naming the path and the reason.
std::vector<std::byte> ReadFile(const std::filesystem::path &path);

/// Atomic and durable: written beside, flushed to disk, renamed over. On any failure the old file is whole and an Error
/// names the path and the reason. An existing file keeps its permission bits, and one that is write protected is not
/// replaced; a symbolic link stays and the file it leads to is replaced. Other hard links keep the old contents.
void ReplaceFile(const std::filesystem::path &path, std::span<const std::byte> data);

} // namespace q3
