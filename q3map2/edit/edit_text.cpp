// GPL-2.0-or-later. Text of edited maps.
#include "q3map2/edit/edit_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace q3 {

namespace {

constexpr double kMostBound = 1 << 30;

} // namespace

std::string NumberText(double number) {
    std::string text = fmt::format("{:.6f}", number);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.')
        text.pop_back();
    return text == "-0" ? "0" : text;
}

std::string VectorText(const Vec3d &v) {
    return NumberText(v.x) + ' ' + NumberText(v.y) + ' ' + NumberText(v.z);
}

std::int32_t WholeBound(double bound) {
    return std::int32_t(std::clamp(bound, -kMostBound, kMostBound));
}

} // namespace q3
