// GPL-2.0-or-later. Ambient cubes as JSON and in -info.
#include "q3map2/convert/bsp_info.h"
#include "tests/convert/json/json_fixture.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// SmallBsp with two samples in its open leaf 1.
Bsp CubesBsp() {
    Bsp bsp = SmallBsp();
    AmbientCubes &cubes = bsp.ambientCubes.emplace();
    cubes.leafs = {{0, 1}, {2, 0}, {0, 1}};
    cubes.samples.resize(2);
    cubes.samples[0].position = {1, 128, 255};
    cubes.samples[0].sides[0] = {255, 128, 0, -128};
    cubes.samples[1].sides[5] = {200, 1, 2, 127};
    return bsp;
}

class CubesJsonTest : public JsonTest {
  protected:
    /// The message of packing after `from` became `to` in a file.
    std::string FaultAfter(std::string_view file, std::string_view from, std::string_view to) {
        return JsonTest::FaultAfter(CubesBsp(), file, from, to);
    }
};

TEST_F(CubesJsonTest, GivesTheSameBytes) {
    Unpack(CubesBsp());
    EXPECT_EQ(Bytes(Pack()), Bytes(CubesBsp()));
    EXPECT_THAT(Text("bspx.json"), HasSubstr("\"AMBIENT_CUBES\",\n        \"file\": \"AmbientCubes.json\""));
    EXPECT_THAT(Text("AmbientCubes.json"), HasSubstr("[255, 128, 0, -128]"));
    Unpack(SmallBsp());
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / "AmbientCubes.json")) << "of the map before";
    EXPECT_EQ(Bytes(Pack()), Bytes(SmallBsp()));
}

TEST_F(CubesJsonTest, FaultsNameTheFileAndTheMember) {
    const std::string_view file = "AmbientCubes.json";
    EXPECT_THAT(FaultAfter(file, "255, 128, 0, -128", "256, 128, 0, -128"),
                testing::AllOf(HasSubstr(file), HasSubstr("samples[0]"), HasSubstr("mantissas in 0..255")));
    EXPECT_THAT(FaultAfter(file, "255, 128, 0, -128", "255, 128, 0, -129"), HasSubstr("exponent in -128..127"));
    EXPECT_THAT(FaultAfter(file, "1, 128, 255]", "1, 128, 256]"), HasSubstr("position"));
    EXPECT_THAT(FaultAfter(file, "\"leafs\"", "\"others\""), HasSubstr("leafs or samples: missing or empty"));
    EXPECT_THAT(FaultAfter(file, "2,", "70000,"), HasSubstr("leafs: expected integers in 0..65535"));
    EXPECT_THAT(FaultAfter(file, "2,", "2, 0,"), HasSubstr("leafs: expected an array of pairs"));
    EXPECT_THAT(FaultAfter(file, "2,", "3,"), HasSubstr("leaf 1: samples 0..2 are outside 0..1"));
    EXPECT_THAT(FaultAfter("bspx.json", file, "x.json"), HasSubstr("expected the file AmbientCubes.json"));
}

TEST(CubesInfo, CountsSamplesAndLeafs) {
    KeptLog log;
    PrintBspInfo("x.bsp", CubesBsp(), 0, log.log);
    EXPECT_THAT(log.text, HasSubstr("        2 ambient cubes         84\n"));
    EXPECT_THAT(log.text, HasSubstr("1 of 3 leafs have their own"));
}

} // namespace

} // namespace q3::test
