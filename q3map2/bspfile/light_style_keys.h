// GPL-2.0-or-later. The keys of animated and switchable lights, and of macro textures.
#pragma once

#include "q3map2/bspfile/entity_key.h"

namespace q3::keys {

/// The keys of light entities for styles, beside kStyle.
inline constexpr EntityKey kStyleLightKeys[] = {
    {{.name = "pattern",
      .values = "LETTERS",
      .kind = SettingKind::Text,
      .help = "Brightness over time, ten letters a second: a is dark, m is 1, z is 2",
      .details = "Lights of one pattern share a style that nothing else uses, unless `style` says which."}},
    {{.name = "targetname",
      .values = "NAME",
      .kind = SettingKind::Text,
      .help = "Under -switchable: lights of one name share a style, which the game can switch",
      .details = "[from_source.md](from_source.md#switchable-and-animated-lights) tells how."}}};
inline constexpr const EntityKey &kPattern = kStyleLightKeys[0], &kSwitchName = kStyleLightKeys[1];

/// The same of worldspawn.
inline constexpr EntityKey kStyleWorldKeys[] = {{{.name = "_switchable",
                                                  .values = "0|1",
                                                  .kind = SettingKind::Flag,
                                                  .initial = "0",
                                                  .help = "1: lights with a targetname can be switched, as under "
                                                          "-switchable"}}};
inline constexpr const EntityKey &kSwitchable = kStyleWorldKeys[0];

/// The macro texture of the world.
inline constexpr EntityKey kMacroKeys[] = {
    {{.name = "_macrotexture",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Image over the whole world, seen from above, that tints lightmaps and vertex light",
      .details = "[from_source.md](from_source.md#macro-textures) tells how. The option `-macrotexture` wins."}},
    {{.name = "world_mins",
      .values = "X Y Z",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "bounds of the world",
      .help = "Where the left and the lower edge of that image are"}},
    {{.name = "world_maxs",
      .values = "X Y Z",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "bounds of the world",
      .help = "Where its right and its upper edge are"}}};
inline constexpr const EntityKey &kMacroTexture = kMacroKeys[0], &kWorldMins = kMacroKeys[1],
                                 &kWorldMaxs = kMacroKeys[2];

} // namespace q3::keys
