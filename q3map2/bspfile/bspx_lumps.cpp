// GPL-2.0-or-later. The BSPX directory, and the table of the lumps that Bsp has members for: how each is read, written
// and checked.
#include "q3map2/bspfile/bspx_lumps.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_hdr.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/bspfile/prop_light.h"

#include <algorithm>
#include <type_traits>
#include <unordered_set>

namespace q3 {

// ---- The directory ----

namespace {

struct BspxHead {
    std::array<char, 4> ident;
    std::uint32_t count;
};
struct BspxEntry {
    std::array<char, kBspxNameBytes> name;
    std::uint32_t offset, length;
};
static_assert(sizeof(BspxHead) == kBspxHeadBytes && sizeof(BspxEntry) == kBspxEntryBytes);

} // namespace

std::vector<BspxPart> ReadBspx(const ByteSource &file, std::uint64_t start, std::string_view name, Log &log) {
    if (start + kBspxHeadBytes > file.size)
        return {};
    BspxHead head{};
    file.Fill(start, std::span(&head, 1));
    if (std::memcmp(head.ident.data(), "BSPX", 4) != 0)
        return {};
    const auto drop = [&](const std::string &text) {
        log.Warn("BSPX directory", "{}: BSPX directory: {}: all of it is dropped", name, text);
        return std::vector<BspxPart>{};
    };
    const std::uint64_t room = file.size - start - kBspxHeadBytes;
    if (head.count > room / kBspxEntryBytes)
        return drop(fmt::format("{} entries do not fit in {} bytes", head.count, room));
    std::vector<BspxEntry> entries(head.count);
    file.Fill(start + kBspxHeadBytes, std::span(entries));

    const std::uint64_t first = start + kBspxHeadBytes + std::uint64_t(head.count) * kBspxEntryBytes;
    std::uint64_t total = 0;
    std::vector<BspxPart> lumps;
    std::unordered_set<std::string> seen;
    for (std::size_t i = 0; i < entries.size(); i++) {
        const std::uint64_t offset = entries[i].offset, length = entries[i].length;
        if (length > 0 && (offset < first || offset + length > file.size))
            return drop(fmt::format("entry {}: offset {} + length {} is not inside {}..{}", i, offset, length, first,
                                    file.size));
        // Lumps that share bytes would let a small file ask for any amount of memory.
        total += length;
        if (total > file.size - first)
            return drop(fmt::format("entry {}: the lumps share bytes", i));
        std::string lumpName(FieldName(entries[i].name));
        if (!seen.insert(lumpName).second) {
            log.Warn("BSPX duplicate", "{}: two BSPX lumps are named {}: the first is kept", name, lumpName);
            continue;
        }
        lumps.push_back({std::move(lumpName), {std::int64_t(offset), std::int64_t(length)}});
    }
    return lumps;
}

std::vector<std::byte> BspxDirectory(const std::vector<BspxPart> &lumps) {
    if (lumps.empty())
        return {};
    std::vector<std::byte> bytes(kBspxHeadBytes + lumps.size() * kBspxEntryBytes);
    const BspxHead head{{'B', 'S', 'P', 'X'}, std::uint32_t(lumps.size())};
    std::memcpy(bytes.data(), &head, sizeof head);
    for (std::size_t i = 0; i < lumps.size(); ++i) {
        BspxEntry entry{{}, std::uint32_t(lumps[i].part.offset), std::uint32_t(lumps[i].part.length)};
        std::ranges::copy(lumps[i].name, entry.name.begin());
        std::memcpy(bytes.data() + kBspxHeadBytes + i * kBspxEntryBytes, &entry, sizeof entry);
    }
    return bytes;
}

void BspxSource::Fail(std::string_view text) const {
    throw Error("{}: BSPX lump {}: {}", fileName, lump, text);
}

std::vector<std::byte> BspxSource::Bytes() const {
    std::vector<std::byte> bytes(std::size_t(part.length));
    file.Fill(std::uint64_t(part.offset), std::span(bytes));
    return bytes;
}

// ---- The table of lumps ----

namespace {

template <typename Member> constexpr bool kIsVector = requires(const Member &member) {
    member.empty();
};

// What most rows do: a member that is a std::optional, or a vector that is empty where the map has no such lump.

template <auto member> bool HasMember(const Bsp &bsp) {
    if constexpr (kIsVector<std::remove_cvref_t<decltype(bsp.*member)>>)
        return !(bsp.*member).empty();
    else
        return (bsp.*member).has_value();
}

template <auto member> void ClearMember(Bsp &bsp) {
    bsp.*member = std::remove_cvref_t<decltype(bsp.*member)>{};
}

template <auto member, auto read> void ReadMember(const BspxSource &from, Bsp &bsp) {
    bsp.*member = read(from);
}

template <auto member, auto write> ByteRanges WriteMember(const Bsp &bsp) {
    return write(*(bsp.*member));
}

template <auto member> ByteRanges WriteVector(const Bsp &bsp) {
    ByteRanges bytes;
    bytes.Add(bsp.*member);
    return bytes;
}

void ReadUniformGrid(const BspxSource &from, Bsp &bsp) {
    if (bsp.gridSH) {
        from.log.Warn("two SH light grids", "{}: lump 18 and BSPX hold an SH light grid each: lump 18 is used",
                      from.fileName);
        return;
    }
    bsp.gridSH = ReadLightGridSH(from.file, from.part, from.fileName);
    bsp.gridSHContainer = GridSHContainer::Bspx;
}

void CheckUniformGrid(const Bsp &bsp, std::string_view name) {
    CheckLightGridSH(*bsp.gridSH, name);
}

void CheckSparse(const Bsp &bsp, std::string_view name) {
    CheckSparseGrid(*bsp.sparseGridSH, name);
}

void CheckNamed(const Bsp &bsp, std::string_view name) {
    CheckNamedGrid(*bsp.namedGridSH, name);
}

using enum StaleAfter;

constexpr BspxRow kRows[] = {
    {BspxId::PropLight, kBspxPropLight, "light of static props", SurfaceBake, HasMember<&Bsp::propLight>,
     ClearMember<&Bsp::propLight>, ReadMember<&Bsp::propLight, ReadPropLight>,
     WriteMember<&Bsp::propLight, PropLightRanges>, PropLightFault, nullptr},
    {BspxId::LightGridSH, kBspxLightGridSH, "the SH light grid", EveryBake, HasMember<&Bsp::gridSH>,
     ClearMember<&Bsp::gridSH>, ReadUniformGrid, WriteMember<&Bsp::gridSH, GridRanges>, nullptr, CheckUniformGrid},
    {BspxId::LightmapsE5bgr9, kBspxLightmapsE5bgr9, "HDR light", SurfaceBake, HasMember<&Bsp::lightmapsE5bgr9>,
     ClearMember<&Bsp::lightmapsE5bgr9>, ReadMember<&Bsp::lightmapsE5bgr9, ReadCodes>,
     WriteVector<&Bsp::lightmapsE5bgr9>, LightmapsFault, nullptr},
    {BspxId::VertexE5bgr9, kBspxVertexE5bgr9, "HDR light", SurfaceBake, HasMember<&Bsp::vertexE5bgr9>,
     ClearMember<&Bsp::vertexE5bgr9>, ReadMember<&Bsp::vertexE5bgr9, ReadCodes>, WriteVector<&Bsp::vertexE5bgr9>,
     VertexFault, nullptr},
    {BspxId::Rnm, kBspxRnm, "HDR light", SurfaceBake, HasMember<&Bsp::rnm>, ClearMember<&Bsp::rnm>,
     ReadMember<&Bsp::rnm, ReadRnm>, WriteMember<&Bsp::rnm, RnmRanges>, RnmFault, nullptr},
    {BspxId::SparseGridSH, kBspxSparseGridSH, "the sparse SH light grid", EveryBake, HasMember<&Bsp::sparseGridSH>,
     ClearMember<&Bsp::sparseGridSH>, ReadMember<&Bsp::sparseGridSH, ReadSparseGrid>,
     WriteMember<&Bsp::sparseGridSH, SparseRanges>, nullptr, CheckSparse},
    {BspxId::NamedGridSH, kBspxNamedGridSH, "the SH light grid that names lights", EveryBake,
     HasMember<&Bsp::namedGridSH>, ClearMember<&Bsp::namedGridSH>, ReadMember<&Bsp::namedGridSH, ReadNamedGrid>,
     WriteMember<&Bsp::namedGridSH, NamedRanges>, nullptr, CheckNamed},
    {BspxId::AmbientCubes, kBspxAmbientCubes, "ambient cubes", EveryBake, HasMember<&Bsp::ambientCubes>,
     ClearMember<&Bsp::ambientCubes>, ReadMember<&Bsp::ambientCubes, ReadAmbientCubes>,
     WriteMember<&Bsp::ambientCubes, CubeRanges>, CubesMisfit, CheckAmbientCubes},
};
static_assert(HasRowOfEachLump(kRows));
static_assert(std::ranges::is_sorted(kRows, {}, &BspxRow::id), "RowOf finds rows by number");

} // namespace

std::span<const BspxRow> BspxRows() {
    return kRows;
}

const BspxRow *FindBspxRow(std::string_view name) {
    const auto found = std::ranges::find(kRows, name, &BspxRow::name);
    return found == std::end(kRows) ? nullptr : found;
}

bool IsInBspx(const Bsp &bsp, const BspxRow &row) {
    return row.has(bsp) && (row.id != BspxId::LightGridSH || bsp.gridSHContainer == GridSHContainer::Bspx);
}

std::uint64_t BytesOfLump(const Bsp &bsp, BspxId id) {
    const BspxRow &row = RowOf(id);
    return row.has(bsp) ? row.write(bsp).Size() : 0;
}

std::uint64_t BytesOfBspx(const Bsp &bsp) {
    std::uint64_t bytes = 0;
    for (const BspxRow &row : kRows)
        bytes += IsInBspx(bsp, row) ? row.write(bsp).Size() : 0;
    for (const BspxLump &lump : bsp.bspx)
        bytes += lump.data.size();
    return bytes;
}

void CheckBspxLumps(const Bsp &bsp, std::string_view name) {
    for (const BspxRow &row : kRows) {
        if (!row.has(bsp))
            continue;
        if (row.misfit != nullptr)
            if (const std::string text = row.misfit(bsp); !text.empty())
                throw Error("{}: BSPX lump {}: {}", name, row.name, text);
        if (row.check != nullptr)
            row.check(bsp, name);
    }
}

void DropUnfitLumps(Bsp &bsp, std::string_view name, Log &log) {
    for (const BspxRow &row : kRows) {
        const std::string text = row.has(bsp) && row.misfit != nullptr ? row.misfit(bsp) : std::string();
        if (text.empty())
            continue;
        log.Warn(row.name, "{}: BSPX lump {} is dropped: {}", name, row.name, text);
        row.clear(bsp);
    }
}

void DropStaleLumps(Bsp &bsp, StaleAfter staleAfter) {
    for (const BspxRow &row : kRows)
        if (row.staleAfter == staleAfter)
            row.clear(bsp);
}

void ReadBspxLumps(const ByteSource &file, std::uint64_t start, std::string_view name, Bsp &bsp, Log &log) {
    for (BspxPart &lump : ReadBspx(file, start, name, log)) {
        const BspxSource from{file, lump.part, lump.name, name, log};
        if (const BspxRow *row = FindBspxRow(lump.name))
            row->read(from, bsp);
        else {
            std::vector<std::byte> data = from.Bytes();
            bsp.bspx.push_back({std::move(lump.name), std::move(data)});
        }
    }
    DropUnfitLumps(bsp, name, log);
}

std::vector<BspxOutput> WriteBspxLumps(const Bsp &bsp) {
    std::vector<BspxOutput> lumps;
    for (const BspxRow &row : kRows) {
        if (IsInBspx(bsp, row))
            lumps.push_back({row.name, row.write(bsp)});
        if (row.id != BspxId::PropLight) // lumps of other programs follow this one
            continue;
        for (const BspxLump &lump : bsp.bspx) {
            if (lump.name.size() > kBspxNameBytes)
                throw Error("BSPX lump {}: the name has more than {} bytes", lump.name, kBspxNameBytes);
            BspxOutput &output = lumps.emplace_back();
            output.name = lump.name;
            output.bytes.Add(lump.data);
        }
    }
    return lumps;
}

} // namespace q3
