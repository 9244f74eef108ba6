// GPL-2.0-or-later. Arguments to exit status.
#include "common/platform/platform.h"
#include "q3map2/cli/program.h"
#include "q3map2/stages/stages.h"

#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>

namespace {

void PrintOutOfMemory() {
    for (const std::string_view part : {q3::kErrorHeader, q3::kOutOfMemory, std::string_view("\n")})
        q3::WriteError(part);
}

std::terminate_handler usualHandler;

/// TBB, which Embree uses, ends the process if it gets no memory to start its work. A run without memory still ends
/// with its error line, and not as a crash; files are only replaced at its end.
void EndOrCrash() {
    constexpr std::size_t kLittle = std::size_t(1) << 12; // bytes
    void *const volatile memory = std::malloc(kLittle);
    if (!memory) {
        PrintOutOfMemory();
        std::_Exit(1);
    }
    std::free(memory);
    usualHandler();
}

} // namespace

int main(int argc, char **argv) {
    usualHandler = std::set_terminate(EndOrCrash);
    try {
        const q3::ProcessStart start = q3::StartProcess(argc, argv);
        q3::Log log;
        return q3::RunProgram(q3::Stages(), start.arguments, start.program, log);
    } catch (const std::bad_alloc &) { // before the run could begin
        PrintOutOfMemory();
        return 1;
    }
}
