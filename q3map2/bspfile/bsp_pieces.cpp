// GPL-2.0-or-later. IBSP files of version 46 and 47: records to bytes.
#include "q3map2/bspfile/bsp_pieces.h"

#include "common/error.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_hdr.h"
#include "q3map2/bspfile/bspfile_sparse.h"

#include <bit>

namespace q3 {

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

} // namespace q3
