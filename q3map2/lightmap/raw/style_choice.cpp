// GPL-2.0-or-later. The light styles of a surface: slots, and the choice if more reach it than it can hold.
#include "q3map2/lightmap/raw/style_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

namespace {

/// The most lights that one warning names.
constexpr std::size_t kNamedLights = 12;

} // namespace

bool StyleChoice::IsNeeded(std::span<const Light *const> lights) {
    std::set<int> styles{0};
    for (const Light *light : lights)
        styles.insert(light->style);
    return styles.size() > kStyles;
}

void StyleChoice::Add(const Light &light, double energy) {
    if (!(std::abs(energy) > 0))
        return;
    energies_[light.style] += std::abs(energy);
    lights_.push_back(&light);
}

void StyleChoice::Choose() {
    std::vector<std::pair<double, int>> order; // most light first
    for (const auto &[style, energy] : energies_)
        if (style != 0)
            order.emplace_back(-energy, style);
    std::sort(order.begin(), order.end());
    for (std::size_t i = kStyles - 1; i < order.size(); ++i)
        dropped_.insert(order[i].second);
}

std::vector<std::string> StyleChoice::Names() const {
    std::vector<std::string> names;
    for (const Light *light : lights_) {
        if (!Drops(light->style))
            continue;
        std::string name = light->label.empty() ? fmt::format("light of style {}", light->style) : light->label;
        if (std::find(names.begin(), names.end(), name) == names.end())
            names.push_back(std::move(name));
    }
    return names;
}

void WarnOfDroppedLights(const DroppedLights &dropped, std::string_view light, std::string_view what, Log &log) {
    std::vector<std::pair<std::string_view, int>> counts; // in the order of surfaces
    for (const std::vector<std::string> &names : dropped)
        for (const std::string &name : names) {
            auto found = std::find_if(counts.begin(), counts.end(), [&](const auto &one) { return one.first == name; });
            if (found == counts.end())
                found = counts.insert(counts.end(), {name, 0});
            ++found->second;
        }
    std::stable_sort(counts.begin(), counts.end(), [](const auto &a, const auto &b) { return a.second > b.second; });
    if (counts.empty())
        return;
    std::string names;
    for (std::size_t i = 0; i < std::min(counts.size(), kNamedLights); ++i)
        names += fmt::format("{}{} ({}: {})", i > 0 ? ", " : "", counts[i].first, what, counts[i].second);
    if (counts.size() > kNamedLights)
        names += fmt::format(" and {} more", counts.size() - kNamedLights);
    log.Warn(fmt::format("{} left out of {}", light, what), "{} left out where {} other styles come first: {}", light,
             kStyles - 1, names);
}

} // namespace q3
