// GPL-2.0-or-later. The stages that run after each save of a map, one after the other.
#include "q3map2/watch/watch_build.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace q3 {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostMessages = 500; ///< that the page lists

bool Exists(const fs::path &file) {
    std::error_code absent;
    return fs::is_regular_file(file, absent);
}

} // namespace

WatchBuild::WatchBuild(Settings settings, Callbacks callbacks)
    : settings_(std::move(settings)), callbacks_(std::move(callbacks)) {}

void WatchBuild::Start() {
    if (stopped_)
        return;
    startAgain_ = true;
    if (process_)
        process_->Stop();
    else
        Begin();
}

void WatchBuild::Stop(std::function<void()> stopped) {
    stopped_ = std::move(stopped);
    startAgain_ = false;
    if (process_)
        process_->Stop();
    else
        stopped_();
}

void WatchBuild::Begin() {
    startAgain_ = false;
    stages_.clear();
    messages_.clear();
    leak_.clear();
    places_.reset();
    Run("bsp", WatchPass::Draft);
}

std::vector<std::string> WatchBuild::LineOf(std::string_view stage, WatchPass pass) const {
    const WatchOptions &options = settings_.options;
    const bool isDraft = pass == WatchPass::Draft;
    std::vector<std::string> line = settings_.globalWords;
    line.push_back(fmt::format("-{}", stage));
    const auto add = [&](const std::vector<std::string> &words) {
        line.insert(line.end(), words.begin(), words.end());
    };
    if (stage == "bsp")
        add(WordsOf(options.bsp));
    else if (stage == "vis")
        // The portals stay for the second pass, and for editors that draw them.
        add(isDraft ? std::vector<std::string>{"-fast", "-saveprt"} : WordsOf(options.vis + " -saveprt"));
    else
        add(WordsOf(isDraft ? options.draft : options.light));
    line.push_back((stage == "bsp" ? settings_.files.map : settings_.files.bsp).string());
    return line;
}

void WatchBuild::Run(std::string_view stage, WatchPass pass) {
    stages_.push_back({.name = stage, .pass = pass});
    begun_ = Clock::now();
    unfinishedBefore_ = UnfinishedFiles();
    try {
        process_ = std::make_unique<StageProcess>(
            settings_.program, LineOf(stage, pass),
            pass == WatchPass::Draft ? StageProcess::Priority::Normal : StageProcess::Priority::Low,
            StageProcess::Callbacks{.message = [this](const FeedbackMessage &message) { OnMessage(message); },
                                    .end = [this](const StageEnd &end) { OnEnd(end); }});
    } catch (const Error &error) {
        stages_.back().state = WatchedStage::State::Failed;
        Add(LogLevel::Error, error.what(), {});
    }
    callbacks_.changed();
}

// ---- Messages ----

void WatchBuild::OnMessage(const FeedbackMessage &message) {
    if (startAgain_ || stopped_)
        return;
    callbacks_.said(message);
    if (message.level == LogLevel::Normal)
        return;
    if (!message.mark) {
        AddLines(message.level, message.text);
    } else if (message.mark->line.empty()) {
        Add(message.level, message.text, PlaceOf(*message.mark));
    } else {
        leak_ = message.mark->line;
        // Its last point is the entity that can be reached from outside.
        const auto &end = leak_.back();
        Add(message.level, message.text, Vec3f{end[0], end[1], end[2]});
    }
    callbacks_.changed();
}

/// Text without a mark: lines that were printed, such as "WARNING: text" and what ends a run.
void WatchBuild::AddLines(LogLevel level, const std::string &text) {
    constexpr std::string_view kWarning = "WARNING: ";
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (line.starts_with(kWarning))
            line.remove_prefix(kWarning.size());
        // RunProgram prints errors between a header and the summary of the run.
        const bool isAround = line.starts_with("************") || line.starts_with("failed: ");
        if (!line.empty() && !isAround)
            Add(level, std::string(line), {});
    }
}

void WatchBuild::Add(LogLevel level, std::string text, std::optional<Vec3f> at) {
    while (!text.empty() && text.back() == '\n')
        text.pop_back();
    // Everything is about files of one folder.
    const std::string folder = settings_.files.map.parent_path().string() + "/";
    for (std::size_t place = 0; (place = text.find(folder, place)) != std::string::npos;)
        text.erase(place, folder.size());
    // Each stage may complain about the same.
    const bool isKnown =
        std::ranges::any_of(messages_, [&](const WatchedMessage &m) { return m.text == text && (m.at == at || !at); });
    if (!isKnown && messages_.size() < kMostMessages)
        messages_.push_back({.level = level, .stage = stages_.back().name, .text = std::move(text), .at = at});
}

std::optional<Vec3f> WatchBuild::PlaceOf(const LogMark &mark) {
    if (!places_) {
        try {
            places_.emplace(ReadTextFile(settings_.files.map), settings_.game);
        } catch (const Error &) { // the file is gone
            places_.emplace();
        }
    }
    return places_->Of(mark.entity, mark.primitive);
}

// ---- From a stage to the next ----

void WatchBuild::OnEnd(const StageEnd &end) {
    process_.reset();
    if (end.stopped || end.signal)
        RemoveUnfinished();
    if (stopped_) {
        stopped_();
        return;
    }
    if (startAgain_) {
        Begin();
        return;
    }
    WatchedStage &stage = stages_.back();
    stage.seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
    stage.state = end.done ? WatchedStage::State::Done : WatchedStage::State::Failed;
    if (end.signal)
        Add(LogLevel::Error, fmt::format("the {} stage was ended by signal {}", stage.name, end.signal), {});
    callbacks_.ended(stage);
    if (end.done)
        Next();
    callbacks_.changed();
}

void WatchBuild::Next() {
    const auto [name, pass] = std::pair(stages_.back().name, stages_.back().pass);
    if (name == "bsp")
        callbacks_.compiled();
    // A map that leaks has no portals, and is lit without visibility.
    if (name == "bsp" && Exists(settings_.files.prt)) {
        Run("vis", WatchPass::Draft);
    } else if (name != "light") {
        Run("light", pass);
    } else {
        callbacks_.lit(pass);
        if (pass == WatchPass::Draft)
            Run(Exists(settings_.files.prt) ? "vis" : "light", WatchPass::Final);
    }
}

std::set<fs::path> WatchBuild::UnfinishedFiles() const {
    std::set<fs::path> unfinished;
    const MapFiles &files = settings_.files;
    const fs::path pages = WithExtension(files.bsp, ""); // the folder of external lightmaps
    for (const fs::path &folder : {files.bsp.parent_path(), pages}) {
        std::error_code failed;
        for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
            const std::string target = TargetOfUnfinished(at->path().filename().string());
            const bool isOurs =
                folder == pages ? target.starts_with("lm_") || target.starts_with("lightmap_")
                                : std::ranges::any_of(std::array{files.bsp, files.srf, files.prt, files.lin},
                                                      [&](const fs::path &file) { return file.filename() == target; });
            if (isOurs)
                unfinished.insert(at->path());
        }
    }
    return unfinished;
}

void WatchBuild::RemoveUnfinished() const {
    // New ones cannot be told by their time: a hard link to an old file has the time of that file.
    for (const fs::path &file : UnfinishedFiles()) {
        std::error_code ignored;
        if (!unfinishedBefore_.contains(file))
            fs::remove(file, ignored);
    }
}

} // namespace q3
