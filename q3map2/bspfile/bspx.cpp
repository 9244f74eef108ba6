// GPL-2.0-or-later. The BSPX directory that may follow the header lumps.
#include "common/error.h"
#include "q3map2/bspfile/bsp_layout.h"

#include <algorithm>
#include <unordered_set>

namespace q3 {

std::vector<BspxLump> ReadBspx(std::span<const std::byte> file, std::size_t start, std::string_view name, Log &log) {
    if (start + kBspxHeadBytes > file.size() || std::memcmp(file.data() + start, "BSPX", 4) != 0)
        return {};
    const auto drop = [&](const std::string &text) {
        log.Warn("BSPX directory", "{}: BSPX directory: {}: all of it is dropped", name, text);
        return std::vector<BspxLump>{};
    };
    const auto count = LoadRecord<std::uint32_t>(file, start + 4);
    const std::uint64_t room = file.size() - start - kBspxHeadBytes;
    if (count > room / kBspxEntryBytes)
        return drop(fmt::format("{} entries do not fit in {} bytes", count, room));

    const std::uint64_t first = start + kBspxHeadBytes + std::uint64_t(count) * kBspxEntryBytes;
    std::uint64_t total = 0;
    std::vector<BspxLump> lumps;
    std::unordered_set<std::string> seen;
    for (std::size_t i = 0; i < count; i++) {
        const std::size_t entry = start + kBspxHeadBytes + i * kBspxEntryBytes;
        const auto field = LoadRecord<std::array<char, kBspxNameBytes>>(file, entry);
        const std::uint64_t offset = LoadRecord<std::uint32_t>(file, entry + kBspxNameBytes);
        const std::uint64_t length = LoadRecord<std::uint32_t>(file, entry + kBspxNameBytes + 4);
        if (length > 0 && (offset < first || offset + length > file.size()))
            return drop(fmt::format("entry {}: offset {} + length {} is not inside {}..{}", i, offset, length, first,
                                    file.size()));
        // Lumps that share bytes would let a small file ask for any amount of memory.
        total += length;
        if (total > file.size() - first)
            return drop(fmt::format("entry {}: the lumps share bytes", i));
        std::string lumpName(FieldName(field));
        if (!seen.insert(lumpName).second) {
            log.Warn("BSPX duplicate", "{}: two BSPX lumps are named {}: the first is kept", name, lumpName);
            continue;
        }
        const auto data = length > 0 ? file.subspan(offset, length) : std::span<const std::byte>{};
        lumps.push_back({std::move(lumpName), {data.begin(), data.end()}});
    }
    return lumps;
}

} // namespace q3
