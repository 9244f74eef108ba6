// GPL-2.0-or-later. Counts and sizes of a .bsp file, and what may be in one of an unknown game.
#include "q3map2/convert/bsp_info.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/grid_table.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace q3 {

// ---- q3map2 -analyze ----

namespace {

constexpr std::size_t kDirectoryAt = 8, kEntryBytes = 8;   ///< bytes: ident and version; offset and length
constexpr std::size_t kMaxLumps = 100;                     ///< more than any game of the family has
constexpr std::size_t kMaxText = 1023, kTextColumns = 100; ///< characters of a lump that are shown, and of a line

/// A record of games of the family: its size, and how many a map has at least.
struct RecordKind {
    std::string_view name;
    std::size_t bytes, minCount;
};
constexpr RecordKind kRecordKinds[] = {
    {"planes", 16, 6},
    {"brushes", 12, 1},
    {"brush sides (IBSP)", 8, 6},
    {"brush sides (RBSP)", 12, 6},
    {"models", 40, 1},
    {"nodes", 36, 2},
    {"leafs", 48, 1},
    {"draw surfaces", 104, 3},
    {"draw vertices", 44, 3},
    {"draw indexes", 4, 6},
    {"lightmaps, 128 x 128", 49152, 1},
    {"lightmaps, 256 x 256", 196608, 1},
    {"lightmaps, 512 x 512", 786432, 1},
};

template <typename T> T FirstAs(std::span<const std::byte> bytes) {
    T value{};
    std::memcpy(&value, bytes.data(), std::min(sizeof value, bytes.size()));
    return value;
}

/// Text up to the first zero byte, with '.' for what cannot be printed.
std::string PrintableStart(std::span<const std::byte> lump) {
    const std::string_view text = AsText(lump.first(std::min(lump.size(), kMaxText)));
    std::string printable(text.substr(0, text.find('\0')));
    std::ranges::replace_if(
        printable, [](char c) { return c < ' ' || c > '~'; }, '.');
    return printable;
}

void PrintLump(std::size_t number, const FoundLump &found, std::span<const std::byte> file, Log &log) {
    log.Print("lump {:2}: offset {}, length {}\n", number, found.offset, found.length);
    const auto lump = file.subspan(std::size_t(found.offset), std::size_t(found.length));
    if (lump.empty())
        return;
    log.Print("         hex {:08x}, int {}, float {}\n", FirstAs<std::uint32_t>(lump), FirstAs<std::int32_t>(lump),
              FirstAs<float>(lump));
    const std::string text = PrintableStart(lump);
    for (std::size_t at = 0; at < text.size(); at += kTextColumns)
        log.Print("         {} {}\n", at == 0 ? "text" : "    ", text.substr(at, kTextColumns));
    std::string guesses;
    for (const std::string &guess : GuessLump(lump))
        guesses += (guesses.empty() ? "" : ", ") + guess;
    log.Print("         may be {}\n", guesses.empty() ? "of a kind not known here" : guesses);
}

} // namespace

std::vector<FoundLump> FindLumps(std::span<const std::byte> file, bool lumpSwap, std::string_view name) {
    if (file.size() < kDirectoryAt + kEntryBytes)
        throw Error("{}: {} bytes, expected four letters, a version and a directory of lumps", name, file.size());
    std::vector<FoundLump> lumps;
    std::size_t end = file.size(); // of the directory, as far as one can tell
    for (std::size_t at = kDirectoryAt; at + kEntryBytes <= end && lumps.size() < kMaxLumps; at += kEntryBytes) {
        const auto first = FirstAs<std::int32_t>(file.subspan(at)),
                   second = FirstAs<std::int32_t>(file.subspan(at + 4));
        const FoundLump lump{lumpSwap ? second : first, lumpSwap ? first : second};
        if (lump.offset < 0 || lump.length < 0 || std::int64_t(lump.offset) + lump.length > std::int64_t(file.size()))
            break;
        lumps.push_back(lump);
        if (lump.length > 0)
            end = std::min(end, std::size_t(lump.offset));
    }
    return lumps;
}

