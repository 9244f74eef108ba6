// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records and back. See docs/bsp_format.md.
#include "q3map2/bspfile/bspfile_ibsp.h"

#include "common/error.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <algorithm>
#include <bit>

namespace q3 {

// ---- Records to bytes ----

static_assert(std::endian::native == std::endian::little, "records are written as they lie in memory");

namespace {

/// Slots in the order in which their lumps lie in the file: that of the compilers of these games.
constexpr std::array<int, kNumLumps> kDiskOrder = {1, 2, 4, 3, 8, 9, 5, 6, 7, 10, 13, 16, 14, 15, 0, 12, 11, 17, 18};

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

namespace {

using SlotBytes = std::array<ByteRanges, kNumLumps>;

SlotBytes TakeLumps(const Bsp &bsp, const BspFormat &format) {
    SlotBytes lumps;
    ForEachArray(bsp, [&](int slot, const auto &records) {
        if (slot != LUMP_ADVERTISEMENTS || format.advertisements)
            lumps[std::size_t(slot)].Add(records);
    });
    lumps[LUMP_ENTITIES].Add(std::span(bsp.entities.c_str(), bsp.entities.size() + 1));
    if (bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Lump)
        lumps[LUMP_LIGHTGRID_SH] = GridRanges(*bsp.gridSH);
    return lumps;
}

std::vector<std::byte> MakeHeader(const FilePlan &plan, int version) {
    std::vector<std::byte> header(HeaderBytes(plan.slots));
    std::memcpy(header.data(), kIbspIdent.data(), kIbspIdent.size());
    Store32(header, 4, std::uint32_t(version));
    for (std::size_t slot = 0; slot < plan.slots; slot++)
        StorePart(header, HeaderBytes(slot), plan.lumps[slot]);
    return header;
}

} // namespace

ByteRanges EncodeIbsp(const Bsp &bsp, const BspFormat &format) {
    CheckBspxLumps(bsp, "writing");
    SlotBytes lumps = TakeLumps(bsp, format);
    std::vector<BspxOutput> bspx = WriteBspxLumps(bsp);
    std::array<std::uint64_t, kNumLumps> lengths{};
    std::ranges::transform(lumps, lengths.begin(), &ByteRanges::Size);
    std::vector<std::uint64_t> bspxLengths;
    for (const BspxOutput &lump : bspx)
        bspxLengths.push_back(lump.bytes.Size());
    const bool hasLump18 = lengths[LUMP_LIGHTGRID_SH] > 0;
    const std::size_t slots = hasLump18               ? std::size_t(kNumLumps)
                              : format.advertisements ? kAdvertisementSlots
                                                      : kClassicSlots;
    const FilePlan plan = PlanFile(slots, lengths, bspxLengths);

    std::vector<BspxPart> directory;
    for (std::size_t i = 0; i < bspx.size(); ++i)
        directory.push_back({std::string(bspx[i].name), plan.bspx[i]});
    ByteRanges file;
    file.AddOwned(MakeHeader(plan, hasLump18 ? 47 : format.version));
    for (const int slot : kDiskOrder)
        file.AddPadded(std::move(lumps[std::size_t(slot)]));
    file.AddOwned(BspxDirectory(directory));
    for (BspxOutput &lump : bspx)
        file.AddPadded(std::move(lump.bytes));
    return file;
}

// ---- Bytes to records ----

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in the file");

namespace {

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
        if (bsp.lightmaps.size() % kLightmapPageBytes != 0) {
            RefuseRagged(LUMP_LIGHTMAPS, kLightmapPageBytes);
            bsp.lightmaps.clear();
        }
        ReadBspxDirectory(bsp);
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
        if (std::memcmp(head_.data(), kIbspIdent.data(), kIbspIdent.size()) != 0)
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
        if (version_ != 47 || !format_.advertisements || firstByte_ < std::int64_t(HeaderBytes(kAdvertisementSlots)))
            return;
        const FilePart part = Slot(LUMP_ADVERTISEMENTS);
        if (Inside(part, HeaderBytes(kAdvertisementSlots)) &&
            part.length % std::int64_t(sizeof(bspAdvertisement_t)) == 0)
            lumps_[LUMP_ADVERTISEMENTS] = part;
    }

    void ReadGridSHSlot(Bsp &bsp) {
        constexpr std::size_t header = HeaderBytes(kNumLumps);
        if (version_ != 47 || firstByte_ < std::int64_t(header) || file_.size < header)
            return;
        const FilePart part = Slot(LUMP_LIGHTGRID_SH);
        // This program places the first lump right behind 19 slots. Where others begin later, slot 18 may be anything.
        const bool isOwnLayout = firstByte_ == std::int64_t(header);
        if (part.length == 0 || (!isOwnLayout && !Inside(part, header)))
            return;
        if (!Inside(part, header))
            throw Error("{}: lump {} ({}): offset {} + length {} is not inside the {} bytes of the file", name_,
                        int(LUMP_LIGHTGRID_SH), kLumpNames[LUMP_LIGHTGRID_SH], part.offset, part.length, file_.size);
        try {
            bsp.gridSH = ReadLightGridSH(file_, part, name_);
        } catch (const Error &error) {
            if (isOwnLayout)
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
        if (part.length % std::int64_t(sizeof(Record)) != 0)
            return RefuseRagged(slot, sizeof(Record));
        records.resize(std::size_t(part.length) / sizeof(Record));
        file_.Fill(std::uint64_t(part.offset), std::span(records));
    }

    /// Error for a lump that is no whole number of records of `record` bytes; with -force, a warning that the caller
    /// drops it.
    void RefuseRagged(int slot, std::size_t record) {
        const auto text = fmt::format("{}: lump {} ({}): length {} is not a multiple of the record size {}", name_,
                                      slot, kLumpNames[std::size_t(slot)], lumps_[std::size_t(slot)].length, record);
        if (!format_.force)
            throw Error(text);
        log_.Warn("ragged lump", "{}: the lump is dropped", text);
    }

    void ReadBspxDirectory(Bsp &bsp) {
        std::int64_t end = 0;
        for (const FilePart &part : lumps_)
            end = std::max(end, part.End());
        ReadBspxLumps(file_, Align4(std::uint64_t(end)), name_, bsp, log_);
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

Bsp DecodeIbsp(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log) {
    return Reader(file, name, format, log).Read();
}

} // namespace q3
