/*
===========================================================================
SPDX-License-Identifier: GPL-2.0-or-later

The SH light grid in renderer 2: programs that evaluate it, 3D textures, and drawing of the points.
===========================================================================
*/
// tr_shgrid_gl2.c

#ifdef USE_INTERNAL_SDL_HEADERS
#	include "SDL.h"
#else
#	include <SDL.h>
#endif

#include "tr_local.h"
#include "tr_dsa.h"
#include "../renderercommon/shgrid_atlas.h"

#include <stdlib.h>

#ifndef GL_TEXTURE_3D
#define GL_TEXTURE_3D			0x806F
#define GL_TEXTURE_WRAP_R		0x8072
#define GL_MAX_3D_TEXTURE_SIZE	0x8073
#endif
#ifndef GL_RGBA8UI
#define GL_RGBA8UI				0x8D7C
#define GL_RGBA_INTEGER			0x8D99
#endif
#ifndef GL_RGBA16UI
#define GL_RGBA16UI				0x8D76
#endif
#ifndef GL_RGBA32F
#define GL_RGBA32F				0x8814
#endif
#ifndef GL_ACTIVE_TEXTURE
#define GL_ACTIVE_TEXTURE		0x84E0
#endif
#ifndef GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS
#define GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS	0x8B4C
#endif

// texture units after those that the engine uses, so that the textures can stay bound
#define	TB_SHGRIDMAP			NUM_TEXTURE_BUNDLES
#define	SHGRID_MAPS				7
#define	TB_SHGRIDINDIRECTION	( TB_SHGRIDMAP + SHGRID_MAPS )
#define	TB_SHGRIDNAMES			( TB_SHGRIDMAP + SHGRID_MAPS + 1 )
#define	TB_SHGRIDSHARES			( TB_SHGRIDMAP + SHGRID_MAPS + 2 )
#define	TB_SHGRIDTABLE			( TB_SHGRIDMAP + SHGRID_MAPS + 3 )
#define	SHGRID_TEXTURES			( SHGRID_MAPS + 4 )
#define	SHGRID_TEXTURES_PLAIN	( SHGRID_MAPS + 1 )		// without those that keep the names of lights
#define	SHGRID_NAME_GROUPS		( SHGRID_BRICK_NAMES / 4 )	// texels of names and shares have four lights each

#define	SHGRID_ENTITY_FLOATS	33
#define	SHGRID_LIGHT_FLOATS		7		// direction, spread, color
#define	SHGRID_LIGHTS_FLOATS	( 1 + SHGRID_LIGHT_FLOATS * SHGRID_ENTITY_LIGHTS )

extern const char *fallbackShader_shgrid;
extern const char *fallbackShader_shgrid_atlas;
extern const char *fallbackShader_shgrid_light;

typedef void (APIENTRY *texImage3D_t)( GLenum target, GLint level, GLint internalFormat, GLsizei width, GLsizei height,
	GLsizei depth, GLint border, GLenum format, GLenum type, const GLvoid *pixels );

// a lightall or generic program with the light of the grid
typedef struct {
	shaderProgram_t	sp;
	GLint	entityUniform, lightsUniform;
	float	entity[SHGRID_ENTITY_FLOATS];	// the last that were set
	float	lights[SHGRID_LIGHTS_FLOATS];
} shGridProgram_t;

static struct {
	shGridProgram_t	lightall[LIGHTDEF_COUNT];
	shGridProgram_t	generic[GENERICDEF_COUNT];
	GLuint			textures[SHGRID_TEXTURES];		// 0: none
	shgrid_atlas	atlas;							// count is 0 for a uniform grid
	qboolean		named;							// the textures keep the names of lights
	float			styles[SHGRID_STYLES];			// as they are in the table of lights
} sh;

static cvar_t	*r_shgridTextures;

/*
=============================================================================

LIGHT OF ENTITIES

=============================================================================
*/

