// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records and back.
#include "common/error.h"
#include "q3map2/bspfile/bsp_layout.h"

#include <algorithm>
#include <bit>

namespace q3 {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in the file");

namespace {

constexpr std::size_t kClassicSlots = 17;
constexpr std::size_t kLightmapPageBytes = 128 * 128 * 3;
constexpr std::array<int, kNumLumps> kDiskOrder = {1, 2, 4, 3, 8, 9, 5, 6, 7, 10, 13, 16, 14, 15, 0, 12, 11, 17, 18};

class Reader {
  public:
    Reader(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log)
        : file_(file), name_(name), format_(format), log_(log) {}

    Bsp Read() {
        ReadHead();
        Bsp bsp;
        ReadAdvertisementSlot();
        ReadGridSHSlot(bsp);
        WarnOverlap();
        ReadEntities(bsp);
        ForEachArray(bsp, [this](int slot, auto &records) { ReadArray(slot, records); });
        if (bsp.lightmaps.size() % kLightmapPageBytes != 0 && Ragged(LUMP_LIGHTMAPS, kLightmapPageBytes))
            bsp.lightmaps.clear();
        ReadBspxLumps(bsp);
        return bsp;
    }

  private:
    std::int64_t FileSize() const { return std::int64_t(file_.size()); }
    bool Inside(const FilePart &part, std::size_t header) const {
        return part.length > 0 && part.offset >= std::int64_t(header) && part.End() <= FileSize();
    }
    FilePart Slot(std::size_t slot) const {
        const std::size_t at = HeaderBytes(slot);
        return {LoadRecord<std::int32_t>(file_, at), LoadRecord<std::int32_t>(file_, at + 4)};
    }
    std::span<const std::byte> Bytes(int slot) const {
        const FilePart &part = lumps_[std::size_t(slot)];
        return file_.subspan(std::size_t(part.offset), std::size_t(part.length));
    }

    void ReadHead() {
        if (file_.size() < HeaderBytes(kClassicSlots))
            throw Error("{}: {} bytes, but a BSP header has {}", name_, file_.size(), HeaderBytes(kClassicSlots));
        if (std::memcmp(file_.data(), "IBSP", 4) != 0)
            Mismatch("the file does not start with IBSP: not a Quake III map");
        version_ = LoadRecord<std::int32_t>(file_, 4);
        if (version_ != 46 && version_ != 47)
            Mismatch(fmt::format("BSP version {}, expected 46 or 47", version_));
        for (std::size_t slot = 0; slot < kClassicSlots; slot++)
            lumps_[slot] = CheckedSlot(slot);
        for (std::size_t slot = 0; slot < kClassicSlots; slot++)
            if (lumps_[slot].length > 0)
                firstByte_ = std::min(firstByte_, lumps_[slot].offset);
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
                             file_.size()));
        if (part.length > 0 && part.offset < std::int64_t(HeaderBytes(kClassicSlots)))
            fail(fmt::format("offset {} lies inside the header of {} bytes", part.offset, HeaderBytes(kClassicSlots)));
        return part;
    }

    // What slot 17 holds is only a guess from the place of the first lump: other layouts have text or lumps there.
    void ReadAdvertisementSlot() {
        if (version_ != 47 || !format_.advertisements || firstByte_ < std::int64_t(HeaderBytes(18)))
            return;
        const FilePart part = Slot(LUMP_ADVERTISEMENTS);
        if (Inside(part, HeaderBytes(18)) && part.length % std::int64_t(sizeof(bspAdvertisement_t)) == 0)
            lumps_[LUMP_ADVERTISEMENTS] = part;
    }

