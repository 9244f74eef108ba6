// GPL-2.0-or-later. The shaders and textures that the page needs to draw a map, made beside the stages.
#pragma once

#include "q3map2/watch/glib_ptr.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// An archive, shared with answers that are being sent.
struct ResourcePackage {
    std::shared_ptr<const std::vector<std::byte>> bytes; ///< null: none was made so far
    std::string digest;                                  ///< of the bytes, as text
};

/// Makes packages in a thread of its own, one at a time.
class Resources {
  public:
    /// Whether files of the game may have changed too.
    enum class Reason { MapChanged, FilesChanged };
    /// Makes the package of the map on disk. Called in the thread; must not use the main loop. Empty: it would be the
    /// same as before. Errors: Error.
    using Make = std::function<std::optional<std::vector<std::byte>>(Reason)>;
    /// `done`: called from the main loop after each package, with the error or "".
    Resources(Make make, std::function<void(const std::string &error)> done);
    /// Waits for the package that is being made.
    ~Resources();
    Resources(const Resources &) = delete;
    Resources &operator=(const Resources &) = delete;

    /// Begins a package, or another one after that which is being made.
    void Refresh(Reason reason);
    bool IsBusy() const { return busy_; }
    const ResourcePackage &Latest() const { return latest_; }

  private:
    struct Job;
    void Begin(Reason reason);

    Make make_;
    std::function<void(const std::string &)> done_;
    ResourcePackage latest_;
    bool busy_ = false;
    std::optional<Reason> again_; ///< after the package that is being made
    std::shared_ptr<Job> job_;    ///< the last one
};

} // namespace q3
