// GPL-2.0-or-later. RBSP files (Soldier of Fortune II, Jedi Outcast, Jedi Academy) and FBSP files (qfusion): bytes to
// records and back. See docs/reference/bsp_format.md.
#include "q3map2/bspfile/bspfile_rbsp.h"

#include "common/error.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/grid_table.h"

#include <algorithm>
#include <array>
#include <bit>

namespace q3 {

int FbspLightmapSide(const Entity &world) {
    constexpr unsigned kLeastSide = kLightmapSide, kMostSide = 8192;
    const double given = NumberFromText(world.Value(kLightmapImageSizeKey));
    const bool isSide = given >= kLeastSide && given <= kMostSide && std::has_single_bit(unsigned(given));
    return isSide ? int(given) : kFbspLightmapSide;
}

// ---- Records to bytes ----

namespace {

/// Slots in the order in which their lumps lie in the file: that of the compilers of these games.
constexpr std::array<int, kRbspSlots> kRbspDiskOrder = {1, 2, 4, 3, 8, 9, 5, 6, 7, 10, 13, 16, 14, 15, 17, 0, 11, 12};

/// Adds the two lumps of the light grid.
void AddGrid(const Bsp &bsp, LumpBytes &lumps, Log &log) {
    if (bsp.gridPoints.size() > kMaxGridPoints)
        throw Error("the light grid has {} points, but engines take at most {}: use a larger gridsize",
                    bsp.gridPoints.size(), kMaxGridPoints);
    GridTableLoss loss;
    GridTable table = MakeGridTable(bsp.gridPoints, loss);
    if (loss.changed > 0)
        log.Warn(
            "light grid joined",
            "the light grid has {} different points, but the file holds {}: the nearest were joined, which changes "
            "{} points by {:.2f} levels on average over all and by at most {}; a larger gridsize avoids it",
            loss.distinct, kMaxGridRecords, loss.changed, loss.mean, loss.worst);
    const auto add = [&lumps](int slot, const auto &records) {
        const auto bytes = std::as_bytes(std::span(records));
        lumps[std::size_t(slot)].AddOwned({bytes.begin(), bytes.end()});
    };
    add(LUMP_LIGHTGRID, table.records);
    add(LUMP_LIGHTARRAY, table.numbers);
}

} // namespace

namespace {

/// Raven's engine reads two pages of a file with one. The second one is empty, which tells engines that guess from the
/// number of pages that it has no light directions.
bool NeedsSecondPage(const Bsp &bsp, const BspFormat &format) {
    return format.ident == kRbspIdent && bsp.LightmapPages() == 1;
}

/// Texels of HDR light in the file for each page.
std::size_t PageTexels(const Bsp &bsp) {
    return LightmapPageBytes(bsp.lightmapSide) / 3;
}

} // namespace

ByteRanges EncodeRbsp(const Bsp &bsp, const BspFormat &format, Log &log) {
    if (NeedsSecondPage(bsp, format)) {
        Bsp padded = bsp;
        padded.lightmaps.resize(2 * bsp.lightmaps.size());
        if (!bsp.lightmapsE5bgr9.empty())
            padded.lightmapsE5bgr9.resize(2 * PageTexels(bsp));
        ByteRanges file;
        file.AddOwned(EncodeRbsp(padded, format, log).Bytes());
        return file;
    }
    CheckBspxLumps(bsp, "writing");
    if (bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Lump)
        throw Error("{} has no lump 18 for the SH light grid: -shbspx stores it in a BSPX lump", format.ident);
    LumpBytes lumps = CommonLumps(bsp);
    lumps[LUMP_BRUSHSIDES].Add(bsp.brushSides);
    lumps[LUMP_DRAWVERTS].Add(bsp.drawVerts);
    lumps[LUMP_SURFACES].Add(bsp.drawSurfaces);
    AddGrid(bsp, lumps, log);
    return AssembleFile({.ident = format.ident, .version = kRbspVersion, .slots = kRbspSlots, .order = kRbspDiskOrder},
                        std::move(lumps), bsp);
}

// ---- Bytes to records ----

namespace {

/// Points of the light grid from its two lumps.
std::vector<bspGridPoint_t> ReadGrid(const LumpReader &lumps) {
    std::vector<bspGridPoint_t> records;
    std::vector<std::uint16_t> numbers;
    lumps.ReadArray(LUMP_LIGHTGRID, records);
    lumps.ReadArray(LUMP_LIGHTARRAY, numbers);
    Log &log = lumps.Messages();
    if (numbers.size() > kMaxGridPoints) {
        log.Warn("light grid points", "{}: the light grid has {} points, expected at most {}: it is ignored",
                 lumps.Name(), numbers.size(), kMaxGridPoints);
        return {};
    }
    std::vector<bspGridPoint_t> points;
    points.reserve(numbers.size());
    bspGridPoint_t wall{};
    wall.styles = kNoStyles;
    std::size_t outside = 0;
    for (const std::uint16_t number : numbers) {
        outside += number >= records.size();
        points.push_back(number < records.size() ? records[number] : wall);
    }
    if (outside > 0)
        log.Warn("light grid numbers",
                 "{}: {} of {} light grid points name a record past the {} in the file: taken as black points in walls",
                 lumps.Name(), outside, numbers.size(), records.size());
    return points;
}

/// Maps of these games have flares that name a fog although there is none.
void ClearFogsOfFlares(Bsp &bsp) {
    for (bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.surfaceType == MST_FLARE && bsp.fogs.empty())
            surface.fogNum = -1;
}

/// Takes off what EncodeRbsp adds to a single page.
void DropEmptySecondPage(Bsp &bsp) {
    const std::size_t page = LightmapPageBytes(bsp.lightmapSide);
    const auto isBlack = [](std::uint8_t byte) { return byte == 0; };
    if (bsp.ident != kRbspIdent || bsp.LightmapPages() != 2 || bsp.NamedPages() > 1 ||
        !std::all_of(bsp.lightmaps.begin() + std::ptrdiff_t(page), bsp.lightmaps.end(), isBlack))
        return;
    bsp.lightmaps.resize(page);
    if (!bsp.lightmapsE5bgr9.empty())
        bsp.lightmapsE5bgr9.resize(PageTexels(bsp));
}

/// Numbers of surfaces that are not there become -1. No engine reads them.
void ClearBadSurfaceNumbers(Bsp &bsp) {
    for (bspBrushSide_t &side : bsp.brushSides)
        if (side.surfaceNum < 0 || side.surfaceNum >= std::int64_t(bsp.drawSurfaces.size()))
            side.surfaceNum = -1;
}

} // namespace

Bsp DecodeRbsp(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log) {
    if (file.size < HeaderBytes(kRbspSlots))
        throw Error("{}: {} bytes, but an RBSP or FBSP header has {}", name, file.size, HeaderBytes(kRbspSlots));
    LumpReader lumps(file, name, format, log);
    if (lumps.Version() != kRbspVersion)
        lumps.Mismatch(fmt::format("version {} of an RBSP or FBSP file, expected {}", lumps.Version(), kRbspVersion));
    lumps.ReadSlots(kRbspSlots);
    lumps.WarnOverlap();
    Bsp bsp;
    bsp.ident = lumps.HasIdent(kFbspIdent) ? kFbspIdent : kRbspIdent;
    lumps.ReadCommonLumps(bsp);
    lumps.ReadArray(LUMP_BRUSHSIDES, bsp.brushSides);
    lumps.ReadArray(LUMP_DRAWVERTS, bsp.drawVerts);
    lumps.ReadArray(LUMP_SURFACES, bsp.drawSurfaces);
    bsp.gridPoints = ReadGrid(lumps);
    ClearFogsOfFlares(bsp);
    if (bsp.ident == kFbspIdent)
        bsp.lightmapSide = FbspLightmapSide(StoredWorld(bsp.entities));
    if (const std::size_t page = LightmapPageBytes(bsp.lightmapSide); bsp.lightmaps.size() % page != 0) {
        lumps.RefuseRagged(LUMP_LIGHTMAPS, page);
        bsp.lightmaps.clear();
    }
    lumps.ReadBspx(bsp);
    DropEmptySecondPage(bsp);
    ClearBadSurfaceNumbers(bsp);
    return bsp;
}

} // namespace q3
