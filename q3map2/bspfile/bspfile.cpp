// GPL-2.0-or-later. Compiled maps as files on disk, and names for files that are something else.
#include "q3map2/bspfile/bspfile.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/bspfile/bspfile_rbsp.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace q3 {

// ---- Names files that are neither a map source nor a .bsp of this family, for messages ----

namespace {

using namespace std::string_view_literals;

struct Mark {
    std::string_view bytes, kind;
};

/// Files by their first bytes.
constexpr std::array kMarks = std::to_array<Mark>({
    {"VBSP"sv, "a map of a Source game (VBSP)"},
    {"PSBV"sv, "a map of a Source game for consoles (PSBV)"},
    {"XBSP"sv, "a map of XreaL (XBSP)"},
    {"QBSP"sv, "a map of Quake II with extended limits (QBSP)"},
    {"BSP2"sv, "a map of Quake with extended limits (BSP2)"},
    {"2PSB"sv, "a map of Quake with extended limits (2PSB)"},
    {"FAKK"sv, "a map of Heavy Metal: F.A.K.K.2 or American McGee's Alice"},
    {"2015"sv, "a map of Medal of Honor: Allied Assault"},
    {"EALA"sv, "a map of a Medal of Honor expansion"},
    {"EF2!"sv, "a map of Elite Force II"},
    {"IDP3"sv, "a model (md3)"},
    {"IDP2"sv, "a model (md2)"},
    {"EAAS"sv, "a bot file (aas)"},
    {"PRT1"sv, "a portal file (prt)"},
    {"PACK"sv, "an archive of Quake or Quake II (pak)"},
    {"WAD2"sv, "a texture archive of Quake (wad)"},
    {"WAD3"sv, "a texture archive of Half-Life (wad)"},
    {"JHMF"sv, "a source of the editor J.A.C.K. (jmf): export it as .map"},
    {"PK\3\4"sv, "a zip archive or pk3: unpack the map"},
    {"\x1F\x8B"sv, "compressed by gzip: unpack it"},
    {"BZh"sv, "compressed by bzip2: unpack it"},
    {"\xFD"
     "7zXZ"sv,
     "compressed by xz: unpack it"},
    {"\x28\xB5\x2F\xFD"sv, "compressed by zstd: unpack it"},
    {"7z\xBC\xAF\x27\x1C"sv, "a 7z archive: unpack the map"},
    {"Rar!"sv, "a rar archive: unpack the map"},
    {"\x89PNG"sv, "an image (png)"},
    {"\xFF\xD8\xFF"sv, "an image (jpg)"},
    {"DDS "sv, "an image (dds)"},
    {"\x7F"
     "ELF"sv,
     "a program"},
    {"MZ"sv, "a program"},
    {"\xFF\xFE"sv, "text in UTF-16: save it as plain text"},
    {"\xFE\xFF"sv, "text in UTF-16: save it as plain text"},
});

/// Versions of IBSP, and of files that begin with their version.
struct Version {
    std::uint32_t number;
    std::string_view game;
};
constexpr std::array kIbspVersions = std::to_array<Version>({{4, "Call of Duty 2"},
                                                             {22, "Call of Duty 4"},
                                                             {38, "Quake II"},
                                                             {41, "Daikatana"},
                                                             {43, "a test release of Quake III"},
                                                             {44, "a test release of Quake III"},
                                                             {45, "a test release of Quake III"},
                                                             {59, "Call of Duty"},
                                                             {60, "Call of Duty"},
                                                             {61, "Call of Duty"},
                                                             {62, "Call of Duty"}});
constexpr std::array kBareVersions = std::to_array<Version>(
    {{23, "a test release of Quake"}, {28, "Quake (beta)"}, {29, "Quake or Hexen II"}, {30, "Half-Life"}});

std::string_view GameOf(std::span<const Version> versions, std::uint32_t number) {
    const auto found = std::ranges::find(versions, number, &Version::number);
    return found == versions.end() ? std::string_view() : found->game;
}

std::uint32_t WordAt(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 4; i-- > 0;)
        word = word << 8 | std::uint8_t(bytes[at + i]);
    return word;
}

bool IsText(std::string_view bytes) {
    return std::ranges::none_of(bytes, [](char c) {
        const auto byte = std::uint8_t(c);
        return byte == 127 || (byte < ' ' && c != '\t' && c != '\n' && c != '\r' && c != '\f');
    });
}

std::string KindOfText(std::string_view text) {
    if (std::string kind = KindOfSource(text); !kind.empty())
        return kind;
    TextScanner scanner{std::string(text), {}};
    std::string first, second;
    try {
        const bool opens = scanner.Next(first) && first == "{" && scanner.Next(second);
        return std::string(opens && scanner.IsQuoted() && second == "classname" ? kKindMapSource : kKindText);
    } catch (const Error &) { // a long token
        return std::string(kKindText);
    }
}

} // namespace

