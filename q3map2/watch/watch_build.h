// GPL-2.0-or-later. The stages that run after each save of a map, one after the other.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/shader/games.h"
#include "q3map2/watch/options/watch_options.h"
#include "q3map2/watch/source_places.h"
#include "q3map2/watch/stage_process.h"

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// The draft is for the first picture, the final pass runs in the background.
enum class WatchPass { Draft, Final };

/// A stage of the build of the latest save.
struct WatchedStage {
    enum class State { Running, Done, Failed };
    std::string_view name; ///< "bsp", "vis" or "light"
    WatchPass pass = WatchPass::Draft;
    State state = State::Running;
    double seconds = 0; ///< it took; 0 while it runs
};

/// A warning or an error of the latest build.
struct WatchedMessage {
    LogLevel level = LogLevel::Warning;
    std::string_view stage;  ///< as WatchedStage::name
    std::string text;        ///< one line
    std::optional<Vec3f> at; ///< where it is in the map
};

/// Runs the stages for each save, and stops those of the save before. All calls come from the main loop.
class WatchBuild {
  public:
    struct Settings {
        std::filesystem::path program;
        std::vector<std::string> globalWords; ///< options of all stages, first on each line
        WatchOptions options;
        MapFiles files; ///< all beside the map
        const Game &game;
    };
    struct Callbacks {
        std::function<void()> changed;                     ///< stages or messages
        std::function<void(const FeedbackMessage &)> said; ///< each message of a stage
        std::function<void()> compiled;                    ///< the bsp stage is done
        std::function<void(WatchPass)> lit;                ///< the light stage is done: the .bsp is worth a look
        std::function<void(const WatchedStage &)> ended;
    };

    WatchBuild(Settings settings, Callbacks callbacks);

    /// Begins with the bsp stage, once the stage that runs has ended.
    void Start();
    /// Stops what runs; `stopped` is called once nothing does, possibly at once.
    void Stop(std::function<void()> stopped);

    const std::vector<WatchedStage> &Stages() const { return stages_; }
    const std::vector<WatchedMessage> &Messages() const { return messages_; }
    /// Points of the line that shows a leak; empty: none was found.
    const std::vector<std::array<float, 3>> &Leak() const { return leak_; }
    bool IsRunning() const { return process_ != nullptr; }

  private:
    using Clock = std::chrono::steady_clock;

    void Begin();
    void Run(std::string_view stage, WatchPass pass);
    std::vector<std::string> LineOf(std::string_view stage, WatchPass pass) const;
    void OnMessage(const FeedbackMessage &message);
    void AddLines(LogLevel level, const std::string &text);
    void Add(LogLevel level, std::string text, std::optional<Vec3f> at);
    std::optional<Vec3f> PlaceOf(const LogMark &mark);
    void OnEnd(const StageEnd &end);
    void Next();
    std::set<std::filesystem::path> UnfinishedFiles() const;
    void RemoveUnfinished() const;

    Settings settings_;
    Callbacks callbacks_;
    std::unique_ptr<StageProcess> process_; ///< null: none runs
    bool startAgain_ = false;               ///< once the stage that runs has ended
    std::function<void()> stopped_;         ///< set: nothing begins any more
    std::vector<WatchedStage> stages_;
    std::vector<WatchedMessage> messages_;
    std::vector<std::array<float, 3>> leak_;
    std::optional<SourcePlaces> places_; ///< of the source that is being built; read when the first mark arrives
    Clock::time_point begun_;            ///< the stage that runs
    std::set<std::filesystem::path> unfinishedBefore_; ///< that were there when the running stage began
};

} // namespace q3