    void ReadGridSHSlot(Bsp &bsp) {
        constexpr std::size_t header = HeaderBytes(kNumLumps);
        if (version_ != 47 || firstByte_ < std::int64_t(header) || file_.size() < header)
            return;
        const FilePart part = Slot(LUMP_LIGHTGRID_SH);
        const bool ours = firstByte_ == std::int64_t(header);
        if (part.length == 0 || (!ours && !Inside(part, header)))
            return;
        if (!Inside(part, header))
            throw Error("{}: lump {} ({}): offset {} + length {} is not inside the {} bytes of the file", name_,
                        int(LUMP_LIGHTGRID_SH), kLumpNames[LUMP_LIGHTGRID_SH], part.offset, part.length, file_.size());
        const auto bytes = file_.subspan(std::size_t(part.offset), std::size_t(part.length));
        try {
            bsp.gridSH = ParseLightGridSH(bytes, name_);
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
        std::ranges::sort(order, {}, [this](std::size_t slot) { return lumps_[slot].offset; });
        for (std::size_t i = 1; i < order.size(); i++)
            if (lumps_[order[i]].offset < lumps_[order[i - 1]].End())
                log_.Warn("overlapping lumps", "{}: lump {} ({}) overlaps lump {} ({})", name_, order[i - 1],
                          kLumpNames[order[i - 1]], order[i], kLumpNames[order[i]]);
    }

    void ReadEntities(Bsp &bsp) const {
        const auto bytes = Bytes(LUMP_ENTITIES);
        const std::string_view text(reinterpret_cast<const char *>(bytes.data()), bytes.size());
        bsp.entities = text.substr(0, text.find('\0'));
    }

    template <typename Record> void ReadArray(int slot, std::vector<Record> &records) {
        const auto bytes = Bytes(slot);
        if (bytes.size() % sizeof(Record) != 0 && Ragged(slot, sizeof(Record)))
            return;
        records.resize(bytes.size() / sizeof(Record));
        if (!records.empty())
            std::memcpy(records.data(), bytes.data(), bytes.size());
    }

    bool Ragged(int slot, std::size_t record) {
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
        bsp.bspx = ReadBspx(file_, Align4(std::uint64_t(end)), name_, log_);
        const auto found = std::ranges::find(bsp.bspx, kBspxLightGridSH, &BspxLump::name);
        if (found == bsp.bspx.end())
            return;
        if (bsp.gridSH) {
            log_.Warn("two SH light grids", "{}: lump 18 and BSPX hold an SH light grid each: lump 18 is used", name_);
        } else {
            bsp.gridSH = ParseLightGridSH(found->data, name_);
            bsp.gridSHContainer = GridSHContainer::Bspx;
        }
        bsp.bspx.erase(found);
    }

    std::span<const std::byte> file_;
    std::string_view name_;
    const BspFormat &format_;
    Log &log_;
    std::int32_t version_ = 0;
    std::array<FilePart, kNumLumps> lumps_{};
    std::int64_t firstByte_ = INT64_MAX; ///< smallest offset of a lump that is not empty
};

template <typename Value> void Store(std::vector<std::byte> &file, std::size_t at, const Value &value) {
    std::memcpy(file.data() + at, &value, sizeof value);
}

template <typename Record>
void StoreArray(std::vector<std::byte> &file, const FilePart &part, const std::vector<Record> &records) {
    if (part.length > 0)
        std::memcpy(file.data() + part.offset, records.data(), std::size_t(part.length));
}

void StoreHeader(std::vector<std::byte> &file, const FilePlan &plan, int version) {
    std::memcpy(file.data(), "IBSP", 4);
    Store(file, 4, std::int32_t(version));
    for (std::size_t slot = 0; slot < plan.slots; slot++) {
        Store(file, HeaderBytes(slot), std::int32_t(plan.lumps[slot].offset));
        Store(file, HeaderBytes(slot) + 4, std::int32_t(plan.lumps[slot].length));
    }
}

void StoreBspx(std::vector<std::byte> &file, const FilePlan &plan, const std::vector<BspxLump> &lumps) {
    if (lumps.empty())
        return;
    std::memcpy(file.data() + plan.bspxStart, "BSPX", 4);
    Store(file, plan.bspxStart + 4, std::uint32_t(lumps.size()));
    for (std::size_t i = 0; i < lumps.size(); i++) {
        const std::size_t entry = plan.bspxStart + kBspxHeadBytes + i * kBspxEntryBytes;
        std::memcpy(file.data() + entry, lumps[i].name.data(), lumps[i].name.size());
        Store(file, entry + kBspxNameBytes, std::uint32_t(plan.bspx[i].offset));
        Store(file, entry + kBspxNameBytes + 4, std::uint32_t(plan.bspx[i].length));
        StoreArray(file, plan.bspx[i], lumps[i].data);
    }
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

Bsp ReadBsp(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log) {
    Bsp bsp = Reader(file, name, format, log).Read();
    ValidateBsp(bsp, name, log);
    return bsp;
}

std::vector<std::byte> WriteBsp(const Bsp &bsp, const BspFormat &format) {
    const bool hasLump18 = bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Lump;
    std::array<std::uint64_t, kNumLumps> lengths{};
    ForEachArray(bsp, [&lengths](int slot, const auto &records) {
        lengths[std::size_t(slot)] = records.size() * sizeof(records[0]);
    });
    lengths[LUMP_ENTITIES] = bsp.entities.size() + 1;
    if (!format.advertisements)
        lengths[LUMP_ADVERTISEMENTS] = 0;
    if (hasLump18)
        lengths[LUMP_LIGHTGRID_SH] = sizeof(bspGridSHHeader_t) + bsp.gridSH->points.size() * sizeof(bspGridPointSH_t);

    std::vector<BspxLump> bspx = bsp.bspx;
    if (bsp.gridSH && !hasLump18)
        bspx.push_back({std::string(kBspxLightGridSH), PackLightGridSH(*bsp.gridSH)});
    std::vector<std::uint64_t> bspxLengths;
    for (const BspxLump &lump : bspx) {
        if (lump.name.size() > kBspxNameBytes)
            throw Error("BSPX lump {}: the name has more than {} bytes", lump.name, kBspxNameBytes);
        bspxLengths.push_back(lump.data.size());
    }

    const std::size_t slots = hasLump18 ? std::size_t(kNumLumps) : format.advertisements ? 18 : kClassicSlots;
    const FilePlan plan = PlanFile(slots, lengths, bspxLengths);
    std::vector<std::byte> file(plan.size);
    StoreHeader(file, plan, hasLump18 ? 47 : format.version);
    ForEachArray(bsp, [&](int slot, const auto &records) { StoreArray(file, plan.lumps[std::size_t(slot)], records); });
    std::memcpy(file.data() + plan.lumps[LUMP_ENTITIES].offset, bsp.entities.data(), bsp.entities.size());
    if (hasLump18) { // without PackLightGridSH's copy: the lump can be most of the program's memory
        CheckLightGridSH(*bsp.gridSH, "writing");
        const FilePart &part = plan.lumps[LUMP_LIGHTGRID_SH];
        Store(file, std::size_t(part.offset), bsp.gridSH->header);
        StoreArray(file,
                   {part.offset + std::int64_t(sizeof(bspGridSHHeader_t)),
                    part.length - std::int64_t(sizeof(bspGridSHHeader_t))},
                   bsp.gridSH->points);
    }
    StoreBspx(file, plan, bspx);
    return file;
}

} // namespace q3
