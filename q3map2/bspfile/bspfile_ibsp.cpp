// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records and back. See docs/bsp_format.md.
#include "q3map2/bspfile/bspfile_ibsp.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_hdr.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/bspfile/bspx.h"

#include <algorithm>
#include <bit>

namespace q3 {

// ---- IBSP files of version 46 and 47: records to bytes ----

static_assert(std::endian::native == std::endian::little, "records are written as they lie in memory");

namespace {

constexpr std::array<int, kNumLumps> kDiskOrder = {1, 2, 4, 3, 8, 9, 5, 6, 7, 10, 13, 16, 14, 15, 0, 12, 11, 17, 18};

template <typename Record> std::span<const std::byte> BytesOf(const std::vector<Record> &records) {
    return std::as_bytes(std::span(records));
}

/// The lump of a grid: its head, then its points.
std::vector<std::span<const std::byte>> GridPieces(const LightGridSH &grid) {
    CheckLightGridSH(grid, "writing");
    return {std::as_bytes(std::span(&grid.header, 1)), BytesOf(grid.points)};
}

std::vector<std::span<const std::byte>> RnmPieces(const RnmLightmaps &rnm) {
    std::vector<std::span<const std::byte>> pieces = {std::as_bytes(std::span(&rnm.header, 1))};
    for (const RnmPage &page : rnm.pages) {
        pieces.push_back(std::as_bytes(std::span(&page.lightmapNum, 1)));
        for (const std::vector<std::uint32_t> &map : page.maps)
            pieces.push_back(BytesOf(map));
    }
    return pieces;
}

std::uint64_t LengthOf(std::span<const std::span<const std::byte>> pieces) {
    std::uint64_t length = 0;
    for (const auto &piece : pieces)
        length += piece.size();
    return length;
}

void Store32(std::vector<std::byte> &bytes, std::size_t at, std::uint32_t value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

void StorePart(std::vector<std::byte> &bytes, std::size_t at, const FilePart &part) {
    Store32(bytes, at, std::uint32_t(part.offset));
    Store32(bytes, at + 4, std::uint32_t(part.length));
}

} // namespace

FilePlan PlanFile(std::size_t slots, const std::array<std::uint64_t, kNumLumps> &lengths,
                  std::span<const std::uint64_t> bspxLengths) {
    FilePlan plan;
    plan.slots = slots;
    std::uint64_t position = HeaderBytes(slots);
    const auto place = [&position](std::uint64_t length) {
        const FilePart part{std::int64_t(position), std::int64_t(length)};
        position = Align4(position + length);
        return part;
    };
    for (const int slot : kDiskOrder) {
        const auto index = std::size_t(slot);
        const bool unused = slots == kNumLumps && slot == LUMP_ADVERTISEMENTS && lengths[index] == 0;
        if (index < slots && !unused)
            plan.lumps[index] = place(lengths[index]);
    }
    plan.bspxStart = position;
    if (!bspxLengths.empty())
        position += kBspxHeadBytes + bspxLengths.size() * kBspxEntryBytes;
    for (const std::uint64_t length : bspxLengths)
        plan.bspx.push_back(place(length));
    plan.size = position;
    if (plan.size > INT32_MAX)
        throw Error("the file would have {} bytes, but a BSP file ends at {}: use larger cells for the light grids "
                    "(-gridsh, -gridscalesh) or fewer lightmaps",
                    plan.size, INT32_MAX);
    return plan;
}

BspPieces::BspPieces(const Bsp &bsp, const BspFormat &format) {
    TakeLumps(bsp, format);
    TakeBspx(bsp);
    std::array<std::uint64_t, kNumLumps> lengths{};
    for (std::size_t slot = 0; slot < lengths.size(); slot++)
        lengths[slot] = LengthOf(lumps_[slot]);
    std::vector<std::uint64_t> bspxLengths;
    for (const Pieces &lump : bspx_)
        bspxLengths.push_back(LengthOf(lump));
    const bool hasLump18 = !lumps_[LUMP_LIGHTGRID_SH].empty();
    const std::size_t slots = hasLump18 ? std::size_t(kNumLumps) : format.advertisements ? 18 : 17;
    plan_ = PlanFile(slots, lengths, bspxLengths);
    MakeHeader(hasLump18 ? 47 : format.version);
    MakeDirectory();
}

void BspPieces::TakeLumps(const Bsp &bsp, const BspFormat &format) {
    ForEachArray(bsp, [this](int slot, const auto &records) { lumps_[std::size_t(slot)] = {BytesOf(records)}; });
    if (!format.advertisements)
        lumps_[LUMP_ADVERTISEMENTS].clear();
    lumps_[LUMP_ENTITIES] = {std::as_bytes(std::span(bsp.entities.c_str(), bsp.entities.size() + 1))};
    if (bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Lump)
        lumps_[LUMP_LIGHTGRID_SH] = GridPieces(*bsp.gridSH);
}

void BspPieces::TakeBspx(const Bsp &bsp) {
    for (const BspxLump &lump : bsp.bspx) {
        if (lump.name.size() > kBspxNameBytes)
            throw Error("BSPX lump {}: the name has more than {} bytes", lump.name, kBspxNameBytes);
        bspxNames_.push_back(lump.name);
        bspx_.push_back({BytesOf(lump.data)});
    }
    if (bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Bspx) {
        bspxNames_.push_back(kBspxLightGridSH);
        bspx_.push_back(GridPieces(*bsp.gridSH));
    }
    CheckHdrLight(bsp, "writing");
    const auto add = [this](bool wanted, std::string_view name, Pieces pieces) {
        if (!wanted)
            return;
        bspxNames_.push_back(name);
        bspx_.push_back(std::move(pieces));
    };
    add(!bsp.lightmapsE5bgr9.empty(), kBspxLightmapsE5bgr9, {BytesOf(bsp.lightmapsE5bgr9)});
    add(!bsp.vertexE5bgr9.empty(), kBspxVertexE5bgr9, {BytesOf(bsp.vertexE5bgr9)});
    add(bsp.rnm.has_value(), kBspxRnm, bsp.rnm ? RnmPieces(*bsp.rnm) : Pieces{});
    if (bsp.sparseGridSH) {
        CheckSparseGrid(*bsp.sparseGridSH, "writing");
        sparseHeader_ = HeaderOf(*bsp.sparseGridSH);
        add(true, kBspxSparseGridSH,
            {std::as_bytes(std::span(&sparseHeader_, 1)), BytesOf(bsp.sparseGridSH->nodes),
             BytesOf(bsp.sparseGridSH->points)});
    }
    if (!bsp.ambientCubes)
        return;
    CheckAmbientCubes(bsp, "writing");
    cubeHeader_ = HeaderOf(*bsp.ambientCubes);
    add(true, kBspxAmbientCubes,
        {std::as_bytes(std::span(&cubeHeader_, 1)), BytesOf(bsp.ambientCubes->leafs),
         BytesOf(bsp.ambientCubes->samples)});
}

void BspPieces::MakeHeader(int version) {
    header_.resize(HeaderBytes(plan_.slots));
    std::memcpy(header_.data(), "IBSP", 4);
    Store32(header_, 4, std::uint32_t(version));
    for (std::size_t slot = 0; slot < plan_.slots; slot++)
        StorePart(header_, HeaderBytes(slot), plan_.lumps[slot]);
}

void BspPieces::MakeDirectory() {
    if (bspx_.empty())
        return;
    directory_.resize(kBspxHeadBytes + bspx_.size() * kBspxEntryBytes);
    std::memcpy(directory_.data(), "BSPX", 4);
    Store32(directory_, 4, std::uint32_t(bspx_.size()));
    for (std::size_t i = 0; i < bspx_.size(); i++) {
        const std::size_t entry = kBspxHeadBytes + i * kBspxEntryBytes;
        std::memcpy(directory_.data() + entry, bspxNames_[i].data(), bspxNames_[i].size());
        StorePart(directory_, entry + kBspxNameBytes, plan_.bspx[i]);
    }
}

void BspPieces::Write(const Append &append) const {
    constexpr std::array<std::byte, 4> zeros{};
    const auto lump = [&](const Pieces &pieces) {
        for (const auto &piece : pieces)
            append(piece);
        const std::uint64_t length = LengthOf(pieces);
        append(std::span(zeros).first(std::size_t(Align4(length) - length)));
    };
    append(header_);
    for (const int slot : kDiskOrder)
        lump(lumps_[std::size_t(slot)]);
    append(directory_);
    for (const Pieces &pieces : bspx_)
        lump(pieces);
}

// ---- IBSP files of version 46 and 47: bytes to records ----

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in the file");

namespace {

/// Reads the SH light grid from a part of the file. Errors: a bad length, and those of CheckLightGridSH.
LightGridSH ReadLightGridSH(const ByteSource &file, const FilePart &part, std::string_view name) {
    LightGridSH grid;
    constexpr std::int64_t head = sizeof grid.header;
    constexpr std::int64_t point = sizeof(bspGridPointSH_t);
    if (part.length <= head || (part.length - head) % point != 0)
        throw Error("{}: SH light grid: length {} is not {} plus a multiple of {}", name, part.length, head, point);
    file.Fill(std::uint64_t(part.offset), std::span(&grid.header, 1));
    grid.points.resize(std::size_t((part.length - head) / point));
    file.Fill(std::uint64_t(part.offset + head), std::span(grid.points));
    CheckLightGridSH(grid, name);
    return grid;
}

constexpr std::size_t kClassicSlots = 17;

class Reader {
  public:
    Reader(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log)
        : file_(file), name_(name), format_(format), log_(log) {}

