// GPL-2.0-or-later. Light grids as distinct records and numbers.
#include "q3map2/bspfile/grid_table.h"

#include "common/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace q3 {

namespace {

bspGridPoint_t Point(std::uint8_t ambient, std::uint8_t directed = 0, Styles styles = kOnlyStyle0) {
    bspGridPoint_t point{};
    point.ambient[0] = {ambient, 0, 0};
    point.directed[0] = {0, directed, 0};
    point.styles = styles;
    return point;
}

TEST(GridTable, EqualPointsShareTheRecordOfTheFirst) {
    GridTableLoss loss;
    const std::vector<bspGridPoint_t> points{Point(5), Point(9), Point(5), Point(5, 1), Point(9, 0, kNoStyles)};
    const GridTable table = MakeGridTable(points, loss);
    EXPECT_THAT(table.numbers, testing::ElementsAre(0, 1, 0, 2, 3));
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_EQ(table.records[table.numbers[i]], points[i]) << i;
    EXPECT_EQ(loss.distinct, 4u);
    EXPECT_EQ(loss.changed, 0u);
    EXPECT_TRUE(MakeGridTable({}, loss).records.empty());
}

TEST(GridTable, TheNearestPointsAreJoinedFirst) {
    GridTableLoss loss;
    const std::vector<bspGridPoint_t> points{Point(10), Point(12), Point(100), Point(200), Point(200, 255)};
    const GridTable table = MakeGridTable(points, loss, 4);
    EXPECT_EQ(table.records.size(), 4u);
    EXPECT_EQ(table.numbers[0], table.numbers[1]);
    EXPECT_EQ(table.records[table.numbers[0]].ambient[0][0], 11);
    EXPECT_EQ(table.records[table.numbers[2]], points[2]);
    EXPECT_EQ(loss.changed, 2u);
    EXPECT_EQ(loss.worst, 1);
    EXPECT_DOUBLE_EQ(loss.mean, 2.0 / (5 * 6)) << "one byte at two of five points, of six each";
}

TEST(GridTable, ManyPointsOutweighFew) {
    GridTableLoss loss;
    std::vector<bspGridPoint_t> points(99, Point(10));
    points.push_back(Point(14));
    points.push_back(Point(200));
    EXPECT_EQ(MakeGridTable(points, loss, 2).records[0].ambient[0][0], 10);
}

TEST(GridTable, PointsOfOtherStylesAreNeverJoined) {
    constexpr Styles kLamp{0, 32, kNoStyle, kNoStyle};
    GridTableLoss loss;
    const std::vector<bspGridPoint_t> points{Point(10), Point(11), Point(10, 0, kLamp), Point(90, 0, kLamp),
                                             Point(10, 0, kNoStyles)};
    const GridTable table = MakeGridTable(points, loss, 4);
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_EQ(table.records[table.numbers[i]].styles, points[i].styles) << i;
    EXPECT_EQ(table.numbers[0], table.numbers[1]) << "they differ least";
}

TEST(GridTable, MoreSetsOfStylesThanRecordsAreAnError) {
    GridTableLoss loss;
    const std::vector<bspGridPoint_t> points{Point(1), Point(1, 0, kNoStyles), Point(1, 0, {0, 3, kNoStyle, kNoStyle})};
    EXPECT_THROW(MakeGridTable(points, loss, 2), Error);
}

TEST(GridTable, BytesOfFreeSlotsAreNoLoss) {
    GridTableLoss loss;
    std::vector<bspGridPoint_t> points{Point(10), Point(10)};
    points[1].ambient[3] = {200, 200, 200};
    MakeGridTable(points, loss, 1);
    EXPECT_EQ(loss.worst, 0);
    EXPECT_EQ(loss.mean, 0);
}

TEST(GridTable, NumbersStayInsideAFullTable) {
    std::mt19937 random(1);
    std::vector<bspGridPoint_t> points;
    for (int i = 0; i < 100000; ++i) { // light that changes slowly, with noise
        bspGridPoint_t point = Point(std::uint8_t(i / 400), std::uint8_t(random() % 8));
        point.ambient[0][1] = std::uint8_t(random() % 8), point.ambient[0][2] = std::uint8_t(random() % 64);
        point.latLong = {std::uint8_t(random() % 4), std::uint8_t(random() % 4)};
        points.push_back(point);
    }
    GridTableLoss loss;
    const GridTable table = MakeGridTable(points, loss);
    EXPECT_GT(loss.distinct, kMaxGridRecords);
    EXPECT_EQ(table.records.size(), kMaxGridRecords);
    EXPECT_LT(*std::ranges::max_element(table.numbers), table.records.size());
    EXPECT_EQ(table.numbers.size(), points.size());
    EXPECT_LE(loss.worst, 4);
    EXPECT_LT(loss.mean, 0.25);
}

} // namespace

} // namespace q3
