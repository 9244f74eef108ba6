// GPL-2.0-or-later. Arguments to exit status.
#include "common/platform/platform.h"
#include "q3map2/cli/program.h"
#include "q3map2/stages/stages.h"

#include <new>

int main(int argc, char **argv) {
    try {
        const q3::ProcessStart start = q3::StartProcess(argc, argv);
        q3::Log log;
        return q3::RunProgram(q3::Stages(), start.arguments, start.program, log);
    } catch (const std::bad_alloc &) { // before the run could begin
        q3::WriteError("************ ERROR ************\nout of memory\n");
        return 1;
    }
}