    Bsp Read() {
        ReadHead();
        Bsp bsp;
        ReadAdvertisementSlot();
        ReadGridSHSlot(bsp);
        WarnOverlap();
        ReadEntities(bsp);
        ForEachArray(bsp, [this](int slot, auto &records) { ReadArray(slot, records); });
        if (bsp.lightmaps.size() % kLightmapPageBytes != 0 && DropRagged(LUMP_LIGHTMAPS, kLightmapPageBytes))
            bsp.lightmaps.clear();
        ReadBspxLumps(bsp);
        return bsp;
    }

  private:
    std::int64_t FileSize() const { return std::int64_t(file_.size); }
    bool Inside(const FilePart &part, std::size_t header) const {
        return part.length > 0 && part.offset >= std::int64_t(header) && part.End() <= FileSize();
    }
    FilePart Slot(std::size_t slot) const {
        const std::size_t at = HeaderBytes(slot);
        return {LoadRecord<std::int32_t>(head_, at), LoadRecord<std::int32_t>(head_, at + 4)};
    }
    const FilePart &Lump(int slot) const { return lumps_[std::size_t(slot)]; }

    void ReadHead() {
        const std::string kind = Kind();
        if (file_.size < HeaderBytes(kClassicSlots) && kind.empty())
            throw Error("{}: {} bytes, but a BSP header has {}", name_, file_.size, HeaderBytes(kClassicSlots));
        const bool isShort = file_.size < HeaderBytes(kClassicSlots);
        if (!kind.empty() && (isShort || !format_.force))
            throw Error("{}: the file is {}; expected a .bsp of Quake III or of a game of its family (IBSP 46 or 47)",
                        name_, kind);
        file_.Fill(0, std::span(head_).first(std::size_t(std::min<std::uint64_t>(file_.size, head_.size()))));
        if (std::memcmp(head_.data(), "IBSP", 4) != 0)
            Mismatch("the file does not start with IBSP: not a Quake III map");
        version_ = LoadRecord<std::int32_t>(head_, 4);
        if (version_ != 46 && version_ != 47)
            Mismatch(fmt::format("BSP version {}, expected 46 or 47", version_));
        for (std::size_t slot = 0; slot < kClassicSlots; slot++)
            lumps_[slot] = CheckedSlot(slot);
        for (std::size_t slot = 0; slot < kClassicSlots; slot++)
            if (lumps_[slot].length > 0)
                firstByte_ = std::min(firstByte_, lumps_[slot].offset);
    }

