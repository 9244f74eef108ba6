// GPL-2.0-or-later. Reads the log of a stage as -connect sends it.
#pragma once

#include "common/log.h"

#include <gio/gio.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace q3 {

/// Text of one level, and its mark if it has one.
struct FeedbackMessage {
    LogLevel level = LogLevel::Normal;
    std::string text;
    std::optional<LogMark> mark;
};

/// The other end of EditorFeedback: network messages to the elements of the XML in them.
class FeedbackReader {
  public:
    explicit FeedbackReader(std::function<void(FeedbackMessage)> found);
    ~FeedbackReader();
    FeedbackReader(const FeedbackReader &) = delete;
    FeedbackReader &operator=(const FeedbackReader &) = delete;

    /// The next bytes of the connection, in pieces of any size. False: they are not of the protocol, and nothing after
    /// them is read.
    bool Add(std::string_view bytes);

  private:
    bool AddXml(std::string_view xml);
    void Begin(std::string_view element, std::string_view level);
    void Text(std::string_view text);
    void End(std::string_view element);

    std::function<void(FeedbackMessage)> found_;
    GMarkupParseContext *parser_;
    std::string pending_; ///< a network message that has not arrived as a whole
    FeedbackMessage message_;
    std::string inner_; ///< text of the element inside the message
    int depth_ = 0;     ///< 1: within the root
    bool failed_ = false;
};

} // namespace q3
