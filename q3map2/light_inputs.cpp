// GPL-2.0-or-later. Optional files beside a .bsp that the light stage reads.
#include "q3map2/light_inputs.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/stages.h"

namespace q3 {

LightInputs ReadLightInputs(const std::filesystem::path &bspPath, Log &log) {
    LightInputs inputs;
    inputs.name = bspPath.stem().string();
    const auto mapPath = Beside(bspPath, ".map"), srfPath = Beside(bspPath, ".srf");
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

void WarnOfLuxelSizes(const std::vector<std::string> &given, const LightInputs &inputs, Arguments &arguments,
                      Log &log) {
    if (inputs.surfaceFile.empty())
        return;
    constexpr std::string_view kWord = "sampleSize "; // first in the default block
    const std::size_t at = inputs.surfaceFile.find(kWord);
    const int used = at == std::string::npos ? 0 : IntegerFromText(inputs.surfaceFile.substr(at + kWord.size(), 16));
    for (const std::string_view option : {"-samplesize", "-minsamplesize"}) {
        const std::string value = LastValueOf(option, given);
        if (value.empty())
            continue;
        arguments.DropChange(option);
        log.Warn("luxel size without effect",
                 "{} {} has no effect: {}.srf, which the bsp stage wrote, sets the luxel sizes ({} unless a shader or "
                 "key says otherwise); give {} {} to the bsp stage, or use -samplescale here",
                 option, value, inputs.name, used, option, value);
    }
}

TexLights ReadTexLights(const std::filesystem::path &bspPath, const VirtualFileSystem &vfs,
                        const std::vector<std::string> &given, bool hdr, Log &log) {
    TexLights lights;
    const auto read = [&](std::string_view text, const std::string &name, const std::string &location) {
        log.Print("Loading {}\n", location);
        lights.Read(text, name, hdr, log);
    };
    // False: no such file among those of the game.
    const auto readFromGame = [&](const std::string &name) {
        const auto bytes = vfs.Read(name);
        if (bytes)
            read(AsText(*bytes), name, vfs.Location(name));
        return bytes.has_value();
    };
    readFromGame("lights.rad");
    for (const std::string &name : given)
        if (std::filesystem::exists(name))
            read(ReadTextFile(name), name, name);
        else if (!readFromGame(name))
            throw Error("-lights {}: no such file, neither by its path nor among the game's files", name);
    if (const auto ofMap = Beside(bspPath, ".rad"); std::filesystem::exists(ofMap))
        read(ReadTextFile(ofMap), ofMap.filename().string(), ofMap.string());
    return lights;
}

} // namespace q3
