// GPL-2.0-or-later. Runs the built program as a user would.
#include "tests/support/run_program.h"

#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/map/map_parse.h"
#include "tests/support/this_system.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <sstream>

namespace q3::test {

namespace {

Outcome RunInto(OutputTo output, const std::vector<std::string> &arguments, const std::filesystem::path &home,
                const EndEarly &end = {}) {
    std::vector<std::string> command{PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    Process program(command, home, output);
    Outcome outcome;
    for (std::string more; !(more = program.Read()).empty();) {
        const std::size_t before = outcome.text.size();
        outcome.text += more;
        if (before < end.bytes && outcome.text.size() >= end.bytes)
            program.End(end.signal);
    }
    static_cast<Ending &>(outcome) = program.Wait();
    return outcome;
}

/// The demo's source after the bsp stage.
Bsp CompiledDemo(const std::filesystem::path &game) {
    KeptLog quiet;
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(game, "pk3");
    BspOptions options;
    options.meta = true;
    const Game &rules = *FindGame("quake3");
    ShaderLibrary library(vfs, rules, {}, quiet.log);
    const BspContext context{options, rules, library, quiet.log, &vfs};
    Map map = ReadMap(ReadTextFile(game / "maps/demo.map"), "demo.map", context);
    return CompileMap(map, context).bsp;
}

} // namespace

std::string Slashed(std::string_view text) {
    std::string slashed(text);
    if (kIsWindows)
        std::replace(slashed.begin(), slashed.end(), '\\', '/');
    return slashed;
}

std::vector<std::string> Outcome::ErrorLines() const {
    constexpr std::string_view kHeader = "************ ERROR ************\n";
    std::vector<std::string> lines;
    const std::size_t at = text.find(kHeader);
    if (at == std::string::npos)
        return lines;
    std::istringstream rest(text.substr(at + kHeader.size()));
    for (std::string line; std::getline(rest, line);)
        if (!line.ends_with(" elapsed") && !line.starts_with("failed: "))
            lines.push_back(line);
    return lines;
}

Outcome RunProgramFile(const std::vector<std::string> &arguments, const std::filesystem::path &home,
                       const EndEarly &end) {
    return RunInto(OutputTo::Pipe, arguments, home, end);
}

Outcome RunOnTerminal(const std::vector<std::string> &arguments, const std::filesystem::path &home) {
    return RunInto(OutputTo::Terminal, arguments, home);
}

Ending RunWithoutOutput(const std::vector<std::string> &arguments, const std::filesystem::path &home) {
    return RunInto(OutputTo::Nowhere, arguments, home);
}

std::int32_t IntOf(const std::vector<std::byte> &file, std::size_t at) {
    std::int32_t value = 0;
    if (at + 4 <= file.size())
        std::memcpy(&value, file.data() + at, 4);
    return value;
}

std::vector<std::byte> LumpOf(const std::vector<std::byte> &file, std::size_t lump) {
    const auto offset = std::size_t(IntOf(file, 8 + 8 * lump)), length = std::size_t(IntOf(file, 12 + 8 * lump));
    if (offset > file.size() || length > file.size() - offset)
        return {};
    return {file.begin() + std::ptrdiff_t(offset), file.begin() + std::ptrdiff_t(offset + length)};
}

ProgramTest::ProgramTest() : game_(folder_ / "base/baseq3"), maps_(game_ / "maps") {
    KeptLog quiet;
    std::filesystem::create_directories(folder_ / "base");
    std::filesystem::copy(DEMO_ARENA, game_, std::filesystem::copy_options::recursive);
    // Something in every lump that lighting must keep.
    Bsp bsp = CompiledDemo(game_);
    bsp.lightmaps.resize(kLightmapPageBytes);
    for (std::size_t i = 0; i < bsp.lightmaps.size(); i++)
        bsp.lightmaps[i] = std::uint8_t(i * 31 >> 3); // any pattern
    for (std::size_t i = 0; i < bsp.drawVerts.size(); i++)
        bsp.drawVerts[i].color[0] = {std::uint8_t(i), std::uint8_t(3 * i), 7, 255};
    WriteBspFile(Map(".bsp"), bsp, {}, quiet.log);
}

Outcome ProgramTest::Run(std::string_view words, const EndEarly &end) {
    std::vector<std::string> arguments{"-fs_basepath", (folder_ / "base").string()};
    std::istringstream text{std::string(words)};
    for (std::string word; text >> word;)
        arguments.push_back(word == "MAP" ? Map(".bsp").string() : word);
    return RunProgramFile(arguments, folder_.Root(), end);
}

Outcome ProgramTest::RunWell(std::string_view words) {
    Outcome outcome = Run(words);
    EXPECT_EQ(outcome.status, 0) << words << '\n' << outcome.text;
    EXPECT_TRUE(outcome.ErrorLines().empty()) << outcome.text;
    return outcome;
}

void ProgramTest::ExpectError(std::string_view words, std::string_view text) {
    const auto before = MapBytes();
    const auto time = std::filesystem::last_write_time(Map(".bsp"));
    const Outcome outcome = Run(words);
    EXPECT_EQ(outcome.status, 1) << words << '\n' << outcome.text;
    const auto lines = outcome.ErrorLines();
    ASSERT_EQ(lines.size(), 1u) << words << '\n' << outcome.text;
    EXPECT_NE(Slashed(lines[0]).find(Slashed(text)), std::string::npos) << lines[0];
    EXPECT_EQ(MapBytes(), before) << words;
    EXPECT_EQ(std::filesystem::last_write_time(Map(".bsp")), time) << words;
    for (const auto &entry : std::filesystem::directory_iterator(maps_))
        EXPECT_EQ(entry.path().filename().string().find("demo.bsp."), std::string::npos)
            << "left behind: " << entry.path();
}

std::vector<std::byte> ProgramTest::MapBytes() const {
    return ReadFile(Map(".bsp"));
}

} // namespace q3::test