/*
=================
GLSL_SetSHGridLights

Lights that the grid names: their number, then each of them
=================
*/
static void GLSL_SetSHGridLights( shGridProgram_t *program, const shgrid_lighting *lighting ) {
	float	values[SHGRID_LIGHTS_FLOATS], *to = values + 1;
	int		i, size;

	values[0] = lighting->count;
	for ( i = 0 ; i < lighting->count ; i++, to += SHGRID_LIGHT_FLOATS ) {
		VectorCopy( lighting->direct[i].direction, to );
		to[3] = lighting->direct[i].spread;
		VectorCopy( lighting->direct[i].color, to + 4 );
	}

	size = to - values;
	if ( memcmp( values, program->lights, size * sizeof( float ) ) ) {
		Com_Memcpy( program->lights, values, size * sizeof( float ) );
		qglProgramUniform1fvEXT( program->sp.program, program->lightsUniform, size, values );
	}
}

/*
=================
GLSL_SetSHGridEntity
=================
*/
static void GLSL_SetSHGridEntity( shGridProgram_t *program, const trRefEntity_t *ent ) {
	float	values[SHGRID_ENTITY_FLOATS];
	float	most = MAX( ent->shGrid.dynamicLight[0], MAX( ent->shGrid.dynamicLight[1], ent->shGrid.dynamicLight[2] ) );

	Com_Memcpy( values, ent->shGrid.lighting.rest.c, sizeof( ent->shGrid.lighting.rest.c ) );
	VectorScale( ent->shGrid.dynamicLight, 1.0f / MAX( most, 255.0f ), values + 27 );
	VectorNormalize2( ent->shGrid.dynamicDir, values + 30 );

	if ( memcmp( values, program->entity, sizeof( values ) ) ) {
		Com_Memcpy( program->entity, values, sizeof( values ) );
		qglProgramUniform1fvEXT( program->sp.program, program->entityUniform, SHGRID_ENTITY_FLOATS, values );
	}
	if ( program->lightsUniform >= 0 ) {
		GLSL_SetSHGridLights( program, &ent->shGrid.lighting );
	}
}

/*
=================
R_SetSHGridStyles

Puts the brightness of the light styles into the table of lights whenever it changes
=================
*/
static void R_SetSHGridStyles( int time ) {
	const float	*styles = R_SHGridStyles( time );
	GLint	unit;

	if ( !memcmp( styles, sh.styles, sizeof( sh.styles ) ) ) {
		return;
	}

	Com_Memcpy( sh.styles, styles, sizeof( sh.styles ) );
	qglGetIntegerv( GL_ACTIVE_TEXTURE, &unit );
	qglActiveTexture( GL_TEXTURE0 + TB_SHGRIDTABLE );
	qglTexSubImage2D( GL_TEXTURE_2D, 0, 0, 0, SHGRID_STYLE_TEXELS, 1, GL_RGBA, GL_FLOAT, sh.styles );
	qglActiveTexture( unit );
}

/*
=================
GLSL_SHGridProgram

The program that draws the current entity: sp, or its counterpart with the grid if the grid lights the entity
=================
*/
shaderProgram_t *GLSL_SHGridProgram( shaderProgram_t *sp ) {
	const trRefEntity_t	*ent = backEnd.currentEntity;
	shGridProgram_t		*program;

	if ( !ent || !ent->shGrid.lit ) {
		return sp;
	}

	if ( sp >= tr.lightallShader && sp < tr.lightallShader + LIGHTDEF_COUNT ) {
		program = &sh.lightall[sp - tr.lightallShader];
	} else {
		program = &sh.generic[sp - tr.genericShader];
	}
	if ( !program->sp.program ) {
		return sp;
	}

	GLSL_SetSHGridEntity( program, ent );
	if ( sh.named ) {
		R_SetSHGridStyles( backEnd.refdef.time );
	}
	return &program->sp;
}

/*
=============================================================================

PROGRAMS

=============================================================================
*/

