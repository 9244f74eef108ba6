// GPL-2.0-or-later. Tables of entity keys are read by name.
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/bspfile/map_keys.h"

#include <gtest/gtest.h>

#include <array>

using namespace q3;

namespace {

// What these find is known to the compiler, and Key() does not compile where FindKey() finds nothing.
static_assert(FindKey(keys::kLightKeys, "fade") == &keys::kFade);
static_assert(FindKey(keys::kLightKeys, "fad") == nullptr);
static_assert(FindKey(keys::kLightKeys, "light") == nullptr, "an alias of _light");
static_assert(FindKey(keys::kModelKeys, "angle")->info.name == "angle");

} // namespace

TEST(EntityKeys, ReferencesFollowRowsThatMove) {
    std::array<EntityKey, std::size(keys::kFalloffKeys) + 1> rows{};
    rows[0].info.name = "a new row";
    std::copy(std::begin(keys::kFalloffKeys), std::end(keys::kFalloffKeys), rows.begin() + 1);
    const EntityKey *wait = FindKey(rows, "wait");
    ASSERT_NE(wait, nullptr);
    EXPECT_EQ(wait->info.help, keys::kWait.info.help);
    EXPECT_EQ(keys::kWait.info.name, "wait");
}

TEST(EntityKeys, KeysOfOneNameInTwoTablesAreTheirOwn) {
    EXPECT_NE(&keys::kColor, &keys::kWorldColor);
    EXPECT_EQ(keys::kColor.info.name, keys::kWorldColor.info.name);
}
