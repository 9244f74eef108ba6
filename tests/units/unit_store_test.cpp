// GPL-2.0-or-later. Division of units among parts, keys, and files of results.
#include "q3map2/units/unit_file.h"
#include "q3map2/units/unit_store.h"

#include "common/error.h"
#include "common/files/files.h"
#include "tests/support/game_folder.h"

#include <gmock/gmock.h>

#include <numeric>

namespace q3::test {

namespace {

using Division = UnitStore::Division;

TEST(HashTest, IsXxh3) {
    // The hash of nothing, from the specification of XXH3 (128 bits, seed 0).
    EXPECT_EQ(HashOf(std::string_view()).Text(), "99aa06d3014798d86001c324468d497f");
}

TEST(KeyBuilderTest, TextsThatFollowEachOtherStayApart) {
    KeyBuilder a, b;
    a.AddText("ab"), a.AddText("c");
    b.AddText("a"), b.AddText("bc");
    EXPECT_NE(a.Key(), b.Key());
}

class DivisionTest : public testing::TestWithParam<Division> {};

TEST_P(DivisionTest, EveryUnitBelongsToOnePartAndCostsAreEven) {
    std::vector<double> costs(1000);
    std::iota(costs.begin(), costs.end(), 1.0);
    const double total = std::accumulate(costs.begin(), costs.end(), 0.0);
    for (const int count : {1, 2, 4, 16}) {
        std::vector<int> owners(costs.size());
        for (int number = 1; number <= count; ++number) {
            const UnitStore store(UnitStore::Purpose::Parts, PartNumber{number, count});
            const auto own = store.Own(costs, GetParam());
            double sum = 0;
            for (std::size_t i = 0; i < own.size(); ++i)
                owners[i] += own[i], sum += own[i] * costs[i];
            EXPECT_NEAR(sum, total / count, 1000) << "by at most the largest unit";
        }
        EXPECT_THAT(owners, testing::Each(1));
    }
}

INSTANTIATE_TEST_SUITE_P(Both, DivisionTest, testing::Values(Division::Ranges, Division::BySize));

TEST(DivisionTest, RangesFollowEachOther) {
    const std::vector<double> costs{5, 1, 1, 1, 1, 1};
    EXPECT_THAT(DivideUnits(costs, 2, Division::Ranges), testing::ElementsAre(0, 1, 1, 1, 1, 1));
    EXPECT_THAT(DivideUnits(std::vector<double>(4), 2, Division::Ranges), testing::Each(0)) << "no cost at all";
}

Hash128 KeyOfNumber(int number) {
    KeyBuilder key("test");
    key.Add(number);
    return key.Key();
}

std::vector<std::byte> Bytes(int value, std::size_t count) {
    return std::vector<std::byte>(count, std::byte(value));
}

const std::vector<std::byte> kOnes = Bytes(1, 40), kTwos = Bytes(2, 4);

TEST(UnitStoreTest, ACacheDropsResultsOfOtherInputsAndKeepsWhatItUsed) {
    UnitStore store(UnitStore::Purpose::Cache);
    store.Load(std::vector<UnitResult>{{KeyOfNumber(1), kOnes}, {KeyOfNumber(2), kTwos}}, MappedFile(),
               KeyOfNumber(100));
    store.Begin(KeyOfNumber(100));
    EXPECT_TRUE(store.Find(KeyOfNumber(1)));
    EXPECT_FALSE(store.Find(KeyOfNumber(3)));
    store.Keep(KeyOfNumber(3), Bytes(3, 4));
    EXPECT_EQ(store.Used().size(), 2u) << "units 1 and 3: unit 2 was not asked for";
    EXPECT_TRUE(store.HasChanged());

    UnitStore other(UnitStore::Purpose::Cache);
    other.Load(std::vector<UnitResult>{{KeyOfNumber(1), kOnes}}, MappedFile(), KeyOfNumber(100));
    other.Begin(KeyOfNumber(101));
    EXPECT_FALSE(other.Find(KeyOfNumber(1)));
}

TEST(UnitStoreTest, PartsOfOtherInputsAreAnError) {
    UnitStore store(UnitStore::Purpose::Parts);
    store.Load(std::vector<UnitResult>{{KeyOfNumber(1), kOnes}}, MappedFile(), KeyOfNumber(100));
    EXPECT_THROW(store.Begin(KeyOfNumber(101)), Error);
}

TEST(UnitFileTest, ReadsWhatItWroteAndRefusesEveryTruncationAndFlippedByte) {
    const GameFolder folder;
    const auto path = folder / "results";
    const UnitFile file{
        {.stage = "-light", .text = "part 2 of 3", .inputs = KeyOfNumber(7), .round = 2, .part = {2, 3}},
        {{KeyOfNumber(1), kOnes}, {KeyOfNumber(2), {}}},
        {}};
    WriteUnitFile(path, file);
    const UnitFile read = ReadUnitFile(path);
    EXPECT_EQ(read.header, file.header);
    ASSERT_EQ(read.results.size(), 2u);
    EXPECT_EQ(read.results[0].key, KeyOfNumber(1));
    EXPECT_TRUE(std::ranges::equal(read.results[0].bytes, kOnes));
    EXPECT_TRUE(read.results[1].bytes.empty());

    const std::vector<std::byte> bytes = ReadFile(path);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        ReplaceFile(path, std::span<const std::byte>(bytes).first(i));
        EXPECT_THROW(ReadUnitFile(path), Error) << i << " bytes";
        std::vector<std::byte> flipped = bytes;
        flipped[i] ^= std::byte(0x10);
        ReplaceFile(path, flipped);
        EXPECT_THROW(ReadUnitFile(path), Error) << "byte " << i;
    }
}

} // namespace

} // namespace q3::test