/*
=================
GLSL_SHGridSource

The source of one of the engine's shaders with that of the grid after its header. To be freed with ri.Free
=================
*/
static char *GLSL_SHGridSource( GLuint shader, const char *defines ) {
	static const char	marker[] = "#line 0\n";
	const char	*parts[] = { defines, fallbackShader_shgrid, fallbackShader_shgrid_atlas, fallbackShader_shgrid_light, marker };
	char	*source, *end;
	GLint	size = 0;
	int		i, added = 0;

	qglGetShaderiv( shader, GL_SHADER_SOURCE_LENGTH, &size );
	for ( i = 0 ; i < ARRAY_LEN( parts ) ; i++ ) {
		added += strlen( parts[i] );
	}

	source = ri.Malloc( size + added + 1 );
	qglGetShaderSource( shader, size, NULL, source );
	source[size] = 0;
	end = strstr( source, marker );
	if ( !end ) {
		ri.Error( ERR_DROP, "GLSL_SHGridSource: a shader without a header" );
	}

	end += strlen( marker );
	memmove( end + added, end, strlen( end ) + 1 );
	for ( i = 0 ; i < ARRAY_LEN( parts ) ; i++ ) {
		Com_Memcpy( end, parts[i], strlen( parts[i] ) );
		end += strlen( parts[i] );
	}
	return source;
}

/*
=================
GLSL_SetSHGridConstants

Uniforms that are the same for the whole map
=================
*/
static void GLSL_SetSHGridConstants( GLuint program ) {
	const shgrid_tone	*tone = &shGridWorld.tone;
	const shgrid_grid	*grid = &shGridWorld.grid;
	const qboolean		radiance = shGridWorld.isRadiance;
	const float	toneValues[9] = { tone->contrast, 1 / tone->gamma, tone->exposure, tone->saturation, tone->scale,
		tone->maxlight / 255, tone->srgb ? 1 : 0, shGridWorld.limit, shGridWorld.scale / 255 };
	const float	placeValues[16] = { grid->mins[0], grid->mins[1], grid->mins[2], grid->cell[0], grid->cell[1], grid->cell[2],
		grid->bounds[0], grid->bounds[1], grid->bounds[2], sh.atlas.bricks[0], sh.atlas.bricks[1], sh.atlas.bricks[2],
		ldexp( 1, sh.atlas.shift ), radiance ? M_PI : 1, radiance ? 2 * M_PI / 3 : 1, radiance ? M_PI / 4 : 1 };
	int		i;

	qglProgramUniform1fvEXT( program, qglGetUniformLocation( program, "u_SHGridTone" ), 9, toneValues );
	if ( !sh.textures[0] ) {
		return;
	}

	qglProgramUniform1fvEXT( program, qglGetUniformLocation( program, "u_SHGridPlace" ), 16, placeValues );
	for ( i = 0 ; i < SHGRID_MAPS ; i++ ) {
		qglProgramUniform1iEXT( program, qglGetUniformLocation( program, va( "u_SHGridMap%i", i ) ), TB_SHGRIDMAP + i );
	}
	if ( sh.atlas.count ) {
		qglProgramUniform1iEXT( program, qglGetUniformLocation( program, "u_SHGridIndirection" ), TB_SHGRIDINDIRECTION );
	}
	if ( sh.named ) {
		qglProgramUniform1iEXT( program, qglGetUniformLocation( program, "u_SHGridNames" ), TB_SHGRIDNAMES );
		qglProgramUniform1iEXT( program, qglGetUniformLocation( program, "u_SHGridShares" ), TB_SHGRIDSHARES );
		qglProgramUniform1iEXT( program, qglGetUniformLocation( program, "u_SHGridTable" ), TB_SHGRIDTABLE );
	}
}

