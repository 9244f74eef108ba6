// GPL-2.0-or-later. Windows has no copies of processes.
#include "common/platform/process_copy.h"

namespace q3 {

Channel::~Channel() = default;

bool Channel::Send(std::span<const std::byte>) {
    return false;
}

std::optional<std::vector<std::byte>> Channel::Receive() {
    return std::nullopt;
}

bool ProcessCopy::IsAvailable() {
    return false;
}

ProcessCopy::ProcessCopy(const CopyLimits &, const std::function<void(Channel &)> &) {
    throw ProcessCopyError("Windows has no copies of processes");
}

ProcessCopy::~ProcessCopy() = default;

std::string ProcessCopy::Wait() {
    return {};
}

} // namespace q3
