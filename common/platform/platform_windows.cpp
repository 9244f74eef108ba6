// GPL-2.0-or-later. Windows.
#include "common/platform/platform.h"

#include <glib.h>
#include <glib/gstdio.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cwchar>
#include <string_view>
#include <utility>

// In this order: each needs types of those above it, and windows.h without winsock2.h declares other sockets.
#include <winsock2.h>

#include <windows.h>

#ifndef _MSC_VER
#include <dirent.h>
#endif
#include <fcntl.h>
#include <io.h>
#include <psapi.h>
#include <sys/stat.h>
#include <ws2tcpip.h>

namespace q3 {

namespace fs = std::filesystem;

namespace {

// Virus scanners and editors open new files for a moment, which forbids renaming over them: for a second it is tried
// again.
constexpr int kRenameTries = 20;
constexpr DWORD kRenameWait = 50; ///< milliseconds

fs::path ProgramFile() {
    std::wstring name(MAX_PATH, L'\0');
    for (;;) {
        const DWORD size = GetModuleFileNameW(nullptr, name.data(), DWORD(name.size()));
        if (size < name.size())
            return name.substr(0, size);
        name.resize(2 * name.size()); // it was cut
    }
}

double Seconds(const FILETIME &time) {
    constexpr double kSecondsPerTick = 1e-7;
    return double(ULONGLONG(time.dwHighDateTime) << 32 | time.dwLowDateTime) * kSecondsPerTick;
}

/// The nearest errno of an error of the system.
int ErrorNumber(DWORD error) {
    switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
        return ENOENT;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
        return EACCES;
    case ERROR_DISK_FULL:
        return ENOSPC;
    default:
        return EIO;
    }
}

} // namespace

ProcessStart StartProcess(int, char **) {
    SetConsoleOutputCP(CP_UTF8);
    _setmode(_fileno(stdout), _O_BINARY);
    // Those of main are in the user's code page, which lacks most letters.
    char **words = g_win32_get_command_line();
    ProcessStart start{{words + 1, words + g_strv_length(words)}, ProgramFile()};
    g_strfreev(words);
    return start;
}

// ---- Crashes ----

namespace {

void (*crashReport)(std::string_view fault);
std::atomic<DWORD> crashedThread; ///< its number, or 0

void ReportOnce(std::string_view fault) {
    DWORD none = 0;
    if (crashedThread.compare_exchange_strong(none, GetCurrentThreadId()))
        crashReport(fault);
    else if (none != GetCurrentThreadId()) // another thread is reporting, and then ends the process
        Sleep(INFINITE);
}

std::string_view FaultText(DWORD code) {
    switch (code) {
    case EXCEPTION_ACCESS_VIOLATION:
    case EXCEPTION_IN_PAGE_ERROR:
        return "Invalid memory access (access violation)";
    case EXCEPTION_STACK_OVERFLOW:
        return "Stack overflow";
    case EXCEPTION_ILLEGAL_INSTRUCTION:
    case EXCEPTION_PRIV_INSTRUCTION:
        return "Invalid instruction";
    case EXCEPTION_INT_DIVIDE_BY_ZERO:
        return "Arithmetic error (division by zero)";
    default:
        return "Unhandled exception";
    }
}

/// Windows goes on as without this filter: with its own error report, and the exception's code as exit status.
LONG WINAPI OnException(EXCEPTION_POINTERS *exception) {
    ReportOnce(FaultText(exception->ExceptionRecord->ExceptionCode));
    return EXCEPTION_CONTINUE_SEARCH;
}

void OnAbort(int) {
    ReportOnce("Abort"); // abort then ends the process
}

} // namespace

void SetCrashHandler(void (*report)(std::string_view fault)) {
    crashReport = report;
    PrepareThreadForCrashes();
    SetUnhandledExceptionFilter(OnException);
    std::signal(SIGABRT, OnAbort);
}

void PrepareThreadForCrashes() {
    ULONG forHandler = 16 * 1024; // of the stack, for faults that come from a full one
    SetThreadStackGuarantee(&forHandler);
}

void WriteError(std::string_view text) {
    DWORD written = 0;
    WriteFile(GetStdHandle(STD_ERROR_HANDLE), text.data(), DWORD(text.size()), &written, nullptr);
}

bool IsTerminal() {
    DWORD mode = 0; // _isatty takes every device for a terminal, NUL too
    return GetConsoleMode(GetStdHandle(STD_OUTPUT_HANDLE), &mode) != 0;
}

