// GPL-2.0-or-later. The tokenizer.
#include "common/error.h"
#include "common/text/text_scan.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> All(TextScanner scanner) {
    std::vector<std::string> tokens;
    for (std::string token; scanner.Next(token);)
        tokens.push_back(token);
    return tokens;
}

std::vector<std::string> All(std::string text) {
    return All(TextScanner(std::move(text), "test"));
}

std::vector<std::string> RestOfLine(TextScanner &scanner) {
    std::vector<std::string> tokens;
    for (std::string token; scanner.NextOnLine(token);)
        tokens.push_back(token);
    return tokens;
}

TextScanner::Include From(std::map<std::string, std::string> files) {
    return [files](std::string_view name) -> std::optional<std::string> {
        const auto found = files.find(std::string(name));
        return found == files.end() ? std::nullopt : std::optional(found->second);
    };
}

TEST(TextScanner, WhiteSpaceIsEveryByteUpToBlank) {
    EXPECT_THAT(All("a\tb\r\nc\x01"
                    "d\ve f"),
                ElementsAre("a", "b", "c", "d", "e", "f"));
    EXPECT_THAT(All(std::string("a\0b", 3)), ElementsAre("a", "b"));
    EXPECT_THAT(All("caf\xC3\xA9 \xFF"), ElementsAre("caf\xC3\xA9", "\xFF"));
    EXPECT_THAT(All(""), IsEmpty());
    EXPECT_THAT(All(" \n\t"), IsEmpty());
}

TEST(TextScanner, ByteOrderMarkIsNoToken) {
    EXPECT_THAT(All("\xEF\xBB\xBFname {"), ElementsAre("name", "{"));
}

TEST(TextScanner, Comments) {
    EXPECT_THAT(All("a ; b\nc # d\ne // f\ng /* h\n i */ j"), ElementsAre("a", "c", "e", "g", "j"));
    EXPECT_THAT(All("a /* never closed"), ElementsAre("a"));
    EXPECT_THAT(All("// only"), IsEmpty());
    EXPECT_THAT(All("/ /"), ElementsAre("/", "/"));
}

TEST(TextScanner, SemicolonEndsAPlainToken) {
    TextScanner scanner("slick;surfaceparm dust\nnext", "test");
    std::string token;
    ASSERT_TRUE(scanner.NextOnLine(token));
    EXPECT_EQ(token, "slick");
    EXPECT_FALSE(scanner.NextOnLine(token));
    ASSERT_TRUE(scanner.Next(token));
    EXPECT_EQ(token, "next");
}

TEST(TextScanner, CommentMarksInsideAPlainTokenAreText) {
    EXPECT_THAT(All("a//b a/*b a#b a\"b c"), ElementsAre("a//b", "a/*b", "a#b", "a\"b", "c"));
}

TEST(TextScanner, BracesNeedWhiteSpace) {
    EXPECT_THAT(All("name{ (1 2 ) }"), ElementsAre("name{", "(1", "2", ")", "}"));
}

