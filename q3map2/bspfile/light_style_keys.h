// GPL-2.0-or-later. The keys of animated and switchable lights.
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

} // namespace q3::keys
