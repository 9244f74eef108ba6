// GPL-2.0-or-later. Tells when a file was saved.
#include "q3map2/watch/file_watch.h"

#include <utility>

namespace q3 {

namespace {

constexpr guint kPollTime = 250;  ///< ms between two looks without events
constexpr guint kSettleTime = 50; ///< ms that the file must stay the same

} // namespace

FileWatch::FileWatch(std::filesystem::path file, std::function<void(Event)> changed)
    : file_(std::move(file)), changed_(std::move(changed)), known_(FileState::Of(file_)), seen_(known_) {
    const ObjectPtr<GFile> path(g_file_new_for_path(file_.c_str()));
    monitor_.reset(g_file_monitor_file(path.get(), G_FILE_MONITOR_WATCH_MOVES, nullptr, nullptr));
    if (monitor_) {
        g_file_monitor_set_rate_limit(monitor_.get(), 0);
        g_signal_connect(monitor_.get(), "changed",
                         G_CALLBACK(+[](GFileMonitor *, GFile *, GFile *, GFileMonitorEvent, gpointer self) {
                             static_cast<FileWatch *>(self)->Look();
                         }),
                         this);
    }
    poll_.Set(g_timeout_add(
        kPollTime,
        [](gpointer self) -> gboolean {
            static_cast<FileWatch *>(self)->Look();
            return G_SOURCE_CONTINUE;
        },
        this));
}

FileWatch::~FileWatch() {
    if (monitor_)
        g_signal_handlers_disconnect_by_data(monitor_.get(), this);
}

void FileWatch::Look() {
    const FileState now = FileState::Of(file_);
    if (now == seen_)
        return;
    seen_ = now;
    settle_.Set(g_timeout_add(
        kSettleTime,
        [](gpointer self) -> gboolean {
            static_cast<FileWatch *>(self)->settle_.Forget();
            static_cast<FileWatch *>(self)->Settle();
            return G_SOURCE_REMOVE;
        },
        this));
}

void FileWatch::Settle() {
    Look(); // begins again if the file has changed meanwhile
    if (settle_ || seen_ == known_)
        return;
    known_ = seen_;
    changed_(known_.exists ? Event::Saved : Event::Gone);
}

} // namespace q3
