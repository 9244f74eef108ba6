// GPL-2.0-or-later. The options of the SH light grid and of ambient cubes, declared.
#include "q3map2/light/options/grid_settings.h"

namespace q3 {

namespace {

using Group = SettingGroup<LightOptions>;
using Values = SettingValues;

/// -shfit without a number, and its maximum.
constexpr int kDefaultFit = 6, kMaxFit = 64;

Group GridSH() {
    const auto cell = [](LightOptions &o, const Values &v) {
        o.gridSizeSH = Vec3f{float(v.numbers[0]), float(v.numbers[1]), float(v.numbers[2])};
    };
    const auto small = [](LightOptions &o, const Values &) {
        o.sh = true;
        o.gridSizeSH = Vec3f{kSmallCellSH, kSmallCellSH, kSmallCellSH};
        o.shFit = kDefaultFit;
    };
    return {
        "SH light grid",
        "The SH light grid is an irradiance volume. Each of its points is a light probe that holds nine coefficients "
        "of spherical harmonics (SH), from which engines light models. [Releasing](../guide/releasing.md) compares "
        "sizes and errors of grids.",
        {{{.name = "-sh",
           .help = "Bakes the SH light grid and stores it in lump 18 of the .bsp, which becomes version 47",
           .details = "Engines without support for the grid refuse files of version 47. RBSP and FBSP files keep their "
                      "version and hold the grid in a BSPX lump, as with `-shbspx`. A run that bakes no SH grid drops "
                      "one that the file had, with a warning.",
           .since = "0.1.0"},
          &LightOptions::sh},
         {{.name = "-shbspx",
           .help = "Bakes the SH light grid into a BSPX lump, so that engines without support still load the map",
           .details = "Implies `-sh`. The file keeps version 46, and [BSP format](bsp_format.md) describes the lump.",
           .since = "0.1.0"},
          &LightOptions::shBspx},
         {{.name = "-shradiance",
           .help = "Stores radiance instead of irradiance, for engines that do the convolution themselves",
           .details =
               "Implies `-sh`, unless `-shadaptive` or a word of `-gridformats` (`sh`, `shbspx` or `sparse`) names the "
               "grid to store. Writes the worldspawn key `_q3map2_sh` with the value `radiance`. Cannot be combined "
               "with `-shlights`.",
           .since = "0.1.0"},
          &LightOptions::shRadiance},
         {{.name = "-gridformats",
           .values = "LIST",
           .initial = "none",
           .help = "Converts the baked SH grid to the light grid formats of other engines",
           .details =
               "LIST is one or more words with commas between them, as for "
               "[-convertgrid](other_stages.md#-convertgrid), which explains them. The SH grid is baked in any case. "
               "It stays in the map only if LIST has `sh` or `shbspx`, or if another option implies `-sh`. A legacy "
               "grid that is made from the SH grid is not traced.",
           .since = "0.2.0",
           .example = "shbspx,legacy-ioq3"},
          &LightOptions::gridFormats},
         {{.name = "-shsmall",
           .help = "Bakes an SH grid of about a quarter of the size, with wider cells that are fitted to the light",
           .details = "Stands for `-sh -gridsh 64 64 64 -shfit`. The options `-gridsh` and `-shfit N` override it. "
                      "[Releasing](../guide/releasing.md) compares its size and its error with other grids.",
           .since = "0.2.0"},
          Do<LightOptions>(small)},
         {{.name = "-gridscalesh",
           .values = "F",
           .range = {.low = 0, .aboveLow = true},
           .help = "Sets how many points the SH grid has per point of the legacy grid, along each axis",
           .details = "The size of a cell is the worldspawn key `gridsize` divided by F. Has no effect with `-gridsh`.",
           .since = "0.1.0",
           .example = "1"},
          &LightOptions::gridScaleSH},
         {{.name = "-gridsh",
           .values = "X Y Z",
           .kind = SettingKind::Number,
           .unit = "game units",
           .initial = "gridsize divided by -gridscalesh",
           .range = {.low = 0, .aboveLow = true},
           .floor = double(kMinCell),
           .help = "Sets the size of the cells of the SH grid",
           .details = "A value below 8 becomes 8, with a warning. If the grid would pass 1.75 GiB, its cells grow by 8 "
                      "units at a time until it does not, with a warning.",
           .since = "0.1.0",
           .example = "64 64 64"},
          Do<LightOptions>(cell)}}};
}

Group SparseGridSH() {
    const auto goal = [](LightOptions &o) -> SparseGoal & {
        o.shAdaptive = o.sparseGoal.isGiven = true;
        return o.sparseGoal;
    };
    return {
        "Sparse SH light grid",
        "A sparse grid has cells with edges down to 4 units near lights and shadow edges, and large cells elsewhere. "
        "[The SH grid](../internals/sh_grid.md) explains how it is refined, and [Releasing](../guide/releasing.md) "
        "when to use it.",
        {{{.name = "-shadaptive",
           .help = "Bakes the SH light as a sparse grid into a BSPX lump, which other engines ignore",
           .details = "Add `-sh` or `-shbspx` to store the uniform grid too. A run that bakes no sparse grid drops one "
                      "that the file had, with a warning.",
           .since = "0.2.0"},
          &LightOptions::shAdaptive},
         {{.name = "-shlights",
           .help = "Bakes the SH light as a grid that names its strongest lights, into a BSPX lump",
           .details =
               "Each point stores the visible fraction of each named light, and SH coefficients of all other light. "
               "Engines compute the named lights at the position of the model, see "
               "[Named lights](../engines/named_lights.md). Cells have the size of `-gridsh`. With `-shadaptive`, they "
               "begin at twice that edge, and are split and joined to meet `-sherrortarget` or `-shbudget`. No other "
               "sparse grid is stored then. Without a target and a budget, splitting ends where it would take longer "
               "than the uniform grid. Lights with a style are named wherever they arrive, so that engines can switch "
               "them. Cannot be combined with `-shradiance`.",
           .since = "0.2.0"},
          &LightOptions::shLights},
         {{.name = "-shnames",
           .values = "N",
           .kind = SettingKind::Integer,
           .unit = "lights",
           .range = {1, 16},
           .help = "Sets how many lights without a style a cell of -shlights names at most",
           .details = "Lights with a style are named in addition. Has no effect without `-shlights`.",
           .since = "0.2.0",
           .example = "8"},
          &LightOptions::shNames},
         ErrorTargetSetting<LightOptions>(
             "Sets the error on screen that the sparse grid may have at positions of players",
             "Implies `-shadaptive`. The error is the root mean square (RMS) of displayed light at 2000 random "
             "positions that players can reach, which is measured and printed. Cells are split while the error is "
             "above the target and smaller cells reduce it. The grid has at most half of the bytes of the uniform "
             "grid, or 0.08 MB if that is more. With `-shlights`, the limit is a tenth instead of a half. "
             "[Results](../internals/results.md) has errors and sizes of real maps.",
             goal),
         BudgetSetting<LightOptions>("Sets the size of the sparse grid, instead of an error target",
                                     "Implies `-shadaptive`. The grid with the least error that fits is stored.",
                                     goal)}};
}

Group QualityOfGridSH() {
    const auto fit = [](LightOptions &o, const Values &v) {
        o.shFit = v.numbers.empty() ? kDefaultFit : int(v.numbers[0]);
    };
    return {
        "SH light grid: quality",
        "",
        {{{.name = "-shdering",
           .help = "Removes negative lobes, which are the dark sides opposite to strong lights",
           .details =
               "If a channel of a point is below zero in some direction, its bands 1 and 2 are scaled by the weakest "
               "window that leaves no negative value (Sloan 2008). The mean of the point and all other points stay as "
               "they are. Interpolated values are then not negative either, except for rounding in a sparse grid. "
               "Needs `-sh` or `-shadaptive`, or an option that implies one of them.",
           .since = "0.1.0"},
          &LightOptions::shDering},
         {{.name = "-sherror",
           .help = "Compares the finished SH grid with exact light and prints its error",
           .details =
               "Light is traced at 2000 random positions that players can reach. The error of displayed light and the "
               "fraction of positions with light leaks are printed. For the uniform grid, the cell size that would "
               "halve the error is printed too. Needs `-sh`, `-shadaptive` or `-shlights`, or an option that implies "
               "one of them.",
           .since = "0.1.0"},
          &LightOptions::shError},
         {{.name = "-shfit",
           .values = "[N]",
           .kind = SettingKind::Integer,
           .unit = "samples per cell",
           .initial = "off; 6 without N",
           .range = {1, kMaxFit},
           .help = "Fits the points of the SH grid to N light samples in each cell, by least squares",
           .details =
               "The grid is more accurate between its points, and takes about N times as long. Samples are taken where "
               "players can be, and more of them close to lights. [Results](../internals/results.md) shows what it "
               "gains. Needs `-sh` or `-shadaptive`, or an option that implies one of them. Cannot be combined with "
               "`-noshfill`.",
           .since = "0.1.0",
           .example = "8 -sh"},
          Do<LightOptions>(fit)},
         {{.name = "-noshfill",
           .help = "Fills grid points inside walls from their neighbors, without fitting them to the light in front",
           .details = "Cannot be combined with `-shfit`.",
           .since = "0.1.0"},
          Off(&LightOptions::shFill)},
         {{.name = "-shsamples",
           .values = "F",
           .initial = "1, or 1/16 with -fast or -fastgrid",
           .range = {1.0 / 64, 64},
           .help = "Multiplies the number of rays and samples of the SH grid",
           .details = "More rays hardly reduce the error. Smaller cells and `-shfit` do.",
           .since = "0.1.0",
           .example = "0.25"},
          &LightOptions::givenSHSamples},
         {{.name = "-shpreview",
           .values = "FILE.png",
           .initial = "none",
           .help = "Draws a plan of the map and spheres that both light grids light to a picture",
           .details = "Needs `-sh`, `-shadaptive` or `-shlights`, or an option that implies one of them. "
                      "The stage [-shpreview](other_stages.md#-shpreview) draws the same of a lit map.",
           .since = "0.1.0",
           .example = "preview.png -sh"},
          &LightOptions::previewFile}}};
}

Group AmbientCubes() {
    const auto from = [](LightOptions &o, const Values &v) {
        o.ambientCubes = true;
        o.cubesFromSH = v.words[0] == "sh";
    };
    return {"Ambient cubes",
            "Ambient cubes hold the light on surfaces that face the six axes, at several places in each leaf of the "
            "BSP tree. [Other grid formats](../engines/grid_formats.md) compares them with the SH grid.",
            {{{.name = "-ambientcubes",
               .help = "Bakes ambient cubes into a BSPX lump, which other engines ignore",
               .details = "A run that bakes no ambient cubes drops those that the file had, with a warning.",
               .since = "0.2.0"},
              &LightOptions::ambientCubes},
             {{.name = "-ambientcubesfrom",
               .values = "light|sh",
               .kind = SettingKind::Choice,
               .initial = "light",
               .help = "Chooses whether the light of ambient cubes is traced or taken from the SH grid",
               .details = "Implies `-ambientcubes`. The value `sh` costs next to nothing and has the errors of the SH "
                          "grid. It needs `-sh` or `-shadaptive`, or an option that implies one of them.",
               .since = "0.2.0",
               .example = "sh -sh"},
              Do<LightOptions>(from)},
             {{.name = "-cubesperleaf",
               .values = "N",
               .kind = SettingKind::Integer,
               .unit = "cubes",
               .range = {1, 32},
               .help = "Sets how many ambient cubes a leaf keeps at most",
               .details = "Engines blend all cubes of a leaf at every model. More than 16 hardly improve the blend.",
               .since = "0.2.0",
               .example = "8"},
              &LightOptions::cubesPerLeaf},
             {{.name = "-cubetolerance",
               .values = "F",
               .unit = "8-bit levels",
               .range = {.low = 0, .high = 255},
               .help = "Leaves out ambient cubes that the others of their leaf reproduce within this error",
               .details = "The error is that on a screen of gamma 2.2. At 0 only duplicates are left out.",
               .since = "0.2.0",
               .example = "1"},
              &LightOptions::cubeTolerance}}};
}

Group Skips() {
    const auto skip = [](bool SkipOptions::*field) {
        return Do<LightOptions>([field](LightOptions &o, const Values &) { o.skip.*field = false; });
    };
    const auto none = [](LightOptions &o, const Values &) {
        o.skip = {.reach = false,
                  .pvs = false,
                  .faint = false,
                  .moments = false,
                  .probes = false,
                  .smooth = false,
                  .coarse = false};
    };
    return {
        "Accelerations to switch off",
        "The light stage leaves out light that cannot matter. These options compute it all the same, to measure what "
        "is lost and how much time is saved.",
        {{{.name = "-noskip",
           .help = "Traces every light at every point",
           .details = "Stands for all of the following options.",
           .since = "0.1.0"},
          Do<LightOptions>(none)},
         {{.name = "-noskipreach", .help = "Also traces lights that are out of reach or face away", .since = "0.1.0"},
          skip(&SkipOptions::reach)},
         {{.name = "-noskippvs", .help = "Also traces lights that visibility data hides", .since = "0.1.0"},
          skip(&SkipOptions::pvs)},
         {{.name = "-noskipfaint",
           .help = "Traces all faint lights instead of a few that represent them",
           .details = "Concerns both grids, and surface lights in lightmaps.",
           .since = "0.1.0"},
          skip(&SkipOptions::faint)},
         {{.name = "-noskipmoments",
           .help = "Integrates far surface lights exactly instead of approximating them by points",
           .details = "Concerns both grids.",
           .since = "0.1.0"},
          skip(&SkipOptions::moments)},
         {{.name = "-noskipprobes",
           .help = "Casts several rays to faint surface lights instead of one",
           .since = "0.1.0"},
          skip(&SkipOptions::probes)},
         {{.name = "-noskipsmooth",
           .help = "Traces weak light at every point of the SH grid, even where it is smooth",
           .since = "0.2.0"},
          skip(&SkipOptions::smooth)},
         {{.name = "-noskipcoarse",
           .help = "Casts rays to dim lights at every point, with -fast or -fastgrid",
           .since = "0.1.0"},
          skip(&SkipOptions::coarse)}}};
}

} // namespace

std::vector<SettingGroup<LightOptions>> GridSettings() {
    return {GridSH(), SparseGridSH(), QualityOfGridSH(), AmbientCubes(), Skips()};
}

} // namespace q3
