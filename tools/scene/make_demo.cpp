// GPL-2.0-or-later. Program: writes the demo arena into a game folder.
#include "common/error.h"
#include "tools/scene/demo_scene.h"

#include <cstdio>
#include <exception>

int main(int argc, char **argv) {
    if (argc != 2) {
        std::fputs("usage: make_demo OUTDIR\nWrites OUTDIR/maps/demo.bsp, demo.map and OUTDIR/scripts/demo.shader\n",
                   stderr);
        return 1;
    }
    try {
        q3::Log log;
        q3::WriteDemo(argv[1], log);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "make_demo: %s\n", error.what());
        return 1;
    }
}
