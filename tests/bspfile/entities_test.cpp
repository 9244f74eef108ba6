// GPL-2.0-or-later. Entity text of the lump and of map sources.
#include "common/files/files.h"
#include "q3map2/bspfile/entities.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

namespace {

Entity One(std::string key, std::string value) {
    Entity entity;
    entity.pairs.emplace_back(std::move(key), std::move(value));
    return entity;
}

std::vector<Entity> StylesMap() {
    return ParseMapEntities(ReadTextFile(std::string(TEST_DATA) + "/bsp/editor_styles.map"), "styles.map");
}

std::string LumpError(std::string_view text) {
    return ErrorOf([text] { ParseEntities(text, "x.bsp"); });
}

std::string MapError(std::string_view text) {
    return ErrorOf([text] { ParseMapEntities(text, "x.map"); });
}

} // namespace

TEST(Entities, TextOfTheLumpRoundTrips) {
    const std::string text = "{\n\"classname\" \"worldspawn\"\n\"Key\" \"a\\nb c\"\n\"key\" \"second\"\n}\n"
                             "{\n\"classname\" \"light\"\n}\n";
    const auto entities = ParseEntities(text, "x.bsp");
    ASSERT_EQ(entities.size(), 2u);
    EXPECT_EQ(entities[0].pairs.size(), 3u);
    EXPECT_EQ(entities[0].Value("KEY"), "a\\nb c"); // the first of duplicates, case ignored, no escapes
    EXPECT_EQ(entities[1].ClassName(), "light");
    EXPECT_EQ(FormatEntities(entities), text);
}

TEST(Entities, TrailingBlanksGoAndEmptyPairsAreDropped) {
    const auto entities = ParseEntities("{ \"a \t\" \"v \n\" \"b\" \" \" \" \" \"c\" \"d\" \"n\xc3\xa9\" }", "x.bsp");
    ASSERT_EQ(entities.size(), 1u);
    const std::vector<std::pair<std::string, std::string>> expected = {{"a", "v"}, {"d", "n\xc3\xa9"}};
    EXPECT_EQ(entities[0].pairs, expected);
}

TEST(Entities, TextEndsAtTheFirstNul) {
    using namespace std::string_view_literals;
    EXPECT_EQ(ParseEntities("{\n\"a\" \"b\"\n}\n\0{ broken"sv, "x.bsp").size(), 1u);
    EXPECT_EQ(ParseEntities("", "x.bsp").size(), 0u);
}

TEST(Entities, ErrorsNameTheLine) {
    EXPECT_EQ(LumpError("{\n\"a\" \"b\"\n"), "x.bsp: line 1: the entity opened here has no closing brace");
    EXPECT_EQ(LumpError("{\n\"a\" \"b\"\n}\n}\n"), "x.bsp: line 4: expected '{' to open an entity, found }");
    EXPECT_EQ(LumpError("{\n\"a\"\n}\n"), "x.bsp: line 2: the key a has no value");
    EXPECT_EQ(LumpError("{\n\"a\" \"b\n"), "x.bsp: line 2: a string is opened here and never closed");
    EXPECT_EQ(LumpError("{\na \"b\"\n}\n"), "x.bsp: line 2: expected a key in quotes or '}', found a");
    EXPECT_EQ(LumpError("{\n{\n}\n}\n"), "x.bsp: line 2: expected a key in quotes or '}', found {");
    EXPECT_EQ(LumpError("\n/* {"), "x.bsp: line 2: a comment is opened here and never closed");
    EXPECT_THAT(LumpError("$include \"/etc/passwd\""), HasSubstr("$include"));
    EXPECT_THAT(MapError("{\n$include \"/etc/passwd\"\n}"), HasSubstr("line 2: $include"));
    EXPECT_EQ(MapError("{\n\"a\" \"b\"\n{\n( 0 0 0 )\n}\n"),
              "x.map: line 1: the entity opened here has no closing brace");
    EXPECT_EQ(MapError("{\n{\nbrushDef\n{\n}\n"), "x.map: line 2: '{' is never closed");
    EXPECT_EQ(MapError("}\n"), "x.map: line 1: expected '{' to open an entity, found }");
    const std::string noise = LumpError("{ " + std::string(5000, 'x') + "\x01\n }");
    EXPECT_LT(noise.size(), 120u); // a message stays one readable line
}

