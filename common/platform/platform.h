// GPL-2.0-or-later. What differs between operating systems: one source for each, of which CMake takes one.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace q3 {

/// What the operating system tells main.
struct ProcessStart {
    std::vector<std::string> arguments; ///< UTF-8 on Windows, without the name of the program
    std::filesystem::path program;      ///< the file that runs
};

/// To be called once, first of all. Sets up standard output: bytes are printed as they are, and the console reads them
/// as UTF-8.
ProcessStart StartProcess(int argc, char **argv);

/// Whether this build has sanitizers.
#ifdef Q3_SANITIZED
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

/// From now on `report` is called when a fault is about to end the process, with the fault in words. It may call only
/// WriteError and what else is safe in a signal handler. Afterwards the fault ends the process as it would have without
/// this. Sanitizer builds keep the reports of the sanitizer instead.
void SetCrashHandler(void (*report)(std::string_view fault));
/// To be called by each other thread when it starts, so that an overflow of its stack is reported too.
void PrepareThreadForCrashes();
/// Writes to standard error. Safe in signal handlers.
void WriteError(std::string_view text);

/// Whether standard output is a terminal.
bool IsTerminal();
/// Whether standard output is a terminal that understands ANSI colors.
bool HasColors();

/// Folder with the user's files of a game, `name` being the one on Linux, with its leading dot: ~/.q3a there,
/// %APPDATA%/q3a on Windows. ".": the folder that holds them.
std::string UserFolder(const std::string &name);

/// CPU seconds of all threads of the process so far.
double CpuSeconds();
/// Those of the calling thread.
double ThreadCpuSeconds();
/// Peak resident memory so far, in bytes.
double PeakMemory();
/// Asks the operating system for large pages in fresh memory that is read at random. A hint: may do nothing.
void UseLargePages(void *memory, std::size_t bytes);

/// The path of a name in game data, which may be no UTF-8: such a name is taken for Latin-1 by Windows.
std::filesystem::path PathOf(std::string_view name);
/// As fopen, "e" included. Null: failed, errno says why.
std::FILE *OpenFile(const std::filesystem::path &path, const char *mode);
/// What tells a file from its other versions of the same size.
struct FileStamp {
    std::uint64_t number = 0;  ///< of the file on its disk; 0 on file systems without
    std::uint64_t written = 0; ///< time of the last write, as exact as the system has it
    bool operator==(const FileStamp &) const = default;
};
/// All 0: no such file.
FileStamp StampOf(const std::filesystem::path &path);
/// Creates a file with a new name and these permission bits, but those of the umask. `name` has XXXXXX in it, which
/// are replaced. Null: failed, errno says why.
std::FILE *CreateTemporary(std::string &name, int mode);
/// Sets the permission bits whatever the umask. Failure is ignored: some file systems have none.
void SetPermissions(std::FILE *file, int mode);
/// Writes what the operating system still holds of the file to disk. False: failed, errno says why.
bool SyncFile(std::FILE *file);
/// Renames a closed file over another, atomically. False: failed, errno says why.
bool RenameOver(const std::filesystem::path &from, const std::filesystem::path &to);

/// Appends the paths of what is in the folder, in any order. Returns why that failed. std::filesystem's iterators, which
/// Windows uses, end the program when memory runs out.
std::error_code ListFolder(const std::filesystem::path &folder, std::vector<std::filesystem::path> &entries);

/// The sending end of a TCP connection. Only WaitUntilReady blocks.
class Socket {
  public:
    /// Starts to connect to an IPv4 address "a.b.c.d". Null: no such address, or no socket could be made.
    static std::unique_ptr<Socket> Connect(const std::string &address, std::uint16_t port);
    Socket(const Socket &) = delete;
    Socket &operator=(const Socket &) = delete;
    /// Closes the connection; bytes already taken by Send still arrive.
    ~Socket();
    /// Waits until bytes can be sent or the connection is lost. False: neither happened before the timeout.
    bool WaitUntilReady(std::chrono::milliseconds timeout);
    /// Returns how many of the bytes the system took, possibly 0. Empty: connecting failed or the other end is gone.
    std::optional<std::size_t> Send(std::string_view bytes);

  private:
    /// Takes ownership of a socket or descriptor of the operating system.
    explicit Socket(std::uintptr_t handle) : handle_(handle) {}

    std::uintptr_t handle_;
};

/// Measures CPU seconds of the process from its construction.
class CpuTimer {
  public:
    CpuTimer() : start_(CpuSeconds()) {}
    double Seconds() const { return CpuSeconds() - start_; }

  private:
    double start_;
};

} // namespace q3
