# GPL-2.0-or-later. tools/engines/ioquake3/apply on a tree that has the names which it looks for, and little else.
"""apply_test.py FOLDER: the folder of the integration."""

import subprocess
import sys
import tempfile
from pathlib import Path

SHARED = {
    "tr_backend.c": "void Draw(void) {\n\tWorld();\n\n\t// the sun\n\tif (r_drawSun->integer)\n\t\tSun();\n}\n",
    "tr_bsp.c": """\
// RE_LoadWorldMap( name ) { is called by the client; dheader_t *header; and ri.FS_ReadFile are below
void RE_LoadWorldMap( const char *name ) {
  dheader_t *header;
  ri.FS_ReadFile(name, &buffer.v);
  if (i != BSP_VERSION) {
    Refuse("};");
  }
  Swap(header);
}
""",
    "tr_init.c": """\
void R_Register( void ) {
	Variables();
	// what follows is removed below
	ri.Cmd_AddCommand("a");
	ri.Cmd_AddCommand("b");
}
void RE_Shutdown( int all ) {
	ri.Cmd_RemoveCommand("a");
	ri.Cmd_RemoveCommand("b");
	Free();
}
""",
    "tr_light.c": """\
void R_SetupEntityLighting( refdef_t *refdef, trRefEntity_t *ent ) {
	if ( !( refdef->rdflags & RDF_NOWORLDMODEL ) && HasGrid() ) {
		Sample();
	}
	if ( 1 /* always */ ) {
		AddMinimum();
	}
	while ( More() ) {
		VectorMA( lightDir, d, dir, lightDir );
	}
	ent->lightDir[2] = Up();
}

int R_LightForPoint( void )
{
	trRefEntity_t ent;

	if (tr.world->lightGridData == NULL)
		return 0;
	return 1;
}
""",
    "tr_local.h": """\
#include "../renderercommon/tr_common.h"
typedef struct {
	float directedLight;
} trRefEntity_t;
int R_LightForPoint( void );
""",
}
TREE = {
    "Makefile": """\
one = $(B)/renderergl1/tr_shadows.o \\
  $(B)/renderergl1/last.o
two = $(B)/renderergl2/tr_shadows.o \\
  $(B)/renderergl2/glsl/shadowmask_vp.o \\
  $(B)/renderergl2/last.o
$(B)/renderergl1/%.o: $(RCOMMONDIR)/%.c
	build
""",
    "code/qcommon/qfiles.h": "#define BSP_VERSION 46\n",
    "code/qcommon/cm_load.c": "void CM_LoadMap(void) {\n\tif (h.version != BSP_VERSION) {\n\t\tRefuse();\n\t}\n}\n",
    "code/renderercommon/qgl.h": "int qglesMajorVersion;\nPROCEDURE(ProgramUniform1fvEXT)\n",
    "code/renderergl1/tr_shade_calc.c": "void RB_CalcDiffuseColor( byte *colors )\n{\n\tCalculate();\n}\n",
    "code/renderergl2/tr_glsl.c": """\
static int GLSL_InitGPUShader2(void) { return 1; }
void GLSL_ShutdownGPUShaders(void) {
	for (i = 0; i < FOGDEF_COUNT; i++)
		Delete();
}
""",
    "code/renderergl2/tr_shade.c": "void RB_IterateStagesGeneric(void) {\n\tGLSL_BindProgram(sp);\n}\n",
    "code/renderergl2/tr_world.c": "static mnode_t *R_PointInLeaf(void) {\n\treturn 0;\n}\n",
    "code/renderergl2/glsl/generic_vp.glsl": """\
uniform float u_PortalRange;
vec4 CalcColor(void) {
	color.rgb = u_DirectedLight;
}
""",
    "code/renderergl2/glsl/lightall_vp.glsl": """\
void main()
{
	var_Color.rgb *= u_AmbientLight;
	var_ColorAmbient.rgb = u_AmbientLight;
}
""",
    "code/renderergl2/glsl/lightall_fp.glsl": """\
uniform int u_AlphaTest;
void main()
{
	reflectance = CalcDiffuse();
	reflectance += CalcDiffuse();
}
""",
} | {f"code/renderergl{number}/{name}": text for number in (1, 2) for name, text in SHARED.items()}
TREE["code/renderergl2/tr_local.h"] += "void GLSL_InitGPUShaders(void);\n"