    /// What the file is if not a map of this family.
    std::string Kind() const {
        std::vector<std::byte> begin(std::size_t(std::min<std::uint64_t>(file_.size, kKindBytes)));
        file_.Fill(0, std::span(begin));
        return KindOfFile(begin);
    }

    void Mismatch(const std::string &text) {
        if (!format_.force)
            throw Error("{}: {}", name_, text);
        log_.Warn("BSP ident or version", "{}: {}", name_, text);
    }

    FilePart CheckedSlot(std::size_t slot) const {
        const FilePart part = Slot(slot);
        const auto fail = [&](const std::string &text) {
            throw Error("{}: lump {} ({}): {}", name_, slot, kLumpNames[slot], text);
        };
        if (part.offset < 0)
            fail(fmt::format("offset {} is negative", part.offset));
        if (part.length < 0)
            fail(fmt::format("length {} is negative", part.length));
        if (part.End() > FileSize())
            fail(fmt::format("offset {} + length {} exceeds the {} bytes of the file", part.offset, part.length,
                             file_.size));
        if (part.length > 0 && part.offset < std::int64_t(HeaderBytes(kClassicSlots)))
            fail(fmt::format("offset {} lies inside the header of {} bytes", part.offset, HeaderBytes(kClassicSlots)));
        return part;
    }

