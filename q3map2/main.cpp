// GPL-2.0-or-later. Arguments to exit status.
#include "q3map2/stages.h"

#include <system_error>

int main(int argc, char **argv) {
    std::error_code failed;
    auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
    if (failed)
        program = argv[0];
    q3::Log log;
    return q3::RunProgram({argv + 1, argv + argc}, program, log);
}
