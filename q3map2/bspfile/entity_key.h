// GPL-2.0-or-later. Declaration of entity keys: names, default, range and help.
#pragma once

#include "common/log.h"
#include "common/settings.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/entities.h"

#include <cstddef>
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

/// The row of that name; aliases do not count. Null: there is none.
constexpr const EntityKey *FindKey(std::span<const EntityKey> keys, std::string_view name) {
    for (const EntityKey &key : keys)
        if (key.info.name == name)
            return &key;
    return nullptr;
}
/// The same for references to rows of tables; a name without a row does not compile.
consteval const EntityKey &Key(std::span<const EntityKey> keys, std::string_view name) {
    return *FindKey(keys, name);
}

/// Warns of every value that is no number, is followed by something else, or is out of range. `number` is the index
/// of the entity in its file.
void WarnOfBadKeys(const Entity &entity, std::size_t number, std::span<const EntityKey> keys, Log &log);

/// The documentation section of these keys.
SettingSection DescribeKeys(std::string_view title, std::string_view intro, std::span<const EntityKey> keys);

/// What kind of entity has a key.
enum class KeyOwner {
    World,  ///< worldspawn, about light
    Light,  ///< entities whose class begins with light
    Brushes ///< entities with brushes or patches, worldspawn among them
};

/// One warning for each key of other compilers that has no effect here, on such an owner; `number` is the index of the
/// entity in its file.
void WarnOfForeignKeys(const Entity &entity, std::size_t number, KeyOwner owner, Log &log);

/// Keys of other compilers that have no effect here, for the documentation.
std::vector<SettingSection> ForeignKeySections();

/// How to read the SH grid: kRadiance after -shradiance, absent otherwise.
inline constexpr std::string_view kGridSHKey = "_q3map2_sh", kRadiance = "radiance";
/// Tone mapping of the lightmaps, written by ToneText (light/options/light_tone.h) and read by shgrid_parse_tone.
/// Absent if all settings are at their defaults.
inline constexpr std::string_view kToneKey = "_q3map2_tone";
/// How the basis maps of -rnm are stored, in the file and beside it: "raw" or "rescaled". Absent without such maps.
inline constexpr std::string_view kRnmKey = "_q3map2_rnm";
constexpr std::string_view RnmStorageWord(RnmStorage storage) {
    return storage == RnmStorage::Raw ? "raw" : "rescaled";
}

/// Keys of light style N: _styleNpattern, its pattern; _switchN, the targetnames of its lights; _switchNdark, 1 if they
/// are dark at first.
std::string PatternKey(int style);
std::string SwitchKey(int style);
std::string DarkKey(int style);
/// Whether it is one of these keys.
bool IsStyleKey(std::string_view key);
/// The number N, 1 to 254, of a key like "_styleNrgbgen", with such a beginning and end, ignoring case; -1: it is
/// another key.
int StyleOfKey(std::string_view key, std::string_view beginning, std::string_view end);

} // namespace q3
