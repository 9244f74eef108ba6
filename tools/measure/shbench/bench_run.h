// GPL-2.0-or-later. The benchmark of one map: reference, bakes, errors.
#pragma once

#include "q3map2/cli/global_options.h"
#include "tools/measure/shbench/error_list.h"
#include "tools/measure/shbench/error_top_view.h"
#include "tools/measure/shbench/report.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace q3::bench {

/// What to measure on a map.
struct BenchSettings {
    TruthSettings truth;
    std::vector<BakeSetting> bakes; ///< empty: DefaultBakes()
    std::string options;            ///< light options of the reference and all bakes; a bake's own follow them
    int repeats = 1;
    bool measureRaw = true;       ///< bare Embree, between the bakes
    bool measureBaselines = true; ///< BakeBaseline, the legacy grid and ambient cubes
    double rawSeconds = 1;        ///< CPU time of each measurement of bare Embree
    std::filesystem::path cache;  ///< folder of reference light; empty: none
    std::string worstOf = std::string(kDefaultName);
    std::size_t worstCount = 0; ///< worst positions to list
    bool drawWorst = false;     ///< draws them on the map as seen from above
    WorstBy worstBy = WorstBy::Reference;
    bool listErrors = false; ///< of all positions
    std::string errorsOf;    ///< the setting whose errors are listed; empty: the first
};

/// The default, faster and slower settings, and other sizes of grid cells.
std::vector<BakeSetting> DefaultBakes();

/// What RunBench gives.
struct BenchResult {
    BenchReport report;
    std::string worst;                     ///< text, empty unless asked for
    std::optional<ErrorTopView> worstView; ///< of the same, without value unless asked for
    std::string errors;                    ///< ErrorListJson, empty unless asked for
};

/// A map from files, with the game's shaders.
class BenchFiles {
  public:
    /// `words`: the command line, which may contain the engine path. Errors: as the light stage.
    BenchFiles(const GlobalOptions &global, const std::vector<std::string> &words, const std::filesystem::path &program,
               const std::filesystem::path &bspPath, const LightOptions &options, Log &log);
    const BenchMap &Map() const { return *map_; }
    ShaderLibrary &Library() { return *library_; }

  private:
    VirtualFileSystem vfs_;
    std::unique_ptr<ShaderLibrary> library_;
    std::unique_ptr<BenchMap> map_;
};

/// Layout of the SH grid under default settings.
bspGridSHHeader_t DefaultLayout(const BenchMap &map);

/// Measures all settings and the baselines. `progress` gets status lines. Errors:
/// `worstOf` or `errorsOf` is not among the settings, or not of a kind that can be listed.
BenchResult RunBench(const BenchMap &map, ShaderLibrary &library, const BenchSettings &given, const Game &game,
                     const JobPool &jobs, Log &progress);

} // namespace q3::bench
