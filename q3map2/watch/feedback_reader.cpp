// GPL-2.0-or-later. Reads the log of a stage as -connect sends it.
#include "q3map2/watch/feedback_reader.h"

#include "q3map2/editors/editor_feedback.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <utility>

namespace q3 {

namespace {

constexpr std::size_t kLengthBytes = 4;
constexpr int kMessageDepth = 2;            ///< of a message within the root
constexpr std::size_t kMostPoints = 100000; ///< of a polyline

/// The numbers of a text, separated by blanks; less than N: the text has no more.
template <typename T, std::size_t N> std::size_t ReadNumbers(std::string_view text, std::array<T, N> &numbers) {
    const char *at = text.data();
    const char *const end = at + text.size();
    std::size_t count = 0;
    for (; count < N; ++count) {
        while (at != end && g_ascii_isspace(*at))
            ++at;
        const auto read = std::from_chars(at, end, numbers[count]);
        if (read.ec != std::errc())
            break;
        at = read.ptr;
    }
    return count;
}

} // namespace

FeedbackReader::FeedbackReader(std::function<void(FeedbackMessage)> found) : found_(std::move(found)) {
    static constexpr GMarkupParser kParser = {
        .start_element =
            [](GMarkupParseContext *, const gchar *name, const gchar **, const gchar **values, gpointer self,
               GError **) { static_cast<FeedbackReader *>(self)->Begin(name, values[0] ? values[0] : ""); },
        .end_element = [](GMarkupParseContext *, const gchar *name, gpointer self,
                          GError **) { static_cast<FeedbackReader *>(self)->End(name); },
        .text =
            [](GMarkupParseContext *, const gchar *text, gsize length, gpointer self, GError **) {
                static_cast<FeedbackReader *>(self)->Text({text, length});
            },
        .passthrough = nullptr,
        .error = nullptr,
    };
    parser_ = g_markup_parse_context_new(&kParser, GMarkupParseFlags(0), this, nullptr);
}

FeedbackReader::~FeedbackReader() {
    g_markup_parse_context_free(parser_);
}

bool FeedbackReader::Add(std::string_view bytes) {
    pending_ += bytes;
    while (!failed_ && pending_.size() >= kLengthBytes) {
        std::size_t length = 0;
        for (std::size_t i = 0; i < kLengthBytes; ++i)
            length |= std::size_t(static_cast<unsigned char>(pending_[i])) << 8 * i;
        if (length > kMaxPayload) {
            failed_ = true;
            break;
        }
        if (pending_.size() < kLengthBytes + length)
            break;
        failed_ = !AddXml(std::string_view(pending_).substr(kLengthBytes, length));
        pending_.erase(0, kLengthBytes + length);
    }
    return !failed_;
}

bool FeedbackReader::AddXml(std::string_view xml) {
    return g_markup_parse_context_parse(parser_, xml.data(), gssize(xml.size()), nullptr);
}

void FeedbackReader::Begin(std::string_view, std::string_view level) {
    inner_.clear();
    if (++depth_ != kMessageDepth)
        return;
    message_ = {};
    if (level == "2")
        message_.level = LogLevel::Warning;
    else if (level == "3")
        message_.level = LogLevel::Error;
}

void FeedbackReader::Text(std::string_view text) {
    if (depth_ == kMessageDepth)
        message_.text += text;
    else if (depth_ > kMessageDepth)
        inner_ += text;
}

void FeedbackReader::End(std::string_view element) {
    if (depth_-- == kMessageDepth) {
        found_(std::exchange(message_, {}));
        return;
    }
    if (element == "brush") {
        std::array<int, 2> numbers{};
        if (ReadNumbers(inner_, numbers) == numbers.size())
            message_.mark = LogMark{.entity = numbers[0], .primitive = numbers[1], .line = {}};
    } else if (element == "point") {
        std::array<float, 3> point{};
        if (!message_.mark)
            message_.mark.emplace();
        if (ReadNumbers(inner_, point) == point.size() && message_.mark->line.size() < kMostPoints)
            message_.mark->line.push_back(point);
    }
}

} // namespace q3
