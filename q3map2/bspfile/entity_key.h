// GPL-2.0-or-later. A key of an entity, declared once: names, default, range and help.
#pragma once

#include "common/log.h"
#include "common/setting_info.h"
#include "q3map2/bspfile/entities.h"

#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// Reads a key, and says everything that is printed about it. Unreadable text and a missing key are the default;
/// numbers out of range are clamped. WarnOfBadKeys tells the user about both.
struct EntityKey {
    SettingInfo info; ///< `name` and `aliases`: the first one present counts; kinds are Integer, Number, Text and Flag
    double initial = 0; ///< of numbers

    std::string_view Text(const Entity &entity) const;
    bool Given(const Entity &entity) const { return !Text(entity).empty(); }
    double Number(const Entity &entity) const { return Number(entity, initial); }
    /// The same with a default that is known only now.
    double Number(const Entity &entity, double fallback) const;
    bool InRange(const Entity &entity) const;
    /// The number cut to a whole one.
    int Integer(const Entity &entity) const { return int(Number(entity)); }
    int Integer(const Entity &entity, int fallback) const { return int(Number(entity, fallback)); }
    /// True when the text starts with 1.
    bool Flag(const Entity &entity) const { return Text(entity).starts_with('1'); }
    /// Three numbers, without a range; nothing if there are fewer.
    std::optional<Vec3f> Vector(const Entity &entity) const;

    /// The default as the documentation has it.
    std::string InitialText() const;
};

/// Warns of every value that is no number, is followed by something else, or is out of range. `number` is the entity's
/// in its file, from 0.
void WarnOfBadKeys(const Entity &entity, std::size_t number, std::span<const EntityKey> keys, Log &log);

/// What is printed about keys.
SettingSection DescribeKeys(std::string_view title, std::string_view intro, std::span<const EntityKey> keys);

} // namespace q3