std::vector<std::string> GuessLump(std::span<const std::byte> lump) {
    const std::string_view text = AsText(lump);
    if (text.size() > 2 && text[0] == '{' && text[2] == '"') // a brace, a line end, and the quote of the first key
        return {"entities"};
    if (text.find("textures/") != std::string_view::npos)
        return {"shaders"};
    std::vector<std::string> guesses;
    for (const RecordKind &kind : kRecordKinds)
        if (lump.size() % kind.bytes == 0 && lump.size() / kind.bytes >= kind.minCount)
            guesses.push_back(fmt::format("{} {}", lump.size() / kind.bytes, kind.name));
    return guesses;
}

void PrintAnalysis(std::span<const std::byte> file, bool lumpSwap, std::string_view name, Log &log) {
    const std::vector<FoundLump> lumps = FindLumps(file, lumpSwap, name);
    log.Print("{}\nident   {}\n", name, PrintableStart(file.first(4)));
    log.Print("version {}\n", FirstAs<std::int32_t>(file.subspan(4)));
    log.Print("bytes   {}\n", file.size());
    for (std::size_t i = 0; i < lumps.size(); ++i)
        PrintLump(i, lumps[i], file, log);
    if (lumps.empty())
        log.Print("The first entry of the directory does not lie in the file; try it {} -lumpswap\n",
                  lumpSwap ? "without" : "with");
}

// ---- q3map2 -info ----

namespace {

constexpr std::string_view kSeparator = "---------------------------------";
constexpr double kMegabyte = 1024 * 1024;

/// Record sizes of IBSP. NetRadiant's q3map2 prints those in memory, which RBSP files have, for all files.
constexpr std::size_t kIbspBrushSideBytes = 8, kIbspSurfaceBytes = 104, kIbspVertBytes = 44, kIbspGridPointBytes = 8;

/// The value with -0 as 0, for text.
float WithoutNegativeZero(float value) {
    return value + 0.0f;
}

/// Prints the table of one file.
class InfoTable {
  public:
    InfoTable(const std::filesystem::path &path, const Bsp &bsp, Log &log) : path_(path), bsp_(bsp), log_(log) {}

    void Print() const {
        PrintGeometry();
        PrintSurfaces();
        const Entity world = StoredWorld(bsp_.entities);
        PrintLight(world);
        PrintLumps(world);
        PrintExtras();
    }

  private:
    /// What is printed of a BSPX lump. A blank line follows each group.
    struct LumpInfo {
        BspxId id;
        enum Group { UniformGrid, SparseGrid, HdrLight, Cubes } group;
        void (InfoTable::*print)(const Entity &world) const;
    };

    void PrintLumps(const Entity &world) const {
        static constexpr LumpInfo kInfos[] = {
            {BspxId::LightGridSH, LumpInfo::UniformGrid, &InfoTable::PrintGridSH},
            {BspxId::SparseGridSH, LumpInfo::SparseGrid, &InfoTable::PrintSparseGrid},
            {BspxId::NamedGridSH, LumpInfo::SparseGrid, &InfoTable::PrintNamedGrid},
            {BspxId::LightmapsE5bgr9, LumpInfo::HdrLight, &InfoTable::PrintHdrLightmaps},
            {BspxId::VertexE5bgr9, LumpInfo::HdrLight, &InfoTable::PrintHdrVertices},
            {BspxId::Rnm, LumpInfo::HdrLight, &InfoTable::PrintRnm},
            {BspxId::PropLight, LumpInfo::HdrLight, &InfoTable::PrintProps},
            {BspxId::AmbientCubes, LumpInfo::Cubes, &InfoTable::PrintCubes},
        };
        static_assert(HasRowOfEachLump(kInfos));
        const LumpInfo *last = nullptr; // printed
        for (const LumpInfo &info : kInfos) {
            if (!RowOf(info.id).has(bsp_))
                continue;
            if (last != nullptr && last->group != info.group)
                log_.Print("\n");
            (this->*info.print)(world);
            last = &info;
        }
        if (last != nullptr)
            log_.Print("\n");
    }

