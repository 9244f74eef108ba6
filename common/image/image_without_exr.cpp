// GPL-2.0-or-later. In place of image_exr.cpp in a program built without OpenEXR.
#include "common/error.h"
#include "common/image/float_image.h"

namespace q3 {

bool HasOpenExr() {
    return false;
}

FloatImage DecodeExr(std::span<const std::byte>, std::string_view name) {
    throw Error("{}: built without OpenEXR, use .hdr or .pfm", name);
}

std::vector<std::byte> EncodeExr(const FloatImage &) {
    throw Error("an .exr image cannot be written: built without OpenEXR, use .hdr or .pfm");
}

} // namespace q3
