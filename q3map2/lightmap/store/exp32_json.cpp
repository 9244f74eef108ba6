// GPL-2.0-or-later. Lightmaps as JSON of ColorRGBExp32.
#include "q3map2/lightmap/store/exp32_json.h"

#include "common/error.h"
#include "common/image/image_check.h"
#include "common/text/text.h"
#include "libs/math/packed_color.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>

namespace q3 {

namespace {

using nlohmann::json;

/// The value as an integer in low..high; `what` names it in the error.
int IntegerOf(const json &value, int low, int high, std::string_view what, std::string_view name) {
    if (!value.is_number_integer() || value < low || value > high)
        throw Error("{}: {}: expected an integer in {}..{}", name, what, low, high);
    return value.get<int>();
}

const json &MemberOf(const json &object, const char *member, std::string_view name) {
    if (!object.is_object() || !object.contains(member))
        throw Error("{}: {}: missing", name, member);
    return object.at(member);
}

} // namespace

std::vector<std::byte> EncodeExp32Json(const FloatImage &image) {
    std::string text =
        fmt::format("{{\n    \"width\": {},\n    \"height\": {},\n    \"texels\": [\n", image.width, image.height);
    for (std::size_t i = 0; i < image.texels.size(); ++i) {
        const ColorRgbExp32 code = EncodeRgbExp32(image.texels[i]);
        fmt::format_to(std::back_inserter(text), "        [{}, {}, {}, {}]{}\n", code.r, code.g, code.b,
                       int(code.exponent), i + 1 < image.texels.size() ? "," : "");
    }
    text += "    ]\n}\n";
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

FloatImage DecodeExp32Json(std::span<const std::byte> file, std::string_view name) {
    const json all = json::parse(AsText(file), nullptr, false);
    if (all.is_discarded())
        throw Error("{}: not valid JSON", name);
    constexpr int kMaxSide = 16384;
    FloatImage image;
    image.width = IntegerOf(MemberOf(all, "width", name), 1, kMaxSide, "width", name);
    image.height = IntegerOf(MemberOf(all, "height", name), 1, kMaxSide, "height", name);
    const json &texels = MemberOf(all, "texels", name);
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height);
    if (!texels.is_array() || texels.size() != count)
        throw Error("{}: texels: expected an array of {} x {}", name, image.width, image.height);
    for (const json &texel : texels) {
        if (!texel.is_array() || texel.size() != 4)
            throw Error("{}: texels: expected [r, g, b, exponent] for each", name);
        const auto byte = [&](std::size_t i) { return std::uint8_t(IntegerOf(texel[i], 0, 255, "texels", name)); };
        image.texels.push_back(
            DecodeRgbExp32({byte(0), byte(1), byte(2), std::int8_t(IntegerOf(texel[3], -128, 127, "texels", name))}));
    }
    return image;
}

} // namespace q3