    // A first lump behind 18 slots only suggests that slot 17 exists: other layouts have text or lumps there.
    void ReadAdvertisementSlot() {
        if (version_ != 47 || !format_.advertisements || firstByte_ < std::int64_t(HeaderBytes(18)))
            return;
        const FilePart part = Slot(LUMP_ADVERTISEMENTS);
        if (Inside(part, HeaderBytes(18)) && part.length % std::int64_t(sizeof(bspAdvertisement_t)) == 0)
            lumps_[LUMP_ADVERTISEMENTS] = part;
    }

    void ReadGridSHSlot(Bsp &bsp) {
        constexpr std::size_t header = HeaderBytes(kNumLumps);
        if (version_ != 47 || firstByte_ < std::int64_t(header) || file_.size < header)
            return;
        const FilePart part = Slot(LUMP_LIGHTGRID_SH);
        const bool ours = firstByte_ == std::int64_t(header);
        if (part.length == 0 || (!ours && !Inside(part, header)))
            return;
        if (!Inside(part, header))
            throw Error("{}: lump {} ({}): offset {} + length {} is not inside the {} bytes of the file", name_,
                        int(LUMP_LIGHTGRID_SH), kLumpNames[LUMP_LIGHTGRID_SH], part.offset, part.length, file_.size);
        try {
            bsp.gridSH = ReadLightGridSH(file_, part, name_);
        } catch (const Error &error) {
            if (ours)
                throw;
            log_.Warn("slot 18", "slot 18 is ignored, it is no SH light grid: {}", error.what());
            return;
        }
        lumps_[LUMP_LIGHTGRID_SH] = part;
    }

    void WarnOverlap() {
        std::vector<std::size_t> order;
        for (std::size_t slot = 0; slot < lumps_.size(); slot++)
            if (lumps_[slot].length > 0)
                order.push_back(slot);
        std::ranges::stable_sort(order, {}, [this](std::size_t slot) { return lumps_[slot].offset; });
        for (std::size_t i = 1; i < order.size(); i++)
            if (lumps_[order[i]].offset < lumps_[order[i - 1]].End())
                log_.Warn("overlapping lumps", "{}: lump {} ({}) overlaps lump {} ({})", name_, order[i - 1],
                          kLumpNames[order[i - 1]], order[i], kLumpNames[order[i]]);
    }

