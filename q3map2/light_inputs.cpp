// GPL-2.0-or-later. Optional files beside a .bsp that the light stage reads.
#include "q3map2/light_inputs.h"

#include "common/files/files.h"
#include "q3map2/stages.h"

namespace q3 {

LightInputs ReadLightInputs(const std::filesystem::path &bspPath, Log &log) {
    LightInputs inputs;
    inputs.name = bspPath.stem().string();
    const auto mapPath = WithExtension(bspPath, ".map"), srfPath = WithExtension(bspPath, ".srf");
    if (std::filesystem::exists(mapPath)) {
        log.Print("Loading {}\n", mapPath.string());
        inputs.mapEntities = ParseMapEntities(ReadTextFile(mapPath), mapPath.string());
    }
    if (std::filesystem::exists(srfPath)) {
        log.Print("Loading {}\n", srfPath.string());
        inputs.surfaceFile = ReadTextFile(srfPath);
    }
    return inputs;
}

} // namespace q3
