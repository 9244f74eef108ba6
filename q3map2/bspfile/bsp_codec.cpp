// GPL-2.0-or-later. What the .bsp formats share: parts and bytes of files, lumps by slot, and the decoder and encoder
// of a format.
#include "q3map2/bspfile/bsp_codec.h"

#include "common/error.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <algorithm>
#include <bit>

namespace q3 {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in the file");

// ---- Writing ----

namespace {

void Store32(std::vector<std::byte> &bytes, std::size_t at, std::uint32_t value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

void StorePart(std::vector<std::byte> &bytes, std::size_t at, const FilePart &part) {
    Store32(bytes, at, std::uint32_t(part.offset));
    Store32(bytes, at + 4, std::uint32_t(part.length));
}

std::vector<std::byte> MakeHeader(const FilePlan &plan, const FileLayout &layout) {
    std::vector<std::byte> header(HeaderBytes(plan.slots));
    std::memcpy(header.data(), layout.ident.data(), layout.ident.size());
    Store32(header, 4, std::uint32_t(layout.version));
    for (std::size_t slot = 0; slot < plan.slots; slot++)
        StorePart(header, HeaderBytes(slot), plan.lumps[slot]);
    return header;
}

} // namespace

FilePlan PlanFile(std::size_t slots, std::span<const int> order, const std::array<std::uint64_t, kNumLumps> &lengths,
                  std::span<const std::uint64_t> bspxLengths) {
    FilePlan plan;
    plan.slots = slots;
    std::uint64_t position = HeaderBytes(slots);
    const auto place = [&position](std::uint64_t length) {
        const FilePart part{std::int64_t(position), std::int64_t(length)};
        position = Align4(position + length);
        return part;
    };
    for (const int slot : order) {
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

LumpBytes CommonLumps(const Bsp &bsp) {
    LumpBytes lumps;
    ForEachCommonArray(bsp, [&](int slot, const auto &records) { lumps[std::size_t(slot)].Add(records); });
    lumps[LUMP_ENTITIES].Add(std::span(bsp.entities.c_str(), bsp.entities.size() + 1));
    return lumps;
}

ByteRanges AssembleFile(const FileLayout &layout, LumpBytes lumps, const Bsp &bsp) {
    std::vector<BspxOutput> bspx = WriteBspxLumps(bsp);
    std::array<std::uint64_t, kNumLumps> lengths{};
    std::ranges::transform(lumps, lengths.begin(), &ByteRanges::Size);
    std::vector<std::uint64_t> bspxLengths;
    for (const BspxOutput &lump : bspx)
        bspxLengths.push_back(lump.bytes.Size());
    const FilePlan plan = PlanFile(layout.slots, layout.order, lengths, bspxLengths);

    std::vector<BspxPart> directory;
    for (std::size_t i = 0; i < bspx.size(); ++i)
        directory.push_back({std::string(bspx[i].name), plan.bspx[i]});
    ByteRanges file;
    file.AddOwned(MakeHeader(plan, layout));
    for (const int slot : layout.order)
        file.AddPadded(std::move(lumps[std::size_t(slot)]));
    file.AddOwned(BspxDirectory(directory));
    for (BspxOutput &lump : bspx)
        file.AddPadded(std::move(lump.bytes));
    return file;
}

// ---- Reading ----

LumpReader::LumpReader(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log)
    : file_(file), name_(name), format_(format), log_(log) {
    file_.Fill(0, std::span(head_).first(std::size_t(std::min<std::uint64_t>(file_.size, head_.size()))));
}

void LumpReader::ReadSlots(std::size_t slots) {
    for (std::size_t slot = 0; slot < slots; slot++)
        lumps_[slot] = CheckedSlot(slot, slots);
    for (std::size_t slot = 0; slot < slots; slot++)
        if (lumps_[slot].length > 0)
            firstByte_ = std::min(firstByte_, lumps_[slot].offset);
}

void LumpReader::Mismatch(const std::string &text) const {
    if (!format_.force)
        throw Error("{}: {}", name_, text);
    log_.Warn("BSP ident or version", "{}: {}", name_, text);
}

FilePart LumpReader::Slot(std::size_t slot) const {
    const std::size_t at = HeaderBytes(slot);
    return {LoadRecord<std::int32_t>(head_, at), LoadRecord<std::int32_t>(head_, at + 4)};
}

bool LumpReader::Inside(const FilePart &part, std::size_t header) const {
    return part.length > 0 && part.offset >= std::int64_t(header) && part.End() <= std::int64_t(file_.size);
}

FilePart LumpReader::CheckedSlot(std::size_t slot, std::size_t slots) const {
    const FilePart part = Slot(slot);
    const auto fail = [&](const std::string &text) {
        throw Error("{}: lump {} ({}): {}", name_, slot, LumpName(slot), text);
    };
    if (part.offset < 0)
        fail(fmt::format("offset {} is negative", part.offset));
    if (part.length < 0)
        fail(fmt::format("length {} is negative", part.length));
    if (part.End() > std::int64_t(file_.size))
        fail(fmt::format("offset {} + length {} exceeds the {} bytes of the file", part.offset, part.length,
                         file_.size));
    if (part.length > 0 && part.offset < std::int64_t(HeaderBytes(slots)))
        fail(fmt::format("offset {} lies inside the header of {} bytes", part.offset, HeaderBytes(slots)));
    return part;
}

std::string_view LumpReader::LumpName(std::size_t slot) const {
    return slot == LUMP_LIGHTARRAY && !HasIdent(kIbspIdent) ? "light grid numbers" : kLumpNames[slot];
}

void LumpReader::WarnOverlap() const {
    std::vector<std::size_t> order;
    for (std::size_t slot = 0; slot < lumps_.size(); slot++)
        if (lumps_[slot].length > 0)
            order.push_back(slot);
    std::ranges::stable_sort(order, {}, [this](std::size_t slot) { return lumps_[slot].offset; });
    for (std::size_t i = 1; i < order.size(); i++)
        if (lumps_[order[i]].offset < lumps_[order[i - 1]].End())
            log_.Warn("overlapping lumps", "{}: lump {} ({}) overlaps lump {} ({})", name_, order[i - 1],
                      LumpName(order[i - 1]), order[i], LumpName(order[i]));
}

void LumpReader::ReadCommonLumps(Bsp &bsp) const {
    const FilePart &part = Lump(LUMP_ENTITIES);
    bsp.entities.resize(std::size_t(part.length));
    file_.Fill(std::uint64_t(part.offset), std::span(bsp.entities));
    bsp.entities.resize(std::min(bsp.entities.find('\0'), bsp.entities.size()));
    ForEachCommonArray(bsp, [this](int slot, auto &records) { ReadArray(slot, records); });
}

void LumpReader::RefuseRagged(int slot, std::size_t record) const {
    const auto text = fmt::format("{}: lump {} ({}): length {} is not a multiple of the record size {}", name_, slot,
                                  LumpName(std::size_t(slot)), Lump(slot).length, record);
    if (!format_.force)
        throw Error(text);
    log_.Warn("ragged lump", "{}: the lump is dropped", text);
}

void LumpReader::ReadBspx(Bsp &bsp) const {
    std::int64_t end = 0;
    for (const FilePart &part : lumps_)
        end = std::max(end, part.End());
    ReadBspxLumps(file_, Align4(std::uint64_t(end)), name_, bsp, log_);
}

} // namespace q3
