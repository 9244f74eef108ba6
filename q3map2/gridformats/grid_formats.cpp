// GPL-2.0-or-later. The formats in which a map can hold its light grid: -gridformats and -convertgrid.
#include "q3map2/gridformats/grid_formats.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/gridformats/grid_octree.h"
#include "q3map2/gridformats/legacy_encode.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

namespace q3 {

// ---- Options of the stage -convertgrid ----

std::vector<SettingGroup<ConvertGridOptions>> ConvertGridSettings() {
    const auto scale = [](ConvertGridOptions &o, const SettingValues &v) { o.ambientFactor *= float(v.numbers[0]); };
    const auto goal = [](ConvertGridOptions &o) -> SparseGoal & {
        o.remakesSparse = true;
        return o.sparse;
    };
    return {
        {"Light grid formats",
         "",
         {{{.name = "-gridformats",
            .values = "LIST",
            .initial = "none; required",
            .help = "Chooses the formats in which the map has its light grid afterwards",
            .details = kGridFormatsDetails,
            .since = "0.2.0",
            .example = "sh,legacy"},
           &ConvertGridOptions::formats},
          {{.name = "-out",
            .values = "FILE.bsp",
            .initial = "the input",
            .help = "Names the map to write, next to which other files are written too",
            .details = "It is required if LIST has no form of the SH grid, since the map could not be converted again.",
            .since = "0.2.0",
            .example = "maps/mymap_ioq3.bsp"},
           &ConvertGridOptions::output},
          {{.name = "-gridambientscale",
            .values = "F",
            .kind = SettingKind::Number,
            .initial = "by game, usually 1",
            .range = {.low = 0, .aboveLow = true},
            .help = "Multiplies the ambient part of the legacy grid and of raw files",
            .since = "0.1.0",
            .example = "1.5"},
           Do<ConvertGridOptions>(scale)},
          ErrorTargetSetting<ConvertGridOptions>(
              "Sets the RMS error that the format sparse may add by interpolation",
              "Without this option and `-shbudget`, a sparse grid that the map has stays as it is. Either option makes "
              "it again from the uniform grid, whose cells it joins but does not split.",
              goal),
          BudgetSetting<ConvertGridOptions>(
              "Sets the size of the grid that the format sparse makes, instead of an error target", "", goal),
          {{.name = "-fixaas",
            .help = "Makes bot files next to the map fit the written map",
            .details = "Writes the checksum of the written map into `x.aas`, `x_b0.aas` and `x_b1.aas`.",
            .since = "0.2.0"},
           &ConvertGridOptions::fixBotFiles}}}};
}

ConvertGridOptions ParseConvertGridOptions(Arguments &arguments, float gameAmbientFactor, Log &log) {
    ConvertGridOptions options;
    options.ambientFactor = gameAmbientFactor;
    TakeSettings(ConvertGridSettings(), options, arguments, log);
    if (options.formats.empty())
        throw Error("-convertgrid needs -gridformats LIST");
    if (options.remakesSparse && !HasPlace(ParseGridFormats(options.formats), GridPlace::Sparse))
        throw Error("-sherrortarget and -shbudget need sparse in -gridformats");
    return options;
}

// ---- The conversion, and the table of formats ----

/// The SH grid of a map, and the grids made from it that several formats share.
class GridConversion {
  public:
    GridConversion(const Bsp &bsp, const GridFormats &formats, const GridStoring &storing, const JobPool &jobs,
                   Log &log)
        : jobs_(jobs), log_(log), storing_(storing), stored_(SourceGrid(bsp)), space_(bsp, SolidBrushes(bsp)),
          source_(stored_, SolidPoints(space_, LayoutOf(stored_.grid))), tone_(bsp.entities, log),
          isDeluxe_(StoredWorld(bsp.entities).Value("deluxeMapping") == "1") {
        if (AnyWritesLegacyGrid(formats))
            legacy_ = SampleLegacyPoints(source_, space_, LegacyLayout(bsp));
        hasLump15_ = HasPlace(formats, GridPlace::Lump15);
        if (HasPlace(formats, GridPlace::Sparse))
            sparse_ = bsp.sparseGridSH && !storing.sparse ? *bsp.sparseGridSH : MakeSparse();
    }

    const LightGridSH &Stored() const { return stored_.grid; }
    const SparseGridSH &Sparse() const { return *sparse_; }
    const GridSource &Source() const { return source_; }
    const GridTone &Tone() const { return tone_; }
    bool HasLump15() const { return hasLump15_; }
    bool IsDeluxe() const { return isDeluxe_; }