std::string KindOfFile(std::span<const std::byte> begin) {
    const std::string_view bytes = AsText(begin).substr(0, kKindBytes);
    if (bytes.empty())
        return std::string(kKindEmpty);
    for (const Mark &mark : kMarks)
        if (bytes.starts_with(mark.bytes))
            return std::string(mark.kind);
    if (bytes.size() >= 8 && bytes.starts_with("IBSP")) {
        const std::uint32_t version = WordAt(bytes, 4);
        const std::string_view game = GameOf(kIbspVersions, version);
        return game.empty() ? "" : fmt::format("a map of {} (IBSP {})", game, version);
    }
    if (bytes.size() >= 7 && bytes.substr(4).starts_with("RMF"))
        return "a source of the editor Worldcraft or Hammer (rmf): export it as .map";
    if (bytes.size() >= 4)
        if (const std::string_view game = GameOf(kBareVersions, WordAt(bytes, 0)); !game.empty())
            return fmt::format("a map of {} (version {})", game, WordAt(bytes, 0));
    return IsText(bytes) ? KindOfText(bytes) : "";
}

std::string KindOfSource(std::string_view text) {
    TextScanner scanner{std::string(text.substr(0, kKindBytes)), {}};
    std::string word, value;
    try {
        if (!scanner.Next(word) || !scanner.Next(value))
            return {};
    } catch (const Error &) { // a long token
        return {};
    }
    if (EqualNoCase(word, "Version"))
        return fmt::format("a map source of {} (Version {})",
                           value == "1"   ? "an early Doom 3"
                           : value == "2" ? "Doom 3"
                           : value == "3" ? "Quake 4"
                                          : "a Doom 3 engine",
                           value);
    if (EqualNoCase(word, "iwmap"))
        return fmt::format("a map source of Call of Duty (iwmap {})", value);
    for (const std::string_view block : {"versioninfo", "visgroups", "viewsettings", "world"})
        if (EqualNoCase(word, block) && value == "{")
            return "a map source of a Source game (vmf)";
    return {};
}

// ---- Reading and writing compiled maps ----

namespace {

/// The formats. The first one reads files that are of none, and says what they are.
constexpr BspCodec kCodecs[] = {
    {kIbspIdent, DecodeIbsp, EncodeIbsp},
    {kRbspIdent, DecodeRbsp, EncodeRbsp},
    {kFbspIdent, DecodeRbsp, EncodeRbsp},
};

const BspCodec &CodecOfFile(const ByteSource &file) {
    std::array<char, 4> ident{};
    file.Fill(0, std::span(ident).first(std::size_t(std::min<std::uint64_t>(file.size, ident.size()))));
    const auto found = std::ranges::find(kCodecs, std::string_view(ident.data(), ident.size()), &BspCodec::ident);
    return found == std::end(kCodecs) ? kCodecs[0] : *found;
}

const BspCodec &CodecOfFormat(const BspFormat &format) {
    const auto found = std::ranges::find(kCodecs, format.ident, &BspCodec::ident);
    if (found == std::end(kCodecs))
        throw Error("no .bsp format has the ident {}", format.ident);
    return *found;
}

} // namespace

Bsp ReadBspFrom(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log) {
    Bsp bsp = CodecOfFile(file).decode(file, name, format, log);
    ValidateBsp(bsp, name, log);
    return bsp;
}

Bsp ReadBsp(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log) {
    const auto copy = [file](std::uint64_t at, std::span<std::byte> into) {
        std::memcpy(into.data(), file.data() + at, into.size());
    };
    return ReadBspFrom({file.size(), copy}, name, format, log);
}

Bsp ReadBspFile(const std::filesystem::path &path, const BspFormat &format, Log &log) {
    InputFile file(path);
    const auto read = [&file](std::uint64_t at, std::span<std::byte> into) { file.Read(at, into); };
    return ReadBspFrom({file.Size(), read}, path.string(), format, log);
}

std::vector<std::byte> WriteBsp(const Bsp &bsp, const BspFormat &format) {
    Log quiet(Log::Nowhere());
    return CodecOfFormat(format).encode(bsp, format, quiet).Bytes();
}

void WriteBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, Log &log) {
    FileSet written;
    AddBspFile(path, bsp, format, written, log);
    written.Commit();
}

std::uint64_t AddBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, FileSet &written,
                         Log &log) {
    log.Print("Writing {}\n", path.string());
    const ByteRanges bytes = [&] {
        try {
            return CodecOfFormat(format).encode(bsp, format, log);
        } catch (const Error &error) {
            throw Error("{}: {}", path.string(), error.what());
        }
    }();
    FileReplacement &file = written.Add(path);
    bytes.Write([&file](std::span<const std::byte> range) { file.Append(range); });
    file.Finish();
    written.AddLine(log, fmt::format("Wrote {} ({} bytes)\n", SizeText(bytes.Size()), bytes.Size()));
    return bytes.Size();
}

} // namespace q3
