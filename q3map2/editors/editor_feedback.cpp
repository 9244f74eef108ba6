// GPL-2.0-or-later. The log of a compile as XML, sent to an editor (-connect).
#include "q3map2/editors/editor_feedback.h"

#include "common/platform/platform.h"

#include <glib.h>
#include <libxml/entities.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

namespace q3 {

// ---- Log messages as the XML that editors read (-connect) ----

namespace {

/// Most bytes of the elements around the text of a `select`, and of that text.
constexpr std::size_t kSelectElementBytes = 100, kMaxSelectText = kMaxPayload - kSelectElementBytes;

/// Strings that must not be divided between network messages.
using Pieces = std::vector<std::string>;

/// The text with replacements for what XML cannot hold: U+FFFD for invalid UTF-8, '?' for control characters.
std::string ValidText(std::string_view text) {
    const std::unique_ptr<char, decltype(&g_free)> valid(g_utf8_make_valid(text.data(), gssize(text.size())), g_free);
    std::string result = valid.get();
    std::ranges::replace_if(
        result,
        [](char c) {
            const auto code = static_cast<unsigned char>(c);
            return code == 127 || (code < 32 && c != '\n' && c != '\t');
        },
        '?');
    return result;
}

/// The characters of XML text; an entity such as "&lt;" counts as one.
Pieces Characters(std::string_view xml) {
    Pieces characters;
    while (!xml.empty()) {
        const std::size_t bytes =
            xml.front() == '&' ? xml.find(';') + 1 : std::size_t(g_utf8_next_char(xml.data()) - xml.data());
        characters.emplace_back(xml.substr(0, bytes));
        xml.remove_prefix(bytes);
    }
    return characters;
}

/// The pieces in as few payloads of kMaxPayload bytes as possible.
std::vector<std::string> Packed(const Pieces &pieces) {
    std::vector<std::string> payloads;
    for (const std::string &piece : pieces) {
        if (payloads.empty() || payloads.back().size() + piece.size() > kMaxPayload)
            payloads.emplace_back();
        payloads.back() += piece;
    }
    return payloads;
}

std::string OpeningTag(std::string_view element, LogLevel level) {
    return fmt::format("<{} level=\"{}\">", element, int(level));
}

} // namespace

std::string XmlText(std::string_view text) {
    const std::string valid = ValidText(text);
    const std::unique_ptr<xmlChar, decltype(xmlFree)> encoded(
        xmlEncodeSpecialChars(nullptr, reinterpret_cast<const xmlChar *>(valid.c_str())), xmlFree);
    if (!encoded)
        throw std::bad_alloc();
    return reinterpret_cast<const char *>(encoded.get());
}

std::vector<std::string> MessagePayloads(LogLevel level, std::string_view text) {
    Pieces pieces = Characters(XmlText(text));
    pieces.insert(pieces.begin(), OpeningTag("message", level));
    pieces.emplace_back("</message>");
    return Packed(pieces);
}

std::vector<std::string> MarkPayloads(LogLevel level, std::string_view text, const LogMark &mark) {
    if (mark.line.empty()) {
        std::string cut;
        for (const std::string &character : Characters(XmlText(text))) {
            if (cut.size() + character.size() > kMaxSelectText)
                break;
            cut += character;
        }
        return {fmt::format("{}{}<brush>{} {}</brush></select>", OpeningTag("select", level), cut, mark.entity,
                            mark.primitive)};
    }
    Pieces pieces = Characters(XmlText(text));
    pieces.insert(pieces.begin(), OpeningTag("message", level));
    pieces.emplace_back("<polyline>");
    for (const std::array<float, 3> &p : mark.line)
        pieces.push_back(fmt::format("<point>{:f} {:f} {:f}</point>", p[0], p[1], p[2]));
    pieces.emplace_back("</polyline></message>");
    return Packed(pieces);
}

// ---- Sends the log of a compile to an editor (-connect) ----

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kFlushBytes = 511;           ///< text longer than this is sent at once
constexpr std::chrono::seconds kFlushDelay{1};     ///< for more text of the same level, while nothing else is sent
constexpr std::chrono::seconds kConnectTime{15};   ///< until the editor accepts: editors wait no longer either
constexpr std::chrono::seconds kStallTime{1};      ///< after the run: for an editor that takes nothing
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
            GiveUpWithoutMemory([&] { Flush(); });
            ended_ = lastProgress_ = Clock::now();
        }
        wake_.notify_one();
        thread_.join();
    }
    Connection(const Connection &) = delete;
    Connection &operator=(const Connection &) = delete;

    void Write(LogLevel level, std::string_view text) {
        const std::lock_guard lock(mutex_);
        GiveUpWithoutMemory([&] {
            if (level != pending_.level)
                Flush();
            pending_.level = level;
            pending_.text += text;
            if (pending_.text.size() > kFlushBytes)
                Flush();
        });
    }

    void Write(LogLevel level, std::string_view text, const LogMark &mark) {
        const std::lock_guard lock(mutex_);
        GiveUpWithoutMemory([&] {
            Flush();
            Queue({level, std::string(text), mark});
        });
    }

  private:
    /// What cannot be kept is lost for the editor; the compile goes on. With the mutex held.
    template <typename Keep> void GiveUpWithoutMemory(const Keep &keep) {
        try {
            keep();
        } catch (const std::bad_alloc &) {
            lost_ = true;
        }
    }
    /// Queues the pending text. With the mutex held.
    void Flush() {
        if (!pending_.text.empty())
            Queue(std::exchange(pending_, {}));
    }
    /// With the mutex held.
    void Queue(LogEntry entry) {
        if (!lost_)
            queue_.push_back(std::move(entry));
        wake_.notify_one();
    }

    void Run() {
        try {
            SendEntries();
        } catch (const std::bad_alloc &) { // as if the editor were gone; the compile goes on
        }
        socket_.reset();
        const std::lock_guard lock(mutex_);
        lost_ = true;
        queue_.clear();
    }

    void SendEntries() {
        if (WaitUntilReady(Clock::now() + kConnectTime) && Send(kFeedbackRoot))
            while (const auto entry = NextEntry())
                if (!std::ranges::all_of(entry->Payloads(), [&](const auto &payload) { return Send(payload); }))
                    break;
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
        lastProgress_ = Clock::now();
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
        return ended_ && (now > lastProgress_ + kStallTime || now > *ended_ + kLongestWait);
    }

    std::unique_ptr<Socket> socket_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<LogEntry> queue_;
    LogEntry pending_;                       ///< text that may grow
    bool lost_ = false;                      ///< the connection ended or failed: nothing is queued any more
    std::optional<Clock::time_point> ended_; ///< when the run ended
    Clock::time_point lastProgress_;         ///< last message sent, or end of the run
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
    std::shared_ptr<Connection> connection;
    try {
        connection = std::make_shared<Connection>(std::move(socket));
    } catch (const std::system_error &error) { // no thread
        log.Warn("no editor", "-connect {}: {}; no editor gets the messages", address, error.code().message());
        return;
    }
    log.AddSink([connection](LogLevel level, std::string_view text) { connection->Write(level, text); },
                [connection](LogLevel level, std::string_view text, const LogMark &mark) {
                    connection->Write(level, text, mark);
                });
}

} // namespace q3
