// GPL-2.0-or-later. A non-blocking TCP connection. CMake picks the source of the operating system.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace q3 {

/// The sending end of a TCP connection. Only WaitUntilReady blocks.
class Socket {
  public:
    /// Starts to connect to an IPv4 address "a.b.c.d". Null: no such address, or no socket could be made.
    static std::unique_ptr<Socket> Connect(const std::string &address, std::uint16_t port);
    Socket(const Socket &) = delete;
    Socket &operator=(const Socket &) = delete;
    /// Closes the connection; bytes already taken by Send still arrive.
    ~Socket();
    /// Waits until bytes can be sent or the connection is lost, at most for `most`. False: timed out.
    bool WaitUntilReady(std::chrono::milliseconds most);
    /// Returns how many of the bytes the system took, possibly 0. Empty: connecting failed or the other end is gone.
    std::optional<std::size_t> Send(std::string_view bytes);

  private:
    /// Takes ownership of a socket or descriptor of the operating system.
    explicit Socket(std::uintptr_t handle) : handle_(handle) {}

    std::uintptr_t handle_;
};

} // namespace q3