/*
=================
GLSL_InitSHGridProgram

Compiles the sources of one of the engine's programs again, with the light of the grid
=================
*/
static void GLSL_InitSHGridProgram( shGridProgram_t *program, const shaderProgram_t *like ) {
	char	defines[256];
	char	*vertex, *fragment;

	Com_sprintf( defines, sizeof( defines ), "#define USE_SHGRID\n%s%s%s%s%s", shGridWorld.hasTone ? "#define USE_SHGRID_TONE\n" : "",
		shGridWorld.grid.lights ? "#define USE_SHGRID_LIGHTS\n" : "", sh.textures[0] ? "#define USE_SHGRID_TEXTURES\n" : "",
		sh.atlas.count ? "#define USE_SHGRID_SPARSE\n" : "", sh.named ? "#define USE_SHGRID_NAMES\n" : "" );
	vertex = GLSL_SHGridSource( like->vertexShader, defines );
	fragment = GLSL_SHGridSource( like->fragmentShader, defines );
	GLSL_InitGPUShader2( &program->sp, va( "%s_shgrid", like->name ), like->attribs, vertex, fragment );
	ri.Free( fragment );
	ri.Free( vertex );

	GLSL_InitUniforms( &program->sp );
	GLSL_SetUniformInt( &program->sp, UNIFORM_DIFFUSEMAP, TB_DIFFUSEMAP );
	GLSL_SetUniformInt( &program->sp, UNIFORM_LIGHTMAP, TB_LIGHTMAP );
	GLSL_SetUniformInt( &program->sp, UNIFORM_NORMALMAP, TB_NORMALMAP );
	GLSL_SetUniformInt( &program->sp, UNIFORM_DELUXEMAP, TB_DELUXEMAP );
	GLSL_SetUniformInt( &program->sp, UNIFORM_SPECULARMAP, TB_SPECULARMAP );
	GLSL_SetUniformInt( &program->sp, UNIFORM_SHADOWMAP, TB_SHADOWMAP );
	GLSL_SetUniformInt( &program->sp, UNIFORM_CUBEMAP, TB_CUBEMAP );
	program->entityUniform = qglGetUniformLocation( program->sp.program, "u_SHGridEntity" );
	program->lightsUniform = qglGetUniformLocation( program->sp.program, "u_SHGridLights" );
	GLSL_SetSHGridConstants( program->sp.program );
	GLSL_FinishGPUShader( &program->sp );
}

/*
=============================================================================

3D TEXTURES

=============================================================================
*/

/*
=================
R_CreateSHGridTexture

Makes a texture and leaves it bound to its unit. texImage3D: NULL for a 2D texture
=================
*/
static void R_CreateSHGridTexture( texImage3D_t texImage3D, int unit, const int32_t size[3], GLenum internalFormat, const void *texels ) {
	const qboolean	isWhole = internalFormat == GL_RGBA8UI || internalFormat == GL_RGBA16UI;
	const GLenum	target = texImage3D ? GL_TEXTURE_3D : GL_TEXTURE_2D, format = isWhole ? GL_RGBA_INTEGER : GL_RGBA;
	const GLenum	filter = isWhole || !texImage3D ? GL_NEAREST : GL_LINEAR;
	const GLenum	type = internalFormat == GL_RGBA16F_ARB ? GL_HALF_FLOAT_ARB : internalFormat == GL_RGBA16UI ? GL_UNSIGNED_SHORT :
		internalFormat == GL_RGBA32F ? GL_FLOAT : GL_UNSIGNED_BYTE;
	GLuint	*texture = &sh.textures[unit - TB_SHGRIDMAP];

	qglGenTextures( 1, texture );
	qglActiveTexture( GL_TEXTURE0 + unit );
	qglBindTexture( target, *texture );
	if ( texImage3D ) {
		texImage3D( target, 0, internalFormat, size[0], size[1], size[2], 0, format, type, texels );
		qglTexParameteri( target, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE );
	} else {
		qglTexImage2D( target, 0, internalFormat, size[0], size[1], 0, format, type, texels );
	}
	qglTexParameteri( target, GL_TEXTURE_MIN_FILTER, filter );
	qglTexParameteri( target, GL_TEXTURE_MAG_FILTER, filter );
	qglTexParameteri( target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE );
	qglTexParameteri( target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE );
}

