// GPL-2.0-or-later. Counts and sizes of a .bsp file.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <cstdint>
#include <filesystem>

namespace q3 {

/// Prints counts and bytes of every lump, as -info does. `fileBytes` is the size on disk.
void PrintBspInfo(const std::filesystem::path &path, const Bsp &bsp, std::uintmax_t fileBytes, Log &log);

} // namespace q3
