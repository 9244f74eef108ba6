#!/usr/bin/env python3
# GPL-2.0-or-later. Compiles the decoders of directional lightmaps as shaders.
"""usage: compile_shaders.py GLSLANG FOLDER PAGE

GLSLANG: glslangValidator. FOLDER: that of directional.glsl and directional.hlsl. Each is compiled with a main function
that calls every function of the file, for the oldest and newest versions that it is meant for. A function that is not
called is a fault, and so is GLSL on PAGE, a page of documentation, that is not in the file. Exit status 77, for a
skipped test, if GLSLANG is not there.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

CALLS = """
    vec3 light = DecodeE5bgr9(uint(a.x)) + DecodeRgbe(a) + DecodeExp32(a);
    light += DeluxeLight(n, n, n) + DeluxeReceived(n, n, n, 0.25, n) + RnmWeights(n);
    light += RnmRaw(n, n, n, n) + RnmRescaled(n, n, n, n) + RnmSquared(n, n, n, n);
    light += SsbumpLight(n, n, n, n, 1.0) + SsbumpNormal(n) * SsbumpDynamic(n, n) + L1Light(n, n, n, n, n);
    light += L1LightWithFlat(n, n, n, n, n, n, n) + L1LightCurved(n, n, n, n, n) * L1CurvedChannel(1.0, n, n);
    light += LightmassColor(a, a, a, 0.0, 0.01858136) * LightmassFactor(a, a, a, n);
    light += LightmassHigh(a, a, a, a, a, a, n) + LightmassLow(a, a, a, a, a, a, n);
    light += SkyOcclusion(a) * Unoccluded(a.x);
"""
GLSL_MAIN = """
in vec4 a;
in vec3 n;
out vec4 result;
void main()
{%s    result = vec4(light, 1.0);
}
""" % CALLS
HLSL_MAIN = """
float4 main(float4 a : TEXCOORD0, float3 n : TEXCOORD1) : SV_Target
{%s    return float4(light, 1.0);
}
""" % CALLS.replace("vec3", "float3")


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
    glsl, hlsl = (folder / "directional.glsl").read_text(), (folder / "directional.hlsl").read_text()
    good = True
    for text in (glsl, hlsl):
        for name in re.findall(r"^\w+ (\w+)\(", text, re.MULTILINE):
            if f"{name}(" not in CALLS:
                print(f"{name} is called by no test")
                good = False
    for version in ("130", "330 core", "460 core"):
        good &= compiled(glslang, "directional.frag", f"#version {version}\n{glsl}{GLSL_MAIN}")
    quotes = re.findall(r"```glsl\n(.*?)```", page.read_text(), re.DOTALL)
    good &= bool(quotes)
    for quote in quotes:
        if quote not in glsl:
            print(f"{page}: not in directional.glsl:\n{quote}")
            good = False
    precision = "precision highp float;\nprecision highp int;\n"
    good &= compiled(glslang, "directional.frag", f"#version 300 es\n{precision}{glsl}{GLSL_MAIN}")
    good &= compiled(glslang, "directional.hlsl", hlsl + HLSL_MAIN, "-D", "-V", "-S", "frag", "-e", "main", "-o",
                     "directional.spv")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
