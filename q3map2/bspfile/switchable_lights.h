// GPL-2.0-or-later. Switchable lights of games whose engines switch light styles: their numbers in a .bsp.
#pragma once

#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/entities.h"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace q3 {

/// Lights that are switched together: their targetname in lower case, since games compare names so, and the style that
/// they have while they are on.
using SwitchGroup = std::pair<std::string, int>;

/// Whether the game can switch the entity: a light with a targetname.
bool IsSwitchableLight(const Entity &entity);
/// The style of a light as it stands in the file, from -1e6 to 1e6; 0 without the key.
int StyleInFile(const Entity &light);

/// The style from kFirstSwitchStyle to kLastStyle that a switchable light has; 0: the entity has none.
int SwitchStyle(const Entity &entity);
/// The group of a light that has a SwitchStyle.
SwitchGroup GroupOfNumbered(const Entity &light);

/// Numbers the switchable ones among `lights`: group n, in order of appearance, has style kFirstSwitchStyle + n. Sets
/// the key `style` to it, and `switch_style` to the light's own style if that is not 0. Errors: too many groups.
void NumberSwitchableLights(std::span<Entity *const> lights, std::string_view mapName);
/// Gives a numbered light the style that it had before.
void RestoreLightStyle(Entity &entity);

/// Whether two lists of entities have groups with other numbers, so that light baked for one is wrong for the other.
/// Groups that only one list has do not count.
bool HaveOtherSwitches(std::span<const Entity> before, std::span<const Entity> after);

} // namespace q3
