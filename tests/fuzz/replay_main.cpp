// GPL-2.0-or-later. Runs the files of folders through a fuzz target without libFuzzer, for the tests.
//
// usage: fuzz_replay TARGET FOLDER... Files of FOLDER/TARGET are run. It is an error if there are none.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

// Every target, under the name that its source has in this program (CMakeLists.txt).
#define Q3_TARGET(name) extern "C" int FuzzOne_##name(const std::uint8_t *data, std::size_t size);
#include "fuzz_targets.inc"
#undef Q3_TARGET

namespace {

struct Target {
    std::string_view name;
    int (*run)(const std::uint8_t *data, std::size_t size);
};
constexpr Target kTargets[] = {
#define Q3_TARGET(name) {#name, FuzzOne_##name},
#include "fuzz_targets.inc"
};

/// Number of files that were run.
int RunFolder(const Target &target, const std::filesystem::path &folder) {
    int count = 0;
    std::error_code absent;
    for (const auto &entry : std::filesystem::directory_iterator(folder, absent)) {
        std::ifstream in(entry.path(), std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(in), {}};
        // A copy of its exact size, so that sanitizers see a read behind its end.
        const std::vector<std::uint8_t> bytes(text.begin(), text.end());
        std::printf("%s\n", entry.path().filename().string().c_str());
        std::fflush(stdout); // the last line names the file of a crash
        target.run(bytes.data(), bytes.size());
        ++count;
    }
    return count;
}

} // namespace

int main(int argc, char **argv) {
    for (const Target &target : kTargets) {
        if (argc < 3 || target.name != argv[1])
            continue;
        int count = 0;
        for (int i = 2; i < argc; ++i)
            count += RunFolder(target, std::filesystem::path(argv[i]) / target.name);
        std::printf("%d inputs of %s\n", count, argv[1]);
        return count > 0 ? 0 : 1;
    }
    std::fputs("usage: fuzz_replay TARGET FOLDER...\n", stderr);
    return 2;
}
