// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records and back. See docs/reference/bsp_format.md.
#include "q3map2/bspfile/bspfile_ibsp.h"

#include "common/error.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <algorithm>
#include <array>

namespace q3 {

// ---- Records that are smaller than those in memory ----

namespace {

struct IbspBrushSide {
    std::int32_t planeNum, shaderNum;
};

struct IbspDrawVert {
    Float3 xyz;
    std::array<float, 2> st, lightmap;
    Float3 normal;
    std::array<std::uint8_t, 4> color;
};

struct IbspDrawSurface {
    std::int32_t shaderNum, fogNum, surfaceType;
    std::int32_t firstVert, numVerts, firstIndex, numIndexes;
    std::int32_t lightmapNum, lightmapX, lightmapY, lightmapWidth, lightmapHeight;
    Float3 lightmapOrigin;
    std::array<Float3, 3> lightmapVecs;
    std::int32_t patchWidth, patchHeight;
};

struct IbspGridPoint {
    std::array<std::uint8_t, 3> ambient, directed;
    std::array<std::uint8_t, 2> latLong;
};

static_assert(kPinned<IbspBrushSide, 8> && kPinned<IbspDrawVert, 44>);
static_assert(kPinned<IbspDrawSurface, 104> && kPinned<IbspGridPoint, 8>);

bspBrushSide_t InMemory(const IbspBrushSide &side) {
    return {side.planeNum, side.shaderNum};
}
IbspBrushSide InFile(const bspBrushSide_t &side) {
    return {side.planeNum, side.shaderNum};
}

bspDrawVert_t InMemory(const IbspDrawVert &vert) {
    return {vert.xyz, vert.st, {vert.lightmap}, vert.normal, {vert.color}};
}
IbspDrawVert InFile(const bspDrawVert_t &vert) {
    return {vert.xyz, vert.st, vert.lightmap[0], vert.normal, vert.color[0]};
}

bspDrawSurface_t InMemory(const IbspDrawSurface &from) {
    bspDrawSurface_t surface{};
    surface.shaderNum = from.shaderNum, surface.fogNum = from.fogNum, surface.surfaceType = from.surfaceType;
    surface.firstVert = from.firstVert, surface.numVerts = from.numVerts;
    surface.firstIndex = from.firstIndex, surface.numIndexes = from.numIndexes;
    surface.lightmapNum[0] = from.lightmapNum;
    surface.lightmapX[0] = from.lightmapX, surface.lightmapY[0] = from.lightmapY;
    surface.lightmapWidth = from.lightmapWidth, surface.lightmapHeight = from.lightmapHeight;
    surface.lightmapOrigin = from.lightmapOrigin, surface.lightmapVecs = from.lightmapVecs;
    surface.patchWidth = from.patchWidth, surface.patchHeight = from.patchHeight;
    return surface;
}
IbspDrawSurface InFile(const bspDrawSurface_t &surface) {
    return {surface.shaderNum,      surface.fogNum,       surface.surfaceType,   surface.firstVert,
            surface.numVerts,       surface.firstIndex,   surface.numIndexes,    surface.lightmapNum[0],
            surface.lightmapX[0],   surface.lightmapY[0], surface.lightmapWidth, surface.lightmapHeight,
            surface.lightmapOrigin, surface.lightmapVecs, surface.patchWidth,    surface.patchHeight};
}

bspGridPoint_t InMemory(const IbspGridPoint &point) {
    return {{point.ambient}, {point.directed}, kOnlyStyle0, point.latLong};
}
IbspGridPoint InFile(const bspGridPoint_t &point) {
    return {point.ambient[0], point.directed[0], point.latLong};
}

// ---- Records to bytes ----

/// Slots in the order in which their lumps lie in the file: that of the compilers of these games.
constexpr std::array<int, kNumLumps> kDiskOrder = {1, 2, 4, 3, 8, 9, 5, 6, 7, 10, 13, 16, 14, 15, 0, 12, 11, 17, 18};

template <typename FileRecord, typename Record> ByteRanges FileRecords(const std::vector<Record> &records) {
    return ConvertedRecords<FileRecord>(records, [](const Record &record) { return InFile(record); });
}

} // namespace

ByteRanges EncodeIbsp(const Bsp &bsp, const BspFormat &format, Log &) {
    CheckBspxLumps(bsp, "writing");
    LumpBytes lumps = CommonLumps(bsp);
    lumps[LUMP_BRUSHSIDES] = FileRecords<IbspBrushSide>(bsp.brushSides);
    lumps[LUMP_DRAWVERTS] = FileRecords<IbspDrawVert>(bsp.drawVerts);
    lumps[LUMP_SURFACES] = FileRecords<IbspDrawSurface>(bsp.drawSurfaces);
    lumps[LUMP_LIGHTGRID] = FileRecords<IbspGridPoint>(bsp.gridPoints);
    if (format.advertisements)
        lumps[LUMP_ADVERTISEMENTS].Add(bsp.advertisements);
    const bool hasLump18 = bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Lump;
    if (hasLump18)
        lumps[LUMP_LIGHTGRID_SH] = GridRanges(*bsp.gridSH);
    const FileLayout layout{.ident = kIbspIdent,
                            .version = hasLump18 ? 47 : format.version,
                            .slots = hasLump18               ? std::size_t(kNumLumps)
                                     : format.advertisements ? kAdvertisementSlots
                                                             : kClassicSlots,
                            .order = kDiskOrder};
    return AssembleFile(layout, std::move(lumps), bsp);
}

std::vector<std::byte> IbspGridLump(std::span<const bspGridPoint_t> points) {
    return FileRecords<IbspGridPoint>(std::vector(points.begin(), points.end())).Bytes();
}

// ---- Bytes to records ----

namespace {

class Reader {
  public:
    Reader(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log)
        : lumps_(file, name, format, log), file_(file), name_(name), format_(format), log_(log) {}

