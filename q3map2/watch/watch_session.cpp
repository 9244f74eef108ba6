// GPL-2.0-or-later. A run of -watch: saves of a map become builds, and builds pictures in the page.
#include "q3map2/watch/watch_session.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/shreport/report_page.h"

#include <glib-unix.h>
#include <nlohmann/json.hpp>

#include <array>
#include <csignal>
#include <utility>

namespace q3 {

namespace {

using Json = nlohmann::ordered_json;

/// Text of files may be no UTF-8.
std::string TextOf(const Json &json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::shared_ptr<const std::vector<std::byte>> BytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
}

std::string_view NameOf(WatchPass pass) {
    return pass == WatchPass::Draft ? "draft" : "final";
}

std::string_view NameOf(WatchedStage::State state) {
    constexpr std::array<std::string_view, 3> kNames{"running", "done", "failed"};
    return kNames[std::size_t(state)];
}

std::string LightsJson(const MapFiles &files) {
    Json lights = Json::array();
    try {
        for (const Entity &light : LightsOfSource(ReadTextFile(files.map))) {
            Json keys = Json::object();
            for (auto pair = light.pairs.rbegin(); pair != light.pairs.rend(); ++pair) // the first of a key counts
                keys[pair->first] = pair->second;
            lights.push_back(std::move(keys));
        }
    } catch (const Error &) { // the file is gone again
    }
    return TextOf(lights);
}

} // namespace

WatchSession::WatchSession(WatchBuild::Settings settings, Resources::Make resources, Log &log)
    : log_(log), files_(settings.files), mapName_(fmt::format("maps/{}.bsp", files_.bsp.stem().string())),
      lock_(files_.map), build_(settings, {.changed = [this] { server_->StateChanged(); },
                                           .said = [this](const FeedbackMessage &message) { OnSaid(message); },
                                           .compiled =
                                               [this] {
                                                   lights_ = LightsJson(files_);
                                                   resources_.Refresh(Resources::Reason::MapChanged);
                                               },
                                           .lit = [this](WatchPass pass) { OnLit(pass); },
                                           .ended = [this](const WatchedStage &stage) { OnEnded(stage); }}),
      resources_(std::move(resources), [this](const std::string &error) { OnResources(error); }),
      server_(std::make_unique<WatchServer>(
          settings.options.port,
          WatchServer::Callbacks{.answer = [this](std::string_view name) { return AnswerTo(name); },
                                 .state = [this] { return State(); }})) {
    lock_.Publish(server_->Address());
}

void WatchSession::Run(const std::function<void()> &started) {
    loop_ = g_main_loop_new(nullptr, FALSE);
    std::array<LoopSource, 3> signals;
    constexpr std::array<int, 3> kNumbers{SIGINT, SIGTERM, SIGHUP};
    for (std::size_t i = 0; i < kNumbers.size(); ++i)
        signals[i].Set(g_unix_signal_add(
            kNumbers[i],
            [](gpointer self) -> gboolean {
                static_cast<WatchSession *>(self)->Stop();
                return G_SOURCE_CONTINUE;
            },
            this));
    started();
    watch_.emplace(files_.map, [this](FileWatch::Event event) { OnFile(event); });
    OnFile(FileState::Of(files_.map).exists ? FileWatch::Event::Saved : FileWatch::Event::Gone);
    g_main_loop_run(loop_);
    watch_.reset();
    server_.reset();
    g_main_loop_unref(loop_);
}

void WatchSession::Stop() {
    watch_.reset();
    build_.Stop([this] { g_main_loop_quit(loop_); });
}

void WatchSession::OnFile(FileWatch::Event event) {
    gone_ = event == FileWatch::Event::Gone;
    if (gone_) {
        log_.Write(LogLevel::Warning, fmt::format("WARNING: {} is gone: waiting for it\n", files_.map.string()));
    } else {
        saved_ = std::chrono::steady_clock::now();
        next_.reset();
        said_.clear();
        log_.Print("{} {}\n", ++saves_ == 1 ? "Building" : "Saved:", files_.map.string());
        build_.Start();
    }
    server_->StateChanged();
}

void WatchSession::OnSaid(const FeedbackMessage &message) {
    if (message.mark)
        log_.Mark(message.level, message.text, *message.mark);
    if (message.level == LogLevel::Normal) {
        if (log_.IsVerbose())
            log_.Write(message.level, message.text);
        return;
    }
    const bool isNew = said_.insert(message.text).second; // each stage may complain about the same
    if (isNew && message.mark && message.level == LogLevel::Warning)
        log_.Write(message.level, fmt::format("WARNING: {}\n", message.text));
    else if (isNew)
        log_.Write(message.level, message.text + (message.text.ends_with('\n') ? "" : "\n"));
}

void WatchSession::OnEnded(const WatchedStage &stage) {
    log_.Print("{:>6} {:6.2f} s{}\n", stage.name, stage.seconds,
               stage.state == WatchedStage::State::Failed ? ", failed" : "");
}

void WatchSession::OnLit(WatchPass pass) {
    try {
        next_ = {.number = shown_.number + 1,
                 .pass = pass,
                 .bsp = std::make_shared<const std::vector<std::byte>>(ReadFile(files_.bsp))};
    } catch (const Error &error) {
        log_.Write(LogLevel::Error, fmt::format("{}\n", error.what()));
        return;
    }
    resources_.Refresh(pass == WatchPass::Draft ? Resources::Reason::MapChanged : Resources::Reason::FilesChanged);
}

void WatchSession::OnResources(const std::string &error) {
    problem_ = error;
    if (!error.empty())
        log_.Write(LogLevel::Warning, fmt::format("WARNING: textures: {}\n", error));
    if (!resources_.IsBusy() && next_)
        Publish();
}

void WatchSession::Publish() {
    shown_ = *std::exchange(next_, std::nullopt);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - saved_).count();
    log_.Print("{} light after {:.1f} s\n", shown_.pass == WatchPass::Draft ? "Draft" : "Final", seconds);
    server_->StateChanged();
}

