// GPL-2.0-or-later. Switchable lights of games whose engines switch light styles: their numbers in a .bsp.
#pragma once

#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/map/map.h"

#include <span>

namespace q3 {

/// Whether the game can switch the entity: its class begins with "light", and it has a targetname.
bool IsSwitchableLight(const Entity &entity);

/// Numbers the switchable lights: those of one targetname and style form a group, and group n, in order of appearance,
/// has style kFirstSwitchStyle + n. Sets the key `style` to it, and `switch_style` to the light's own style if that is
/// not 0. Errors: too many groups; styles of lights that engines do not have.
void NumberSwitchableLights(Map &map);

/// Gives a numbered light the style that it had before.
void RestoreLightStyle(Entity &entity);

/// Whether two lists of entities have groups with other numbers, so that light baked for one is wrong for the other.
/// Groups that only one list has do not count.
bool HaveOtherSwitches(std::span<const Entity> before, std::span<const Entity> after);

} // namespace q3
