// GPL-2.0-or-later. The lump of prop light, against bytes put together here, and damaged ones.
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/prop_light.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

namespace {

constexpr std::string_view kTwoProps =
    "{\n\"classname\" \"worldspawn\"\n}\n{\n\"classname\" \"prop_static\"\n\"model\" \"models/A.md3\"\n}\n"
    "{\n\"classname\" \"prop_static\"\n\"model\" \"models/b.md3\"\n}\n";

/// Prop 1 with meshes of 2 and 0 vertices, prop 2 with one of 3.
PropLight SampleLight() {
    return {.props = {{1, ModelNameCrc("models/a.md3"), 77, 0, 2}, {2, ModelNameCrc("models/b.md3"), 78, 2, 1}},
            .meshes = {{0, 2}, {2, 0}, {2, 3}},
            .colors = {1, 2, 3, 4, 5}};
}

Bsp LitBsp() {
    Bsp bsp = SampleBsp();
    bsp.entities = kTwoProps;
    bsp.propLight = SampleLight();
    return bsp;
}

std::vector<std::byte> BytesOfSample() {
    std::vector<std::byte> bytes;
    for (const char c : {'S', 'P', 'L', '1'})
        bytes.push_back(std::byte(c));
    bytes.resize(20 + 2 * 20 + 3 * 8 + 5 * 4);
    std::size_t at = 4;
    const auto put = [&](std::uint32_t value) {
        SetInt(bytes, at, std::int32_t(value));
        at += 4;
    };
    for (const std::uint32_t value : {1u,
                                      2u,
                                      3u,
                                      5u,
                                      1u,
                                      ModelNameCrc("models/a.md3"),
                                      77u,
                                      0u,
                                      2u,
                                      2u,
                                      ModelNameCrc("models/b.md3"),
                                      78u,
                                      2u,
                                      1u,
                                      0u,
                                      2u,
                                      2u,
                                      0u,
                                      2u,
                                      3u,
                                      1u,
                                      2u,
                                      3u,
                                      4u,
                                      5u})
        put(value);
    return bytes;
}

} // namespace

TEST(PropLight, LumpIsLaidOutAsDescribed) {
    EXPECT_EQ(EncodePropLight(SampleLight()), BytesOfSample());
    const PropLight read = DecodePropLight(BytesOfSample());
    EXPECT_EQ(EncodePropLight(read), BytesOfSample());
    const std::string digits = "123456789";
    EXPECT_EQ(Crc32(std::as_bytes(std::span(digits.data(), digits.size()))), 0xCBF43926u);
}

TEST(PropLight, FileRoundTrip) {
    const Bsp bsp = LitBsp();
    KeptLog listener;
    const Bsp read = ReadBsp(WriteBsp(bsp, {}), "map.bsp", {}, listener.log);
    ASSERT_TRUE(read.propLight) << listener.text;
    EXPECT_EQ(EncodePropLight(*read.propLight), BytesOfSample());
}

TEST(PropLight, EveryPrefixIsAnErrorAndNoChangedByteIsReadOutside) {
    const std::vector<std::byte> whole = BytesOfSample();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::vector<std::byte> cut(whole.begin(), whole.begin() + std::ptrdiff_t(size));
        EXPECT_THROW((void)DecodePropLight(cut), Error) << size;
    }
    for (std::size_t at = 0; at < whole.size(); ++at)
        for (int bit = 0; bit < 8; ++bit) {
            std::vector<std::byte> damaged = whole;
            damaged[at] ^= std::byte(1 << bit);
            try {
                const PropLight light = DecodePropLight(damaged);
                for (const bspPropLight_t &prop : light.props)
                    ASSERT_LE(std::size_t(prop.firstMesh) + prop.meshCount, light.meshes.size());
                for (const bspPropMesh_t &mesh : light.meshes)
                    ASSERT_LE(std::size_t(mesh.firstColor) + mesh.colorCount, light.colors.size());
                EXPECT_EQ(light.colors.size(), 5u);
            } catch (const Error &) {
            }
        }
}

TEST(PropLight, MessagesNameWhatIsWrong) {
    const auto fault = [](std::size_t at, std::int32_t value) {
        std::vector<std::byte> bytes = BytesOfSample();
        SetInt(bytes, at, value);
        return ErrorOf([&] { (void)DecodePropLight(bytes); });
    };
    EXPECT_THAT(fault(0, 5), HasSubstr("does not start with SPL1"));
    EXPECT_THAT(fault(4, 2), HasSubstr("version 2, expected 1"));
    EXPECT_THAT(fault(16, -1), HasSubstr("length 104, expected"));
    EXPECT_THAT(fault(20 + 20, 1), HasSubstr("prop 1: entity 1 after entity 1"));
    EXPECT_THAT(fault(20 + 12, 1), HasSubstr("prop 0: firstMesh 1, expected 0"));
    EXPECT_THAT(fault(60 + 8, 1), HasSubstr("mesh 1: firstColor 1, expected 2"));
    EXPECT_THAT(fault(60 + 20, 9), HasSubstr("the meshes have 11 colors, expected 5"));
}

TEST(PropLight, LightOfOtherEntitiesIsDroppedOnReadingAndAnErrorOnWriting) {
    for (const auto &[from, to, text] :
         {std::array<std::string_view, 3>{"b.md3", "c.md3", "entity 2 has another model now, \"models/c.md3\""},
          std::array<std::string_view, 3>{"{\n\"classname\" \"prop_static\"\n\"model\" \"models/b.md3\"\n}\n", "",
                                          "entity 2 is not one of 2"}}) {
        Bsp bsp = LitBsp();
        std::vector<std::byte> file = WriteBsp(bsp, {});
        bsp.entities.replace(bsp.entities.find(from), from.size(), to);
        EXPECT_THAT(ErrorOf([&] { (void)WriteBsp(bsp, {}); }), HasSubstr(text));
        Bsp bare = bsp;
        bare.propLight.reset();
        bare.bspx.push_back({"STATIC_PROP_LIGHX", BytesOfSample()});
        file = WriteBsp(bare, {});
        const std::string name = "STATIC_PROP_LIGHX";
        const auto at = std::search(file.begin(), file.end(), name.begin(), name.end(),
                                    [](std::byte a, char b) { return char(a) == b; });
        ASSERT_NE(at, file.end());
        *(at + 16) = std::byte('T');
        KeptLog listener;
        const Bsp read = ReadBsp(file, "map.bsp", {}, listener.log);
        EXPECT_FALSE(read.propLight);
        EXPECT_THAT(listener.text,
                    HasSubstr(std::string("BSPX lump STATIC_PROP_LIGHT is dropped: ") + std::string(text)));
    }
}
