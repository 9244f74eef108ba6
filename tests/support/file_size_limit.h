// GPL-2.0-or-later. A disk that is full, for one process.
#pragma once

#include <cstddef>

#ifndef _WIN32
#include <csignal>
#include <sys/resource.h>
#endif

namespace q3::test {

#ifdef _WIN32
/// Windows limits the space of a user, not the size of files.
class FileSizeLimit {
  public:
    static constexpr bool kExists = false;
    explicit FileSizeLimit(std::size_t) {}
};
#else
/// While it lives, this process and its children cannot write past that size, as on a full disk; root included.
class FileSizeLimit {
  public:
    static constexpr bool kExists = true;
    explicit FileSizeLimit(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit &) = delete;
    FileSizeLimit &operator=(const FileSizeLimit &) = delete;

  private:
    void (*handler_)(int);
    rlimit before_{};
};
#endif

} // namespace q3::test
