// GPL-2.0-or-later. A run of -watch: saves of a map become builds, and builds pictures in the page.
#pragma once

#include "q3map2/watch/file_watch.h"
#include "q3map2/watch/resources.h"
#include "q3map2/watch/watch_build.h"
#include "q3map2/watch/watch_lock.h"
#include "q3map2/watch/watch_server.h"

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace q3 {

class WatchSession {
  public:
    /// `resources`: makes the package of what the page needs beside the .bsp. Errors: Error if the map is watched
    /// already, or the port cannot be had.
    WatchSession(WatchBuild::Settings settings, Resources::Make resources, Log &log);

    /// Until SIGINT, SIGTERM or SIGHUP. Leaves no process, and no unfinished file of the map. started: called once these
    /// signals end it in order.
    void Run(const std::function<void()> &started);
    /// The page that shows the map.
    std::string Address() const { return server_->Address(); }

  private:
    void OnFile(FileWatch::Event event);
    void OnSaid(const FeedbackMessage &message);
    void OnEnded(const WatchedStage &stage);
    void OnLit(WatchPass pass);
    void OnResources(const std::string &error);
    void Publish();
    void Stop();

    std::string State() const;
    std::optional<WatchServer::Answer> AnswerTo(std::string_view name) const;

    /// A compiled map that the page can show.
    struct Version {
        int number = 0; ///< 0: there is none yet
        WatchPass pass = WatchPass::Draft;
        std::shared_ptr<const std::vector<std::byte>> bsp;
    };

    Log &log_;
    MapFiles files_;
    std::string mapName_; ///< maps/x.bsp
    WatchLock lock_;
    WatchBuild build_;
    Resources resources_;
    std::unique_ptr<WatchServer> server_;
    std::optional<FileWatch> watch_;
    Version shown_;
    std::optional<Version> next_; ///< waits for its resources
    std::string lights_ = "[]";   ///< light entities of the source, as JSON
    std::set<std::string> said_;  ///< warnings and errors of the build
    std::string problem_;         ///< of the resources
    bool gone_ = false;           ///< there is no map source
    int saves_ = 0;
    std::chrono::steady_clock::time_point saved_;
    GMainLoop *loop_ = nullptr;
};

} // namespace q3
