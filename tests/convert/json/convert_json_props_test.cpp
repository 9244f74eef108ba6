// GPL-2.0-or-later. Light of static props as JSON.
#include "q3map2/bspfile/prop_light.h"
#include "tests/convert/json/json_fixture.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view kFile = "PropLight.json";

/// SmallBsp with two props: entities 2 and 3, of two meshes and one.
Bsp PropsBsp() {
    Bsp bsp = SmallBsp();
    bsp.entities += "{\n\"model\" \"models/A.md3\"\n}\n{\n\"model\" \"models/b.md3\"\n}\n";
    PropLight light;
    light.props = {{2, ModelNameCrc("models/a.md3"), 0x00ABCDEF, 0, 2}, {3, ModelNameCrc("models/b.md3"), ~0u, 2, 2}};
    light.meshes = {{0, 2}, {2, 1}, {3, 0}, {3, 1}};
    light.colors = {511u | 256u << 9 | 7u << 18 | 31u << 27, 0, 1u | 2u << 9 | 3u << 18 | 4u << 27, ~0u};
    bsp.propLight = light;
    return bsp;
}

class PropsJsonTest : public JsonTest {
  protected:
    std::string FaultAfter(std::string_view file, std::string_view from, std::string_view to) {
        return JsonTest::FaultAfter(PropsBsp(), file, from, to);
    }
};

TEST_F(PropsJsonTest, GivesTheSameBytes) {
    Bsp bsp = PropsBsp();
    bsp.bspx.insert(bsp.bspx.begin(), {"BEFORE", {std::byte(1)}});
    bsp.bspx.push_back({"BEHIND", {std::byte(2)}});
    ExpectSame(bsp);
    EXPECT_THAT(Text("bspx.json"), HasSubstr("\"STATIC_PROP_LIGHT\",\n        \"file\": \"PropLight.json\""));
    EXPECT_THAT(Text(kFile), AllOf(HasSubstr("\"entity\": 2"), HasSubstr("\"modelCrc\": \"0x00abcdef\""),
                                   HasSubstr("[511, 256, 7, 31]"), HasSubstr("[1, 2, 3, 4]")));
    ExpectSame(SmallBsp());
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / kFile)) << "of the map before";
}

TEST_F(PropsJsonTest, EditedColorsArePacked) {
    Unpack(PropsBsp());
    std::string text = Text(kFile);
    text.replace(text.find("[1, 2, 3, 4]"), 12, "[9, 8, 7, 6]");
    std::ofstream(folder_.Path() / kFile, std::ios::binary) << text;
    const PropLight light = Pack().propLight.value();
    EXPECT_EQ(light.colors.at(2), 9u | 8u << 9 | 7u << 18 | 6u << 27);
}

TEST_F(PropsJsonTest, DamagedLumpsStayInHexadecimal) {
    Bsp bsp = PropsBsp();
    bsp.propLight->colors.pop_back();
    Unpack(bsp);
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / kFile));
    EXPECT_THAT(Text("bspx.json"), HasSubstr("\"bytes\": \"53504c31"));
    EXPECT_THAT(log_.text, AllOf(HasSubstr("STATIC_PROP_LIGHT stays in hexadecimal"),
                                 HasSubstr("the meshes have 4 colors, expected 3")));
    EXPECT_THAT(PackError(), HasSubstr("STATIC_PROP_LIGHT")) << "a map with it cannot be written";
}

TEST_F(PropsJsonTest, ALumpWithoutPropsStaysInHexadecimal) {
    Bsp bsp = SmallBsp();
    bsp.propLight.emplace();
    ExpectSame(bsp);
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / kFile));
    EXPECT_EQ(log_.text.find("hexadecimal"), std::string::npos);
}

TEST_F(PropsJsonTest, FaultsNameTheFileAndTheMember) {
    EXPECT_THAT(FaultAfter(kFile, "\"entity\": 2", "\"entity\": -2"),
                AllOf(HasSubstr(kFile), HasSubstr("props[0]"), HasSubstr("entity: expected an integer in 0..")));
    EXPECT_THAT(FaultAfter(kFile, "\"entity\"", "\"other\""), HasSubstr("entity: missing"));
    EXPECT_THAT(FaultAfter(kFile, "0x00abcdef", "0x00abcdeg"), HasSubstr("modelCrc: expected 0x and eight hex"));
    EXPECT_THAT(FaultAfter(kFile, "0x00abcdef", "0x0abcdef"), HasSubstr("modelCrc: expected 0x and eight hex"));
    EXPECT_THAT(FaultAfter(kFile, "[1, 2, 3, 4]", "[512, 2, 3, 4]"), HasSubstr("meshes: expected colors of three"));
    EXPECT_THAT(FaultAfter(kFile, "[1, 2, 3, 4]", "[1, 2, 3, 32]"), HasSubstr("an exponent in 0..31"));
    EXPECT_THAT(FaultAfter(kFile, "[1, 2, 3, 4]", "[1, 2, 3]"), HasSubstr("meshes: expected colors of three"));
    EXPECT_THAT(FaultAfter(kFile, "[1, 2, 3, 4]", "7"), HasSubstr("meshes: expected colors of three"));
    EXPECT_THAT(FaultAfter(kFile, "\"meshes\"", "\"others\""), HasSubstr("meshes: missing"));
    EXPECT_THAT(FaultAfter(kFile, "\"props\"", "\"others\""), HasSubstr("props: missing or empty"));
    EXPECT_THAT(FaultAfter(kFile, "\"entity\": 3", "\"entity\": 30"), HasSubstr("entity 30 is not one of"));
    EXPECT_THAT(FaultAfter("bspx.json", kFile, "x.json"), HasSubstr("expected the file PropLight.json"));
}

} // namespace

} // namespace q3::test
