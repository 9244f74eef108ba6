// GPL-2.0-or-later. Runs the built program as a user would.
#include "tests/support/run_program.h"

#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/map/map_parse.h"

#include <cstdlib>
#include <cstring>
#include <iterator>
#include <sstream>

#include <csignal>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace q3::test {

namespace {

constexpr unsigned kMaxSeconds = 120;

[[noreturn]] void Become(const std::vector<std::string> &arguments, const std::string &home, int output) {
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    setenv("HOME", home.c_str(), 1);
    std::vector<char *> words;
    std::vector<std::string> copy = arguments;
    copy.insert(copy.begin(), PROGRAM);
    for (std::string &word : copy)
        words.push_back(word.data());
    words.push_back(nullptr);
    alarm(kMaxSeconds);
    execv(PROGRAM, words.data());
    _exit(127); // as a shell does if there is no such program
}

/// Runs PROGRAM with its output into `to`, of which `from` is the other end.
Outcome RunInto(int from, int to, const std::vector<std::string> &arguments, const std::filesystem::path &home,
                const EndEarly &end) {
    Outcome outcome;
    const pid_t child = fork();
    if (child == 0)
        Become(arguments, home.string(), to);
    close(to);
    char buffer[4096];
    for (ssize_t got; (got = read(from, buffer, sizeof buffer)) > 0;) {
        outcome.text.append(buffer, std::size_t(got));
        if (child > 0 && outcome.text.size() >= end.bytes && outcome.text.size() - std::size_t(got) < end.bytes)
            kill(child, end.signal);
    }
    close(from);
    int status = 0;
    if (child > 0 && waitpid(child, &status, 0) == child) {
        if (WIFEXITED(status))
            outcome.status = WEXITSTATUS(status);
        else if (WIFSIGNALED(status))
            outcome.signal = WTERMSIG(status);
    }
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
    int pipes[2];
    if (pipe(pipes) != 0)
        return {};
    return RunInto(pipes[0], pipes[1], arguments, home, end);
}

Outcome RunOnTerminal(const std::vector<std::string> &arguments, const std::filesystem::path &home) {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0)
        return {};
    const int screen = open(ptsname(terminal), O_RDWR | O_NOCTTY);
    return screen < 0 ? Outcome() : RunInto(terminal, screen, arguments, home, {});
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
    EXPECT_NE(lines[0].find(text), std::string::npos) << lines[0];
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
