// GPL-2.0-or-later. Scaling, moving and merging treat every BSPX lump as its row says.
#include "q3map2/edit/edit_lumps.h"
#include "q3map2/edit/merge_maps.h"
#include "q3map2/edit/scale_shift.h"
#include "tests/support/lumps_fixture.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

Bsp MapWith(BspxId id, std::uint32_t first) {
    Bsp bsp = MapWithoutLumps();
    AddLump(bsp, id, first);
    return bsp;
}

TEST(EditedLumps, WithoutPositionsStayAsTheyAre) {
    for (const LumpEdit &edit : LumpEdits()) {
        const Bsp old = MapWith(edit.id, 7);
        Bsp shifted = old, scaled = old;
        KeptLog log;
        ShiftMap(shifted, {64, -8, 32}, "map", log.log);
        ScaleMap(scaled, {.factors = {2, 2, 2}}, "map", log.log);
        for (const Bsp *bsp : {&shifted, &scaled}) {
            EXPECT_TRUE(RowOf(edit.id).has(*bsp)) << RowOf(edit.id).name;
            EXPECT_EQ(LumpOf(*bsp, edit.id) == LumpOf(old, edit.id), edit.transform == nullptr) << RowOf(edit.id).name;
            EXPECT_FALSE(WriteBsp(*bsp, {}).empty());
        }
    }
}

TEST(EditedLumps, DirectionsOfAnotherShapeAreAWarning) {
    for (const LumpEdit &edit : LumpEdits()) {
        Bsp bsp = MapWith(edit.id, 7);
        bsp.gridPoints.clear();
        KeptLog log;
        ScaleMap(bsp, {.factors = {2, 2, 3}}, "map", log.log);
        EXPECT_EQ(log.text.find("directions of the light grids") != std::string::npos,
                  edit.unevenScaling == UnevenScaling::SpoilsLight)
            << RowOf(edit.id).name;
    }
}

TEST(EditedLumps, GridsOfAMergedMapAreThoseOfTheFirst) {
    for (const LumpEdit &edit : LumpEdits()) {
        const Bsp main = MapWith(edit.id, 7), added = MapWith(edit.id, 9), plain = MapWithoutLumps();
        KeptLog log;
        const Bsp both = MergeMaps({main, "main"}, {added, "added"}, {.world = true}, log.log);
        const std::vector<std::byte> merged = LumpOf(both, edit.id), first = LumpOf(main, edit.id);
        const std::string_view name = RowOf(edit.id).name;
        if (edit.unevenScaling == UnevenScaling::SpoilsLight)
            EXPECT_EQ(merged, first) << name;
        else
            EXPECT_GT(merged.size(), first.size()) << name << " is that of both";
        EXPECT_FALSE(WriteBsp(both, {}).empty());

        const Bsp second = MergeMaps({plain, "main"}, {added, "added"}, {.world = true}, log.log);
        const bool keeps = edit.id == BspxId::Rnm || edit.id == BspxId::PropLight;
        EXPECT_EQ(RowOf(edit.id).has(second), keeps) << name;
        EXPECT_EQ(log.text.find("dropped") != std::string::npos, !keeps) << name;
    }
}

} // namespace

} // namespace q3::test
