// GPL-2.0-or-later. TCP connections on POSIX systems: Linux, macOS, BSD.
#include "common/platform/platform.h"

#include <cerrno>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace q3 {

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

bool Socket::WaitUntilReady(std::chrono::milliseconds most) {
    pollfd state{.fd = int(handle_), .events = POLLOUT, .revents = 0};
    return poll(&state, 1, int(most.count())) > 0;
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
