#!/usr/bin/env python3
# GPL-2.0-or-later. Compiles the shaders of libs/directional and libs/shgrid.
"""usage: compile_shaders.py GLSLANG LIBRARY LIBS PAGE...

GLSLANG: glslangValidator. LIBRARY: directional or shgrid. LIBS: the folder of the libraries. The GLSL and the HLSL of the
library are compiled with a main function that calls them, GLSL for the oldest and newest versions that it is meant for.
A function of libs/directional that is not called is a fault, and so is GLSL on a PAGE of documentation that is not in
the files. Exit status 77, for a skipped test, if GLSLANG is not there.
"""

import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

DIRECTIONAL_CALLS = """
    vec3 light = DecodeE5bgr9(uint(a.x)) + DecodeRgbe(a) + DecodeExp32(a);
    light += DeluxeLight(n, n, n) + DeluxeReceived(n, n, n, 0.25, n) + RnmWeights(n);
    light += RnmRaw(n, n, n, n) + RnmRescaled(n, n, n, n) + RnmSquared(n, n, n, n);
    light += SsbumpLight(n, n, n, n, 1.0) + SsbumpNormal(n) * SsbumpDynamic(n, n) + L1Light(n, n, n, n, n);
    light += L1LightWithFlat(n, n, n, n, n, n, n) + L1LightCurved(n, n, n, n, n) * L1CurvedChannel(1.0, n, n);
    light += LightmassColor(a, a, a, 0.0, 0.01858136) * LightmassFactor(a, a, a, n);
    light += LightmassHigh(a, a, a, a, a, a, n) + LightmassLow(a, a, a, a, a, a, n);
    light += SkyOcclusion(a) * Unoccluded(a.x);
"""
DIRECTIONAL_GLSL = """
in vec4 a;
in vec3 n;
out vec4 result;
void main()
{%s    result = vec4(light, 1.0);
}
""" % DIRECTIONAL_CALLS
DIRECTIONAL_HLSL = """
float4 main(float4 a : TEXCOORD0, float3 n : TEXCOORD1) : SV_Target
{%s    return float4(light, 1.0);
}
""" % DIRECTIONAL_CALLS.replace("vec3", "float3")
SHGRID_GLSL = """
uniform usampler3D indirection;
uniform sampler3D t[7];
uniform usampler3D names;
uniform sampler3D shares;
uniform sampler2D table;
uniform vec3 mins, cell, bounds, bricks;
uniform vec3 numbers;
uniform vec3 sh[9];
uniform vec4 directions[8];
uniform vec3 colors[8];
uniform int count;
uniform float tone[7];
in vec3 position;
in vec3 normal;
out vec4 result;
void main()
{
    ShgridAtlas atlas = ShgridAtlas(mins, cell, bounds, bricks, numbers.x, numbers.y, numbers.z);
    vec3 light = ShgridHalf(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], atlas, position, normal);
    light += ShgridSnorm(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], atlas, position, normal);
    light += ShgridHalfLights(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], names, shares, table, atlas,
                              position, normal);
    ShgridGrid grid = ShgridGrid(mins, cell, bounds);
    light += ShgridLightAt(t[0], t[1], t[2], t[3], t[4], t[5], t[6], grid, position, normal) + ShgridLight(sh, normal);
    light += ShgridShade(sh, directions, colors, count, normal);
    light = ShgridApplyTone(ShgridTone(tone[0], tone[1], tone[2], tone[3], tone[4], tone[5], tone[6]), light);
    result = vec4(light, 1.0);
}
"""
SHGRID_HLSL = """
Texture3D<uint4> indirection : register(t0);
Texture3D<float4> t1 : register(t1);
Texture3D<float4> t2 : register(t2);
Texture3D<float4> t3 : register(t3);
Texture3D<float4> t4 : register(t4);
Texture3D<float4> t5 : register(t5);
Texture3D<float4> t6 : register(t6);
Texture3D<float4> t7 : register(t7);
Texture3D<uint4> names : register(t8);
Texture3D<float4> shares : register(t9);
Texture2D<float4> table : register(t10);
SamplerState filter : register(s0);
cbuffer Constants : register(b0) { ShgridAtlas atlas; ShgridGrid grid; ShgridTone tone; float3 sh[9]; float4 directions[8]; float3 colors[8]; int count; };
float4 main(float3 position : TEXCOORD0, float3 normal : TEXCOORD1) : SV_Target
{
    float3 light = ShgridHalf(indirection, t1, t2, t3, t4, t5, t6, t7, filter, atlas, position, normal);
    light += ShgridSnorm(indirection, t1, t2, t3, t4, t5, t6, t7, filter, atlas, position, normal);
    light += ShgridHalfLights(indirection, t1, t2, t3, t4, t5, t6, t7, names, shares, table, filter, atlas, position,
                              normal);
    light += ShgridLightAt(t1, t2, t3, t4, t5, t6, t7, filter, grid, position, normal) + ShgridLight(sh, normal);
    light += ShgridShade(sh, directions, colors, count, normal);
    light = ShgridApplyTone(tone, light);
    return float4(light, 1.0);
}
"""


