# GPL-2.0-or-later. What is added to ioquake3 for the SH light grid, place by place.
"""Lines are written without the indentation of their place. An empty line at their start or end is one of them."""

from edits import In, after, before, need, replace, start

VERSION = replace(r"([\w.>-]+)\s*!=\s*BSP_VERSION\b", r"\g<0> && \g<1> != BSP_VERSION_SHGRID")

COMMON = [
    In("code/qcommon/qfiles.h", "",
       after(r"^#define\s+BSP_VERSION\b",
             "#define BSP_VERSION_SHGRID\t47\t// the same 17 lumps, and an SH light grid in lump 18")),
    In("code/qcommon/cm_load.c", "CM_LoadMap", VERSION),
]

# In both renderers alike.
BOTH = [
    # After the world and its models.
    In("tr_backend.c", "",
       before(r"\br_drawSun->integer\b", "RB_ShowSHGrid();\n")),

    # The grid is read before the header is swapped, since the reader takes the bytes of the file.
    In("tr_bsp.c", "RE_LoadWorldMap",
       before(r"\bdheader_t\s*\*\s*header\s*;", "long\t\tlength;"),
       replace(r"ri\.FS_ReadFile\b", r"length = \g<0>"),
       VERSION,
       after(r"!=\s*BSP_VERSION\b", """
R_LoadSHGrid( name, buffer.b, length, r_mapOverBrightBits->integer - tr.overbrightBits );""")),

    In("tr_init.c", "R_Register",
       before(r"ri\.Cmd_AddCommand\b", "R_RegisterSHGrid();\n", pick="first")),

    # An entity or point that the SH grid lights goes past the legacy grid, and past the light that makes up for what
    # the legacy grid loses.
    In("tr_light.c", "R_SetupEntityLighting",
       replace(r"\bif\s*\(\s*!\s*\(\s*refdef->rdflags\s*&\s*RDF_NOWORLDMODEL\b", r"""
if ( R_SetupSHGridEntity( &ent->shGrid, !( refdef->rdflags & RDF_NOWORLDMODEL ), refdef->time,
		lightOrigin, ent->ambientLight, ent->directedLight, ent->lightDir ) ) {
	// the SH grid stores all light: no minimum is added
} else \g<0>""".lstrip()),
       replace(r"\b(if\s*\(\s*)1\b", r"\g<1>!ent->shGrid.lit"),
       after(r"\bVectorMA\s*\(\s*lightDir\s*,\s*d\s*,\s*dir\b", """
VectorMA( ent->shGrid.dynamicLight, d, dl->color, ent->shGrid.dynamicLight );
VectorMA( ent->shGrid.dynamicDir, d, dir, ent->shGrid.dynamicDir );""".lstrip())),
    In("tr_light.c", "R_LightForPoint",
       after(r"\btrRefEntity_t\s+ent\s*;", "shgrid_lighting lighting;"),
       before(r"\btr\.world->lightGridData\s*==\s*NULL", """
if ( R_SHGridAt( point, tr.refdef.time, &lighting ) ) {
	R_SHGridSplit( &lighting, ambientLight, directedLight, lightDir );
	return qtrue;
}
""".lstrip())),

    In("tr_local.h", "",
       after(r'^#include\s+".*\btr_common\.h"', '#include "../renderercommon/tr_shgrid.h"')),
    In("tr_local.h", "trRefEntity_t",
       after(r"\bdirectedLight\s*;", "shGridEntity_t\tshGrid;")),
]

RENDERER1 = [
    In("tr_init.c", "R_Register",
       after(r"ri\.Cmd_AddCommand\b", 'ri.Cmd_AddCommand( "shgridspeed", R_SHGridSpeed_f );', pick="last")),
    In("tr_init.c", "RE_Shutdown",
       after(r"ri\.Cmd_RemoveCommand\b", 'ri.Cmd_RemoveCommand( "shgridspeed" );\nR_FreeSHGrid();', pick="last")),

    In("tr_light.c", "R_SetupEntityLighting",
       after(r"\bent->lightDir\[2\]\s*=", """
if ( ent->shGrid.lit ) {
	R_TurnEntitySHGrid( ent );
}""".lstrip())),

    In("tr_local.h", "",
       after(r"^int\s+R_LightForPoint\b", """
void R_TurnEntitySHGrid( trRefEntity_t *ent );
void R_SHGridSpeed_f( void );
void RB_CalcSHGridColor( unsigned char *colors );
void RB_ShowSHGrid( void );""".lstrip())),

    # Before it chooses the AltiVec version, which has the legacy light only.
    In("tr_shade_calc.c", "RB_CalcDiffuseColor",
       start("""
if ( backEnd.currentEntity->shGrid.lit ) {
	RB_CalcSHGridColor( colors );
	return;
}""".lstrip())),
]