    void ReadEntities(Bsp &bsp) const {
        const FilePart &part = Lump(LUMP_ENTITIES);
        bsp.entities.resize(std::size_t(part.length));
        file_.Fill(std::uint64_t(part.offset), std::span(bsp.entities));
        bsp.entities.resize(std::min(bsp.entities.find('\0'), bsp.entities.size()));
    }

    template <typename Record> void ReadArray(int slot, std::vector<Record> &records) {
        const FilePart &part = Lump(slot);
        if (part.length % std::int64_t(sizeof(Record)) != 0 && DropRagged(slot, sizeof(Record)))
            return;
        records.resize(std::size_t(part.length) / sizeof(Record));
        file_.Fill(std::uint64_t(part.offset), std::span(records));
    }

    /// True: the lump is to be dropped. Error without -force.
    bool DropRagged(int slot, std::size_t record) {
        const auto text = fmt::format("{}: lump {} ({}): length {} is not a multiple of the record size {}", name_,
                                      slot, kLumpNames[std::size_t(slot)], lumps_[std::size_t(slot)].length, record);
        if (!format_.force)
            throw Error(text);
        log_.Warn("ragged lump", "{}: the lump is dropped", text);
        return true;
    }

    void ReadBspxLumps(Bsp &bsp) {
        std::int64_t end = 0;
        for (const FilePart &part : lumps_)
            end = std::max(end, part.End());
        for (BspxPart &lump : ReadBspx(file_, Align4(std::uint64_t(end)), name_, log_)) {
            if (ReadHdrLump(file_, lump, name_, bsp))
                continue;
            if (lump.name == kBspxAmbientCubes) {
                bsp.ambientCubes = ReadAmbientCubes(file_, lump.part, name_);
                continue;
            }
            if (lump.name == kBspxSparseGridSH) {
                bsp.sparseGridSH = ReadSparseGrid(file_, lump.part, name_);
                continue;
            }
            if (lump.name != kBspxLightGridSH) {
                std::vector<std::byte> data(std::size_t(lump.part.length));
                file_.Fill(std::uint64_t(lump.part.offset), std::span(data));
                bsp.bspx.push_back({std::move(lump.name), std::move(data)});
            } else if (bsp.gridSH) {
                log_.Warn("two SH light grids", "{}: lump 18 and BSPX hold an SH light grid each: lump 18 is used",
                          name_);
            } else {
                bsp.gridSH = ReadLightGridSH(file_, lump.part, name_);
                bsp.gridSHContainer = GridSHContainer::Bspx;
            }
        }
        DropUnfitHdrLight(bsp, name_, log_);
        DropUnfitCubes(bsp, name_, log_);
    }

    const ByteSource &file_;
    std::string_view name_;
    const BspFormat &format_;
    Log &log_;
    std::array<std::byte, HeaderBytes(kNumLumps)> head_{}; ///< zeros where the file is shorter
    std::int32_t version_ = 0;
    std::array<FilePart, kNumLumps> lumps_{};
    std::int64_t firstByte_ = INT64_MAX; ///< smallest offset of a lump that is not empty
};

} // namespace

Bsp ReadBspFrom(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log) {
    Bsp bsp = Reader(file, name, format, log).Read();
    ValidateBsp(bsp, name, log);
    return bsp;
}

Bsp ReadBsp(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log) {
    const auto copy = [file](std::uint64_t at, std::span<std::byte> into) {
        std::memcpy(into.data(), file.data() + at, into.size());
    };
    return ReadBspFrom({file.size(), copy}, name, format, log);
}

} // namespace q3
