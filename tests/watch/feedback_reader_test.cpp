// GPL-2.0-or-later. What -connect sends is read again as it was logged, however the network divides it.
#include "q3map2/watch/feedback_reader.h"

#include "q3map2/editors/editor_feedback.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace q3::test {

namespace {

std::string Framed(const std::vector<std::string> &payloads) {
    std::string bytes;
    for (const std::string &payload : payloads) {
        for (int shift = 0; shift < 32; shift += 8)
            bytes += char(payload.size() >> shift & 255);
        bytes += payload;
    }
    return bytes;
}

/// The messages of a stream that arrives in pieces of that many bytes.
std::vector<FeedbackMessage> Read(const std::string &bytes, std::size_t piece) {
    std::vector<FeedbackMessage> messages;
    FeedbackReader reader([&](FeedbackMessage message) { messages.push_back(std::move(message)); });
    for (std::size_t at = 0; at < bytes.size(); at += piece)
        EXPECT_TRUE(reader.Add(std::string_view(bytes).substr(at, piece)));
    return messages;
}

std::string Stream(std::initializer_list<std::vector<std::string>> parts) {
    std::string bytes = Framed({std::string(kFeedbackRoot)});
    for (const auto &part : parts)
        bytes += Framed(part);
    return bytes;
}

TEST(FeedbackReader, TextsComeBack) {
    const std::string text = "a <b> & \"c\" \u00e9\n", longText(5000, 'x');
    const std::string bytes =
        Stream({MessagePayloads(LogLevel::Normal, text), MessagePayloads(LogLevel::Error, longText),
                MessagePayloads(LogLevel::Warning, "w")});
    for (const std::size_t piece : {std::size_t(1), std::size_t(3), std::size_t(1000), bytes.size()}) {
        const auto messages = Read(bytes, piece);
        ASSERT_EQ(messages.size(), 3u);
        EXPECT_EQ(messages[0].text, text);
        EXPECT_EQ(messages[0].level, LogLevel::Normal);
        EXPECT_EQ(messages[1].text, longText);
        EXPECT_EQ(messages[1].level, LogLevel::Error);
        EXPECT_EQ(messages[2].level, LogLevel::Warning);
        EXPECT_FALSE(messages[2].mark);
    }
}

TEST(FeedbackReader, MarksComeBack) {
    LogMark line;
    for (int i = 0; i < 300; ++i) // more than fits into one network message
        line.line.push_back({float(i), -0.5F, 1e5F});
    const auto messages =
        Read(Stream({MarkPayloads(LogLevel::Warning, "brush", {.entity = 7, .primitive = 12, .line = {}}),
                     MarkPayloads(LogLevel::Error, "MAP LEAKED\n", line), MessagePayloads(LogLevel::Normal, "after")}),
             100);
    ASSERT_EQ(messages.size(), 3u);
    ASSERT_TRUE(messages[0].mark);
    EXPECT_EQ(messages[0].text, "brush");
    EXPECT_EQ(messages[0].mark->entity, 7);
    EXPECT_EQ(messages[0].mark->primitive, 12);
    EXPECT_TRUE(messages[0].mark->line.empty());
    ASSERT_TRUE(messages[1].mark);
    EXPECT_EQ(messages[1].text, "MAP LEAKED\n");
    EXPECT_EQ(messages[1].mark->line, line.line);
    EXPECT_FALSE(messages[2].mark);
}

TEST(FeedbackReader, OtherBytesAreRefused) {
    for (const std::string &bytes : {std::string("GET / HTTP/1.1\r\n\r\n"), Framed({"<a><b></a>"}),
                                     Framed({"\xff\xfe"}), std::string("\xff\xff\xff\xff", 4)}) {
        FeedbackReader reader([](const FeedbackMessage &) { ADD_FAILURE(); });
        EXPECT_FALSE(reader.Add(bytes));
        EXPECT_FALSE(reader.Add(Stream({MessagePayloads(LogLevel::Normal, "x")})));
    }
}

} // namespace

} // namespace q3::test