std::string WatchSession::State() const {
    Json state{{"map", mapName_},
               {"source", files_.map.filename().string()},
               {"gone", gone_},
               {"save", saves_},
               {"version", shown_.number},
               {"pass", NameOf(shown_.pass)},
               {"resources", resources_.Latest().digest},
               {"running", build_.IsRunning()}};
    Json &stages = state["stages"] = Json::array();
    for (const WatchedStage &stage : build_.Stages())
        stages.push_back({{"name", stage.name},
                          {"pass", NameOf(stage.pass)},
                          {"state", NameOf(stage.state)},
                          {"seconds", stage.seconds}});
    Json &messages = state["messages"] = Json::array();
    for (const WatchedMessage &message : build_.Messages()) {
        Json entry{{"level", message.level == LogLevel::Error ? "error" : "warning"},
                   {"stage", message.stage},
                   {"text", message.text}};
        if (message.at)
            entry["at"] = {message.at->x, message.at->y, message.at->z};
        messages.push_back(std::move(entry));
    }
    if (!problem_.empty())
        messages.push_back({{"level", "warning"}, {"stage", "textures"}, {"text", problem_}});
    state["leak"] = build_.Leak();
    return TextOf(state);
}

std::optional<WatchServer::Answer> WatchSession::AnswerTo(std::string_view name) const {
    if (name.empty())
        return WatchServer::Answer{.type = "text/html; charset=utf-8",
                                   .bytes = BytesOf(PageForWatch(ViewerPage(), mapName_, server_->Origins()))};
    if (name == "map.bsp" && shown_.bsp)
        return WatchServer::Answer{.type = "application/octet-stream", .bytes = shown_.bsp};
    if (name == "resources.pk3" && resources_.Latest().bytes)
        return WatchServer::Answer{.type = "application/zip", .bytes = resources_.Latest().bytes};
    if (name == "lights.json")
        return WatchServer::Answer{.type = "application/json", .bytes = BytesOf(lights_)};
    return std::nullopt;
}

} // namespace q3
