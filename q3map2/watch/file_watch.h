// GPL-2.0-or-later. Tells when a file was saved.
#pragma once

#include "common/files/files.h"
#include "q3map2/watch/glib_ptr.h"

#include <filesystem>
#include <functional>

namespace q3 {

/// Watches one path from the main loop, by the events of the system and by looking at the file a few times a second,
/// since some file systems have no events. A save counts once the file has stayed the same for 50 ms, so a file that
/// is half written is not read. Files that replace the old one by renaming, as editors save, are saves too.
class FileWatch {
  public:
    /// What the path became.
    enum class Event {
        Saved, ///< there is a file, another than at the last event
        Gone   ///< there is none any more
    };
    /// Calls `changed` later, never before this returns. The file that is there now counts as known.
    FileWatch(std::filesystem::path file, std::function<void(Event)> changed);
    ~FileWatch();
    FileWatch(const FileWatch &) = delete;
    FileWatch &operator=(const FileWatch &) = delete;

  private:
    void Look();
    void Settle();

    std::filesystem::path file_;
    std::function<void(Event)> changed_;
    FileState known_;                 ///< of the last event
    FileState seen_;                  ///< of the last look
    ObjectPtr<GFileMonitor> monitor_; ///< null: the system has no events for it
    LoopSource poll_, settle_;
};

} // namespace q3