    /// Sets lump 15. Where points have light styles, those in walls have none.
    void SetLegacy(const LegacyTarget &target, Bsp &bsp) const {
        bsp.gridPoints = EncodeLegacyGrid(*legacy_, target, tone_, storing_.ambientFactor);
        for (std::size_t i = 0; bsp.ident != kIbspIdent && i < bsp.gridPoints.size(); ++i)
            if (legacy_->use[i] == PointUse::Solid || legacy_->use[i] == PointUse::Void)
                bsp.gridPoints[i].styles = kNoStyles;
    }
    std::vector<std::byte> Raw(const LegacyTarget &target, double scale) const {
        return EncodeRawGrid(*legacy_, target, tone_, storing_.ambientFactor, scale);
    }

  private:
    static GridLayout LayoutOf(const LightGridSH &grid) {
        return {grid.header.gridMins, grid.header.gridSize, grid.header.gridBounds};
    }

    SparseGridSH MakeSparse() const {
        const SparseGoal goal = storing_.sparse.value_or(SparseGoal{});
        SparseStats stats;
        SparseGridSH grid = SparseFromUniform(space_, stored_.grid, stored_.isRadiance, goal, jobs_, stats);
        PrintSparseStats(stats, goal, log_);
        return grid;
    }

    const JobPool &jobs_;
    Log &log_;
    GridStoring storing_;
    StoredGridSH stored_;
    BspSpace space_;
    GridSource source_;
    GridTone tone_;
    bool isDeluxe_, hasLump15_ = false;
    std::optional<LegacyPoints> legacy_; ///< for lump 15 and raw files
    std::optional<SparseGridSH> sparse_;
};

namespace {

/// As NetRadiant's q3map2 writes them, for engines that leave no points out too.
constexpr LegacyTarget kPlainReader{};
/// ioquake3 shows 0.6 * (ambient << (2 - b)) + 32 * 2^-b, where 0.6 is r_ambientScale, 2 r_mapOverBrightBits and b its
/// overbright bits. In bytes of the lump, which are shifted, the addition is 32 * 2^-b / 2^(2 - b) = 8.
constexpr LegacyTarget kIoquake3{.ambientScale = 0.6, .ambientAdded = 8, .angleSteps = 256, .skipsSolid = true};
/// The same for its floats of lightgrid.raw, to which it adds nothing.
constexpr LegacyTarget kIoquake3Raw{.ambientScale = 0.6, .angleSteps = 256, .skipsSolid = true};
/// rend2 finds points in solids by the map, not by their light.
constexpr LegacyTarget kRend2Raw{.angleSteps = 256};
constexpr double kRend2Scale = std::numbers::pi / 255; ///< it divides by pi, and 1 is full light
/// Weight k of directed light in ambient + k * directed, the one color that Daemon keeps: of maps without and with
/// deluxemaps.
constexpr double kDaemonDirected = 0.4, kDaemonDeluxeDirected = 0.25;

void StoreUniform(const GridConversion &from, Bsp &bsp, GridSHContainer container) {
    bsp.gridSH = from.Stored();
    bsp.gridSHContainer = container;
}

void StoreSH(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    StoreUniform(from, bsp, bsp.ident == kIbspIdent ? GridSHContainer::Lump : GridSHContainer::Bspx);
}

void StoreSHBspx(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    StoreUniform(from, bsp, GridSHContainer::Bspx);
}

void StoreSparse(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    bsp.sparseGridSH = from.Sparse();
}

void StoreLegacy(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    from.SetLegacy(kPlainReader, bsp);
}

void StoreLegacyIoquake3(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    from.SetLegacy(kIoquake3, bsp);
}

void StoreLegacyDaemon(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    const LegacyTarget target{.skipsSolid = true,
                              .directedWeight = from.IsDeluxe() ? kDaemonDeluxeDirected : kDaemonDirected};
    from.SetLegacy(target, bsp);
}

void StoreRaw(const GridConversion &from, const LegacyTarget &lump, const LegacyTarget &raw, double scale, Bsp &bsp,
              std::vector<GridFile> &files) {
    if (!from.HasLump15())
        from.SetLegacy(lump, bsp);
    files.push_back({std::string(kRawGridFile), from.Raw(raw, scale)});
}

void StoreRawIoquake3(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &files) {
    StoreRaw(from, kIoquake3, kIoquake3Raw, 1, bsp, files);
}

void StoreRawRend2(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &files) {
    StoreRaw(from, kPlainReader, kRend2Raw, kRend2Scale, bsp, files);
}

void StoreOctree(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    bsp.bspx.push_back({std::string(kBspxGridOctree), EncodeOctreeLump(from.Source(), from.Tone())});
}

void StoreGrids(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &) {
    bsp.bspx.push_back({std::string(kBspxGrids), EncodeGridsLump(from.Source(), from.Tone())});
}

constexpr GridFormat kGridFormats[] = {
    {"sh", GridPlace::Uniform, GridFormat::Convertible::Yes, StoreSH},
    {"shbspx", GridPlace::Uniform, GridFormat::Convertible::Yes, StoreSHBspx},
    {"sparse", GridPlace::Sparse, GridFormat::Convertible::Yes, StoreSparse},
    {"legacy", GridPlace::Lump15, GridFormat::Convertible::No, StoreLegacy},
    {"legacy-ioq3", GridPlace::Lump15, GridFormat::Convertible::No, StoreLegacyIoquake3},
    {"legacy-daemon", GridPlace::Lump15, GridFormat::Convertible::No, StoreLegacyDaemon},
    {"raw-ioq3", GridPlace::RawFile, GridFormat::Convertible::No, StoreRawIoquake3},
    {"raw-rend2", GridPlace::RawFile, GridFormat::Convertible::No, StoreRawRend2},
    {"octree", GridPlace::OctreeLump, GridFormat::Convertible::No, StoreOctree},
    {"grids", GridPlace::GridsLump, GridFormat::Convertible::No, StoreGrids},
};

const GridFormat &FindGridFormat(std::string_view word) {
    const auto found =
        std::ranges::find_if(kGridFormats, [&](const GridFormat &f) { return EqualNoCase(f.word, word); });
    if (found != std::end(kGridFormats))
        return *found;
    std::vector<std::string_view> words;
    for (const GridFormat &format : kGridFormats)
        words.push_back(format.word);
    throw Error("-gridformats: \"{}\" is not a format, expected words of {} separated by commas", word,
                fmt::join(words, ", "));
}

} // namespace

std::span<const GridFormat> AllGridFormats() {
    return kGridFormats;
}

GridFormats ParseGridFormats(std::string_view list) {
    GridFormats formats;
    for (std::size_t at = 0; at <= list.size();) {
        const std::size_t end = std::min(list.find(',', at), list.size());
        const GridFormat &format = FindGridFormat(list.substr(at, end - at));
        for (const GridFormat *other : formats)
            if (other->place == format.place)
                throw Error("-gridformats: {} and {} exclude each other, since a map has one place for both",
                            other->word, format.word);
        formats.push_back(&format);
        at = end + 1;
    }
    return formats;
}

bool HasPlace(const GridFormats &formats, GridPlace place) {
    return std::ranges::any_of(formats, [&](const GridFormat *format) { return format->place == place; });
}

bool AnyConvertible(const GridFormats &formats) {
    return std::ranges::any_of(
        formats, [](const GridFormat *format) { return format->convertible == GridFormat::Convertible::Yes; });
}

bool AnyWritesLegacyGrid(const GridFormats &formats) {
    return HasPlace(formats, GridPlace::Lump15) || HasPlace(formats, GridPlace::RawFile);
}

void DropGridLumps(Bsp &bsp) {
    std::erase_if(bsp.bspx,
                  [](const BspxLump &lump) { return lump.name == kBspxGridOctree || lump.name == kBspxGrids; });
}

std::vector<GridFile> StoreGridFormats(Bsp &bsp, const GridFormats &formats, const GridStoring &storing,
                                       const JobPool &jobs, Log &log) {
    const GridConversion from(bsp, formats, storing, jobs, log);
    bsp.gridSH.reset();
    bsp.sparseGridSH.reset();
    DropGridLumps(bsp);
    std::vector<GridFile> files;
    for (const GridFormat *format : formats) {
        log.Print("Light grid as {}\n", format->word);
        format->store(from, bsp, files);
    }
    if (!AnyConvertible(formats)) {
        std::vector<Entity> entities = StoredEntities(bsp.entities, "the map");
        entities.front().Erase(kGridSHKey);
        bsp.entities = FormatEntities(entities);
    }
    return files;
}

} // namespace q3
