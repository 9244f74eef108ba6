// GPL-2.0-or-later. Vector code gives the same bytes at every width.
#include "common/simd.h"
#include "tests/support/run_program.h"

#include <glib.h>

#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace q3::test {

namespace {

struct Limit {
    const char *name;  ///< in the environment
    std::string shown; ///< by -version
};

/// The limits that this processor can do, narrowest first; none if this build has one version of its vector code.
std::vector<Limit> LimitsOfThisProcessor() {
    std::vector<Limit> limits;
    if (Q3_SIMD_VERSIONS) {
        limits = {{"sse2", "SSE2 (x86-64)"}, {"avx2", "AVX2 (x86-64-v3)"}, {"avx512", "AVX-512 (x86-64-v4)"}};
        limits.resize(std::size_t(kVectorIsa) + 1);
    }
    return limits;
}
constexpr const char *kOneVersion = "this build has one version of its vector code";

/// Q3MAP2_SIMD in the environment of the programs that run while this exists.
class IsaLimit {
  public:
    explicit IsaLimit(const char *name) {
        if (const char *value = g_getenv("Q3MAP2_SIMD"))
            before_ = value;
        g_setenv("Q3MAP2_SIMD", name, TRUE);
    }
    ~IsaLimit() {
        if (before_)
            g_setenv("Q3MAP2_SIMD", before_->c_str(), TRUE);
        else
            g_unsetenv("Q3MAP2_SIMD");
    }
    IsaLimit(const IsaLimit &) = delete;
    IsaLimit &operator=(const IsaLimit &) = delete;

  private:
    std::optional<std::string> before_;
};

/// Bakes the demo with vectors of 128, 256 and 512 bits, or as many of these as the processor has.
TEST_F(ProgramTest, VectorsOfEveryWidthGiveTheSameMap) {
    if (!Q3_SIMD_VERSIONS)
        GTEST_SKIP() << kOneVersion;
    const auto before = MapBytes();
    std::vector<std::byte> first;
    for (const auto &[name, shown] : LimitsOfThisProcessor()) {
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
    if (!Q3_SIMD_VERSIONS)
        GTEST_SKIP() << kOneVersion;
    for (const auto &[name, shown] : LimitsOfThisProcessor()) {
        const IsaLimit limit(name);
        EXPECT_TRUE(RunWell("-version").Printed("SIMD     " + shown)) << name;
    }
}

} // namespace
} // namespace q3::test
