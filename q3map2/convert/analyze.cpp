// GPL-2.0-or-later. What may be in a .bsp of an unknown game.
#include "q3map2/convert/analyze.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace q3 {

namespace {

constexpr std::size_t kDirectoryAt = 8, kEntryBytes = 8, kMaxLumps = 100;
constexpr std::size_t kMaxText = 1023, kTextColumns = 100;

/// A record of games of the family: its size, and how many a map has at least.
struct RecordKind {
    std::string_view name;
    std::size_t bytes, least;
};
constexpr RecordKind kRecordKinds[] = {
    {"planes", 16, 6},
    {"brushes", 12, 1},
    {"brush sides (IBSP)", 8, 6},
    {"brush sides (RBSP)", 12, 6},
    {"models", 40, 1},
    {"nodes", 36, 2},
    {"leafs", 48, 1},
    {"draw surfaces", 104, 3},
    {"draw vertices", 44, 3},
    {"draw indexes", 4, 6},
    {"lightmaps, 128 x 128", 49152, 1},
    {"lightmaps, 256 x 256", 196608, 1},
    {"lightmaps, 512 x 512", 786432, 1},
};

template <typename T> T FirstAs(std::span<const std::byte> bytes) {
    T value{};
    std::memcpy(&value, bytes.data(), std::min(sizeof value, bytes.size()));
    return value;
}

/// Text up to the first zero byte, with '.' for what cannot be printed.
std::string PrintableStart(std::span<const std::byte> lump) {
    const std::string_view text = AsText(lump.first(std::min(lump.size(), kMaxText)));
    std::string printable(text.substr(0, text.find('\0')));
    std::ranges::replace_if(
        printable, [](char c) { return c < ' ' || c > '~'; }, '.');
    return printable;
}

void PrintLump(std::size_t number, const FoundLump &found, std::span<const std::byte> file, Log &log) {
    log.Print("lump {:2}: offset {}, length {}\n", number, found.offset, found.length);
    const auto lump = file.subspan(std::size_t(found.offset), std::size_t(found.length));
    if (lump.empty())
        return;
    log.Print("         hex {:08x}, int {}, float {}\n", FirstAs<std::uint32_t>(lump), FirstAs<std::int32_t>(lump),
              FirstAs<float>(lump));
    const std::string text = PrintableStart(lump);
    for (std::size_t at = 0; at < text.size(); at += kTextColumns)
        log.Print("         {} {}\n", at == 0 ? "text" : "    ", text.substr(at, kTextColumns));
    std::string guesses;
    for (const std::string &guess : GuessLump(lump))
        guesses += (guesses.empty() ? "" : ", ") + guess;
    log.Print("         may be {}\n", guesses.empty() ? "of a kind not known here" : guesses);
}

} // namespace

std::vector<FoundLump> FindLumps(std::span<const std::byte> file, bool lumpSwap, std::string_view name) {
    if (file.size() < kDirectoryAt + kEntryBytes)
        throw Error("{}: {} bytes, expected four letters, a version and a directory of lumps", name, file.size());
    std::vector<FoundLump> lumps;
    std::size_t end = file.size(); // of the directory, as far as one can tell
    for (std::size_t at = kDirectoryAt; at + kEntryBytes <= end && lumps.size() < kMaxLumps; at += kEntryBytes) {
        const auto first = FirstAs<std::int32_t>(file.subspan(at)),
                   second = FirstAs<std::int32_t>(file.subspan(at + 4));
        const FoundLump lump{lumpSwap ? second : first, lumpSwap ? first : second};
        if (lump.offset < 0 || lump.length < 0 || std::int64_t(lump.offset) + lump.length > std::int64_t(file.size()))
            break;
        lumps.push_back(lump);
        if (lump.length > 0)
            end = std::min(end, std::size_t(lump.offset));
    }
    return lumps;
}

std::vector<std::string> GuessLump(std::span<const std::byte> lump) {
    const std::string_view text = AsText(lump);
    if (text.size() > 2 && text[0] == '{' && text[2] == '"')
        return {"entities"};
    if (text.find("textures/") != std::string_view::npos)
        return {"shaders"};
    std::vector<std::string> guesses;
    for (const RecordKind &kind : kRecordKinds)
        if (lump.size() % kind.bytes == 0 && lump.size() / kind.bytes >= kind.least)
            guesses.push_back(fmt::format("{} {}", lump.size() / kind.bytes, kind.name));
    return guesses;
}

void PrintAnalysis(std::span<const std::byte> file, bool lumpSwap, std::string_view name, Log &log) {
    const std::vector<FoundLump> lumps = FindLumps(file, lumpSwap, name);
    log.Print("{}\nident   {}\n", name, PrintableStart(file.first(4)));
    log.Print("version {}\n", FirstAs<std::int32_t>(file.subspan(4)));
    log.Print("bytes   {}\n", file.size());
    for (std::size_t i = 0; i < lumps.size(); ++i)
        PrintLump(i, lumps[i], file, log);
    if (lumps.empty())
        log.Print("The first entry of the directory does not lie in the file; try it {} -lumpswap\n",
                  lumpSwap ? "without" : "with");
}

} // namespace q3