RENDERER2 = [
    # Engines before October 2017 lack one of these.
    In("../renderercommon/qgl.h", "",
       need(r"\bqglesMajorVersion\b", "it tells OpenGL ES from OpenGL"),
       need(r"\bProgramUniform1fvEXT\b", "it sets uniforms")),

    In("tr_bsp.c", "RE_LoadWorldMap",
       after(r"!=\s*BSP_VERSION\b", "R_InitSHGrid();")),

    # What the engine's own programs are made by, for the programs with the grid.
    In("tr_glsl.c", "",
       replace(r"^(?:static\s+)?(int\s+GLSL_InitGPUShader2\b)", r"\g<1>")),
    In("tr_glsl.c", "GLSL_ShutdownGPUShaders",
       before(r"\bFOGDEF_COUNT\b", "R_ShutdownSHGrid();\n")),

    In("tr_init.c", "RE_Shutdown",
       after(r"ri\.Cmd_RemoveCommand\b", "R_FreeSHGrid();", pick="last")),

    In("tr_local.h", "",
       after(r"^int\s+R_LightForPoint\b", """
void R_InitSHGrid( void );
void R_ShutdownSHGrid( void );
shaderProgram_t *GLSL_SHGridProgram( shaderProgram_t *sp );
void RB_ShowSHGrid( void );
mnode_t *R_PointInLeaf( const vec3_t p );""".lstrip()),
       after(r"^void\s+GLSL_InitGPUShaders\b", """
int GLSL_InitGPUShader2(shaderProgram_t *program, const char *name, int attribs, const char *vpCode, const char *fpCode);
void GLSL_InitUniforms(shaderProgram_t *program);
void GLSL_FinishGPUShader(shaderProgram_t *program);
void GLSL_DeleteGPUShader(shaderProgram_t *program);""".lstrip())),

    # Entities that the grid lights get its program.
    In("tr_shade.c", "RB_IterateStagesGeneric",
       before(r"\bGLSL_BindProgram\s*\(", """
if (pStage->rgbGen == CGEN_LIGHTING_DIFFUSE && !backEnd.depthFill)
	sp = GLSL_SHGridProgram(sp);
""".lstrip())),

    # For the colors of r_showshgrid 2.
    In("tr_world.c", "",
       replace(r"^(?:static\s+)?(mnode_t\s*\*\s*R_PointInLeaf\b)", r"\g<1>")),

    # USE_SHGRID is defined for the programs with the grid only.
    In("glsl/generic_vp.glsl", "",
       after(r"^uniform\s+float\s+u_PortalRange\b", """
#if defined(USE_SHGRID)
uniform mat4   u_ModelMatrix;
#endif""".lstrip())),
    In("glsl/generic_vp.glsl", "CalcColor",
       after(r"\bcolor\.rgb\s*=.*\bu_DirectedLight\b", """
#if defined(USE_SHGRID)
color.rgb = u_BaseColor.rgb * SHGridLight(normalize(mat3(u_ModelMatrix) * normal), vec3(u_ModelMatrix * vec4(position, 1.0)));
#endif""".lstrip())),

    In("glsl/lightall_vp.glsl", "main",
       before(r"\bvar_Color\.rgb\s*\*=.*\bu_AmbientLight\b", """
    #if defined(USE_SHGRID)
var_Color.rgb *= SHGridLight(normalize(normal), position);
    #else""".lstrip("\n")),
       after(r"\bvar_Color\.rgb\s*\*=.*\bu_AmbientLight\b", "    #endif"),
       before(r"\bvar_ColorAmbient\.rgb\s*=.*\bu_AmbientLight\b", """
    #if defined(USE_SHGRID)
var_ColorAmbient.rgb = var_Color.rgb;
    #else""".lstrip("\n")),
       after(r"\bvar_ColorAmbient\.rgb\s*=.*\bu_AmbientLight\b", "    #endif")),

    In("glsl/lightall_fp.glsl", "",
       before(r"^uniform\s+int\s+u_AlphaTest\b", """
#if defined(USE_SHGRID)
uniform vec3      u_ViewOrigin;
#endif
""".lstrip())),
    In("glsl/lightall_fp.glsl", "main",
       after(r"\breflectance\s*=\s*CalcDiffuse\b", """
  #if defined(USE_SHGRID)
// the light vector is for the highlight only
reflectance = vec3(0.0);
ambientColor *= SHGridLight(N, u_ViewOrigin - viewDir);
  #endif""", pick="first")),
]

# Lists of sources by build system, which is known by the first file. A tree must have one of them, and may have both.
BUILDS = [
    [
        In("cmake/renderer_common.cmake", "",
           after(r"renderercommon/tr_noise\.c", "${SOURCE_DIR}/renderercommon/tr_shgrid.c")),
        In("cmake/renderer_gl1.cmake", "",
           after(r"renderergl1/tr_shadows\.c", "${SOURCE_DIR}/renderergl1/tr_shgrid_gl1.c")),
        In("cmake/renderer_gl2.cmake", "",
           after(r"renderergl2/tr_shadows\.c", "${SOURCE_DIR}/renderergl2/tr_shgrid_gl2.c"),
           need(r"\bGLOB\b.*\.glsl\b", "it puts the GLSL files into the build")),
    ],
    [
        In("Makefile", "",
           after(r"renderergl1/tr_shadows\.o", "$(B)/renderergl1/tr_shgrid.o \\\n$(B)/renderergl1/tr_shgrid_gl1.o \\"),
           after(r"renderergl2/tr_shadows\.o", "$(B)/renderergl2/tr_shgrid.o \\\n$(B)/renderergl2/tr_shgrid_gl2.o \\"),
           after(r"renderergl2/glsl/shadowmask_vp\.o", """
$(B)/renderergl2/glsl/shgrid.o \\
$(B)/renderergl2/glsl/shgrid_atlas.o \\
$(B)/renderergl2/glsl/shgrid_light.o \\""".lstrip()),
           # Releases are built with -ffast-math, and the check for damaged grids needs NaN and infinity.
           before(r"^\$\(B\)/renderergl1/%\.o:\s*\$\(RCOMMONDIR\)", """
$(B)/renderergl1/tr_shgrid.o $(B)/renderergl2/tr_shgrid.o: override OPTIMIZE += -fno-finite-math-only
""".lstrip())),
    ],
]
