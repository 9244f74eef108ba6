// GPL-2.0-or-later. Programs that tests start. What differs between operating systems is in process_posix.cpp and
// process_windows.cpp, of which CMake takes one.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace q3::test {

/// How a program ended.
struct Ending {
    int status = -1; ///< exit status; -1 when a signal ended it, or on Windows an exception or another process
    int signal = 0;  ///< the signal that ended it; 0: none, always so on Windows
};

/// Where standard output and standard error of a program go.
enum class OutputTo {
    Pipe,
    Terminal, ///< not on Windows
    Nowhere   ///< each write fails
};

/// A program that runs beside the test. It is killed after two minutes, or when this object goes.
class Process {
  public:
    /// command: the program and its arguments, in UTF-8. home: the user's folder, below which the program finds the
    /// user's files; empty: that of the test.
    Process(const std::vector<std::string> &command, const std::filesystem::path &home, OutputTo output);
    ~Process();
    Process(const Process &) = delete;
    Process &operator=(const Process &) = delete;

    /// Waits for more output. Empty: there is no more.
    std::string Read();
    /// Sends the signal; Windows ends the process whatever the signal.
    void End(int signal);
    Ending Wait();

    static constexpr std::chrono::seconds kMostTime{120};

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The file that runs.
std::filesystem::path ThisProgram();

/// Ends this process at once, as by kill -9.
[[noreturn]] void KillThisProcess();
/// The exit status of a process that KillThisProcess ended, in the form of death tests.
bool IsOfAKilledProcess(int status);

} // namespace q3::test