LIGHT = """\
void R_SetupEntityLighting( refdef_t *refdef, trRefEntity_t *ent ) {
	if ( R_SetupSHGridEntity( &ent->shGrid, !( refdef->rdflags & RDF_NOWORLDMODEL ), refdef->time,
			lightOrigin, ent->ambientLight, ent->directedLight, ent->lightDir ) ) {
		// the SH grid stores all light: no minimum is added
	} else if ( !( refdef->rdflags & RDF_NOWORLDMODEL ) && HasGrid() ) {
		Sample();
	}
	if ( !ent->shGrid.lit /* always */ ) {
		AddMinimum();
	}
	while ( More() ) {
		VectorMA( lightDir, d, dir, lightDir );
		VectorMA( ent->shGrid.dynamicLight, d, dl->color, ent->shGrid.dynamicLight );
		VectorMA( ent->shGrid.dynamicDir, d, dir, ent->shGrid.dynamicDir );
	}
	ent->lightDir[2] = Up();
}

int R_LightForPoint( void )
{
	trRefEntity_t ent;
	shgrid_lighting lighting;

	if ( R_SHGridAt( point, tr.refdef.time, &lighting ) ) {
		R_SHGridSplit( &lighting, ambientLight, directedLight, lightDir );
		return qtrue;
	}

	if (tr.world->lightGridData == NULL)
		return 0;
	return 1;
}
"""
BSP = """\
// RE_LoadWorldMap( name ) { is called by the client; dheader_t *header; and ri.FS_ReadFile are below
void RE_LoadWorldMap( const char *name ) {
  long\t\tlength;
  dheader_t *header;
  length = ri.FS_ReadFile(name, &buffer.v);
  if (i != BSP_VERSION && i != BSP_VERSION_SHGRID) {
    Refuse("};");
  }

  R_LoadSHGrid( name, buffer.b, length, r_mapOverBrightBits->integer - tr.overbrightBits );
  R_InitSHGrid();
  Swap(header);
}
"""


def write_tree(folder, tree):
    for name, text in tree.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(text.encode())


def read_tree(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes().decode()
            for path in folder.rglob("*") if path.is_file()}


def main():
    engine = Path(sys.argv[1])

    def apply(tree, *words):
        """What apply says of a tree, and its files then."""
        with tempfile.TemporaryDirectory() as folder:
            write_tree(Path(folder), tree)
            done = subprocess.run([sys.executable, engine / "apply", *words, folder], capture_output=True, text=True,
                                  check=False)
            return done.returncode, done.stdout, done.stderr, read_tree(Path(folder))

    status, _, said, changed = apply(TREE)
    assert status == 0, said
    assert changed["code/renderergl2/tr_light.c"] == LIGHT, changed["code/renderergl2/tr_light.c"]
    assert changed["code/renderergl2/tr_bsp.c"] == BSP, changed["code/renderergl2/tr_bsp.c"]
    assert "\tRB_ShowSHGrid();\n\n\t// the sun\n" in changed["code/renderergl1/tr_backend.c"]
    assert changed["code/renderergl2/tr_world.c"].startswith("mnode_t *R_PointInLeaf")
    for source in (engine / "source").rglob("*.[ch]"):
        name = source.relative_to(engine / "source").as_posix()
        assert changed[name] == source.read_text()
        if name.endswith(".c"):
            assert f"/{source.stem}.o" in changed["Makefile"], f"{name} is in no list of sources"
    assert "code/renderercommon/shgrid.h" in changed and "code/renderercommon/shgrid_atlas.h" in changed

    # CMake's lists of sources, and line ends of Windows.
    lists = {"cmake/renderer_common.cmake": "    a/renderercommon/tr_noise.c\n",
             "cmake/renderer_gl1.cmake": "    a/renderergl1/tr_shadows.c\n",
             "cmake/renderer_gl2.cmake": "    a/renderergl2/tr_shadows.c\nfile(GLOB names a/*.glsl)\n"}
    windows = {name: text.replace("\n", "\r\n") for name, text in (TREE | lists).items() if name != "Makefile"}
    status, _, said, converted = apply(windows)
    assert status == 0, said
    assert converted["code/renderergl2/tr_light.c"] == LIGHT.replace("\n", "\r\n")
    assert "\r\n    ${SOURCE_DIR}/renderergl1/tr_shgrid_gl1.c\r\n" in converted["cmake/renderer_gl1.cmake"]

    status, patch, said, left = apply(TREE, "--diff")
    assert status == 0 and left == TREE, said
    assert "--- a/code/qcommon/cm_load.c\n+++ b/code/qcommon/cm_load.c\n" in patch and "+R_SHGridLight\n" in patch

    # Refused, and nothing is changed: a second time, a part of the change, a place that is missing or there twice.
    twice = TREE["code/qcommon/cm_load.c"].replace("Refuse();", "Warn(h.version != BSP_VERSION);")
    for tree, words in (
            (changed, ["is applied already"]),
            (TREE | {"code/renderergl1/tr_bsp.c": BSP}, ["holds a part", "in code/renderergl1/tr_bsp.c;"]),
            (TREE | {"code/renderergl1/tr_light.c": SHARED["tr_light.c"].replace("R_LightForPoint", "R_LightAt")},
             ["code/renderergl1/tr_light.c, R_LightForPoint: there is no R_LightForPoint."]),
            (TREE | {"code/renderergl2/tr_shade.c": "void RB_IterateStagesGeneric(void) {\n}\n"},
             ["code/renderergl2/tr_shade.c, RB_IterateStagesGeneric: nothing matches", "GLSL_BindProgram",
              "\n    \tsp = GLSL_SHGridProgram(sp);"]),
            (TREE | {"code/qcommon/cm_load.c": twice}, ["code/qcommon/cm_load.c, CM_LoadMap: 2 places match"]),
            ({name: text for name, text in TREE.items() if name != "code/renderergl2/tr_world.c"},
             ["code/renderergl2/tr_world.c: there is no such file."]),
            ({name: text for name, text in TREE.items() if name != "Makefile"}, ["Makefile", "how is it built?"])):
        status, _, said, left = apply(tree)
        assert status == 1 and left == tree, said
        for word in words:
            assert word in said, said


main()
