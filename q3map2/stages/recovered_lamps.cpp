// GPL-2.0-or-later. What the stages share that find the lamps of a lit map: options, files, table and warnings.
#include "q3map2/stages/recovered_lamps.h"

#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/light/options/light_options.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>
#include <string>

namespace q3 {

namespace {

/// Lamps that the table lists.
constexpr std::size_t kListed = 32;
/// A larger difference of the relit map is a warning. Bytes, root mean square.
constexpr double kMuchUnexplained = 6;

/// What worldspawn's record of commands says about the light in the map.
struct LightRecord {
    std::vector<std::string> words; ///< of the last run that lit surfaces, without the stage word
    bool hasOtherGrid = false;      ///< a later run has lit the light grid only
};

LightRecord ReadLightRecord(const Bsp &bsp) {
    const Entity world = StoredWorld(bsp.entities);
    std::string_view record = world.Value("_q3map2_cmdline");
    LightRecord read;
    while (!record.empty()) {
        const std::size_t end = std::min(record.find(';'), record.size());
        std::istringstream text{std::string(record.substr(0, end))};
        const std::vector<std::string> command{std::istream_iterator<std::string>(text), {}};
        record.remove_prefix(std::min(end + 1, record.size()));
        if (command.empty() || !EqualNoCase(command.front(), "-light"))
            continue;
        read.hasOtherGrid =
            std::ranges::any_of(command, [](const std::string &word) { return EqualNoCase(word, "-onlygrid"); });
        if (!read.hasOtherGrid)
            read.words.assign(command.begin() + 1, command.end());
    }
    return read;
}

/// Of the cone's half angle.
float Degrees(const LampCone &cone) {
    return std::atan(cone.radiusByDist) * 180 / std::numbers::pi_v<float>;
}

void PrintLamps(const RecoveredLights &found, Log &log) {
    log.Print("{:>8} {:>8} {:>8}  {:>8}  {:>5}  {:>5}  color\n", "x", "y", "z", "light", "err %", "err");
    for (std::size_t i = 0; i < std::min(kListed, found.lamps.size()); ++i) {
        const Lamp &lamp = found.lamps[i];
        const Vec3f color = lamp.Color();
        log.Print("{:8.1f} {:8.1f} {:8.1f}  {:8.1f}  {:5.1f}  {:5.1f}  {:.2f} {:.2f} {:.2f}{}\n", lamp.origin.x,
                  lamp.origin.y, lamp.origin.z, lamp.Intensity(), 100 * found.spreads[i].intensity,
                  found.spreads[i].position, color.x, color.y, color.z,
                  lamp.cone ? fmt::format("  spotlight of {:.0f} degrees", Degrees(*lamp.cone)) : "");
    }
    if (found.lamps.size() > kListed)
        log.Print("and {} weaker ones\n", found.lamps.size() - kListed);
    if (!found.lamps.empty())
        log.Print(
            "err: standard errors of the light, and of the position in game units, if all lamps are point lights and "
            "spotlights\n");
}

/// Lines of a .rad file.
std::string ScalesText(const TexLights &sources) {
    std::string text;
    for (const auto &[name, factor] : sources.Scales())
        text += fmt::format("lightscale textures/{} {:.3f}\n", name, factor);
    return text;
}

void PrintDifference(const RecoveredLights &found, Log &log) {
    log.Print("Light on surfaces that known sources leave: {:.2f} bytes RMS; after {} lamps: {:.2f}\n", found.rmsBefore,
              found.lamps.size(), found.rmsAfter);
    const RelitDifference &difference = found.difference;
    log.Print("Lit with these lamps, the map differs from the file by {:.2f} bytes RMS on surfaces{}\n",
              difference.surfaces,
              found.map.gridNumbers.empty() ? "" : fmt::format(" and {:.2f} in the light grid", difference.grid));
    if (difference.surfaces > kMuchUnexplained)
        log.Warn("much light unexplained",
                 "the map lit with these lamps differs from the file by {:.1f} bytes RMS on surfaces; if it was lit "
                 "with options such as -gamma, -bounce or -dirty, give them to -recoverlights",
                 difference.surfaces);
}

} // namespace

std::vector<SettingGroup<RecoverOptions>> RecoverSettings() {
    return {{"Lamps",
             "All options of `-light` that change how light is computed count too, such as `-gamma`, `-bounce` and "
             "`-dirty`. Without any, those of the light run count that the map records.",
             {{{.name = "-insert",
                .help = "Also puts the lamps among the entities of the map",
                .details = "The light stage and engines find them there. All else in the `.bsp` stays.",
                .since = "0.2.0"},
               &RecoverOptions::insert}}}};
}

void GuardRecoveredLamps(const StageContext &context, const MapFiles &files, FileGuard &guard) {
    for (const std::string_view extension : {kRecoveredLights, kRecoveredSources})
        if (const auto path = WithExtension(files.bsp, extension);
            std::filesystem::exists(path) && !context.options.force)
            throw Error("{} exists; -force replaces it", path.string());
    for (const std::string_view extension : {kRecoveredLights, kRecoveredSources, kUnexplainedLight})
        guard.Writes(WithExtension(files.bsp, extension));
}

KeptImages ImagesFor(const LightRun &run) {
    return run.lightmap.bounces > 0 ? KeptImages::OfReflectors : KeptImages::SeeThrough;
}

LightRun RecordedLightRun(const Bsp &bsp, const StageContext &context) {
    const std::vector<std::string> words = ReadLightRecord(bsp).words;
    Arguments arguments(words);
    if (!words.empty())
        context.log.Print("The map records the light run {}\n", fmt::join(words, " "));
    return TakeLightRun(arguments, *context.options.game, context.log);
}

RecoveredLights FindLamps(const RecoverInputs &in, const MapFiles &files, FileSet &written) {
    if (in.bsp.lightmaps.empty())
        throw Error("{}: it has no lightmaps, from which lamps could be found", files.bsp.string());
    if (keys::kKeepLights.Flag(StoredWorld(in.bsp.entities)))
        in.log.Warn("kept lights", "worldspawn has _keepLights, so -light reads only the lights that the .bsp has; "
                                   "-recoverlights -insert puts the lamps there");
    RecoverInputs own = in;
    own.readsGrid = !ReadLightRecord(in.bsp).hasOtherGrid;
    if (!own.readsGrid)
        in.log.Print("The light grid is of a later run with -onlygrid, so it is not read\n");
    RecoveredLights found = RecoverLights(own);
    PrintLamps(found, in.log);
    PrintDifference(found, in.log);
    const auto add = [&](std::string_view extension, std::string_view text) {
        const auto path = WithExtension(files.bsp, extension);
        written.AddText(path, text);
        written.AddLine(in.log, fmt::format("Wrote {}\n", path.string()));
    };
    add(kRecoveredLights, FormatEntities(SourceOfLamps(in, found.lamps)));
    if (!found.sources.Scales().empty())
        add(kRecoveredSources, ScalesText(found.sources));
    else
        written.AddRemoval(WithExtension(files.bsp, kRecoveredSources)); // of an earlier run
    add(kUnexplainedLight, UnexplainedText(found.map, found.difference, in.inputs.name));
    return found;
}

} // namespace q3