bool HasColors() {
    const HANDLE output = GetStdHandle(STD_OUTPUT_HANDLE);
    DWORD mode = 0;
    return GetConsoleMode(output, &mode) != 0 && SetConsoleMode(output, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

std::string UserFolder(const std::string &name) {
    const char *roaming = g_getenv("APPDATA");
    std::string home = roaming != nullptr ? roaming : g_get_home_dir();
    std::replace(home.begin(), home.end(), '\\', '/');
    if (name == ".")
        return home;
    return home + "/" + (name.starts_with('.') ? name.substr(1) : name);
}

double CpuSeconds() {
    FILETIME created{}, ended{}, kernel{}, user{};
    GetProcessTimes(GetCurrentProcess(), &created, &ended, &kernel, &user);
    return Seconds(kernel) + Seconds(user);
}

double ThreadCpuSeconds() {
    FILETIME created{}, ended{}, kernel{}, user{};
    GetThreadTimes(GetCurrentThread(), &created, &ended, &kernel, &user);
    return Seconds(kernel) + Seconds(user);
}

// Windows gives large pages only to processes that may lock memory.
void UseLargePages(void *, std::size_t) {}

double PeakMemory() {
    PROCESS_MEMORY_COUNTERS counters{};
    GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters);
    return double(counters.PeakWorkingSetSize);
}

fs::path PathOf(std::string_view name) {
    if (g_utf8_validate(name.data(), gssize(name.size()), nullptr) != FALSE)
        return name;
    std::wstring wide;
    for (const char c : name)
        wide += wchar_t(static_cast<unsigned char>(c));
    return wide;
}

std::FILE *OpenFile(const fs::path &path, const char *mode) {
    std::wstring wide(mode, mode + std::char_traits<char>::length(mode));
    std::replace(wide.begin(), wide.end(), L'e', L'N'); // not inherited
    return _wfopen(path.c_str(), wide.c_str());
}

FileStamp StampOf(const fs::path &path) {
    constexpr DWORD kShareAll = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
    const HANDLE file =
        CreateFileW(path.c_str(), 0, kShareAll, nullptr, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr);
    if (file == INVALID_HANDLE_VALUE)
        return {};
    BY_HANDLE_FILE_INFORMATION info{};
    GetFileInformationByHandle(file, &info);
    CloseHandle(file);
    const auto join = [](DWORD high, DWORD low) { return std::uint64_t(high) << 32 | low; };
    return {join(info.nFileIndexHigh, info.nFileIndexLow),
            join(info.ftLastWriteTime.dwHighDateTime, info.ftLastWriteTime.dwLowDateTime)};
}

std::FILE *CreateTemporary(std::string &name, int mode) {
    const int descriptor = g_mkstemp_full(name.data(), _O_WRONLY | _O_BINARY | _O_NOINHERIT, mode);
    if (descriptor < 0)
        return nullptr;
    std::FILE *file = _fdopen(descriptor, "wb");
    if (file == nullptr) {
        const int error = errno;
        _close(descriptor);
        g_unlink(name.c_str());
        errno = error;
    }
    return file;
}

void SetPermissions(std::FILE *, int) {}

bool SyncFile(std::FILE *file) {
    return std::fflush(file) == 0 && _commit(_fileno(file)) == 0;
}

std::error_code ListFolder(const fs::path &folder, std::vector<fs::path> &entries) {
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
        entries.push_back(at->path());
    return failed;
}

bool RenameOver(const fs::path &from, const fs::path &to) {
    for (int tried = 1;; ++tried) {
        if (MoveFileExW(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0)
            return true;
        const DWORD error = GetLastError();
        if ((error != ERROR_ACCESS_DENIED && error != ERROR_SHARING_VIOLATION) || tried == kRenameTries) {
            errno = ErrorNumber(error);
            return false;
        }
        Sleep(kRenameWait);
    }
}

// ---- TCP connections ----

std::unique_ptr<Socket> Socket::Connect(const std::string &address, std::uint16_t port) {
    sockaddr_in peer{};
    peer.sin_family = AF_INET;
    peer.sin_port = htons(port);
    WSADATA data{};
    if (WSAStartup(MAKEWORD(2, 2), &data) != 0) // stays in effect until the process ends
        return nullptr;
    if (inet_pton(AF_INET, address.c_str(), &peer.sin_addr) != 1)
        return nullptr;
    const SOCKET handle = WSASocketW(AF_INET, SOCK_STREAM, 0, nullptr, 0, WSA_FLAG_NO_HANDLE_INHERIT);
    if (handle == INVALID_SOCKET)
        return nullptr;
    std::unique_ptr<Socket> made(new Socket(handle));
    u_long doNotWait = 1;
    ioctlsocket(handle, FIONBIO, &doNotWait);
    const BOOL on = TRUE;
    setsockopt(handle, IPPROTO_TCP, TCP_NODELAY, reinterpret_cast<const char *>(&on), sizeof on);
    // A failure shows in Send.
    (void)connect(handle, reinterpret_cast<const sockaddr *>(&peer), sizeof peer);
    return made;
}

Socket::~Socket() {
    shutdown(handle_, SD_SEND); // so that bytes already sent arrive
    closesocket(handle_);
}

bool Socket::WaitUntilReady(std::chrono::milliseconds timeout) {
    fd_set writable, failed;
    FD_ZERO(&writable);
    FD_SET(handle_, &writable);
    FD_ZERO(&failed);
    FD_SET(handle_, &failed);
    timeval wait{.tv_sec = long(timeout.count() / 1000), .tv_usec = long(timeout.count() % 1000 * 1000)};
    return select(0, nullptr, &writable, &failed, &wait) > 0; // Windows ignores the first argument
}

std::optional<std::size_t> Socket::Send(std::string_view bytes) {
    const int sent = send(handle_, bytes.data(), int(bytes.size()), 0);
    if (sent < 0)
        return WSAGetLastError() == WSAEWOULDBLOCK ? std::optional<std::size_t>(0) : std::nullopt;
    return std::size_t(sent);
}

} // namespace q3

#ifndef _MSC_VER
/// In place of mbrtowc of the C library, which knows no UTF-8 (the linker's --wrap, see common/CMakeLists.txt):
/// std::filesystem::path reads std::string by it. A code point beyond 16 bits becomes two surrogates, in two calls; the
/// second one waits in `state`.
extern "C" std::size_t __wrap_mbrtowc(wchar_t *to, const char *from, std::size_t size, std::mbstate_t *state) {
    constexpr auto kBad = std::size_t(-1), kShort = std::size_t(-2);
    if (from == nullptr || size == 0)
        return from == nullptr ? 0 : kShort;
    wchar_t unused;
    wchar_t &unit = to != nullptr ? *to : unused;
    if (state != nullptr && *state != 0) { // the last of four bytes
        unit = wchar_t(std::exchange(*state, 0));
        return 1;
    }
    if (*from == 0) {
        unit = 0;
        return 0;
    }
    const gunichar c = g_utf8_get_char_validated(from, gssize(size));
    if (c == gunichar(-2))
        return kShort;
    if (c == gunichar(-1) || (c > 0xffff && state == nullptr)) {
        errno = EILSEQ;
        return kBad;
    }
    if (c <= 0xffff) {
        unit = wchar_t(c);
        return std::size_t(g_unichar_to_utf8(c, nullptr));
    }
    // UTF-16: the upper and the lower 10 bits of c - 10000h.
    unit = wchar_t(0xd800 + ((c - 0x10000) >> 10));
    *state = 0xdc00 + int((c - 0x10000) & 0x3ff);
    return 3;
}

/// In place of _wopendir of MinGW-w64, by which std::filesystem lists folders: it takes no path of more than 260
/// characters. Made for the library's _wreaddir and _wclosedir.
extern "C" _WDIR *__wrap__wopendir(const wchar_t *path) {
    const DWORD attributes = GetFileAttributesW(path);
    if (attributes == INVALID_FILE_ATTRIBUTES || (attributes & FILE_ATTRIBUTE_DIRECTORY) == 0) {
        errno = attributes == INVALID_FILE_ATTRIBUTES ? q3::ErrorNumber(GetLastError()) : ENOTDIR;
        return nullptr;
    }
    constexpr std::wstring_view kAllFiles = L"\\*";
    const DWORD room = GetFullPathNameW(path, 0, nullptr, nullptr); // with the zero at the end
    auto *folder = static_cast<_WDIR *>(std::calloc(1, sizeof(_WDIR) + (room + kAllFiles.size()) * sizeof(wchar_t)));
    if (folder == nullptr) {
        errno = ENOMEM;
        return nullptr;
    }
    DWORD length = GetFullPathNameW(path, room, folder->dd_name, nullptr);
    if (length > 0 && folder->dd_name[length - 1] == L'\\')
        --length;
    kAllFiles.copy(folder->dd_name + length, kAllFiles.size()); // a zero follows
    folder->dd_handle = -1;                                     // nothing has been read
    return folder;
}
#endif
