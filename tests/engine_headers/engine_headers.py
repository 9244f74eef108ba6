#!/usr/bin/env python3
"""GPL-2.0-or-later. The headers for engines, as an engine programmer takes them: each file alone, and the first snippet
of C in each README.

usage: engine_headers.py COMPILER LIBS

COMPILER: a C compiler that knows -std=c99 -Wpedantic. LIBS: the folder of the libraries. Each header is copied to an
empty folder, with the one that it includes, and compiled as C99 without warnings; all of them are compiled together;
the search of BSPX lumps that they hold is that of bspx/bspx.h, byte for byte."""
import pathlib
import re
import subprocess
import sys
import tempfile

# Whether each searches a file for lumps.
HEADERS = {
    "bspx/bspx.h": True,
    "shgrid/shgrid.h": True,
    "shgrid/shgrid_atlas.h": False,
    "ambientcubes/ambient_cubes.h": True,
    "staticprops/staticprops.h": True,
    "hdrlight/hdrlight.h": True,
    "directional/directional.h": False,
}
# Headers that include each other.
NEEDS = {"shgrid/shgrid.h": "shgrid/shgrid_atlas.h", "shgrid/shgrid_atlas.h": "shgrid/shgrid.h"}
WITHOUT = {"shgrid/shgrid.h": "SHGRID_NO_ATLAS"}  # the macro that leaves the other one out
# What the snippets take from the engine.
ENGINE = """#include <stdint.h>
#include <stddef.h>
#include <stdio.h>
extern const void *file, *model;
extern size_t fileBytes, modelBytes;
extern const char *valueOf_q3map2_tone;
extern float origin[3], normal[3], tangentNormal[3];
extern uint32_t texels[3], entityNumber, vertex;
extern int32_t lightmapNum;
uint32_t leafOf(const float position[3]);
void upload(const unsigned char *codes, uint32_t side);
"""
BLOCK = re.compile(r"/\* ---- bspx\.h: begin ---- \*/\n.*?/\* ---- bspx\.h: end ---- \*/\n", re.S)


def compiles(compiler, folder, name, source):
    (folder / name).write_text(source)
    run = subprocess.run([compiler, "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", name],
                         cwd=folder, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(f"{name}:\n{run.stderr}")
    return run.returncode == 0


def snippet_of(readme):
    found = re.search(r"^```c\n(.*?)^```", readme.read_text(), re.S | re.M)
    if not found:
        sys.exit(f"{readme} has no snippet of C")
    lines = found.group(1).splitlines()
    includes = [line for line in lines if line.startswith("#include")]
    return "\n".join(includes + ["void snippet(void);", "void snippet(void) {"] +
                     [line for line in lines if not line.startswith("#include")] + ["}"]) + "\n"


def main():
    compiler, libs = sys.argv[1], pathlib.Path(sys.argv[2])
    block = BLOCK.search((libs / "bspx/bspx.h").read_text()).group(0)
    good = True
    with tempfile.TemporaryDirectory() as work:
        together = pathlib.Path(work)
        for header, searches in HEADERS.items():
            path = libs / header
            text = path.read_text()
            if BLOCK.findall(text) != ([block] if searches else []):
                print(f"{header}: its search of BSPX lumps is not that of bspx/bspx.h")
                good = False
            (together / path.name).write_text(text)
            with tempfile.TemporaryDirectory() as alone:
                folder = pathlib.Path(alone)
                (folder / path.name).write_text(text)
                if header in WITHOUT:
                    good &= compiles(compiler, folder, "without.c",
                                     f'#define {WITHOUT[header]}\n#include "{path.name}"\nint engine;\n')
                if header in NEEDS:
                    (folder / pathlib.Path(NEEDS[header]).name).write_text((libs / NEEDS[header]).read_text())
                good &= compiles(compiler, folder, "alone.c", f'#include "{path.name}"\nint engine;\n')
                good &= compiles(compiler, folder, f"{path.parent.name}_readme.c",
                                 ENGINE + snippet_of(path.parent / "README.md"))
        good &= compiles(compiler, together, "together.c",
                         "".join(f'#include "{pathlib.Path(header).name}"\n' for header in HEADERS) + "int engine;\n")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