/*
=================
R_SHGridTextureProblem

Why the grid cannot be put into textures of that size; NULL if it can. Sets sh.named where the names of lights fit too
=================
*/
static const char *R_SHGridTextureProblem( texImage3D_t texImage3D, const int32_t size[3] ) {
	GLint	fragmentUnits = 0, vertexUnits = 0, mostTexels = 0;

	if ( !texImage3D ) {
		return "no glTexImage3D";
	}

	qglGetIntegerv( GL_MAX_TEXTURE_IMAGE_UNITS, &fragmentUnits );
	qglGetIntegerv( GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS, &vertexUnits );
	qglGetIntegerv( GL_MAX_3D_TEXTURE_SIZE, &mostTexels );
	if ( fragmentUnits < TB_SHGRIDMAP + SHGRID_TEXTURES_PLAIN || vertexUnits < SHGRID_TEXTURES_PLAIN ) {
		return "too few texture units";
	}
	if ( shGridWorld.grid.levels && !sh.atlas.count ) {
		return "no atlas holds all bricks";
	}
	if ( MAX( size[0], MAX( size[1], size[2] ) ) > mostTexels ) {
		return va( "%i x %i x %i texels, limit %i", size[0], size[1], size[2], mostTexels );
	}

	sh.named = sh.atlas.tableRows && fragmentUnits >= TB_SHGRIDMAP + SHGRID_TEXTURES && vertexUnits >= SHGRID_TEXTURES &&
		SHGRID_NAME_GROUPS * size[2] <= mostTexels && MAX( SHGRID_TABLE_WIDTH, sh.atlas.tableRows ) <= glConfig.maxTextureSize;
	if ( sh.atlas.tableRows && !sh.named ) {
		ri.Printf( PRINT_WARNING, "WARNING: SH light grid: textures hold named lights as coefficients: too few texture units, or too large\n" );
	}
	return NULL;
}

/*
=================
R_SHGridTextureBytes
=================
*/
static size_t R_SHGridTextureBytes( const int32_t size[3] ) {
	return (size_t)8 * SHGRID_MAPS * size[0] * size[1] * size[2] + shgrid_indirection_bytes( &sh.atlas ) +
		( sh.named ? shgrid_names_bytes( &sh.atlas ) + shgrid_shares_bytes( &sh.atlas ) + shgrid_table_bytes( &sh.atlas ) : 0 );
}

/*
=================
R_FillSHGridTextures

False: no memory. The zone of ri.Malloc is too small for large grids, and ends the game then
=================
*/
static qboolean R_FillSHGridTextures( texImage3D_t texImage3D, const int32_t size[3] ) {
	const size_t	bytes = (size_t)8 * size[0] * size[1] * size[2];
	const int32_t	names[3] = { sh.atlas.bricks[0], sh.atlas.bricks[1], SHGRID_NAME_GROUPS * sh.atlas.bricks[2] };
	const int32_t	shares[3] = { size[0], size[1], SHGRID_NAME_GROUPS * size[2] }, table[3] = { SHGRID_TABLE_WIDTH, sh.atlas.tableRows, 1 };
	byte	*texels = malloc( R_SHGridTextureBytes( size ) );
	byte	*indirection, *at;
	void	*maps[SHGRID_MAPS], *lights[3] = { NULL, NULL, NULL };
	GLint	unit;
	int		i;

	if ( !texels ) {
		return qfalse;
	}

	// all of these sizes but the last are multiples of 8 bytes
	at = texels;
	for ( i = 0 ; i < SHGRID_MAPS ; i++, at += bytes ) {
		maps[i] = at;
	}
	if ( sh.named ) {
		lights[0] = at;
		lights[1] = at += shgrid_names_bytes( &sh.atlas );
		lights[2] = at += shgrid_shares_bytes( &sh.atlas );
		at += shgrid_table_bytes( &sh.atlas );
	}
	indirection = at;
	if ( sh.named ) {
		shgrid_atlas_fill_lights( &shGridWorld.grid, &sh.atlas, indirection, maps, lights[0], lights[1], lights[2] );
	} else if ( sh.atlas.count ) {
		shgrid_atlas_fill( &shGridWorld.grid, &sh.atlas, SHGRID_ATLAS_HALF, indirection, maps );
	} else {
		shgrid_fill_half( &shGridWorld.grid, maps );
	}

	qglGetIntegerv( GL_ACTIVE_TEXTURE, &unit );
	for ( i = 0 ; i < SHGRID_MAPS ; i++ ) {
		R_CreateSHGridTexture( texImage3D, TB_SHGRIDMAP + i, size, GL_RGBA16F_ARB, maps[i] );
	}
	if ( sh.atlas.count ) {
		R_CreateSHGridTexture( texImage3D, TB_SHGRIDINDIRECTION, sh.atlas.entries, GL_RGBA8UI, indirection );
	}
	if ( sh.named ) {
		R_CreateSHGridTexture( texImage3D, TB_SHGRIDNAMES, names, GL_RGBA16UI, lights[0] );
		R_CreateSHGridTexture( texImage3D, TB_SHGRIDSHARES, shares, GL_RGBA8, lights[1] );
		R_CreateSHGridTexture( NULL, TB_SHGRIDTABLE, table, GL_RGBA32F, lights[2] );
		Com_Memcpy( sh.styles, lights[2], sizeof( sh.styles ) );
	}
	qglActiveTexture( unit );
	free( texels );
	return qtrue;
}

