// GPL-2.0-or-later. CPU time and rays of lightmaps and vertex light, pass by pass.
#include "tools/measure/shbench/lightmap_passes.h"

#include "common/error.h"
#include "q3map2/lightmap/light_stage.h"
#include "tools/measure/shbench/report.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>

namespace q3::bench {

namespace {

constexpr std::string_view kSetUp = "set-up", kFirstPass = "SetupSurfaceLightmaps";

/// Reads the log of the light stage, whose headings "--- NAME ---" begin passes and whose lines "N rays" count their
/// rays. All before the heading kFirstPass is one pass, the set-up.
class PassClock {
  public:
    PassClock() { Begin(kSetUp); }
    void Read(std::string_view line) {
        constexpr std::string_view kPrefix = "--- ", kSuffix = " ---\n"; // of headings
        if (line.starts_with(kPrefix) && line.ends_with(kSuffix)) {
            line.remove_prefix(kPrefix.size());
            line.remove_suffix(kSuffix.size());
            if (passes_.back().name != kSetUp || line == kFirstPass)
                Begin(line);
            return;
        }
        line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
        std::uint64_t count = 0;
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), count);
        const std::string_view counted(end, line.data() + line.size());
        if (error == std::errc() && (counted.starts_with(" rays") || counted.starts_with(" radiosity rays")))
            passes_.back().rays += count;
    }
    std::vector<LightmapPass> End() {
        Stop();
        return std::move(passes_);
    }

  private:
    void Begin(std::string_view name) {
        Stop();
        passes_.push_back({std::string(name), 0, 0});
        start_ = CpuSeconds();
    }
    void Stop() {
        if (!passes_.empty())
            passes_.back().cpuSeconds = CpuSeconds() - start_;
    }

    std::vector<LightmapPass> passes_;
    double start_ = 0;
};

std::vector<LightmapPass> LightOnce(const BenchMap &map, const LightmapSettings &settings, ShaderLibrary &library,
                                    const JobPool &jobs) {
    LightOptions light = settings.light;
    light.sh = false;
    light.noGrid = true;
    Bsp bsp = map.bsp;
    PassClock clock;
    Log log([&](LogLevel, std::string_view text) { clock.Read(text); });
    LightWorld(bsp, map.inputs, light, settings.lightmap, library, jobs, log);
    return clock.End();
}

LightmapPass Sum(const std::vector<LightmapPass> &passes) {
    LightmapPass sum{"all", 0, 0};
    for (const LightmapPass &pass : passes)
        sum.cpuSeconds += pass.cpuSeconds, sum.rays += pass.rays;
    return sum;
}

double PerSecond(const LightmapPass &pass) {
    return pass.cpuSeconds > 0 ? double(pass.rays) / pass.cpuSeconds : 0;
}

} // namespace

LightmapSettings LightmapSettingsFrom(std::string_view text, const Game &game) {
    LightmapSettings settings;
    ParseOptionWords(WordsOf(text), text, [&](Arguments &arguments, Log &log) {
        settings.light = ParseLightOptions(arguments, game, log);
        settings.lightmap = ParseLightmapOptions(arguments, settings.light, game, log);
    });
    if (settings.lightmap.onlyGrid)
        throw Error("light options \"{}\": expected lightmaps, not -onlygrid", text);
    return settings;
}

std::vector<LightmapPass> LightmapPasses(const BenchMap &map, const LightmapSettings &settings, ShaderLibrary &library,
                                         const JobPool &jobs, int repeats) {
    std::vector<LightmapPass> least = LightOnce(map, settings, library, jobs);
    for (int repeat = 1; repeat < repeats; ++repeat) {
        const std::vector<LightmapPass> again = LightOnce(map, settings, library, jobs);
        for (std::size_t i = 0; i < least.size() && i < again.size(); ++i)
            least[i].cpuSeconds = std::min(least[i].cpuSeconds, again[i].cpuSeconds);
    }
    return least;
}

std::string LightmapPassTable(const std::vector<LightmapPass> &passes, double rawPerSecond) {
    std::vector<std::vector<std::string>> rows = {{"pass", "CPU s", "M rays", "M rays/s", "of Embree"}};
    const auto add = [&](const LightmapPass &pass) {
        const bool traces = pass.rays > 0;
        rows.push_back({pass.name, fmt::format("{:.3f}", pass.cpuSeconds),
                        traces ? fmt::format("{:.3f}", double(pass.rays) / 1e6) : "",
                        traces ? fmt::format("{:.2f}", PerSecond(pass) / 1e6) : "",
                        traces && rawPerSecond > 0 ? fmt::format("{:.2f}", PerSecond(pass) / rawPerSecond) : ""});
    };
    for (const LightmapPass &pass : passes)
        add(pass);
    add(Sum(passes));
    std::string text = AlignedTable(rows);
    if (rawPerSecond > 0)
        text += fmt::format("bare Embree: {:.2f} M rays/s\n", rawPerSecond / 1e6);
    return text;
}

std::string LightmapPassJson(const std::vector<LightmapPass> &passes, double rawPerSecond) {
    nlohmann::json all = nlohmann::json::array();
    for (const LightmapPass &pass : passes) {
        nlohmann::json one = {{"name", pass.name},
                              {"cpuSeconds", pass.cpuSeconds},
                              {"rays", pass.rays},
                              {"raysPerCpuSecond", PerSecond(pass)}};
        if (rawPerSecond > 0)
            one["shareOfRaw"] = PerSecond(pass) / rawPerSecond;
        all.push_back(std::move(one));
    }
    nlohmann::json whole = {{"passes", std::move(all)}};
    if (rawPerSecond > 0)
        whole["rawRaysPerCpuSecond"] = rawPerSecond;
    return whole.dump(2) + "\n";
}

} // namespace q3::bench