    template <typename Record> void Line(const std::vector<Record> &records, std::string_view name) const {
        Line(records.size(), name, records.size() * sizeof(Record));
    }
    bool IsIbsp() const { return bsp_.ident == kIbspIdent; }
    /// Records that are smaller in IBSP files.
    template <typename Record>
    void LineOfStyled(const std::vector<Record> &records, std::string_view name, std::size_t ibspBytes) const {
        const std::size_t bytes = records.size() * sizeof(Record);
        if (IsIbsp())
            LineInFile(records.size(), name, bytes, records.size() * ibspBytes);
        else
            Line(records.size(), name, bytes);
    }
    void LineInFile(std::size_t count, std::string_view name, std::size_t bytes, std::size_t inFile) const {
        log_.Print("{:9} {:<14} {:9} * ({} in the file)\n", count, name, bytes, inFile);
    }
    void Line(std::size_t count, std::string_view name, std::size_t bytes) const {
        log_.Print("{:9} {:<14} {:9}\n", count, name, bytes);
    }

    void PrintGeometry() const {
        Line(bsp_.models, "models");
        Line(bsp_.shaders, "shaders");
        Line(bsp_.brushes, "brushes");
        LineOfStyled(bsp_.brushSides, "brushsides", kIbspBrushSideBytes);
        Line(bsp_.fogs, "fogs");
        Line(bsp_.planes, "planes");
        Line(EntityCount(), "entdata", bsp_.entities.size() + 1);
        log_.Print("\n");
        Line(bsp_.nodes, "nodes");
        Line(bsp_.leafs, "leafs");
        Line(bsp_.leafSurfaces, "leafsurfaces");
        Line(bsp_.leafBrushes, "leafbrushes");
        log_.Print("\n");
    }

    void PrintSurfaces() const {
        const auto ofType = [this](int type, std::string_view name) {
            const auto count = std::ranges::count(bsp_.drawSurfaces, type, &bspDrawSurface_t::surfaceType);
            if (count > 0 || type != MST_FLARE)
                log_.Print("{:9}   {}\n", count, name);
        };
        LineOfStyled(bsp_.drawSurfaces, "drawsurfaces", kIbspSurfaceBytes);
        ofType(MST_PATCH, "patch surfaces");
        ofType(MST_PLANAR, "planar surfaces");
        ofType(MST_TRIANGLE_SOUP, "trisoup surfaces");
        ofType(MST_FLARE, "flare surfaces");
        if (!IsIbsp())
            log_.Print("{:9}   of several light styles\n", std::ranges::count_if(bsp_.drawSurfaces, [](const auto &s) {
                           return s.lightmapStyles[1] != kNoStyle || s.vertexStyles[1] != kNoStyle;
                       }));
        LineOfStyled(bsp_.drawVerts, "drawverts", kIbspVertBytes);
        Line(bsp_.drawIndexes, "drawindexes");
        log_.Print("\n");
    }

    void PrintLight(const Entity &world) const {
        Line(bsp_.LightmapPages(), "lightmaps", bsp_.lightmaps.size());
        if (world.Has(kToneKey))
            Note("tone: {}", Printable(std::string(world.Value(kToneKey))));
        PrintLegacyGrid();
        log_.Print("{:9} {:<14} {:9}\n", "", "visibility", bsp_.visibility.size());
        log_.Print("\n");
    }

    void PrintLegacyGrid() const {
        const std::size_t count = bsp_.gridPoints.size();
        std::size_t inFile = count * kIbspGridPointBytes;
        if (!IsIbsp()) {
            GridTableLoss loss;
            const GridTable table = MakeGridTable(bsp_.gridPoints, loss);
            inFile = table.records.size() * sizeof(bspGridPoint_t) + table.numbers.size() * sizeof table.numbers[0];
        }
        LineInFile(count, "lightgrid", count * sizeof(bspGridPoint_t), inFile);
    }

    void NoteConvolution(const Entity &world) const {
        Note("coefficients are {}",
             world.Value(kGridSHKey) == kRadiance ? "radiance, not convolved (-shradiance)" : "cosine-convolved");
    }

