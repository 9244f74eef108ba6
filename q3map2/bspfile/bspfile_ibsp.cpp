// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records.
#include "q3map2/bspfile/bspfile_ibsp.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_hdr.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/bspfile/bspx.h"
#include "q3map2/bspfile/file_kind.h"

#include <algorithm>
#include <bit>

namespace q3 {

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
