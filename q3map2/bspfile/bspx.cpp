// GPL-2.0-or-later. The BSPX directory that may follow the header lumps.
#include "q3map2/bspfile/bspx.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"

#include <algorithm>
#include <unordered_set>

namespace q3 {

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

} // namespace q3