/*
=================
R_InitSHGridTextures
=================
*/
static void R_InitSHGridTextures( void ) {
	texImage3D_t	texImage3D = (texImage3D_t)SDL_GL_GetProcAddress( "glTexImage3D" );
	const char	*problem;
	int32_t		size[3];
	int			start = ri.Milliseconds();

	shgrid_atlas_measure( &shGridWorld.grid, &sh.atlas );
	VectorCopy( shGridWorld.grid.bounds, size );
	if ( sh.atlas.count ) {
		VectorScale( sh.atlas.bricks, SHGRID_BRICK_TEXELS, size );
	}

	problem = R_SHGridTextureProblem( texImage3D, size );
	if ( !problem && !R_FillSHGridTextures( texImage3D, size ) ) {
		problem = "no memory for them";
	}
	if ( problem ) {
		Com_Memset( &sh.atlas, 0, sizeof( sh.atlas ) );
		sh.named = qfalse;
		ri.Printf( PRINT_WARNING, "WARNING: SH light grid is not put into textures: %s\n", problem );
		return;
	}

	ri.Printf( PRINT_ALL, "SH light grid: 7 textures of %i x %i x %i%s, %.1f MB, in %i ms\n", size[0], size[1], size[2],
		sh.named ? ", and those of named lights" : "", R_SHGridTextureBytes( size ) / ( 1024.0f * 1024.0f ), ri.Milliseconds() - start );
}

/*
=================
R_InitSHGrid

Makes the textures and programs for the grid of a map that R_LoadSHGrid has loaded
=================
*/
void R_InitSHGrid( void ) {
	int		i, start = ri.Milliseconds(), count = 0;

	R_ShutdownSHGrid();
	r_shgridTextures = ri.Cvar_Get( "r_shgridTextures", "0", CVAR_ARCHIVE | CVAR_LATCH );
	if ( !shGridWorld.grid.points ) {
		return;
	}
	if ( qglesMajorVersion || ( glRefConfig.glslMajorVersion < 2 && glRefConfig.glslMinorVersion < 30 ) ) {
		ri.Printf( PRINT_WARNING, "WARNING: SH light grid needs OpenGL 3.0: entities get ambient and directed light made of it\n" );
		return;
	}

	R_IssuePendingRenderCommands();
	if ( r_shgridTextures->integer ) {
		R_InitSHGridTextures();
	}
	for ( i = 0 ; i < LIGHTDEF_COUNT ; i++ ) {
		if ( ( i & LIGHTDEF_LIGHTTYPE_MASK ) == LIGHTDEF_USE_LIGHT_VECTOR && tr.lightallShader[i].program ) {
			GLSL_InitSHGridProgram( &sh.lightall[i], &tr.lightallShader[i] );
			count++;
		}
	}
	for ( i = 0 ; i < GENERICDEF_COUNT ; i++ ) {
		if ( ( i & GENERICDEF_USE_RGBAGEN ) && tr.genericShader[i].program ) {
			GLSL_InitSHGridProgram( &sh.generic[i], &tr.genericShader[i] );
			count++;
		}
	}
	ri.Printf( PRINT_ALL, "SH light grid: %i programs, with all in %i ms\n", count, ri.Milliseconds() - start );
}