    void PrintGridSH(const Entity &world) const {
        const LightGridSH &grid = *bsp_.gridSH;
        const bspGridSHHeader_t &head = grid.header;
        Line(grid.points.size(), "SH light grid", sizeof head + grid.points.size() * sizeof(bspGridPointSH_t));
        const Float3 last = GridLayout{head.gridMins, head.gridSize, head.gridBounds}.Position(
            head.gridBounds[0] - 1, head.gridBounds[1] - 1, head.gridBounds[2] - 1);
        Note("cells of {} x {} x {} units, {} x {} x {} points", head.gridSize[0], head.gridSize[1], head.gridSize[2],
             head.gridBounds[0], head.gridBounds[1], head.gridBounds[2]);
        Note("from ( {} {} {} ) to ( {} {} {} )", WithoutNegativeZero(head.gridMins[0]),
             WithoutNegativeZero(head.gridMins[1]), WithoutNegativeZero(head.gridMins[2]), WithoutNegativeZero(last[0]),
             WithoutNegativeZero(last[1]), WithoutNegativeZero(last[2]));
        Note("stored in {}", bsp_.gridSHContainer == GridSHContainer::Lump ? "lump 18" : "BSPX lump LIGHTGRID_SH");
        NoteConvolution(world);
        const GridPointCounts counts = CountGridPoints(bsp_, grid);
        PointsLine(counts.open, "lit points", grid.points.size());
        PointsLine(counts.filled, "filled points", grid.points.size());
        PointsLine(counts.darkVoid, "void points", grid.points.size());
    }

    void PrintSparseGrid(const Entity &world) const {
        const SparseGridSH &grid = *bsp_.sparseGridSH;
        const bspSparseGridHeader_t head = HeaderOf(grid);
        Line(grid.points.size(), "sparse SH grid", head.bytes);
        Note("{} nodes, {:.1f} % of the bytes; {} levels below {} x {} x {} roots", grid.nodes.size(),
             100.0 * double(grid.nodes.size() * sizeof(SparseGridNode)) / double(head.bytes), grid.levels,
             grid.roots[0], grid.roots[1], grid.roots[2]);
        Note("from ( {} {} {} ), smallest cells of {} x {} x {} units", WithoutNegativeZero(grid.mins[0]),
             WithoutNegativeZero(grid.mins[1]), WithoutNegativeZero(grid.mins[2]), grid.cell[0], grid.cell[1],
             grid.cell[2]);
        NoteConvolution(world);
        const std::vector<SparseLevelCounts> levels = CountSparseLevels(grid);
        for (std::size_t level = levels.size(); level-- > 0;) {
            const SparseLevelCounts &counts = levels[level];
            const auto size = [&](std::size_t axis) {
                return double(grid.cell[axis]) * double(1 << (grid.levels - 1 - std::int32_t(level)));
            };
            log_.Print("{:9}   points of cells of {:g} x {:g} x {:g}: {:.1f} %; {} hanging, {} without light\n",
                       counts.stored, size(0), size(1), size(2),
                       100.0 * double(counts.stored) / double(std::max<std::size_t>(grid.points.size(), 1)),
                       counts.hanging, counts.empty);
        }
    }

    void PrintNamedGrid(const Entity &) const {
        const NamedGridSH &grid = *bsp_.namedGridSH;
        Line(grid.points.size(), "SH grid with lights", BytesOfLump(bsp_, BspxId::NamedGridSH));
        Note("{} nodes; {} levels below {} x {} x {} roots; smallest cells of {} x {} x {} units", grid.nodes.size(),
             grid.levels, grid.roots[0], grid.roots[1], grid.roots[2], grid.cell[0], grid.cell[1], grid.cell[2]);
        std::array<std::size_t, 4> types{};
        for (const GridLight &light : grid.table.lights)
            ++types[light.type];
        Note("{} lights: {} points, {} spots, {} suns, {} with polygons", grid.table.lights.size(), types[SHGRID_POINT],
             types[SHGRID_SPOT], types[SHGRID_SUN], types[SHGRID_POLYGONS]);
        const auto styled = std::ranges::count_if(grid.table.lights, [](const GridLight &l) { return l.style != 0; });
        Note("{} of them with a style; {:.1f} names per point", styled,
             double(grid.shares.size()) / double(std::max<std::size_t>(1, grid.points.size())));
    }

