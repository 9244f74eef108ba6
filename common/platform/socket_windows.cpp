// GPL-2.0-or-later. TCP connections on Windows.
#include "common/platform/platform.h"

// Before ws2tcpip.h, which needs its types.
#include <winsock2.h>

#include <ws2tcpip.h>

namespace q3 {

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

bool Socket::WaitUntilReady(std::chrono::milliseconds most) {
    fd_set writable, failed;
    FD_ZERO(&writable);
    FD_SET(handle_, &writable);
    FD_ZERO(&failed);
    FD_SET(handle_, &failed);
    timeval wait{.tv_sec = long(most.count() / 1000), .tv_usec = long(most.count() % 1000 * 1000)};
    return select(0, nullptr, &writable, &failed, &wait) > 0; // Windows ignores the first argument
}

std::optional<std::size_t> Socket::Send(std::string_view bytes) {
    const int sent = send(handle_, bytes.data(), int(bytes.size()), 0);
    if (sent < 0)
        return WSAGetLastError() == WSAEWOULDBLOCK ? std::optional<std::size_t>(0) : std::nullopt;
    return std::size_t(sent);
}

} // namespace q3