/*
=================
R_ShutdownSHGrid
=================
*/
void R_ShutdownSHGrid( void ) {
	int		i;

	for ( i = 0 ; i < LIGHTDEF_COUNT ; i++ ) {
		GLSL_DeleteGPUShader( &sh.lightall[i].sp );
	}
	for ( i = 0 ; i < GENERICDEF_COUNT ; i++ ) {
		GLSL_DeleteGPUShader( &sh.generic[i].sp );
	}
	if ( sh.textures[0] ) {
		qglDeleteTextures( SHGRID_TEXTURES, sh.textures );
	}
	Com_Memset( &sh, 0, sizeof( sh ) );
}

/*
=============================================================================

DRAWING OF THE GRID

=============================================================================
*/

/*
=================
RB_AddSphere
=================
*/
static void RB_AddSphere( const vec3_t origin ) {
	const shGridSphere_t	*sphere = R_SHGridSphere();
	shgrid_lighting	lighting;
	const float		*kind = NULL;
	int				i;

	RB_CHECKOVERFLOW( SHGRID_SPHERE_VERTEXES, SHGRID_SPHERE_INDEXES );

	R_SHGridSample( origin, backEnd.refdef.time, &lighting );
	if ( r_showshgrid->integer > 1 ) {
		kind = R_PointInLeaf( origin )->cluster == -1 ? colorRed : colorGreen;
	}

	for ( i = 0 ; i < SHGRID_SPHERE_INDEXES ; i++ ) {
		tess.indexes[tess.numIndexes++] = tess.numVertexes + sphere->indexes[i];
	}
	for ( i = 0 ; i < SHGRID_SPHERE_VERTEXES ; i++, tess.numVertexes++ ) {
		vec4_t	color;

		VectorMA( origin, SHGRID_SPHERE_RADIUS, sphere->normals[i], tess.xyz[tess.numVertexes] );
		VectorSet2( tess.texCoords[tess.numVertexes], 0, 0 );
		R_SHGridLight( &lighting, sphere->normals[i], color );
		VectorScale( color, 1.0f / 255.0f, color );
		if ( kind ) {
			VectorScale( color, 0.5f, color );
			VectorMA( color, 0.5f, kind, color );
		}
		color[3] = 1;
		R_VaoPackColor( tess.color[tess.numVertexes], color );
	}
}

/*
=================
RB_ShowSHGrid

Draws points of the grid near the viewer as white spheres lit by their own coefficients. With r_showshgrid 2 those in
the open are green, and those in solids, whose light is filled in, red; these can be seen through walls.
=================
*/
void RB_ShowSHGrid( void ) {
	static vec3_t	points[SHGRID_SPHERES];
	int				i, numPoints;

	if ( !r_showshgrid->integer || ( backEnd.refdef.rdflags & RDF_NOWORLDMODEL ) ) {
		return;
	}

	numPoints = R_SHGridNear( backEnd.viewParms.or.origin, SHGRID_RADIUS, SHGRID_SPHERES, points );
	backEnd.currentEntity = &tr.worldEntity;
	backEnd.or = backEnd.viewParms.world;
	if ( r_showshgrid->integer > 1 ) {
		qglDepthRange( 0, 0.3 );
	}
	RB_BeginSurface( R_FindShader( "*white", LIGHTMAP_BY_VERTEX, qfalse ), 0, 0 );
	for ( i = 0 ; i < numPoints ; i++ ) {
		RB_AddSphere( points[i] );
	}
	RB_EndSurface();
	qglDepthRange( 0, 1 );
}
