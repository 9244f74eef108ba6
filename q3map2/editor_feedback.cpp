// GPL-2.0-or-later. Sends the log of a compile to an editor (-connect).
#include "q3map2/editor_feedback.h"

#include "common/platform/socket.h"
#include "q3map2/editors/feedback_xml.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

namespace q3 {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kFlushBytes = 511;           ///< text longer than this is sent at once
constexpr std::chrono::seconds kFlushDelay{1};     ///< for more text of the same level, while nothing else is sent
constexpr std::chrono::seconds kConnectTime{15};   ///< until the editor accepts: editors wait no longer either
constexpr std::chrono::seconds kLastWait{1};       ///< after the run: for an editor that takes nothing
constexpr std::chrono::seconds kLongestWait{5};    ///< after the run, in all
constexpr std::chrono::milliseconds kPollTime{20}; ///< of one wait for the socket, before the clock is checked

/// Starts connecting to "a.b.c.d:port". Null: not an address.
std::unique_ptr<Socket> ConnectTo(std::string_view address) {
    const std::size_t colon = address.rfind(':');
    if (colon == std::string_view::npos)
        return nullptr;
    std::uint16_t port = 0;
    const char *const end = address.data() + address.size();
    const auto read = std::from_chars(address.data() + colon + 1, end, port);
    return read.ec == std::errc() && read.ptr == end ? Socket::Connect(std::string(address.substr(0, colon)), port)
                                                     : nullptr;
}

/// Text of one level, with a mark or without.
struct LogEntry {
    LogLevel level = LogLevel::Normal;
    std::string text;
    std::optional<LogMark> mark;

    std::vector<std::string> Payloads() const {
        return mark ? MarkPayloads(level, text, *mark) : MessagePayloads(level, text);
    }
};

/// Queues what is logged; its own thread sends it, so that no editor can hold up the compile.
class Connection {
  public:
    explicit Connection(std::unique_ptr<Socket> socket) : socket_(std::move(socket)), thread_([this] { Run(); }) {}
    ~Connection() {
        {
            const std::lock_guard lock(mutex_);
            Flush();
            ended_ = progress_ = Clock::now();
        }
        wake_.notify_one();
        thread_.join();
    }
    Connection(const Connection &) = delete;
    Connection &operator=(const Connection &) = delete;

    void Write(LogLevel level, std::string_view text) {
        const std::lock_guard lock(mutex_);
        if (level != pending_.level)
            Flush();
        pending_.level = level;
        pending_.text += text;
        if (pending_.text.size() > kFlushBytes)
            Flush();
    }

    void Write(LogLevel level, std::string_view text, const LogMark &mark) {
        const std::lock_guard lock(mutex_);
        Flush();
        Queue({level, std::string(text), mark});
    }

  private:
    // With the mutex held.
    void Flush() {
        if (!pending_.text.empty())
            Queue(std::exchange(pending_, {}));
    }
    void Queue(LogEntry entry) {
        if (!gone_)
            queue_.push_back(std::move(entry));
        wake_.notify_one();
    }

    void Run() {
        if (WaitUntilReady(Clock::now() + kConnectTime) && Send(kFeedbackRoot))
            while (const auto entry = NextEntry())
                if (!std::ranges::all_of(entry->Payloads(), [&](const auto &payload) { return Send(payload); }))
                    break;
        socket_.reset();
        const std::lock_guard lock(mutex_);
        gone_ = true;
        queue_.clear();
    }

    /// Waits for the next entry. Empty: the run has ended and everything is sent.
    std::optional<LogEntry> NextEntry() {
        std::unique_lock lock(mutex_);
        while (queue_.empty() && !ended_)
            if (wake_.wait_for(lock, kFlushDelay) == std::cv_status::timeout)
                Flush();
        if (queue_.empty())
            return {};
        LogEntry entry = std::move(queue_.front());
        queue_.pop_front();
        return entry;
    }

    /// Length and payload in one call: editors take a message that arrives in parts for the end of the stream.
    bool Send(std::string_view payload) {
        std::string message;
        for (int shift = 0; shift < 32; shift += 8)
            message += char(payload.size() >> shift & 255);
        message += payload;
        for (std::string_view rest = message; !rest.empty();) {
            const auto sent = WaitUntilReady(Clock::time_point::max()) ? socket_->Send(rest) : std::nullopt;
            if (!sent)
                return false; // the editor is gone; the compile goes on
            rest.remove_prefix(*sent);
        }
        const std::lock_guard lock(mutex_);
        progress_ = Clock::now();
        return true;
    }

    bool WaitUntilReady(Clock::time_point until) {
        while (Clock::now() < until && !IsTimeToGiveUp())
            if (socket_->WaitUntilReady(kPollTime))
                return true;
        return false;
    }

    bool IsTimeToGiveUp() {
        const std::lock_guard lock(mutex_);
        const auto now = Clock::now();
        return ended_ && (now > progress_ + kLastWait || now > *ended_ + kLongestWait);
    }

    std::unique_ptr<Socket> socket_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<LogEntry> queue_;
    LogEntry pending_;                       ///< text that may grow
    bool gone_ = false;                      ///< the connection ended or failed: nothing is queued any more
    std::optional<Clock::time_point> ended_; ///< when the run ended
    Clock::time_point progress_;             ///< last message sent, or end of the run
    std::thread thread_;
};

} // namespace

void EditorFeedback::Attach(const std::string &address, Log &log) {
    if (address.empty())
        return;
    std::unique_ptr<Socket> socket = ConnectTo(address);
    if (!socket) {
        log.Warn("no editor", "-connect {}: expected an address such as 127.0.0.1:39000; no editor gets the messages",
                 address);
        return;
    }
    const auto connection = std::make_shared<Connection>(std::move(socket));
    log.AddSink([connection](LogLevel level, std::string_view text) { connection->Write(level, text); },
                [connection](LogLevel level, std::string_view text, const LogMark &mark) {
                    connection->Write(level, text, mark);
                });
}

} // namespace q3
