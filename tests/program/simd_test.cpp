// GPL-2.0-or-later. Vector code gives the same bytes at every width.
#include "tests/support/run_program.h"

#include <glib.h>

#include <fstream>

namespace q3::test {

namespace {

/// Q3MAP2_SIMD in the environment of the programs that run while this exists.
class IsaLimit {
  public:
    explicit IsaLimit(const char *name) { g_setenv("Q3MAP2_SIMD", name, TRUE); }
    ~IsaLimit() { g_unsetenv("Q3MAP2_SIMD"); }
    IsaLimit(const IsaLimit &) = delete;
    IsaLimit &operator=(const IsaLimit &) = delete;
};

/// Bakes the demo with vectors of 128, 256 and 512 bits, or as many of these as the processor has.
TEST_F(ProgramTest, VectorsOfEveryWidthGiveTheSameMap) {
    const auto before = MapBytes();
    std::vector<std::byte> first;
    for (const char *name : {"sse2", "avx2", "avx512"}) {
        const IsaLimit limit(name);
        std::ofstream(Map(".bsp"), std::ios::binary)
            .write(reinterpret_cast<const char *>(before.data()), std::streamsize(before.size()));
        RunWell("-threads 2 -light -sh -gridsh 64 64 64 -dirty -floodlight -areashadows 32 -bounce 1 -bouncegrid MAP");
        EXPECT_NE(MapBytes(), before) << name;
        if (first.empty())
            first = MapBytes();
        EXPECT_TRUE(MapBytes() == first) << name;
    }
}

TEST_F(ProgramTest, TheVersionNamesTheInstructionSetInUse) {
#if defined(__x86_64__) && !defined(__SSE3__)
    const IsaLimit limit("sse2");
    EXPECT_TRUE(RunWell("-version").Printed("SIMD     SSE2 (x86-64)"));
#endif
}

} // namespace
} // namespace q3::test
