#!/usr/bin/env python3
# GPL-2.0-or-later. Compiles the light and the sampling of SH grids as shaders.
"""usage: compile_shaders.py GLSLANG FOLDER PAGE

GLSLANG: glslangValidator. FOLDER: that of shgrid.glsl, shgrid_atlas.glsl and their HLSL, which are compiled with a main
function that calls them, for the oldest and newest versions that they are meant for. GLSL on PAGE, a page of
documentation, that is not in the files is a fault. Exit status 77, for a skipped test, if GLSLANG is not there.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

GLSL_MAIN = """
uniform usampler3D indirection;
uniform sampler3D t[7];
uniform vec3 mins, cell, bounds, bricks;
uniform vec3 numbers;
uniform vec3 sh[9];
uniform float tone[7];
in vec3 position;
in vec3 normal;
out vec4 result;
void main()
{
    ShgridAtlas atlas = ShgridAtlas(mins, cell, bounds, bricks, numbers.x, numbers.y, numbers.z);
    vec3 light = ShgridHalf(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], atlas, position, normal);
    light += ShgridSnorm(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], atlas, position, normal);
    ShgridGrid grid = ShgridGrid(mins, cell, bounds);
    light += ShgridLightAt(t[0], t[1], t[2], t[3], t[4], t[5], t[6], grid, position, normal) + ShgridLight(sh, normal);
    light = ShgridApplyTone(ShgridTone(tone[0], tone[1], tone[2], tone[3], tone[4], tone[5], tone[6]), light);
    result = vec4(light, 1.0);
}
"""
HLSL_MAIN = """
Texture3D<uint4> indirection : register(t0);
Texture3D<float4> t1 : register(t1);
Texture3D<float4> t2 : register(t2);
Texture3D<float4> t3 : register(t3);
Texture3D<float4> t4 : register(t4);
Texture3D<float4> t5 : register(t5);
Texture3D<float4> t6 : register(t6);
Texture3D<float4> t7 : register(t7);
SamplerState filter : register(s0);
cbuffer Constants : register(b0) { ShgridAtlas atlas; ShgridGrid grid; ShgridTone tone; float3 sh[9]; };
float4 main(float3 position : TEXCOORD0, float3 normal : TEXCOORD1) : SV_Target
{
    float3 light = ShgridHalf(indirection, t1, t2, t3, t4, t5, t6, t7, filter, atlas, position, normal);
    light += ShgridSnorm(indirection, t1, t2, t3, t4, t5, t6, t7, filter, atlas, position, normal);
    light += ShgridLightAt(t1, t2, t3, t4, t5, t6, t7, filter, grid, position, normal) + ShgridLight(sh, normal);
    light = ShgridApplyTone(tone, light);
    return float4(light, 1.0);
}
"""


def compiled(glslang, name, text, *options):
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / name
        source.write_text(text)
        done = subprocess.run([glslang, *options, str(source)], capture_output=True, text=True, cwd=folder)
    if done.returncode or "ERROR" in done.stdout or "WARNING" in done.stdout:
        print(f"{name}, {' '.join(options)}: {text.splitlines()[0]}\n{done.stdout}{done.stderr}")
        return False
    return True


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    glslang, folder, page = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    if not Path(glslang).exists():
        print("skipped: glslangValidator (Debian: glslang-tools) is not installed")
        sys.exit(77)
    glsl, hlsl = (
        "".join((folder / f"{name}.{kind}").read_text() for name in ("shgrid", "shgrid_atlas")) for kind in ("glsl", "hlsl"))
    quotes = re.findall(r"```glsl\n(.*?)```", page.read_text(), re.DOTALL)
    good = bool(quotes)
    for quote in quotes:
        if quote not in glsl:
            print(f"{page}: not in shgrid.glsl or shgrid_atlas.glsl:\n{quote}")
            good = False
    for version in ("130", "330 core", "460 core"):
        good &= compiled(glslang, "shgrid.frag", f"#version {version}\n{glsl}{GLSL_MAIN}")
    kinds = ("float", "int", "sampler3D", "usampler3D")
    precision = "".join(f"precision highp {kind};\n" for kind in kinds)
    good &= compiled(glslang, "shgrid.frag", f"#version 300 es\n{precision}{glsl}{GLSL_MAIN}")
    good &= compiled(glslang, "shgrid.hlsl", hlsl + HLSL_MAIN, "-D", "-V", "-S", "frag", "-e", "main", "-o", "shgrid.spv")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
