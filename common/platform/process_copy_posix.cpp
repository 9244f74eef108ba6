// GPL-2.0-or-later. Copies of the process by fork, connected by a pair of sockets.
#include "common/platform/process_copy.h"

#include "common/error.h"
#include "common/platform/platform.h"

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fstream>

namespace q3 {

namespace {

constexpr std::size_t kReceivedAtOnce = 1 << 20; ///< bytes: memory grows only with what arrives
constexpr int kThrew = 3;                        ///< exit status of a copy whose work threw

// Sending to an end that is gone must not raise a signal: a flag of send, or on macOS an option of the socket.
#ifdef MSG_NOSIGNAL
constexpr int kSendFlags = MSG_NOSIGNAL;
void SetNoSignal(int) {}
#else
constexpr int kSendFlags = 0;
void SetNoSignal(int socket) {
    const int on = 1;
    setsockopt(socket, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
}
#endif

void SetLimit(int resource, rlim_t limit) {
    const rlimit softAndHard{limit, limit + 1}; // at the hard limit of seconds, the signal would not say why
    setrlimit(resource, &softAndHard);          // a failure leaves the copy without this limit
}

/// In the copy, before its work.
void Restrict(const CopyLimits &limits) {
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU})
        std::signal(signal, SIG_DFL);
    const rlimit noCore{0, 0};
    setrlimit(RLIMIT_CORE, &noCore);
    SetLimit(RLIMIT_CPU, limits.cpuSeconds);
    std::uint64_t pages = 0; // sanitizers reserve more than any limit
    std::ifstream sizes("/proc/self/statm");
    if (!kIsSanitized && sizes >> pages)
        SetLimit(RLIMIT_AS, rlim_t(pages * std::uint64_t(sysconf(_SC_PAGESIZE)) + limits.moreBytes));
}

[[noreturn]] void RunCopy(int descriptor, const CopyLimits &limits, const std::function<void(Channel &)> &work) {
    int status = 0;
    try {
        Restrict(limits);
        Channel channel(descriptor);
        work(channel);
    } catch (const std::exception &) {
        status = kThrew;
    }
    _exit(status); // without what the process does at its end
}

} // namespace

// ---- Channel ----

Channel::~Channel() {
    if (descriptor_ >= 0)
        close(descriptor_);
}

// A message is its length, then its bytes.
bool Channel::Send(std::span<const std::byte> message) {
    const std::uint64_t length = message.size();
    for (std::span<const std::byte> bytes : {std::as_bytes(std::span(&length, 1)), message})
        while (!bytes.empty()) {
            const ssize_t sent = send(descriptor_, bytes.data(), bytes.size(), kSendFlags);
            if (sent < 0 && errno != EINTR)
                return false;
            bytes = bytes.subspan(std::size_t(std::max<ssize_t>(sent, 0)));
        }
    return true;
}

bool Channel::ReceiveInto(std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t got = recv(descriptor_, bytes.data(), bytes.size(), 0);
        if (got == 0 || (got < 0 && errno != EINTR))
            return false;
        bytes = bytes.subspan(std::size_t(std::max<ssize_t>(got, 0)));
    }
    return true;
}

std::optional<std::vector<std::byte>> Channel::Receive() {
    std::uint64_t length = 0;
    if (!ReceiveInto(std::as_writable_bytes(std::span(&length, 1))))
        return std::nullopt;
    std::vector<std::byte> message;
    while (message.size() < length) {
        const std::size_t at = message.size();
        message.resize(at + std::size_t(std::min<std::uint64_t>(length - at, kReceivedAtOnce)));
        if (!ReceiveInto(std::span(message).subspan(at)))
            return std::nullopt;
    }
    return message;
}

// ---- Copies ----

bool ProcessCopy::IsAvailable() {
    return true;
}

ProcessCopy::ProcessCopy(const CopyLimits &limits, const std::function<void(Channel &)> &work) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0)
        throw ProcessCopyError("cannot connect to another process: {}", std::strerror(errno));
    for (const int end : ends)
        SetNoSignal(end);
    process_ = fork();
    if (process_ == 0) {
        close(ends[0]);
        RunCopy(ends[1], limits, work);
    }
    const int failure = errno;
    close(ends[1]);
    channel_.descriptor_ = ends[0];
    if (process_ < 0)
        throw ProcessCopyError("cannot start another process: {}", std::strerror(failure));
}

ProcessCopy::~ProcessCopy() {
    if (process_ >= 0)
        kill(process_, SIGKILL);
    Wait();
}

std::string ProcessCopy::Wait() {
    if (process_ < 0)
        return {};
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    if (WIFSIGNALED(status))
        return WTERMSIG(status) == SIGXCPU ? "it takes too long" : strsignal(WTERMSIG(status));
    return WEXITSTATUS(status) == 0 ? std::string() : fmt::format("exit status {}", WEXITSTATUS(status));
}

} // namespace q3
