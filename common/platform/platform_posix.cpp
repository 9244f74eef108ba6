// GPL-2.0-or-later. Linux and its relatives.
#include "common/platform/platform.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <fcntl.h>
#include <glib.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <new>
#include <system_error>

namespace q3 {

namespace fs = std::filesystem;

namespace {

/// Makes a rename durable. Failure is ignored: not every file system can, and the file is whole either way.
void SyncFolder(const fs::path &file) noexcept {
    int descriptor = -1;
    try {
        const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
        descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    } catch (const std::bad_alloc &) {
    }
    if (descriptor < 0)
        return;
    fsync(descriptor);
    close(descriptor);
}

} // namespace

ProcessStart StartProcess(int argc, char **argv) {
    std::error_code failed;
    fs::path program = fs::read_symlink("/proc/self/exe", failed);
    if (failed)
        program = argv[0];
    return {{argv + 1, argv + argc}, program};
}

// ---- Crashes ----

namespace {

struct Fault {
    int signal;
    std::string_view text;
};
constexpr Fault kFaults[] = {{SIGSEGV, "Invalid memory access (SIGSEGV)"},
                             {SIGBUS, "Invalid memory access (SIGBUS)"},
                             {SIGILL, "Invalid instruction (SIGILL)"},
                             {SIGFPE, "Arithmetic error (SIGFPE)"},
                             {SIGABRT, "Abort (SIGABRT)"}};

void (*crashReport)(std::string_view fault);
std::atomic_flag hasCrashed;
thread_local std::array<char, 64 * 1024> faultStack; ///< of the handler, for faults that come from a full stack

void OnFault(int number, siginfo_t *info, void *) {
    if (hasCrashed.test_and_set()) // another thread is reporting, and then ends the process
        for (;;)
            pause();
    for (const Fault &fault : kFaults)
        if (fault.signal == number)
            crashReport(fault.text);
    // Returning repeats what the fault interrupted, which now ends the process. A signal that was sent is sent again.
    signal(number, SIG_DFL);
    if (info->si_code <= 0)
        raise(number);
}

} // namespace

void SetCrashHandler(void (*report)(std::string_view fault)) {
    if (kIsSanitized)
        return;
    crashReport = report;
    PrepareThreadForCrashes();
    struct sigaction action {};
    sigfillset(&action.sa_mask); // a fault within the handler ends the process at once
    action.sa_sigaction = OnFault;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    for (const Fault &fault : kFaults)
        sigaction(fault.signal, &action, nullptr);
}

void PrepareThreadForCrashes() {
    if (kIsSanitized)
        return;
    stack_t alternative{};
    alternative.ss_sp = faultStack.data();
    alternative.ss_size = faultStack.size();
    sigaltstack(&alternative, nullptr);
}

void WriteError(std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
        if (written <= 0)
            return;
        text.remove_prefix(std::size_t(written));
    }
}

bool IsTerminal() {
    return isatty(STDOUT_FILENO) != 0;
}

