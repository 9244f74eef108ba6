# GPL-2.0-or-later. The GLSL of renderer 2 compiles with the shaders of libs/shgrid in all its forms.
"""compile_shaders.py GLSLANG ROOT: glslangValidator and the folder of the project. Exit status 77 without GLSLANG."""
import itertools
import subprocess
import sys
import tempfile
from pathlib import Path

MAIN = """
in vec3 normal, position;
out vec4 result;
void main()
{
    result = vec4(SHGridLight(normalize(normal), position), 1.0);
}
"""
TEXTURES = "#define USE_SHGRID_TEXTURES\n"
SPARSE = TEXTURES + "#define USE_SHGRID_SPARSE\n"
NAMES = SPARSE + "#define USE_SHGRID_LIGHTS\n#define USE_SHGRID_NAMES\n"
FORMS = ("", "#define USE_SHGRID_LIGHTS\n", TEXTURES, SPARSE, NAMES)
TONES = ("", "#define USE_SHGRID_TONE\n")
LIGHTS = ("", "#define USE_LIGHT\n#define USE_PBR\n")


def main():
    glslang, root = sys.argv[1], Path(sys.argv[2])
    if not Path(glslang).exists():
        print("skipped: glslangValidator (Debian: glslang-tools) is not installed")
        return 77
    library = "".join((root / "libs/shgrid" / name).read_text() for name in ("shgrid.glsl", "shgrid_atlas.glsl"))
    light = (root / "tools/engines/ioquake3/source/code/renderergl2/glsl/shgrid_light.glsl").read_text()
    good = True
    for version, *defines in itertools.product(("130", "150"), FORMS, TONES, LIGHTS):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder) / "light.frag"
            source.write_text(f"#version {version}\n{''.join(defines)}{library}{light}{MAIN}")
            done = subprocess.run([glslang, source], capture_output=True, text=True)
        if done.returncode or "ERROR" in done.stdout or "WARNING" in done.stdout:
            print(f"{version}, {defines}:\n{done.stdout}{done.stderr}")
            good = False
    return 0 if good else 1


sys.exit(main())
