// GPL-2.0-or-later. Runs the built program as a user would.
#pragma once

#include "tests/support/game_folder.h"
#include "tests/support/process.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace q3::test {

/// The text with / between folders on Windows, where the program prints names with what they were given with.
std::string Slashed(std::string_view text);

/// How the program ended, and what it printed.
struct Outcome : Ending {
    std::string text; ///< standard output and standard error
    /// Takes both separators of Windows for the same.
    bool Printed(std::string_view part) const { return Slashed(text).find(Slashed(part)) != std::string::npos; }
    /// The lines after the error header but those of every run's end; empty when there was no error.
    std::vector<std::string> ErrorLines() const;
};

/// When a run is ended early: as soon as it has written `bytes` of output, by `signal` (Process::End).
struct EndEarly {
    std::size_t bytes = std::size_t(-1);
    int signal = 9; ///< SIGKILL
};

/// Runs PROGRAM with these arguments and `home` as the user's folder; it is killed after two minutes.
Outcome RunProgramFile(const std::vector<std::string> &arguments, const std::filesystem::path &home,
                       const EndEarly &end = {});

/// The same with standard output and standard error on a terminal, which begins lines with a carriage return. Not
/// on Windows.
Outcome RunOnTerminal(const std::vector<std::string> &arguments, const std::filesystem::path &home);

/// The same with standard output and standard error that cannot be written to.
Ending RunWithoutOutput(const std::vector<std::string> &arguments, const std::filesystem::path &home);

/// One lump of a .bsp file on disk.
std::vector<std::byte> LumpOf(const std::vector<std::byte> &file, std::size_t lump);
/// The 32-bit integer at an offset of the file; 0 beyond its end.
std::int32_t IntOf(const std::vector<std::byte> &file, std::size_t at);

/// A game folder with the demo map in it.
class ProgramTest : public testing::Test {
  protected:
    ProgramTest();
    /// q3map2 -fs_basepath FOLDER and these words, split at blanks; MAP stands for the path of the map.
    Outcome Run(std::string_view words, const EndEarly &end = {});
    /// Run, and expects exit status 0.
    Outcome RunWell(std::string_view words);
    /// Expects exit status 1, one error line that holds `text`, and the map untouched.
    void ExpectError(std::string_view words, std::string_view text);

    std::filesystem::path Map(std::string_view extension) const { return maps_ / ("demo" + std::string(extension)); }
    std::vector<std::byte> MapBytes() const;

    GameFolder folder_;
    std::filesystem::path game_, maps_;
};

} // namespace q3::test