bool HasColors() {
    const char *terminal = std::getenv("TERM");
    return IsTerminal() && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

std::string UserFolder(const std::string &name) {
    const char *const variable = std::getenv("HOME"); // GLib ends the process if it cannot copy it
    const std::string home = variable && *variable ? variable : g_get_home_dir();
    return name == "." ? home : home + "/" + name;
}

namespace {

double SecondsOf(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

} // namespace

double CpuSeconds() {
    return SecondsOf(CLOCK_PROCESS_CPUTIME_ID);
}

double ThreadCpuSeconds() {
    return SecondsOf(CLOCK_THREAD_CPUTIME_ID);
}

void UseLargePages([[maybe_unused]] void *memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::uintptr_t kPage = std::uintptr_t(1) << 21;
    const std::uintptr_t first = (reinterpret_cast<std::uintptr_t>(memory) + kPage - 1) / kPage * kPage,
                         end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / kPage * kPage;
    if (first < end)
        madvise(reinterpret_cast<void *>(first), end - first, MADV_HUGEPAGE);
#endif
}

double PeakMemory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
    return double(usage.ru_maxrss); // bytes on macOS, kilobytes elsewhere
#else
    return 1024.0 * double(usage.ru_maxrss);
#endif
}

fs::path PathOf(std::string_view name) {
    return name;
}

std::FILE *OpenFile(const fs::path &path, const char *mode) {
    return std::fopen(path.c_str(), mode);
}

FileStamp StampOf(const fs::path &path) {
    struct stat info {};
    if (stat(path.c_str(), &info) != 0)
        return {};
#ifdef __APPLE__
    const timespec written = info.st_mtimespec;
#else
    const timespec written = info.st_mtim;
#endif
    constexpr std::uint64_t kNanoseconds = 1000000000; // a second
    return {std::uint64_t(info.st_ino), std::uint64_t(written.tv_sec) * kNanoseconds + std::uint64_t(written.tv_nsec)};
}

std::FILE *CreateTemporary(std::string &name, int mode) {
    const int descriptor = g_mkstemp_full(name.data(), O_WRONLY | O_CLOEXEC, mode);
    if (descriptor < 0)
        return nullptr;
    std::FILE *file = fdopen(descriptor, "wb");
    if (file == nullptr) {
        const int number = errno;
        close(descriptor);
        unlink(name.c_str());
        errno = number;
    }
    return file;
}

void SetPermissions(std::FILE *file, int mode) {
    fchmod(fileno(file), mode_t(mode));
}

bool SyncFile(std::FILE *file) {
    return std::fflush(file) == 0 && fsync(fileno(file)) == 0;
}

bool RenameOver(const fs::path &from, const fs::path &to) {
    if (std::rename(from.c_str(), to.c_str()) != 0)
        return false;
    SyncFolder(to);
    return true;
}

std::error_code ListFolder(const fs::path &folder, std::vector<fs::path> &entries) {
    const std::unique_ptr<DIR, int (*)(DIR *)> open(opendir(folder.c_str()), closedir);
    if (!open)
        return {errno, std::generic_category()};
    for (;;) {
        errno = 0;
        const dirent *const entry = readdir(open.get());
        if (entry == nullptr)
            return {errno, std::generic_category()};
        const std::string_view name = entry->d_name;
        if (name != "." && name != "..")
            entries.push_back(folder / name);
    }
}

// ---- TCP connections ----

std::unique_ptr<Socket> Socket::Connect(const std::string &address, std::uint16_t port) {
    sockaddr_in peer{};
    peer.sin_family = AF_INET;
    peer.sin_port = htons(port);
    if (inet_pton(AF_INET, address.c_str(), &peer.sin_addr) != 1)
        return nullptr;
    const int handle = socket(AF_INET, SOCK_STREAM, 0);
    if (handle < 0)
        return nullptr;
    std::unique_ptr<Socket> made(new Socket(std::uintptr_t(handle)));
    fcntl(handle, F_SETFD, FD_CLOEXEC);
    fcntl(handle, F_SETFL, O_NONBLOCK);
    const int on = 1;
    setsockopt(handle, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    // As MSG_NOSIGNAL in Send: a lost connection is an error of Send, not a signal that ends the program.
#ifdef SO_NOSIGPIPE
    setsockopt(handle, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
#endif
    // Not finished yet; Send reports a failure.
    (void)connect(handle, reinterpret_cast<const sockaddr *>(&peer), sizeof peer);
    return made;
}

Socket::~Socket() {
    close(int(handle_));
}

bool Socket::WaitUntilReady(std::chrono::milliseconds timeout) {
    pollfd state{.fd = int(handle_), .events = POLLOUT, .revents = 0};
    return poll(&state, 1, int(timeout.count())) > 0;
}

std::optional<std::size_t> Socket::Send(std::string_view bytes) {
#ifdef MSG_NOSIGNAL
    constexpr int kFlags = MSG_NOSIGNAL;
#else
    constexpr int kFlags = 0;
#endif
    const ssize_t sent = send(int(handle_), bytes.data(), bytes.size(), kFlags);
    if (sent < 0)
        return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? std::optional<std::size_t>(0) : std::nullopt;
    return std::size_t(sent);
}

} // namespace q3

// ---- Memory ----

#if defined(MADV_HUGEPAGE) && !defined(Q3_SANITIZED)

namespace {

constexpr std::size_t kLargePage = std::size_t(2) << 20; ///< bytes; of x86-64, and of ARM64 with pages of 4 KiB

} // namespace

/// Replaces that of the library, which also serves arrays. Large blocks consist of large pages where the system has
/// them: the first use of a page costs as much as hundreds of stores to it, and large ones are 512 times fewer.
void *operator new(std::size_t size) {
    void *block = nullptr;
    if (size < kLargePage)
        block = std::malloc(size > 0 ? size : 1);
    else if (posix_memalign(&block, kLargePage, size) == 0)
        madvise(block, size, MADV_HUGEPAGE); // advice: where it fails, pages are small
    if (block == nullptr)
        throw std::bad_alloc();
    return block;
}

// GCC does not see that these belong together once it has inlined one of them.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

void operator delete(void *block) noexcept {
    std::free(block);
}

void operator delete(void *block, std::size_t) noexcept {
    std::free(block);
}

#endif
