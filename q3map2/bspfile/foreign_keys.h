// GPL-2.0-or-later. Keys of maps for other compilers that have no effect here, and what to write instead.
#pragma once

#include "q3map2/bspfile/entity_key.h"

#include <cstddef>

namespace q3 {

/// What kind of entity has a key.
enum class KeyOwner {
    World,  ///< worldspawn, about light
    Light,  ///< entities whose class begins with light
    Brushes ///< entities with brushes or patches, worldspawn among them
};

/// One warning for each key of the entity that has no effect on such an owner; `number` is its index in the file.
void WarnOfForeignKeys(const Entity &entity, std::size_t number, KeyOwner owner, Log &log);

/// The keys, for the documentation.
std::vector<SettingSection> ForeignKeySections();

} // namespace q3