TEST(TextScanner, QuotedTokens) {
    EXPECT_THAT(All(R"("a b" "" "; # // /*" "back\" x)"), ElementsAre("a b", "", "; # // /*", "back\\", "x"));
    EXPECT_THAT(All("\"two\nlines\"tail"), ElementsAre("two\nlines", "tail"));
    EXPECT_THAT(All("\"open"), ElementsAre("open"));
}

TEST(TextScanner, LinesAreCountedByNewlinesAlone) {
    TextScanner scanner("one\r\n\"two\n2b\" /* \n */ four\rfour", "dir/name.shader");
    std::string token;
    const std::vector<std::pair<std::string, int>> expected = {{"one", 1}, {"two\n2b", 2}, {"four", 4}, {"four", 4}};
    for (const auto &[text, line] : expected) {
        ASSERT_TRUE(scanner.Next(token));
        EXPECT_EQ(token, text);
        EXPECT_EQ(scanner.Line(), line);
    }
    EXPECT_EQ(scanner.Location(), "dir/name.shader:4");
}

TEST(TextScanner, SameLineReadsStopAtTheEndOfTheLine) {
    TextScanner scanner("a b\nc // d\ne /* x */ f /* \n */ g", "test");
    EXPECT_THAT(RestOfLine(scanner), ElementsAre("a", "b"));
    EXPECT_THAT(RestOfLine(scanner), IsEmpty());
    std::string token;
    ASSERT_TRUE(scanner.Next(token));
    EXPECT_EQ(token, "c");
    EXPECT_THAT(RestOfLine(scanner), IsEmpty());
    ASSERT_TRUE(scanner.Next(token));
    EXPECT_EQ(token, "e");
    EXPECT_THAT(RestOfLine(scanner), ElementsAre("f"));
    ASSERT_TRUE(scanner.Next(token));
    EXPECT_EQ(token, "g");
    EXPECT_FALSE(scanner.Next(token));
}

TEST(TextScanner, PushedBackTokenComesAgainOnce) {
    TextScanner scanner("a b", "test");
    std::string token;
    ASSERT_TRUE(scanner.Next(token));
    scanner.PushBack();
    ASSERT_TRUE(scanner.NextOnLine(token));
    EXPECT_EQ(token, "a");
    ASSERT_TRUE(scanner.Next(token));
    EXPECT_EQ(token, "b");
}

TEST(TextScanner, SkipLineLeavesTheNextLine) {
    TextScanner scanner("a b c\nd", "test");
    std::string token;
    ASSERT_TRUE(scanner.Next(token));
    scanner.SkipLine();
    ASSERT_TRUE(scanner.Next(token));
    EXPECT_EQ(token, "d");
}

TEST(TextScanner, TokensOf1023BytesAndNoMore) {
    EXPECT_THAT(All(std::string(1023, 'a')), ElementsAre(std::string(1023, 'a')));
    EXPECT_THROW(All(std::string(1024, 'a')), Error);
    try {
        All("fine\n\"" + std::string(2000, 'a'));
        FAIL() << "no error";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr("test:2"));
    }
}

TEST(TextScanner, IncludeReadsAnotherFileAndReturns) {
    EXPECT_THAT(
        All(TextScanner("a $include one.inc b", "test", From({{"one.inc", "x $INCLUDE two.inc y"}, {"two.inc", "z"}}))),
        ElementsAre("a", "x", "z", "y", "b"));
    EXPECT_THAT(All(TextScanner("a $include gone b\nc", "test", From({}))), ElementsAre("a", "b", "c"));
    EXPECT_THAT(All(TextScanner("a $include\nb", "test", From({}))), ElementsAre("a", "b"));
    EXPECT_THAT(All("$include name"), ElementsAre("$include", "name"));
}

TEST(TextScanner, LocationNamesTheIncludedFile) {
    TextScanner scanner("a $include one.inc b", "test", From({{"one.inc", "\nx"}}));
    std::string token;
    scanner.Next(token);
    scanner.Next(token);
    EXPECT_EQ(scanner.Location(), "one.inc:2");
    scanner.Next(token);
    EXPECT_EQ(scanner.Location(), "test:1");
}

TEST(TextScanner, SameLineReadStopsAtTheEndOfAnInclude) {
    TextScanner scanner("a $include one.inc b", "test", From({{"one.inc", "x"}}));
    EXPECT_THAT(RestOfLine(scanner), ElementsAre("a", "x"));
}

TEST(TextScanner, IncludesInACircleOrTooManyAreErrors) {
    EXPECT_THROW(All(TextScanner("$include a", "test", From({{"a", "$include b"}, {"b", "x $include A"}}))), Error);
    EXPECT_THROW(All(TextScanner("$include test", "test", From({{"test", "x"}}))), Error);
    EXPECT_THROW(All(TextScanner("$include \"te\nst\"", "test", From({{"te\nst", "x"}}))), Error);
    std::map<std::string, std::string> chain;
    for (int i = 0; i < 40; ++i)
        chain[std::to_string(i)] = fmt::format("$include {}", i + 1);
    EXPECT_THROW(All(TextScanner("$include 0", "test", From(chain))), Error);
    // Doubling at every level: 2^12 files in a depth that is allowed.
    std::map<std::string, std::string> doubling;
    for (int i = 0; i < 12; ++i)
        doubling[std::to_string(i)] = fmt::format("$include {0} $include {0}", i + 1);
    doubling["12"] = "x";
    EXPECT_THROW(All(TextScanner("$include 0", "test", From(doubling))), Error);
}

TEST(TextScanner, TokensOfALineStayWhileFilesAreIncluded) {
    TextScanner scanner("a $include one.inc\nc", "test", From({{"one.inc", "b d"}}));
    std::string_view a, b, d, c;
    ASSERT_TRUE(scanner.NextOnLine(a) && scanner.NextOnLine(b) && scanner.NextOnLine(d));
    EXPECT_FALSE(scanner.NextOnLine(c));
    EXPECT_EQ(std::string(a) + std::string(b) + std::string(d), "abd");
    const TextLocation location = scanner.TokenLocation();
    ASSERT_TRUE(scanner.Next(c));
    EXPECT_EQ(c, "c");
    EXPECT_EQ(scanner.Location(), "test:2");
    EXPECT_EQ(location.Text(), "one.inc:1");
}

TEST(TextScanner, UnreadIsWhatFollowsTheLastToken) {
    TextScanner scanner("a \"{\" b; c", "test");
    std::string_view token;
    scanner.Next(token);
    EXPECT_EQ(scanner.Unread(), " \"{\" b; c");
    scanner.Next(token);
    EXPECT_EQ(scanner.Unread(), " b; c");
    scanner.Next(token);
    EXPECT_EQ(scanner.Unread(), "; c");
    EXPECT_FALSE(scanner.Next(token));
    EXPECT_EQ(scanner.Unread(), "");
}

TEST(TextScanner, KnowsWhetherItsFileIncludesOthers) {
    EXPECT_TRUE(TextScanner("map $lightmap\n$INCLUDE x", "test", From({})).HasIncludes());
    EXPECT_FALSE(TextScanner("map $lightmap $inc", "test", From({})).HasIncludes());
    EXPECT_FALSE(TextScanner("$include x", "test").HasIncludes());
}

TEST(TextScanner, EnginesKnowFewerComments) {
    EXPECT_THAT(All(TextScanner("# a;b // c\n; /* d */ e", "test", {}, TextDialect::Engine)),
                ElementsAre("#", "a;b", ";", "e"));
}

TEST(TextScanner, QuotesOfMapSourcesMayBeEscaped) {
    const auto tokens = [](std::string text) {
        return All(TextScanner(std::move(text), "x", {}, TextDialect::MapSource));
    };
    EXPECT_THAT(tokens("\"m\" \"say \\\"hi there\\\"\"\nnext"), ElementsAre("m", "say \\\"hi there\\\"", "next"));
    EXPECT_THAT(tokens("\"m\" \"\\\"a\\\" \\\"b\\\"\"\n\"n\""), ElementsAre("m", "\\\"a\\\" \\\"b\\\"", "n"));
    // A backslash at the end of a value is none of an escape.
    EXPECT_THAT(tokens("\"p\" \"c:\\maps\\\"\n\"n\" \"x\""), ElementsAre("p", "c:\\maps\\", "n", "x"));
    EXPECT_THAT(tokens("\"p\" \"c:\\\" // \"\nx"), ElementsAre("p", "c:\\", "x"));
    EXPECT_THAT(tokens("{ \"p\" \"c:\\\" \"q\" \"d\" }"), ElementsAre("{", "p", "c:\\", "q", "d", "}"));
}

TEST(TextScanner, LongTokensAreReadWhenAskedFor) {
    const std::string text = "k \"" + std::string(5000, 'a') + "\"\nb " + std::string(2000, 'c');
    TextScanner scanner(text, "test");
    std::string key, value;
    ASSERT_TRUE(scanner.Next(key) && scanner.NextLongOnLine(value));
    EXPECT_EQ(value.size(), 5000u);
    ASSERT_TRUE(scanner.Next(key));
    EXPECT_THROW(scanner.Next(key), Error);
}

TEST(Text, CaseIsOfAsciiAlone) {
    EXPECT_EQ(LowerCase("AbC\xC3\x89"), "abc\xC3\x89");
    EXPECT_TRUE(EqualNoCase("SurfaceParm", "surfaceparm"));
    EXPECT_FALSE(EqualNoCase("a", "ab"));
}

} // namespace
} // namespace q3
