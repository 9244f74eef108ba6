// GPL-2.0-or-later. Work in a copy of the process, which may crash without harm, and messages between the two.
#pragma once

#include "common/error.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// One end of the connection between a process and its copy. Messages arrive whole and in order.
class Channel {
  public:
    /// Takes ownership of a descriptor of the operating system.
    explicit Channel(int descriptor) : descriptor_(descriptor) {}
    ~Channel();
    Channel(const Channel &) = delete;
    Channel &operator=(const Channel &) = delete;

    /// False: the other end is gone.
    bool Send(std::span<const std::byte> message);
    /// Waits for the next message. Nothing: the other end is gone.
    std::optional<std::vector<std::byte>> Receive();

  private:
    friend class ProcessCopy;
    bool ReceiveInto(std::span<std::byte> bytes);

    int descriptor_; ///< -1: none
};

/// What a copy may use.
struct CopyLimits {
    std::uint64_t moreBytes = 0; ///< of address space, beyond what the process has when it is copied
    unsigned cpuSeconds = 0;
};

/// The system refuses to make a copy.
class ProcessCopyError : public Error {
  public:
    using Error::Error;
};

/// A copy of the process as fork makes it: with all of its memory, but only the calling thread. It has no crash report.
class ProcessCopy {
  public:
    /// Whether the operating system has this.
    static bool IsAvailable();

    /// Starts the copy, which calls `work` with its end of the channel and ends when that returns. Errors:
    /// ProcessCopyError.
    ProcessCopy(const CopyLimits &limits, const std::function<void(Channel &)> &work);
    /// Ends the copy if it still runs.
    ~ProcessCopy();
    ProcessCopy(const ProcessCopy &) = delete;
    ProcessCopy &operator=(const ProcessCopy &) = delete;

    Channel &ToCopy() { return channel_; }
    /// Waits until the copy has ended. Empty if `work` returned; else why not, such as "Segmentation fault".
    std::string Wait();

  private:
    Channel channel_{-1};
    int process_ = -1; ///< -1: it has ended
};

} // namespace q3
