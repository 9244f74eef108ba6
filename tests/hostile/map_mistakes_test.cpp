// GPL-2.0-or-later. What a mapper does wrong, and the one message that says so. The whole stage runs.
#include "common/error.h"
#include "tests/support/compile_fixture.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

struct Mistake {
    const char *name;
    std::string text;    ///< of the map
    std::string message; ///< what must be printed, once; "ERROR " first: what stops the compile
};
std::ostream &operator<<(std::ostream &out, const Mistake &mistake) {
    return out << mistake.name;
}

/// The sealed room with more in its world, and more entities.
std::string With(const std::string &inWorld, const std::string &entities = "") {
    return MapText(RoomText() + inWorld) + entities;
}
std::string EntityText(std::string_view pairs, const std::string &inside = "") {
    return fmt::format("{{\n{}\n{}}}\n", pairs, inside);
}
std::string PatchText(int width, int height) {
    std::string text = fmt::format("{{\npatchDef2\n{{\ntest/wall\n( {} {} 0 0 0 )\n(\n", width, height);
    for (int x = 0; x < width; ++x) {
        text += "(";
        for (int y = 0; y < height; ++y)
            text += fmt::format(" ( {} {} 32 0 0 )", x * 8, y * 8);
        text += " )\n";
    }
    return text + ")\n}\n}\n";
}
/// A box as a detail brush: its sides have that content flag.
std::string DetailBox(const Vec3d &mins, const Vec3d &maxs, std::string_view shader = "test/wall") {
    std::string text = Box(mins, maxs, shader);
    constexpr std::string_view kFlags = "0.5 0.5 0 0 0";
    for (std::size_t at = text.find(kFlags); at != std::string::npos; at = text.find(kFlags, at))
        text.replace(at, kFlags.size(), "0.5 0.5 134217728 0 0");
    return text;
}
/// A box without its last line, with `lines` in their place.
std::string OpenBox(const std::string &lines) {
    const std::string box = Box({64, 64, 16}, {96, 96, 48});
    return box.substr(0, box.size() - 2) + lines;
}
/// A box whose upper side is `lines`.
std::string BoxUnder(const std::string &lines) {
    const std::string sides = OpenBox("");
    return sides.substr(0, sides.rfind('\n', sides.size() - 2) + 1) + lines + "}\n";
}
std::string Repeated(int count, const std::function<std::string(int)> &text) {
    std::string all;
    for (int i = 0; i < count; ++i)
        all += text(i);
    return all;
}
std::string Boxed(const Vec3d &at, double size, std::string_view shader = "test/wall") {
    return Box(at, at + Vec3d{size, size, size}, shader);
}