TEST(Entities, MapSourcesOfAllEditorStyles) {
    const auto entities = StylesMap();
    ASSERT_EQ(entities.size(), 4u);
    EXPECT_EQ(entities[0].pairs.size(), 3u);
    EXPECT_EQ(entities[0].Value("gridsize"), "64 64 128");
    EXPECT_EQ(entities[0].Value("message"), "a { brace, a // slash and ; semi # hash");
    EXPECT_EQ(entities[1].Value("light"), "300");
    EXPECT_EQ(entities[2].ClassName(), "lightJunior");
    EXPECT_EQ(entities[2].Vector({"origin"}), Vec3f(1, 2, 3));
    EXPECT_TRUE(entities[3].pairs.empty());
}

TEST(Entities, DeepNestingIsSkippedWithoutRecursion) {
    std::string braces;
    for (const char c : {'{', '}'})
        for (int i = 0; i < 1000000; i++)
            (braces += c) += '\n';
    EXPECT_EQ(ParseMapEntities(braces, "x.map").size(), 1u);
}

TEST(Entities, NumbersFollowAtof) {
    EXPECT_EQ(NumberFromText("  12.5abc"), 12.5);
    EXPECT_EQ(NumberFromText("+3"), 3);
    EXPECT_EQ(NumberFromText("-.5"), -0.5);
    EXPECT_EQ(NumberFromText("1e3 2"), 1000);
    for (const char *bad : {"", "abc", "+-3", "nan", "inf", "-infinity", "1e999", "."})
        EXPECT_EQ(NumberFromText(bad), 0) << bad;
    EXPECT_EQ(One("a", "x1").Number({"a"}, 7), 7);
    EXPECT_EQ(One("a", "1e999").Number({"a"}, 7), 7);
    EXPECT_EQ(One("a", "5").Number({"b", "A"}, 7), 5);
    EXPECT_EQ(One("a", "0").Number({"a"}, 7), 0);
}

TEST(Entities, VectorsAreThreeFiniteNumbers) {
    EXPECT_EQ(One("v", "1 -2.5 3e1 junk").Vector({"v"}), Vec3f(1, -2.5f, 30));
    for (const char *bad : {"", "1 2", "1 2 x", "1 nan 3", "1 2 1e39"})
        EXPECT_FALSE(One("v", bad).Vector({"v"})) << bad;
}

TEST(Entities, FlagsSetAndNames) {
    Entity entity = One("Key", "1 yes");
    EXPECT_TRUE(entity.Flag("key"));
    entity.Set("KEY", "0");
    entity.Set("new", "x");
    EXPECT_FALSE(entity.Flag("key"));
    EXPECT_EQ(entity.pairs.size(), 2u);
    EXPECT_TRUE(entity.Has("new"));
    EXPECT_FALSE(entity.Has("other"));
    EXPECT_TRUE(EqualNoCase("LightJunior", "lightjunior"));
    EXPECT_FALSE(EqualNoCase("light", "lights"));
    EXPECT_TRUE(StartsWithNoCase("LIGHTjunior", "light"));
    EXPECT_FALSE(StartsWithNoCase("lig", "light"));
    EXPECT_TRUE(EndsWithNoCase("models/x.MD3", ".md3"));
    EXPECT_FALSE(EndsWithNoCase("md3", ".md3"));
}

TEST(Entities, FormattedTextCanAlwaysBeReadBack) {
    Entity quoted = One("command", "q3map2 \"my map.map\"");
    const std::string text = FormatEntities({quoted, Entity{}, One("a", "b")});
    const auto back = ParseEntities(text, "x.bsp");
    ASSERT_EQ(back.size(), 2u); // an entity without pairs is not written
    EXPECT_EQ(back[0].Value("command"), "q3map2 'my map.map'");
}

TEST(Entities, RandomTextIsParsedOrRefused) {
    std::mt19937 random(11);
    using namespace std::string_view_literals;
    const std::string_view alphabet = "{}\"\" \n\n/*;#a1$\0\xff("sv;
    int parsed = 0;
    for (int round = 0; round < 20000; round++) {
        std::string text = "{ ";
        for (int i = int(random() % 24); i > 0; i--)
            text += alphabet[random() % alphabet.size()];
        text += " }";
        parsed += LumpError(text) == "no error";
        parsed += MapError(text) == "no error";
    }
    EXPECT_GT(parsed, 0);
    EXPECT_LT(parsed, 40000);
}