    template <typename... Args> void Note(fmt::format_string<Args...> format, Args &&...args) const {
        log_.Print("{:9}   {}\n", "", fmt::format(format, std::forward<Args>(args)...));
    }
    void PointsLine(std::size_t count, std::string_view name, std::size_t total) const {
        log_.Print("{:9}   {:<14} {:5.1f} % {:9.2f} MB\n", count, name, 100.0 * double(count) / double(total),
                   double(count * sizeof(bspGridPointSH_t)) / kMegabyte);
    }

    void PrintHdrLightmaps(const Entity &) const { // LightmapPageBytes has 3 bytes a texel, HDR pages a code each
        Line(bsp_.lightmapsE5bgr9.size() * 3 / LightmapPageBytes(bsp_.lightmapSide), "HDR lightmaps",
             4 * bsp_.lightmapsE5bgr9.size());
    }

    void PrintHdrVertices(const Entity &) const { Line(bsp_.vertexE5bgr9, "HDR vertices"); }

    void PrintRnm(const Entity &) const {
        const bspRnmHeader_t &head = bsp_.rnm->header;
        Line(bsp_.rnm->pages.size(), "RNM lightmaps", BytesOfLump(bsp_, BspxId::Rnm));
        Note("{} x {} texels for each of three basis vectors, {}", head.side, head.side,
             head.storage == RnmStorage::Raw ? "raw" : "rescaled to the flat light");
    }

    void PrintProps(const Entity &) const {
        const PropLight &light = *bsp_.propLight;
        Line(light.props.size(), "lit props", BytesOfLump(bsp_, BspxId::PropLight));
        Note("{} meshes with {} vertices", light.meshes.size(), light.colors.size());
    }

    void PrintCubes(const Entity &) const {
        const AmbientCubes &cubes = *bsp_.ambientCubes;
        Line(cubes.samples.size(), "ambient cubes", BytesOfLump(bsp_, BspxId::AmbientCubes));
        const auto withCubes =
            std::ranges::count_if(cubes.leafs, [](const bspCubeLeaf_t &leaf) { return leaf.count > 0; });
        Note("{} of {} leafs have their own, others refer to one of these", withCubes, cubes.leafs.size());
    }

    void PrintExtras() const {
        if (!bsp_.advertisements.empty())
            Line(bsp_.advertisements, "advertisements");
        for (const BspxLump &lump : bsp_.bspx)
            log_.Print("{:>9} {:<14} {:9}\n", "BSPX", Printable(lump.name), lump.data.size());
        if (!bsp_.advertisements.empty() || !bsp_.bspx.empty())
            log_.Print("\n");
    }

    static std::string Printable(std::string name) {
        std::ranges::replace_if(
            name, [](char c) { return c < ' ' || c > '~'; }, '?');
        return name;
    }

    std::size_t EntityCount() const {
        try {
            return ParseEntities(bsp_.entities, path_.string()).size();
        } catch (const Error &error) {
            log_.Warn("entity text", "{}", error.what());
            return 0;
        }
    }

    const std::filesystem::path &path_;
    const Bsp &bsp_;
    Log &log_;
};

} // namespace

void PrintBspInfo(const std::filesystem::path &path, const Bsp &bsp, std::uintmax_t fileBytes, Log &log) {
    log.Print("{}\n{}\n", kSeparator, path.string());
    log.Print("Abstracted BSP file components (*actual sizes may differ)\n");
    InfoTable(path, bsp, log).Print();
    log.Print("{:9} {:<14} {:9}\n", "", "total", fileBytes);
    log.Print("{:9} {:<14} {:9} KB\n", "", "", fileBytes / 1024);
    log.Print("{:9} {:<14} {:9} MB\n{}\n", "", "", fileBytes / (1024 * 1024), kSeparator);
}

} // namespace q3
