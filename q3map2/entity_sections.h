// GPL-2.0-or-later. Documentation of the keys of entities.
#pragma once

#include "common/setting_info.h"

namespace q3 {

inline constexpr std::string_view kKeyRules =
    "Key names are case-insensitive. Of several names of a key the first one present counts. Text that is not a "
    "number, a number with something after it, and a number out of range are warnings that name the entity and the "
    "key; for the last the nearest number of the range is used. Numbers of keys without a range may be from -1000000 "
    "to 1000000.";

/// All declared keys, by kind of entity.
std::vector<SettingSection> EntitySections();

} // namespace q3
