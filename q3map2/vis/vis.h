// GPL-2.0-or-later. The vis stage: from portals to what every cluster may see.
#pragma once

#include "common/arguments.h"
#include "common/jobs.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/prtfile.h"
#include "q3map2/units/unit_store.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace q3 {

/// How the distance of two portals is compared with the far plane.
enum class FarPlaneMode {
    Nearest,    ///< nearest points of their spheres
    Origins,    ///< their centers
    Farthest,   ///< farthest points of their spheres against twice the distance
    RadiusOnly, ///< the sum of their radii; their positions do not matter
};

/// Portals farther apart than `distance` do not see each other, unless one of them is a sky portal.
struct FarPlane {
    double distance = 0; ///< game units; 0: none
    FarPlaneMode mode = FarPlaneMode::Nearest;
};

/// Reads the first of the worldspawn keys `_farplanedist`, `fogclip`, `distancecull` that is not empty: a number, then
/// optionally the letter of a mode: o (Origins), e (Exact), r (RadiusOnly).
FarPlane FarPlaneOf(const Entity &world);

/// What the passes of the vis stage do.
struct VisOptions {
    bool fast = false;                ///< -fast: flood only
    bool merge = false;               ///< -merge, -hint: merge leafs, then portals
    bool mergePortals = false;        ///< -mergeportals
    bool keepHints = false;           ///< -hint: do not merge leafs across hint portals
    bool noPassage = false;           ///< -nopassage: portal flow alone
    bool passageOnly = false;         ///< -passageOnly: passages alone
    bool noSort = false;              ///< -nosort: portals in the order of the file
    int flowRounds = 0;               ///< -flowrounds: see its help; 0: rounds of a constant number of portals
    int memory = 4096;                ///< -vismemory: megabytes
    int triesBeforeKeeping = 1 << 12; ///< as in FlowSettings; not an option of the program
    bool plain = false;               ///< -plain: reference mode, see FlowSettings::reference
    FarPlane farPlane{};
};

/// The potentially visible set of every cluster.
struct Visibility {
    int clusters = 0;
    std::size_t rowBytes = 0;       ///< a multiple of 8
    std::vector<std::uint8_t> rows; ///< row by row; bit c & 7 of byte c >> 3: cluster c is seen

    bool Sees(int from, int to) const {
        return (rows[std::size_t(from) * rowBytes + std::size_t(to >> 3)] >> (to & 7) & 1) != 0;
    }
    /// Number of clusters that cluster `from` sees, itself included.
    int Count(int from) const;
    /// The bytes of the visibility lump.
    std::vector<std::uint8_t> Lump() const;
};

/// The clusters that each cluster of a portal file may see: a superset of those that it does see, itself included. The
/// bytes do not depend on the number of threads. `name`: file name for messages. Throws what BuildPortalGraph throws.
/// units: results of parts, or null. Nothing: the run ends with results of units, in the store.
std::optional<Visibility> ComputeVisibility(const PortalFile &file, std::string_view name, const VisOptions &options,
                                            UnitStore *units, const JobPool &jobs, Log &log);

/// Rounds of a run in parts (PartOptions).
int PartRounds(const VisOptions &options);

/// Prints total, average, deviation, minimum and maximum of visible clusters; each cluster counts itself. `histogram`:
/// also prints, for each such number, how many clusters have it. Percentages are of all clusters.
void PrintStatistics(const Visibility &visibility, bool histogram, Log &log);

/// Set by the command-line options in the table of vis.cpp.
struct VisStageOptions {
    VisOptions vis;
    bool savePrt = false;
    bool histogram = false; ///< set by a second -v: print the number of clusters for each count of visible clusters
};

/// Takes the options of the vis stage off `arguments`. Errors: those of TakeSettings.
VisStageOptions ParseVisOptions(Arguments &arguments, Log &log);

/// The options of the vis stage, except those that all stages accept.
std::vector<SettingGroup<VisStageOptions>> VisSettings();

} // namespace q3
