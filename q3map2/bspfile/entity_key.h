// GPL-2.0-or-later. Declaration of an entity key: names, default, range and help.
#pragma once

#include "common/log.h"
#include "common/setting_info.h"
#include "q3map2/bspfile/entities.h"

#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// Reads a key and describes it for warnings and documentation. A missing key and unreadable text give the default;
/// numbers out of range are clamped. WarnOfBadKeys reports bad text and bad ranges.
struct EntityKey {
    SettingInfo info; ///< `name` and `aliases`: the first one present counts; kinds are Integer, Number, Text and Flag
    double initial = 0; ///< default of number keys

    std::string_view Text(const Entity &entity) const;
    bool Given(const Entity &entity) const { return !Text(entity).empty(); }
    double Number(const Entity &entity) const { return Number(entity, initial); }
    /// The same with a default that only the caller knows.
    double Number(const Entity &entity, double fallback) const;
    /// The number truncated toward zero.
    int Integer(const Entity &entity) const { return int(Number(entity)); }
    int Integer(const Entity &entity, int fallback) const { return int(Number(entity, fallback)); }
    /// True when the text starts with 1.
    bool Flag(const Entity &entity) const { return Text(entity).starts_with('1'); }
    /// Three numbers, without a range; nothing if there are fewer.
    std::optional<Vec3f> Vector(const Entity &entity) const;

    /// The default as the documentation prints it.
    std::string InitialText() const;
};

/// Warns of every value that is no number, is followed by something else, or is out of range. `number` is the index
/// of the entity in its file.
void WarnOfBadKeys(const Entity &entity, std::size_t number, std::span<const EntityKey> keys, Log &log);

/// The documentation section of these keys.
SettingSection DescribeKeys(std::string_view title, std::string_view intro, std::span<const EntityKey> keys);

} // namespace q3
