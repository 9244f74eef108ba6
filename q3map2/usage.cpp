// GPL-2.0-or-later. q3map2 -help.
#include "q3map2/bspfile/entities.h"
#include "q3map2/stages.h"

namespace q3 {

namespace {

struct Topic {
    std::string_view name, text;
};

constexpr Topic kTopics[] = {
    {"common", R"(Global options, with every stage, anywhere on the line:
  -help [topic]           this text; topics: common bsp vis light lightmap json
                          export info shpreview game
  -v                      more output
  -threads N              worker threads (default: one per hardware thread)
  -connect A.B.C.D:PORT   send what is printed to an editor
  -force                  load files with a wrong ident or version
  -game NAME              row of the games table (default quake3)
  -fs_basepath DIR        where the game is installed; repeatable
  -fs_game DIR            mod folder; repeatable, wins over the base game
  -fs_basegame DIR        base game folder instead of the table's
  -fs_home DIR, -fs_homebase DIR, -fs_homepath DIR
                          home folder; the game's folder in it; both in one
  -fs_pakpath DIR         further folder with game files; repeatable
  -fs_forbiddenpath MASK  skip folders and archives of that name; repeatable
)"},
    {"bsp", R"(q3map2 [-bsp] [options] maps/x.map     compiles a map source: x.bsp, x.srf, x.prt (x.lin when it leaks)
  -meta                   triangles of brush faces joined to large surfaces; what everybody wants
  -patchmeta              patches as triangles too
  -leaktest               stop at a leak
  -onlyents               replace the entities of x.bsp only
  -keeplights, -keepmodels   entities that are otherwise compiled in
Left out: -nodetail -nowater -nohint -nofog -nosubdivide -nocurves -notjunc -noflares;  -fulldetail
Surfaces:
  -samplesize N           game units a luxel (16);  -minsamplesize N
  -mv N  -mi N            vertices and indexes a surface
  -np DEGREES             smooth and join across edges
  -metaadequatescore N  -metagoodscore N  -maxarea  -nobrushsnap  -flat  -celshader NAME
  -flares  -skyfix
Tree and planes:
  -ne F  -de F            how near normals and distances of planes count as equal
  -deep  -altsplit  -snap N
Shaders and models:
  -custinfoparms  -noob  -globalflag PARM  -rename  -clipdepth F  -sRGBcolor -nosRGBcolor -nosRGB
For editors:
  -autocaulk              x.caulk: which sides nobody sees
  -tempname FILE          read the map from this file and delete it afterwards
Pictures of what is going on:
  -debugsurfaces  -debuginset  -debugportals  -debugclip  -fakemap  -verboseentities
Global ones of this stage:
  -subdivisions N         tolerance of curves made of triangles (8)
  -maxmapdrawsurfs N      most draw surfaces (131072)
)"},
    {"vis", R"(q3map2 -vis [options] maps/x.bsp       what can be seen from where, from maps/x.prt; removes x.prt
  -saveprt                keep x.prt
  -fast                   rough and quick: by the sides that portals face
  -merge                  merge leafs and their portals first: quicker, less exact
  -hint                   the same, but not through hint brushes
  -mergeportals           merge portals between the same two leafs
  -nopassage              portal flow without passages: slower, less exact
  -passageOnly            passages without portal flow: quicker, less exact
  -nosort                 portals in the order of the file
  -plain                  each direction for itself, as the established program does
  -v -v                   how many clusters see how many others
)"},
    {"light", R"(q3map2 -light [options] maps/x.bsp     lights a compiled map; lightmap options: -help lightmap
  -onlygrid               leave lightmaps and vertex colours as they are
SH light grid:
  -sh                     bake the SH light grid into lump 18 of a version 47 file
  -shbspx                 ... into a BSPX lump of a version 46 file, which unmodified engines load
  -shradiance             store the plain projection, for engines that convolve themselves
  -shdering               no negative lobes: values change by the least that takes them away
  -sherror                say how far the grid is off, and which cells halve that
  -shfit [N]              fit all points to light at N places a cell (default 6)
  -noshfill               points in solids from their neighbours alone
  -shsamples F            F times as many rays and samples (default 1)
  -gridscalesh F          points per axis relative to the legacy grid (default 2)
  -gridsh X Y Z           cell size in game units, at least 8
  -shpreview FILE.png     picture of what both grids show
Intensities (each multiplies):
  -scale F  -point F  -spherical F  -spot F  -area F  -sky F (also with the ending "scale")
  -bouncescale F
  -gridscale F  -gridambientscale F  -griddirectionality F  -gridambientdirectionality F
  -backsplash SCALE DIST  -extradist F  -wolf  -q3
Tone of lightmaps, vertices and the legacy grid:
  -gamma F  -exposure F  -compensate F  -contrast F  -saturation F
  -sRGB -nosRGB, -sRGBlight, -sRGBtex, -sRGBcolor and their -nosRGB forms
Speed and rays:
  -fast                   lights end below the tolerance; SH grid: few samples
  -fastgrid               that for the grids alone
  -faster                 and area lights count as points, but for the SH grid
  -cheap, -cheapgrid      stop adding lights to what is white: vertices and legacy grid, or the grid alone
  -nogrid                 leave the legacy grid as it is
  -noskip                 trace every light at every point; or one kind of skip off:
  -noskipreach  -noskippvs  -noskipfaint  -noskipmoments  -noskipprobes  -noskipcoarse
  -notrace  -nosurf  -sunonly  -onesky  -patchshadows  -style  -nostyle
  -floodlight             light from wherever it is open around;  -lowquality with half the rays
)"},
    {"lightmap", R"(q3map2 -light [options] maps/x.bsp     lightmaps, vertex light and bounces
Samples:
  -super N                N x N samples a luxel, 1 to 8
  -samples [+]N           grade of adaptive samples where light changes; with -randomsamples random ones
  -samplessearchboxsize N  -filter  -thresh F  -samplescale N  -rawlightmapsizelimit N
  -samplesize N           without a .srf: game units a luxel (16); -minsamplesize N
  -shade, -shadeangle F   smooth normals where faces meet at less than so many degrees
  -lightanglehl 0|1       softer angle of light
  -nofastpoint  -dark  -trianglecheck  -extravisnudge
Dirt:
  -dirty                  darken what is hemmed in
  -dirtdepth F  -dirtscale F  -dirtgain F  -dirtmode 0|1
Bounces:
  -bounce N               passes of light that surfaces throw back
  -bouncegrid             on the grids too
  -bouncescale F  -bouncecolorratio F  -bounceonly
Vertices:
  -vertexscale F  -novertex [F]  -cpma  -nolm
Pages:
  -lightmapsize N [M]     another size than the game's: images beside the map
  -external               images at the game's size too;  -lightmapdir DIR
  -extlmhacksize N [M]    images shown by made shaders, for engines that know only their own pages
  -deluxe, -nodeluxe      pages of light directions;  -deluxemode 0|1 model or tangent space
  -brightness F  -approx N  -nocollapse  -slowallocate  -fill  -fillpink  -trisoup  -export
  -nolightmapsearch  -lightmapsearchblocksize N  -lightmapsearchpower N
Pictures of what is going on:
  -debug  -border  -debugsurfaces  -debugaxis  -debugcluster  -debugorigin  -debugnormals
  -normalmap  -debugdeluxe  -dirtdebug  -debugsamplesize
)"},
    {"json", R"(q3map2 -json [-unpack] maps/x.bsp      writes all lumps as JSON files into maps/x/
q3map2 -json -pack maps/x.bsp          reads them and writes maps/x_json.bsp
  -useflagnames           with -pack: flags come from their names in the game's table
  -skipflags              with -useflagnames: drop unknown names
)"},
    {"export", R"(q3map2 -export maps/x.bsp              writes the lightmaps of the file as maps/x/lightmap_NNNN.tga
q3map2 -import maps/x.bsp              replaces them by these images
)"},
    {"info", R"(q3map2 -info a.bsp b.bsp ...           counts and bytes of all lumps
)"},
    {"shpreview", R"(q3map2 -shpreview FILE.png maps/x.bsp  picture of what both light grids of a map show
)"}};

} // namespace

void PrintUsage(std::string_view topic, Log &log) {
    while (topic.starts_with('-'))
        topic.remove_prefix(1);
    if (EqualNoCase(topic, "game")) {
        for (const Game &game : Games())
            log.Print("  {}\n", game.name);
        return;
    }
    bool found = false;
    for (const Topic &one : kTopics)
        found |= EqualNoCase(topic, one.name);
    log.Print("{}\n", kVersion);
    for (const Topic &one : kTopics)
        if (!found || EqualNoCase(topic, one.name))
            log.Print("\n{}", one.text);
}

} // namespace q3