@dataclass
class Library:
    names: tuple  # of files without suffix, in the order in which they include each other
    glsl: str     # main functions
    hlsl: str
    precise: tuple = ("float", "int")  # types that need a precision in GLSL ES
    each_is_called: bool = False       # the main functions call every function of the files


LIBRARIES = {
    "directional": Library(("directional",), DIRECTIONAL_GLSL, DIRECTIONAL_HLSL, each_is_called=True),
    "shgrid": Library(("shgrid", "shgrid_atlas"), SHGRID_GLSL, SHGRID_HLSL, ("float", "int", "sampler2D", "sampler3D", "usampler3D")),
}


def compiled(glslang, name, text, *options):
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / name
        source.write_text(text)
        done = subprocess.run([glslang, *options, str(source)], capture_output=True, text=True, cwd=folder)
    if done.returncode or "ERROR" in done.stdout or "WARNING" in done.stdout:
        print(f"{name}, {' '.join(options)}: {text.splitlines()[0]}\n{done.stdout}{done.stderr}")
        return False
    return True


def uncalled(text, main):
    return [name for name in re.findall(r"^\w+ (\w+)\(", text, re.MULTILINE) if f"{name}(" not in main]


def faults(glslang, name, folder, pages):
    """What is wrong besides what the compiler says; whether all compiled."""
    library = LIBRARIES[name]
    glsl, hlsl = ("".join((folder / f"{part}.{kind}").read_text() for part in library.names) for kind in ("glsl", "hlsl"))
    found = []
    if library.each_is_called:
        found = [f"{function} is called by no test" for function in uncalled(glsl, library.glsl) + uncalled(hlsl, library.hlsl)]
    for page in pages:
        quotes = re.findall(r"```glsl\n(.*?)```", page.read_text(), re.DOTALL)
        if not quotes:
            found.append(f"{page}: no GLSL")
        found += [f"{page}: not in the files:\n{quote}" for quote in quotes if quote not in glsl]
    good = True
    precision = "".join(f"precision highp {kind};\n" for kind in library.precise)
    for version in ("130\n", "330 core\n", "460 core\n", f"300 es\n{precision}"):
        good &= compiled(glslang, f"{name}.frag", f"#version {version}{glsl}{library.glsl}")
    good &= compiled(glslang, f"{name}.hlsl", hlsl + library.hlsl, "-D", "-V", "-S", "frag", "-e", "main", "-o", f"{name}.spv")
    return found, good


def main():
    if len(sys.argv) < 5 or sys.argv[2] not in LIBRARIES:
        sys.exit(__doc__)
    glslang, name, libs, *pages = sys.argv[1:]
    if not Path(glslang).exists():
        print("skipped: glslangValidator (Debian: glslang-tools) is not installed")
        sys.exit(77)
    found, good = faults(glslang, name, Path(libs) / name, [Path(page) for page in pages])
    for fault in found:
        print(fault)
    sys.exit(0 if good and not found else 1)


if __name__ == "__main__":
    main()
