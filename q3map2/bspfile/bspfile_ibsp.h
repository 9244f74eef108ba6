// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_layout.h"

#include <cstddef>
#include <span>
#include <string_view>

namespace q3 {

struct ByteSource;

/// Parses and validates a whole file in memory. `name` is for messages. Errors: Error, one line, for anything that a
/// later stage could trip over; recoverable oddities are warnings.
Bsp ReadBsp(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log);
/// The same from any source. Each byte is read once, into the records.
Bsp ReadBspFrom(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);

} // namespace q3
