// GPL-2.0-or-later. -part, -partfile and -join: one map computed by several machines, in parts.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/units/unit_store.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A run of a stage in parts. A round is what parts can compute before they need the results of all others:
///
///     -part I/N -partfile F             computes part I of the first round and writes F
///     -join F1 ... FN -partfile R       writes R, all results so far, if there is another round; else ends the run
///     -join R -part I/N -partfile F     computes part I of the next round
///     -join R F1 ... FN                 ends the run, as if there were no parts
struct PartOptions {
    std::optional<PartNumber> part; ///< compute this part, write its file, and leave the map as it is
    std::string file;               ///< of the part, or of the joined results
    std::vector<std::string> join;  ///< files of results
    bool Any() const { return part || !file.empty() || !join.empty(); }
};

/// The options of a stage that has parts.
std::vector<SettingGroup<PartOptions>> PartSettings();
/// Takes them off `arguments`. To be called before the words are copied that the map records, since results do not
/// depend on parts. -join takes all words up to the next option or to the last word. Errors: those of TakeSettings, a
/// -part that is not I/N, and combinations that mean nothing.
PartOptions TakePartOptions(Arguments &arguments, Log &log);

/// A store with the results of options.join, for `stage` ("-light"). Null without options. Errors: those of
/// ReadUnitFile; a file that is of another stage or of other inputs than the first, a part that is missing or there
/// twice, a round that is missing.
std::unique_ptr<UnitStore> MakePartStore(const PartOptions &options, std::string_view stage, Log &log);

/// Whether the run ends with a file of results, without a map: a part, or a join before the last round.
/// rounds: of the stage with its options.
bool EndsWithFile(const PartOptions &options, const UnitStore &units, int rounds);
/// Writes the results of a part, or of a join, to options.file.
void WritePartFile(const PartOptions &options, const UnitStore &units, std::string_view stage, std::string_view map,
                   Log &log);

} // namespace q3