// Line 1 is the world's brace; the six walls take eight lines each, so that the sides of brush 6 begin in line 52.
std::vector<Mistake> Mistakes() {
    const Vec3d at{64, 64, 16};
    return {
        {"MissingBraceOfABrush", With(OpenBox("")),
         "test.map:60: '{' and a class name within entity 0: the next entity starts here, a '}' is missing"},
        {"MissingBraceOfTheWorld",
         WorldText(RoomText()).substr(0, WorldText(RoomText()).size() - 2) + std::string(kStart),
         "test.map:52: '{' and a class name within entity 0: the next entity starts here, a '}' is missing"},
        {"BraceTooMany", With("}\n"), "test.map:52: expected '{' of entity 1, found '}'"},
        {"DuplicatePlane", With(OpenBox(SideText(2, true, 48, "test/wall") + "}\n")),
         "Entity 0, Brush 6: test.map:52: duplicate plane"},
        {"MirroredPlane", With(OpenBox(SideText(2, false, 48, "test/wall") + "}\n")),
         "Entity 0, Brush 6: test.map:52: mirrored plane"},
        {"DegeneratePlane", With(OpenBox("( 1 1 1 ) ( 1 1 1 ) ( 2 2 2 ) test/wall 0 0 0 1 1\n}\n")),
         "Entity 0, Brush 6: test.map:52: degenerate plane"},
        {"Microbrush", With(Boxed(at, 0.004)), "Entity 0, Brush 6: test.map:52: mirrored plane"},
        {"InsideOutBrush", With(Box({96, 96, 48}, {64, 64, 16})),
         "Entity 0, Brush 6: test.map:52: the brush is inside out"},
        {"OpenBrush", With(BoxUnder("")), "Entity 0, Brush 6: test.map:52: the brush is open"},
        {"TextureAxesInOneLine",
         With(BoxUnder("( 0 0 48 ) ( 0 64 48 ) ( 64 0 48 ) test/wall [ 1 0 0 0 ] [ 2 0 0 0 ] 0 1 1\n")),
         "Entity 0, Brush 6: test.map:57: the texture test/wall has no extent on this side"},
        {"DecalThatHitsNothing",
         With("", EntityText("\"classname\" \"_decal\"\n\"target\" \"x\"", PatchText(3, 3)) +
                      EntityText("\"classname\" \"info_null\"\n\"targetname\" \"x\"\n\"origin\" \"8 8 16\"")),
         "Entity 3, Brush 0: test.map:65: the patch of the _decal hits no surface"},
        {"DecalOnItsTarget",
         With("", EntityText("\"classname\" \"_decal\"\n\"target\" \"x\"", PatchText(3, 3)) +
                      EntityText("\"classname\" \"info_null\"\n\"targetname\" \"x\"\n\"origin\" \"8 8 32\"")),
         "Entity 3: test.map:61: a _decal is left out: its target 'x' is where the decal itself is"},
        {"BrushOutsideTheWorld", With(Boxed({65500, 0, 0}, 64)),
         "Entity 0, Brush 6: test.map:52: the brush reaches beyond 65536 units"},
        {"EvenPatch", With(PatchText(4, 3)), "Entity 0, Brush 6: test.map:"},
        {"PatchTooLarge", With(PatchText(33, 3)), "ERROR Entity 0, Brush 6: test.map:"},
        {"PatchWithoutBrace", With("{\npatchDef2\n{\ntest/wall\n( 3 3 0 0 0 )\n(\n( ( 0 0 0 0 0 ) )\n"),
         "ERROR Entity 0, Brush 6: test.map:57: "},
        {"MissingTexture", With(Boxed(at, 32, "test/nowhere")), "shader textures/test/nowhere: couldn't find image"},
        {"MissingModel", With("", EntityText("\"classname\" \"misc_model\"\n\"model\" \"models/gone.md3\"")),
         "Entity 3: test.map:61: the model models/gone.md3 cannot be read: there is no such file"},
        {"ModelWithoutKey", With("", EntityText("\"classname\" \"misc_model\"")),
         "Entity 3: test.map:61: misc_model without a \"model\" key"},
        {"ModelWithoutTarget",
         With("", EntityText("\"classname\" \"misc_model\"\n\"model\" \"a.obj\"\n\"target\" \"nobody\"")),
         "Entity 3: test.map:61: no entity with brushes has the targetname 'nobody'"},
        {"MissingSkin",
         With("", EntityText("\"classname\" \"misc_model\"\n\"model\" \"models/t.obj\"\n\"skin\" \"gone\"")),
         "Entity 3: test.map:61: the skin file models/t_gone.skin cannot be read"},
        {"LightInSolid", With("", EntityText("\"classname\" \"light\"\n\"origin\" \"0 0 -8\"")),
         "Entity 3: test.map:61: the light stands in solid"},
        {"LightInDetail", With(DetailBox({-16, -16, 80}, {16, 16, 112})),
         "Entity 2: test.map:64: the light at 0 0 96 stands in a detail brush (entity 0, brush 6)"},
        {"DecalWithoutPatch", With("", EntityText("\"classname\" \"_decal\"\n\"target\" \"x\"")),
         "Entity 3: test.map:61: a _decal without patches is left out"},
        {"CloneOfNobody", With("", EntityText("\"classname\" \"func_door\"\n\"_clone\" \"x\"")),
         "Entity 3: test.map:61: it is a clone of x, but no entity has that _clonename"},
        {"Leak", MapText(RoomText(true)), "Entity 2: test.map:48: the light at 0 0 96 can be reached from outside"},
        {"NothingInTheOpen", WorldText(RoomText()), "ERROR test.map: no entity is in open space"},
        {"TooManySides", With("{\n" + Repeated(1025, [](int i) { return SideText(0, true, i, "test/wall"); }) + "}\n"),
         "ERROR Entity 0, Brush 6: test.map:1076: the brush has too many sides, expected at most 1024"},
        {"TooLongAShaderName", With(Boxed(at, 32, std::string(60, 'a'))), "ERROR Entity 0, Brush 6: test.map:52: "},
    };
}

class MistakeTest : public CompileTest, public testing::WithParamInterface<Mistake> {};

int Count(std::string_view text, std::string_view part) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

TEST_P(MistakeTest, HasOneMessage) {
    const std::string header("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0", 18); // TGA of one pixel
    folder.Write("textures/test/wall.tga", header + "abc");
    folder.Write("models/t.obj", "v 0 0 0\nv 8 0 0\nv 0 8 0\nf 1 2 3\n");
    std::string expected = GetParam().message, error;
    try {
        Compile(GetParam().text);
    } catch (const Error &failed) {
        error = failed.what();
    }
    out.log.FlushWarnings();
    const bool stops = expected.starts_with("ERROR ");
    EXPECT_EQ(stops, !error.empty()) << error;
    const std::string &said = stops ? error : out.text;
    EXPECT_EQ(Count(said, stops ? expected.substr(6) : expected), 1) << out.text << error;
}

TEST_F(CompileTest, LightsInBrushesThatLetLightThroughAreNoMistake) {
    folder.Write("textures/test/wall.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0", 18) + "abc");
    for (const std::string_view shader : {"test/glass", "test/mist"})
        Compile(With(DetailBox({-16, -16, 80}, {16, 16, 112}, shader)));
    EXPECT_EQ(out.log.WarningTotals().count("light in detail brush"), 0u) << out.text;
}

INSTANTIATE_TEST_SUITE_P(Mappers, MistakeTest, testing::ValuesIn(Mistakes()),
                         [](const auto &mistake) { return std::string(mistake.param.name); });

} // namespace

} // namespace q3::test
