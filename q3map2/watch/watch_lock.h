// GPL-2.0-or-later. One -watch for each map.
#pragma once

#include <filesystem>
#include <string_view>

namespace q3 {

/// A locked file beside the map, x.watch, that holds the address of the page. It is removed with this object; one that
/// a killed process leaves behind locks nothing.
class WatchLock {
  public:
    /// Errors: another process watches the map (the text has the address of its page), or the file cannot be written.
    explicit WatchLock(const std::filesystem::path &map);
    ~WatchLock();
    WatchLock(const WatchLock &) = delete;
    WatchLock &operator=(const WatchLock &) = delete;

    /// Stores the address of the page, for the error of others.
    void Publish(std::string_view address) const;

  private:
    std::filesystem::path file_;
    int descriptor_ = -1;
};

} // namespace q3
