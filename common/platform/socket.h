// GPL-2.0-or-later. TCP connections: one source for each operating system, of which CMake takes one.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace q3 {

/// The sending end of a TCP connection. No call waits but WaitUntilReady.
class Socket {
  public:
    /// Begins to connect to an IPv4 address "a.b.c.d". Null: it is no address, or the system refuses.
    static std::unique_ptr<Socket> Connect(const std::string &address, std::uint16_t port);
    Socket(const Socket &) = delete;
    Socket &operator=(const Socket &) = delete;
    /// What was sent still arrives.
    ~Socket();
    /// Waits until bytes can be sent or the connection is lost, for so long at most. False: neither yet.
    bool WaitUntilReady(std::chrono::milliseconds most);
    /// How many of the bytes the system takes, possibly none. Empty: there is no connection, or the other end is gone.
    std::optional<std::size_t> Send(std::string_view bytes);

  private:
    /// Takes over what the operating system knows the connection by.
    explicit Socket(std::uintptr_t handle) : handle_(handle) {}

    std::uintptr_t handle_;
};

} // namespace q3
