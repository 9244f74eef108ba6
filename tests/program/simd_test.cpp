// GPL-2.0-or-later. Vector code gives the bytes of plain loops.
#include "tests/support/run_program.h"

#include <cstdlib>
#include <fstream>

namespace q3::test {

namespace {

/// Bakes the demo with q3map2 and with q3map2_plain, in which no function is compiled for wider vectors.
TEST_F(ProgramTest, VectorCodeAndPlainLoopsGiveTheSameMap) {
    const std::string options = " -threads 2 -light -sh -gridsh 64 64 64 -dirty -floodlight -bounce 1 -bouncegrid ";
    const auto before = MapBytes();
    RunWell(options + "MAP");
    const auto vectorCode = MapBytes();
    EXPECT_NE(vectorCode, before);
    std::ofstream(Map(".bsp"), std::ios::binary)
        .write(reinterpret_cast<const char *>(before.data()), std::streamsize(before.size()));
    const std::string command = "HOME='" + folder_.Root().string() + "' '" + PLAIN_PROGRAM + "' -fs_basepath '" +
                                (folder_ / "base").string() + "'" + options + "'" + Map(".bsp").string() +
                                "' > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    EXPECT_TRUE(MapBytes() == vectorCode);
}

} // namespace
} // namespace q3::test
