// GPL-2.0-or-later. A stage that runs as a process of its own.
#pragma once

#include "q3map2/watch/feedback_reader.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace q3 {

/// How a stage ended.
struct StageEnd {
    bool done = false;    ///< exit status 0
    bool stopped = false; ///< by Stop
    int signal = 0;       ///< that ended it otherwise; 0: none
};

/// One run of the program for one stage. What it prints arrives as messages through -connect, its standard output is
/// dropped. The process does not outlive this one (Linux).
class StageProcess {
  public:
    struct Callbacks {
        std::function<void(FeedbackMessage)> message;
        /// Called once, from the main loop, when the process has ended and all its messages have arrived.
        std::function<void(StageEnd)> end;
    };
    enum class Priority { Normal, Low };

    /// Errors: Error if no process or no socket can be made.
    StageProcess(const std::filesystem::path &program, const std::vector<std::string> &words, Priority priority,
                 Callbacks callbacks);
    /// Neither callback is called any more. The process must have ended.
    ~StageProcess();
    StageProcess(const StageProcess &) = delete;
    StageProcess &operator=(const StageProcess &) = delete;

    /// Ends the process at once. Files that it has not finished stay under their temporary names.
    void Stop();

  private:
    struct Run;
    std::shared_ptr<Run> run_;
};

} // namespace q3
