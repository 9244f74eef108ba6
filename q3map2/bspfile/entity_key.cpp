// GPL-2.0-or-later. Declarations of entity keys.
#include "q3map2/bspfile/entity_key.h"

#include "common/settings.h"

namespace q3 {

namespace {

/// What is wrong with the text of a number key; empty: nothing.
std::string Problem(const EntityKey &key, std::string_view text) {
    const std::size_t required = key.info.MinValues(), most = key.info.MaxValues();
    std::size_t count = 0;
    for (; count < most; ++count) {
        const std::optional<double> number = TakeNumber(text);
        if (!number)
            break;
        if (!key.info.range.Contains(*number)) {
            return fmt::format("expected a number {}; {:.12g} is used", key.info.range.Text(),
                               key.info.range.Clamp(*number));
        }
    }
    if (count < required)
        return required == 1 ? "expected a number" : fmt::format("expected {} numbers", required);
    if (text.find_first_not_of(" \t") != std::string_view::npos)
        return fmt::format("\"{}\" after the number{} is not read", text.substr(0, 40), count == 1 ? "" : "s");
    return {};
}

} // namespace

std::string_view EntityKey::Text(const Entity &entity) const {
    const auto &[second, third, fourth, fifth] = info.aliases; // unused aliases are empty and match no key
    return entity.Value({info.name, second, third, fourth, fifth});
}

double EntityKey::Number(const Entity &entity, double fallback) const {
    std::string_view text = Text(entity);
    return info.range.Clamp(TakeNumber(text).value_or(fallback));
}

std::optional<Vec3f> EntityKey::Vector(const Entity &entity) const {
    const auto &[second, third, fourth, fifth] = info.aliases;
    return entity.Vector({info.name, second, third, fourth, fifth});
}

std::string EntityKey::InitialText() const {
    if (!info.initial.empty() || info.kind == SettingKind::Text)
        return std::string(info.initial);
    return SettingText(initial);
}

void WarnOfBadKeys(const Entity &entity, std::size_t number, std::span<const EntityKey> keys, Log &log) {
    for (const EntityKey &key : keys) {
        if (key.info.kind == SettingKind::Text || key.info.kind == SettingKind::Flag || !key.Given(entity))
            continue;
        if (const std::string problem = Problem(key, key.Text(entity)); !problem.empty())
            log.Warn("bad value of a key", "entity {} ({}): {} \"{}\": {}", number, entity.ClassName(), key.info.name,
                     key.Text(entity).substr(0, 80), problem);
    }
}

SettingSection DescribeKeys(std::string_view title, std::string_view intro, std::span<const EntityKey> keys) {
    SettingSection section{title, intro, {}};
    for (const EntityKey &key : keys)
        section.entries.push_back({key.info, key.InitialText()});
    return section;
}

} // namespace q3
