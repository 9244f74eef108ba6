// GPL-2.0-or-later. Every BSPX lump survives a file and a folder of JSON files, alone and with all others.
#include "tests/convert/json/json_fixture.h"
#include "tests/support/lumps_fixture.h"

#include "q3map2/convert/bsp_info.h"
#include "q3map2/convert/json/convert_json_bspx.h"

#include <gmock/gmock.h>

#include <set>

namespace q3::test {

namespace {

Bsp ReadBack(const Bsp &bsp) {
    KeptLog log;
    Bsp read = ReadBsp(WriteBsp(bsp, {}), "map.bsp", {}, log.log);
    EXPECT_EQ(log.text.find("BSPX"), std::string::npos) << log.text;
    return read;
}

class LumpsTest : public JsonTest {
  protected:
    /// Reads, writes, unpacks and packs the map; each time the lumps must have their bytes.
    void ExpectKept(const Bsp &bsp) {
        const Bsp read = ReadBack(bsp);
        EXPECT_TRUE(read.bspx.empty()) << "members hold all of them";
        EXPECT_EQ(WriteBsp(read, {}), WriteBsp(bsp, {}));
        Unpack(bsp);
        const Bsp packed = Pack();
        EXPECT_EQ(WriteBsp(packed, {}), WriteBsp(bsp, {}));
        for (const BspxRow &row : BspxRows()) {
            EXPECT_EQ(LumpOf(read, row.id), LumpOf(bsp, row.id)) << row.name;
            EXPECT_EQ(LumpOf(packed, row.id), LumpOf(bsp, row.id)) << row.name;
            EXPECT_EQ(std::filesystem::exists(folder_.Path() / RowOf(kJsonLumps, row.id).file), row.has(bsp))
                << row.name;
        }
    }
};

TEST_F(LumpsTest, EachAloneAndAllTogether) {
    Bsp all = MapWithoutLumps();
    ExpectKept(all);
    for (const BspxRow &row : BspxRows()) {
        Bsp one = MapWithoutLumps();
        AddLump(one, row.id, 7);
        AddLump(all, row.id, 7);
        EXPECT_FALSE(LumpOf(one, row.id).empty()) << row.name;
        ExpectKept(one);
        row.clear(one);
        EXPECT_FALSE(row.has(one)) << row.name;
        EXPECT_EQ(WriteBsp(one, {}), WriteBsp(MapWithoutLumps(), {})) << row.name;
    }
    ExpectKept(all);
}

TEST_F(LumpsTest, TheirBytesAreThoseInTheFile) {
    for (const BspxRow &row : BspxRows()) {
        Bsp bsp = MapWithoutLumps();
        AddLump(bsp, row.id, 9);
        const std::vector<std::byte> file = WriteBsp(bsp, {}), lump = LumpOf(bsp, row.id);
        EXPECT_FALSE(std::ranges::search(file, lump).empty()) << row.name;
        EXPECT_EQ(BytesOfLump(bsp, row.id), lump.size()) << row.name;
        EXPECT_EQ(BytesOfBspx(bsp), lump.size()) << row.name;
    }
}

TEST_F(LumpsTest, NamesAndFilesAreTheirOwn) {
    std::set<std::string_view> names, files;
    for (const BspxRow &row : BspxRows()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_TRUE(files.insert(RowOf(kJsonLumps, row.id).file).second) << row.name;
        EXPECT_LE(row.name.size(), kBspxNameBytes);
        EXPECT_EQ(FindBspxRow(row.name), &row);
    }
    EXPECT_EQ(FindBspxRow("RGBLIGHTING"), nullptr);
}

TEST_F(LumpsTest, AForeignLumpMustNotTakeTheirNames) {
    for (const BspxRow &row : BspxRows()) {
        Bsp bsp = MapWithoutLumps();
        bsp.bspx = {{std::string(row.name), {}}};
        std::string text;
        try {
            ValidateBsp(bsp, "map", log_.log);
        } catch (const Error &error) {
            text = error.what();
        }
        EXPECT_THAT(text, testing::HasSubstr(fmt::format("the name {} belongs to {}", row.name, row.content)));
    }
}

TEST_F(LumpsTest, InfoHasALineForEach) {
    const auto info = [](const Bsp &bsp) {
        KeptLog log;
        PrintBspInfo("map.bsp", bsp, 1, log.log);
        return log.text;
    };
    const std::string plain = info(MapWithoutLumps());
    for (const BspxRow &row : BspxRows()) {
        Bsp bsp = MapWithoutLumps();
        AddLump(bsp, row.id, 7);
        EXPECT_GT(info(bsp).size(), plain.size()) << row.name;
        EXPECT_EQ(info(bsp).find("BSPX  "), std::string::npos) << row.name << " is not listed as another program's";
    }
}

TEST_F(LumpsTest, BakesDropWhatTheyMakeWrong) {
    Bsp bsp = MapWithoutLumps();
    for (const BspxRow &row : BspxRows())
        AddLump(bsp, row.id, 7);
    DropStaleLumps(bsp, StaleAfter::EveryBake);
    EXPECT_FALSE(bsp.gridSH || bsp.sparseGridSH || bsp.namedGridSH || bsp.ambientCubes);
    EXPECT_TRUE(bsp.rnm && bsp.propLight && !bsp.lightmapsE5bgr9.empty() && !bsp.vertexE5bgr9.empty());
    DropStaleLumps(bsp, StaleAfter::SurfaceBake);
    EXPECT_EQ(BytesOfBspx(bsp), 0u);
}

} // namespace

} // namespace q3::test
