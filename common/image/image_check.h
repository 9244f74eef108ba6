// GPL-2.0-or-later. The limit that every image decoder keeps.
#pragma once

#include "common/error.h"

#include <cstdint>
#include <string_view>

namespace q3 {

/// Error unless 1..16384 texels a side and at most 2^26 in all: 256 MiB as RGBA.
inline void CheckImageSize(std::uint64_t width, std::uint64_t height, std::string_view name) {
    constexpr std::uint64_t kMaxSide = 16384, kMaxTexels = std::uint64_t(1) << 26;
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide || width * height > kMaxTexels)
        throw Error("{}: an image of {} x {}, expected 1 to {} a side and at most {} texels", name, width, height,
                    kMaxSide, kMaxTexels);
}

} // namespace q3
