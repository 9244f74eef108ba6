// GPL-2.0-or-later. What goes into a package, what is missing, and the options of -pk3 and -repack.
#pragma once

#include "common/settings.h"
#include "q3map2/pk3/engine_scripts.h"
#include "q3map2/pk3/map_needs.h"

#include <filesystem>
#include <string>
#include <vector>

namespace q3 {

class FileSet;

// ---- Options of -pk3 and -repack ----

struct PackOptions {
    bool list = false;                   ///< print what was collected
    bool png = false;                    ///< PNG images count too, and first
    int level = 9;                       ///< of compression, as zlib has it; 10 is 9
    std::string folder;                  ///< of the package; empty: the first base path
    std::vector<std::string> basePaks;   ///< masks of archives that players have
    std::vector<std::string> exclusions; ///< more files of exclusions
};

struct RepackOptions : PackOptions {
    RepackOptions() { level = 1; }
    bool onlyList = false; ///< write nothing
};

std::vector<SettingGroup<PackOptions>> PackSettings();
std::vector<SettingGroup<RepackOptions>> RepackSettings();

/// A file of a package.
struct PackageEntry {
    std::string name;
    std::filesystem::path disk; ///< empty: the source has it by its name
};

/// Files in the order in which they are packed, each once.
class PackagePlan {
  public:
    void Add(std::string_view name, std::filesystem::path disk = {});
    const std::vector<PackageEntry> &Files() const { return files_; }

    std::vector<std::string> missing;                  ///< required: name and who wants it
    std::vector<std::string> absent;                   ///< not required
    std::vector<const EngineShader *> strippedShaders; ///< for -repack, in the order of their use

  private:
    std::vector<PackageEntry> files_;
    WantedList names_;
};

/// How needs become files.
struct PlanRules {
    const Exclusions &exclusions;
    std::string_view imageFiles; ///< Game::imageFiles
    bool png = false;
    bool wholeScripts = true; ///< else shaders are listed in PackagePlan::strippedShaders
    bool list = false;        ///< print what was collected
};

/// Images, scripts, sounds, videos and models for the needs. Shaders of models are added to the needs.
PackagePlan MakePlan(MapNeeds &needs, const PackageSource &source, const EngineScripts &scripts, const PlanRules &rules,
                     Log &log);

/// Adds light of a map that is in files: those of its folder that engines load, and external lightmaps that the source
/// has.
void AddLightFiles(const std::filesystem::path &bspPath, const WantedList &externalPages, const PackageSource &source,
                   PackagePlan &plan);

/// Adds a map itself: its lightmap files, the .bsp, and as far as they are there bot files and menu entries.
void AddMapFiles(const std::filesystem::path &bspPath, const WantedList &externalPages, const PackageSource &source,
                 PackagePlan &plan);

/// Reads the plan's files and writes the archive, together with the files that the set has already. A file that cannot
/// be read is added to PackagePlan::missing, and the archive then gets `failedPath`. An older archive with the other of
/// the two names is removed. Errors: a file cannot be written.
void WritePackage(const std::filesystem::path &path, const std::filesystem::path &failedPath, int level,
                  const PackageSource &source, PackagePlan &plan, FileSet &files, Log &log);

} // namespace q3
