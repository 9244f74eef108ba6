// GPL-2.0-or-later. -cache, -part and -join for stages: outputs of an earlier run whose inputs are the same, and
// results of units of work.
#pragma once

#include "common/files/vfs.h"
#include "q3map2/cli/program.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/units/cache.h"
#include "q3map2/units/part_options.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace q3 {

class RunEvents;

/// The folder of -cache; nothing without that option.
std::optional<Cache> CacheOf(const StageContext &context);

/// A hash of what a run depends on besides files: the version and the file of the program, the stage, the options that
/// matter and the game. words: of the command line, see StageFile::wordsToRecord.
Hash128 HashOfSettings(const StageContext &context, const std::vector<std::string> &words);
/// The same without the file of the program: other machines have another build of the same version.
Hash128 HashOfPortableSettings(const StageContext &context, const std::vector<std::string> &words);

/// Finds the outputs of an earlier run of the stage with the same inputs, or keeps those of this run. The inputs are
/// the settings, the contents of the files that the guard names, and what the game's files answered to the requests of
/// the earlier run. Kept are the contents of the output files, counts and warnings.
class StageCache {
  public:
    struct Files {
        const FileGuard &guard;                         ///< with all inputs and outputs
        std::vector<std::filesystem::path> moreInputs;  ///< that messages depend on
        std::vector<std::filesystem::path> moreOutputs; ///< that the stage may write or remove
        VirtualFileSystem *vfs = nullptr;               ///< null: the stage needs none
    };
    /// Reads the inputs. Does nothing without -cache, or if the guard does not know all outputs.
    StageCache(const StageContext &context, const std::vector<std::string> &words, const Files &files);
    ~StageCache();

    /// True: the outputs are those of an earlier run, and its messages were printed. Errors: a file cannot be written.
    bool Restore();
    /// Keeps the outputs, unless a file of the game has changed meanwhile. To be called after the stage has checked
    /// that no input changed, and has written them.
    void Store();
    /// Of -cache; nothing: this run neither finds nor keeps outputs.
    const std::optional<Cache> &Folder() const { return cache_; }
    /// HashOfSettings of the run, if there is a folder.
    const Hash128 &Settings() const { return settings_; }

  private:
    Hash128 KeyOfInputs() const;
    /// Errors: Error if an output cannot be read.
    void StoreOutputs();

    const StageContext &context_;
    const Files files_;
    std::optional<Cache> cache_; ///< nothing: neither Restore nor Store do anything
    std::vector<std::filesystem::path> inputs_, outputs_;
    Hash128 settings_, key_;
    std::unique_ptr<RunEvents> events_;
};

/// The store of results of units of a run: those of -join, or those that the cache has of the run before.
class RunUnits {
  public:
    /// Errors: those of MakePartStore, and -cache with -part or -join.
    RunUnits(const StageContext &context, const std::vector<std::string> &words, const PartOptions &parts,
             const std::filesystem::path &map);
    /// Null: no option asks for one.
    UnitStore *Store() const { return units_.get(); }
    /// After the run: keeps its results in the cache, unless a file of the game has changed meanwhile.
    void Keep(const VirtualFileSystem &vfs) const;

  private:
    const StageContext &context_;
    std::optional<Cache> cache_;
    Hash128 key_;
    std::unique_ptr<UnitStore> units_;
};

} // namespace q3
