#!/usr/bin/env python3
# GPL-2.0-or-later. Compiles the C of the pages for engine programmers.
"""usage: page_structs.py COMPILER SOURCE_FOLDER

The structs of docs/reference/bsp_format.md have the sizes of the records in files, and the code of the pages about the SH
grid compiles with the header of libs/shgrid.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Bytes of each struct.
SIZES = {
    "BspSlot": 8, "BspFileHeader": 144, "BspPlane": 16, "BspNode": 36, "BspLeaf": 48, "BspModel": 40,
    "BspDrawVert": 44, "BspSurface": 104, "BspGridPoint": 8, "RbspBrushSide": 12, "RbspDrawVert": 80,
    "RbspSurface": 148, "RbspGridPoint": 30, "BspxHeader": 8, "BspxEntry": 32, "GridSHHeader": 40, "GridSHPoint": 108,
    "SparseHeader": 64, "SparseNode": 12, "SparsePoint": 28, "NamedHeader": 96, "NamedLight": 116, "NamedPolygon": 44,
    "NamedVertex": 12, "NamedNode": 20, "NamedPoint": 28, "CubeHeader": 16, "CubeLeaf": 4, "CubeColor": 4,
    "CubeSample": 28, "OctreeHeader": 45, "OctreeNode": 44, "OctreeLeaf": 24, "OctreeColor": 4, "GridsLeaf": 25,
    "GridsEntry": 2, "RnmHeader": 20, "RnmPage": 4, "PropLightHeader": 20, "PropLight": 20, "PropMesh": 8,
}
# Bytes before members that follow others of several sizes.
OFFSETS = {
    ("NamedLight", "intensity"): 40, ("NamedLight", "fadeFrom"): 56, ("NamedLight", "cosInner"): 76,
    ("NamedLight", "spread"): 92, ("NamedLight", "nearest"): 96, ("NamedLight", "coneFade"): 100,
    ("NamedLight", "name"): 112, ("NamedHeader", "reserved"): 84, ("OctreeHeader", "root"): 37,
    ("RbspSurface", "lightmapOrigin"): 92,
}
# What an engine has, for the code of the pages.
ENGINE = """#include <stdint.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include "shgrid.h"
#define Com_Printf printf
extern const char *ValueForKey(const void *, const char *);
extern const void *worldspawn;
extern void *Alloc(size_t);
extern float lightOrigin[3], normal[3];
extern const char *pattern[64];
extern int frame;
"""


def blocks(page):
    return re.findall(r"```c\n(.*?)```", page.read_text(), re.DOTALL)


def compiles(compiler, code, *options):
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "page.c"
        source.write_text(code)
        done = subprocess.run([compiler, "-Wall", "-Wextra", *options, "-fsyntax-only", str(source)],
                              capture_output=True, text=True)
    print(done.stderr, end="")
    return done.returncode == 0


def main():
    compiler, source = sys.argv[1], Path(sys.argv[2])
    structs = "\n".join(blocks(source / "docs/reference/bsp_format.md"))
    unknown = set(re.findall(r"^struct (\w+)", structs, re.MULTILINE)) ^ set(SIZES)
    if unknown:
        print(f"only on the page or only in this test: {', '.join(sorted(unknown))}")
    asserts = [f'_Static_assert(sizeof(struct {name}) == {size}, "{name}");' for name, size in SIZES.items()]
    asserts += [f'_Static_assert(offsetof(struct {name}, {member}) == {at}, "{name}.{member}");'
                for (name, member), at in OFFSETS.items()]
    good = compiles(compiler, "#include <stddef.h>\n" + structs + "\n".join(asserts), "-std=c11", "-Werror")
    engines = source / "docs/engines"
    start, *sample = blocks(engines / "quick_start.md")
    switch, declarations = blocks(engines / "named_lights.md")[:2]
    rest = [*sample, *blocks(engines / "tone.md"), declarations, switch, *blocks(engines / "textures.md")]
    body = "\n".join(line for block in rest for line in block.splitlines() if not line.startswith("#include"))
    code = f"{ENGINE}#include \"shgrid_atlas.h\"\n{start}void f(void)\n{{\n{body}\n}}\n"
    good &= compiles(compiler, code, "-std=c99", f"-I{source}/libs/shgrid")
    print(f"{len(SIZES)} structs, {len(rest) + 1} blocks of code")
    return 0 if good and not unknown else 1


if __name__ == "__main__":
    sys.exit(main())
