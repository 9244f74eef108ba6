// GPL-2.0-or-later. The stream to editors keeps their limits.
#include "q3map2/editors/editor_feedback.h"

#include <gmock/gmock.h>

#include <random>

namespace q3::test {

namespace {

using testing::HasSubstr;

std::string Joined(const std::vector<std::string> &payloads) {
    std::string all;
    for (const std::string &payload : payloads) {
        EXPECT_GE(payload.size(), 1u);
        EXPECT_LE(payload.size(), kMaxPayload);
        EXPECT_EQ(payload.find('\0'), std::string::npos);
        all += payload;
    }
    return all;
}

/// Every & is followed by its ; and every first byte of a character by the others.
void ExpectWholeCharacters(const std::string &payload) {
    EXPECT_EQ(std::ranges::count(payload, '&'), std::ranges::count(payload, ';'));
    EXPECT_NE(static_cast<unsigned char>(payload.front()) & 0xC0, 0x80) << "begins inside a character";
    for (std::size_t i = 0; i < payload.size(); ++i) {
        const auto byte = static_cast<unsigned char>(payload[i]);
        const std::size_t length = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC0 ? 2 : 1;
        EXPECT_LE(i + length, payload.size());
    }
}

TEST(FeedbackXml, EscapesMarkup) {
    EXPECT_EQ(XmlText("a<b & \"c\">\n"), "a&lt;b &amp; &quot;c&quot;&gt;\n");
    EXPECT_EQ(XmlText("tab\tbell\a\x1b[0m\x7f"), "tab\tbell??[0m?");
    EXPECT_EQ(XmlText(std::string_view("nul\0!", 5)).find('\0'), std::string::npos);
    EXPECT_EQ(XmlText("gr\xC3\xBC\xC3\x9F"), "gr\xC3\xBC\xC3\x9F");
    EXPECT_EQ(XmlText("\xFFx"), "\xEF\xBF\xBDx") << "the replacement character of Unicode";
}

TEST(FeedbackXml, MessagesHaveTheirLevelFirst) {
    EXPECT_EQ(MessagePayloads(LogLevel::Warning, "x\n"),
              std::vector<std::string>{"<message level=\"2\">x\n</message>"});
}

TEST(FeedbackXml, LongTextIsDividedBetweenCharacters) {
    std::mt19937 random(3);
    const std::string_view letters[] = {"a", "<", "&", "\"", "\xC3\xBC", "\xE2\x82\xAC", "\xF0\x9F\x98\x80", "\n"};
    std::string text, escaped;
    for (int i = 0; i < 20000; ++i) {
        const std::string_view letter = letters[random() % std::size(letters)];
        text += letter;
        escaped += letter == "<" ? "&lt;" : letter == "&" ? "&amp;" : letter == "\"" ? "&quot;" : letter;
    }
    const auto payloads = MessagePayloads(LogLevel::Error, text);
    EXPECT_GT(payloads.size(), 20u);
    for (const std::string &payload : payloads)
        ExpectWholeCharacters(payload);
    EXPECT_EQ(Joined(payloads), "<message level=\"3\">" + escaped + "</message>");
}

TEST(FeedbackXml, ASelectFitsOneMessage) {
    const LogMark mark{.entity = 12, .primitive = 345, .line = {}};
    const auto payloads = MarkPayloads(LogLevel::Warning, std::string(5000, '<'), mark);
    ASSERT_EQ(payloads.size(), 1u);
    EXPECT_THAT(Joined(payloads), testing::EndsWith("&lt;<brush>12 345</brush></select>"));
    EXPECT_THAT(payloads.front(), testing::StartsWith("<select level=\"2\">&lt;"));
}

TEST(FeedbackXml, NoPointIsDivided) {
    LogMark mark;
    for (int i = 0; i < 9000; ++i)
        mark.line.push_back({float(i) - 4000, -65536.125F, 0.5F * float(i)});
    const auto payloads = MarkPayloads(LogLevel::Error, "MAP LEAKED\n", mark);
    EXPECT_GT(payloads.size(), 100u);
    std::size_t points = 0;
    for (const std::string &payload : payloads) {
        EXPECT_TRUE(payload.starts_with("<point>") || &payload == &payloads.front()) << payload;
        EXPECT_TRUE(payload.ends_with("</point>") || payload.ends_with("</message>")) << payload;
        for (std::size_t at = 0; (at = payload.find("<point>", at)) != std::string::npos; ++at)
            ++points;
    }
    EXPECT_EQ(points, mark.line.size());
    EXPECT_THAT(Joined(payloads), HasSubstr("<point>-4000.000000 -65536.125000 0.000000</point>"));
}

} // namespace

} // namespace q3::test
