// GPL-2.0-or-later. What the stages share that find the lamps of a lit map: options, files, table and warnings.
#pragma once

#include "common/files/files.h"
#include "common/settings.h"
#include "q3map2/cli/program.h"
#include "q3map2/recover/recover_lights.h"
#include "q3map2/stages/light_files.h"

#include <filesystem>
#include <vector>

namespace q3 {

struct RecoverOptions {
    bool insert = false; ///< lamps become entities of the .bsp too
};
std::vector<SettingGroup<RecoverOptions>> RecoverSettings();

/// Before lamps are sought: declares the files that are written then. Errors: x.lights.map or x.lights.rad exists,
/// without -force.
void GuardRecoveredLamps(const StageContext &context, const MapFiles &files, FileGuard &guard);

/// Images that the bounced light of a run needs.
KeptImages ImagesFor(const LightRun &run);

/// The options of the last light run that the map records, or the defaults if it records none. Prints them.
LightRun RecordedLightRun(const Bsp &bsp, const StageContext &context);

/// Finds lamps, prints them with the difference of the map lit with them, and adds x.lights.map, x.lights.rad if
/// shaders emit other light than their scripts say, and x.unexplained.json to `written`. Errors: the map has no
/// lightmaps; those of RecoverLights.
RecoveredLights FindLamps(const RecoverInputs &in, const MapFiles &files, FileSet &written);

} // namespace q3