    Bsp Read() {
        ReadHead();
        Bsp bsp;
        ReadAdvertisementSlot();
        ReadGridSHSlot(bsp);
        lumps_.WarnOverlap();
        lumps_.ReadCommonLumps(bsp);
        ReadRecords<IbspBrushSide>(LUMP_BRUSHSIDES, bsp.brushSides);
        ReadRecords<IbspDrawVert>(LUMP_DRAWVERTS, bsp.drawVerts);
        ReadRecords<IbspDrawSurface>(LUMP_SURFACES, bsp.drawSurfaces);
        ReadRecords<IbspGridPoint>(LUMP_LIGHTGRID, bsp.gridPoints);
        lumps_.ReadArray(LUMP_ADVERTISEMENTS, bsp.advertisements);
        ReadLightmapSide(bsp);
        lumps_.ReadBspx(bsp);
        return bsp;
    }

  private:
    void ReadLightmapSide(Bsp &bsp) const {
        const auto hasPagesOf = [&bsp](int side) { return bsp.lightmaps.size() % LightmapPageBytes(side) == 0; };
        bsp.lightmapSide = hasPagesOf(format_.lightmapSide) ? format_.lightmapSide : kLightmapSide;
        if (hasPagesOf(bsp.lightmapSide))
            return;
        lumps_.RefuseRagged(LUMP_LIGHTMAPS, LightmapPageBytes(bsp.lightmapSide));
        bsp.lightmaps.clear();
    }

    template <typename FileRecord, typename Record> void ReadRecords(int slot, std::vector<Record> &records) const {
        lumps_.ReadConverted<FileRecord>(slot, records, [](const FileRecord &record) { return InMemory(record); });
    }

    void ReadHead() {
        const std::string kind = Kind();
        const bool isShort = file_.size < HeaderBytes(kClassicSlots);
        if (isShort && kind.empty())
            throw Error("{}: {} bytes, but a BSP header has {}", name_, file_.size, HeaderBytes(kClassicSlots));
        if (!kind.empty() && (isShort || !format_.force))
            throw Error("{}: the file is {}; expected a .bsp of Quake III or of a game of its family (IBSP 46 or 47, "
                        "RBSP 1, FBSP 1)",
                        name_, kind);
        if (!lumps_.HasIdent(kIbspIdent))
            lumps_.Mismatch("the file does not start with IBSP: not a Quake III map");
        if (lumps_.Version() != 46 && lumps_.Version() != 47)
            lumps_.Mismatch(fmt::format("BSP version {}, expected 46 or 47", lumps_.Version()));
        lumps_.ReadSlots(kClassicSlots);
    }

    /// What the file is if not a map of this family.
    std::string Kind() const {
        std::vector<std::byte> begin(std::size_t(std::min<std::uint64_t>(file_.size, kKindBytes)));
        file_.Fill(0, std::span(begin));
        return KindOfFile(begin);
    }

    // A first lump behind 18 slots only suggests that slot 17 exists: other layouts have text or lumps there.
    void ReadAdvertisementSlot() {
        if (lumps_.Version() != 47 || !format_.advertisements ||
            lumps_.FirstByte() < std::int64_t(HeaderBytes(kAdvertisementSlots)))
            return;
        const FilePart part = lumps_.Slot(LUMP_ADVERTISEMENTS);
        if (lumps_.Inside(part, HeaderBytes(kAdvertisementSlots)) &&
            part.length % std::int64_t(sizeof(bspAdvertisement_t)) == 0)
            lumps_.SetLump(LUMP_ADVERTISEMENTS, part);
    }

    void ReadGridSHSlot(Bsp &bsp) {
        constexpr std::size_t header = HeaderBytes(kNumLumps);
        if (lumps_.Version() != 47 || lumps_.FirstByte() < std::int64_t(header) || file_.size < header)
            return;
        const FilePart part = lumps_.Slot(LUMP_LIGHTGRID_SH);
        // This program places the first lump right behind 19 slots. Where others begin later, slot 18 may be anything.
        const bool isOwnLayout = lumps_.FirstByte() == std::int64_t(header);
        if (part.length == 0 || (!isOwnLayout && !lumps_.Inside(part, header)))
            return;
        if (!lumps_.Inside(part, header))
            throw Error("{}: lump {} ({}): offset {} + length {} is not inside the {} bytes of the file", name_,
                        int(LUMP_LIGHTGRID_SH), kLumpNames[LUMP_LIGHTGRID_SH], part.offset, part.length, file_.size);
        try {
            bsp.gridSH = ReadLightGridSH(file_, part, name_);
        } catch (const Error &error) {
            if (isOwnLayout)
                throw;
            log_.Warn("slot 18", "slot 18 is ignored, since it is not an SH light grid: {}", error.what());
            return;
        }
        lumps_.SetLump(LUMP_LIGHTGRID_SH, part);
    }

    LumpReader lumps_;
    const ByteSource &file_;
    std::string_view name_;
    const BspFormat &format_;
    Log &log_;
};

} // namespace

Bsp DecodeIbsp(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log) {
    return Reader(file, name, format, log).Read();
}

} // namespace q3
