/*
===========================================================================
SPDX-License-Identifier: GPL-2.0-or-later

The SH light grid of the map: loading, sampling, and the scale of lightmaps.
===========================================================================
*/
// tr_shgrid.c

#include "tr_shgrid.h"
#include <stdlib.h>

#if defined( __FINITE_MATH_ONLY__ ) && __FINITE_MATH_ONLY__
#error "the check for damaged grids needs NaN and infinity: compile without -ffast-math and -ffinite-math-only"
#endif

#define	LUMP_SHGRID		18

// constants of the basis, see shgrid_evaluate
#define	SH_BAND0	0.282094791773878f
#define	SH_BAND1	0.488602511902920f
#define	SH_XY		1.092548430592079f
#define	SH_ZZ		0.315391565252520f
#define	SH_XX_YY	0.546274215296040f

cvar_t	*r_shgrid;
cvar_t	*r_showshgrid;
cvar_t	*r_shgridStyles;

shGridWorld_t	shGridWorld;

// the lump. Not on the hunk: a large grid would exhaust it, which is a fatal error
static	byte	*shGridBytes;

/*
===============
R_FreeSHGrid
===============
*/
void R_FreeSHGrid( void ) {
	free( shGridBytes );
	shGridBytes = NULL;
	Com_Memset( &shGridWorld, 0, sizeof( shGridWorld ) );
}

/*
===============
R_RegisterSHGrid
===============
*/
void R_RegisterSHGrid( void ) {
	r_shgrid = ri.Cvar_Get( "r_shgrid", "1", CVAR_ARCHIVE );
	r_showshgrid = ri.Cvar_Get( "r_showshgrid", "0", CVAR_CHEAT );
	r_shgridStyles = ri.Cvar_Get( "r_shgridStyles", "m", 0 );
}

/*
===============
R_ParseSHGridKeys

Reads the keys of worldspawn that describe the grid
===============
*/
static void R_ParseSHGridKeys( const char *entities ) {
	char	*p, *token;
	char	key[MAX_TOKEN_CHARS];

	p = (char *)entities;
	token = COM_ParseExt( &p, qtrue );
	if ( *token != '{' ) {
		return;
	}

	while ( 1 ) {
		token = COM_ParseExt( &p, qtrue );
		if ( !*token || *token == '}' ) {
			return;
		}
		Q_strncpyz( key, token, sizeof( key ) );

		token = COM_ParseExt( &p, qtrue );
		if ( !Q_stricmp( key, "_q3map2_sh" ) ) {
			shGridWorld.isRadiance = !Q_stricmp( token, "radiance" );
		} else if ( !Q_stricmp( key, "_q3map2_tone" ) ) {
			shgrid_result	result = shgrid_parse_tone( token, &shGridWorld.tone );

			shGridWorld.hasTone = result == SHGRID_OK;
			if ( result != SHGRID_OK ) {
				ri.Printf( PRINT_WARNING, "WARNING: _q3map2_tone ignored: %s\n", shgrid_message( result ) );
			}
		}
	}
}

/*
===============
R_SHGridForm

Where the lump was found
===============
*/
static const char *R_SHGridForm( const byte *file, const byte *lump ) {
	if ( shGridWorld.grid.lights ) {
		return "BSPX LIGHTGRID_SH_LIGHTS";
	}
	if ( shGridWorld.grid.levels ) {
		return "BSPX LIGHTGRID_SH_SPARSE";
	}
	if ( lump - file == LittleLong( ((const int *)file)[2 + 2 * LUMP_SHGRID] ) ) {
		return "lump 18";
	}
	return "BSPX LIGHTGRID_SH";
}

/*
===============
R_LoadSHGrid
===============
*/
void R_LoadSHGrid( const char *mapName, const byte *file, long fileBytes, int shift ) {
	const byte		*lump;
	size_t			lumpBytes;
	shgrid_result	result;

	R_FreeSHGrid();
	shGridWorld.scale = ldexpf( 255.0f, shift );
	shGridWorld.limit = MIN( 1.0f, 255.0f / shGridWorld.scale );
	shgrid_parse_tone( NULL, &shGridWorld.tone );

	// check the file's own bytes first, so that a damaged grid takes no memory
	result = shgrid_find( file, fileBytes, &lump, &lumpBytes );
	if ( result == SHGRID_OK ) {
		result = shgrid_parse( lump, lumpBytes, &shGridWorld.grid );
	}
	if ( result == SHGRID_ABSENT ) {
		return;
	}
	if ( result != SHGRID_OK ) {
		ri.Printf( PRINT_WARNING, "WARNING: SH light grid of %s ignored: %s\n", mapName, shgrid_message( result ) );
		return;
	}

	shGridBytes = malloc( lumpBytes );
	if ( !shGridBytes ) {
		ri.Printf( PRINT_WARNING, "WARNING: SH light grid of %s ignored: no memory for it\n", mapName );
		R_FreeSHGrid();
		return;
	}
	Com_Memcpy( shGridBytes, lump, lumpBytes );
	shgrid_parse( shGridBytes, lumpBytes, &shGridWorld.grid );

	R_ParseSHGridKeys( (const char *)file + LittleLong( ((const int *)file)[2] ) );

	ri.Printf( PRINT_ALL, "SH light grid: %s, %i points, %.2f MB%s\n", R_SHGridForm( file, lump ),
		shGridWorld.grid.count, (float)lumpBytes / ( 1024.0f * 1024.0f ), shGridWorld.isRadiance ? ", radiance" : "" );
}

/*
===============
R_SHGridStyleWord

One word of r_shgridStyles; tenth: the tenth of a second
===============
*/
static void R_SHGridStyleWord( const char *word, unsigned tenth, float styles[SHGRID_STYLES] ) {
	const char	*letters = strchr( word, ':' );
	int			first = 1, last = SHGRID_STYLES - 1, style;
	float		brightness;
	char		letter;

	if ( letters ) {
		first = last = atoi( word );
		word = letters + 1;
	}
	if ( !*word || first < 0 || last >= SHGRID_STYLES ) {
		return;
	}

	letter = word[tenth % strlen( word )];
	brightness = letter >= 'a' && letter <= 'z' ? ( letter - 'a' ) / 12.0f : letter == '0' ? 0 : 1;
	for ( style = first ; style <= last ; style++ ) {
		styles[style] = brightness;
	}
}

/*
===============
R_SHGridStyles
===============
*/
const float *R_SHGridStyles( int time ) {
	static float	styles[SHGRID_STYLES];
	static int		lastTenth, lastCount = -1;
	char	*p, *token;
	int		i;

	// the words are read anew only when the letter changes, or they do
	if ( lastCount == r_shgridStyles->modificationCount && lastTenth == time / 100 ) {
		return styles;
	}
	lastCount = r_shgridStyles->modificationCount;
	lastTenth = time / 100;

	for ( i = 0 ; i < SHGRID_STYLES ; i++ ) {
		styles[i] = 1;
	}
	p = r_shgridStyles->string;
	while ( *( token = COM_ParseExt( &p, qtrue ) ) ) {
		R_SHGridStyleWord( token, (unsigned)lastTenth, styles );
	}
	return styles;
}

/*
===============
R_SHGridSample
===============
*/
void R_SHGridSample( const vec3_t origin, int time, shgrid_lighting *lighting ) {
	shgrid_lights( &shGridWorld.grid, origin, shGridWorld.grid.lights ? R_SHGridStyles( time ) : NULL, lighting );
	shgrid_limit_lights( lighting, SHGRID_ENTITY_LIGHTS );
	if ( shGridWorld.isRadiance ) {
		shgrid_convolve( &lighting->rest );
	}
}

/*
===============
R_SHGridAt
===============
*/
qboolean R_SHGridAt( const vec3_t origin, int time, shgrid_lighting *lighting ) {
	if ( !shGridWorld.grid.points || !r_shgrid->integer ) {
		return qfalse;
	}
	R_SHGridSample( origin, time, lighting );
	return qtrue;
}

/*
===============
R_SetupSHGridEntity
===============
*/
qboolean R_SetupSHGridEntity( shGridEntity_t *ent, qboolean hasWorld, int time, const vec3_t origin,
	vec3_t ambient, vec3_t directed, vec3_t dir ) {
	VectorClear( ent->dynamicLight );
	VectorClear( ent->dynamicDir );
	ent->lit = hasWorld && R_SHGridAt( origin, time, &ent->lighting );
	if ( ent->lit ) {
		R_SHGridSplit( &ent->lighting, ambient, directed, dir );
	}
	return ent->lit;
}

/*
===============
R_SHGridNear
===============
*/
int R_SHGridNear( const vec3_t origin, float radius, int max, vec3_t *points ) {
	size_t	count;

	if ( !shGridWorld.grid.points ) {
		return 0;
	}

	while ( ( count = shgrid_points_near( &shGridWorld.grid, origin, radius, max, points ) ) > (size_t)max ) {
		radius *= 0.875f;
	}
	return (int)count;
}

/*
===============
R_SHGridTurnCoeffs

Band 1 is a vector, and band 2 is n . M n with a symmetric, traceless matrix M: in model axes its elements are
axis[i] . M axis[j]
===============
*/
static void R_SHGridTurnCoeffs( const shgrid_coeffs *in, const vec3_t unit[3], shgrid_coeffs *out ) {
	int		i, c;

	for ( c = 0 ; c < 3 ; c++ ) {
		const vec3_t	linear = { in->c[3][c], in->c[1][c], in->c[2][c] };
		const float		xy = 0.5f * SH_XY * in->c[4][c], yz = 0.5f * SH_XY * in->c[5][c], xz = 0.5f * SH_XY * in->c[7][c];
		const float		zz = SH_ZZ * in->c[6][c], xx_yy = SH_XX_YY * in->c[8][c];
		const vec3_t	rows[3] = { { xx_yy - zz, xy, xz }, { xy, -xx_yy - zz, yz }, { xz, yz, 2 * zz } };
		vec3_t			turned[3];	// M axis[i]

		for ( i = 0 ; i < 3 ; i++ ) {
			VectorSet( turned[i], DotProduct( rows[0], unit[i] ), DotProduct( rows[1], unit[i] ), DotProduct( rows[2], unit[i] ) );
		}

		out->c[0][c] = in->c[0][c];
		out->c[1][c] = DotProduct( linear, unit[1] );
		out->c[2][c] = DotProduct( linear, unit[2] );
		out->c[3][c] = DotProduct( linear, unit[0] );
		out->c[4][c] = DotProduct( unit[0], turned[1] ) * ( 2 / SH_XY );
		out->c[5][c] = DotProduct( unit[1], turned[2] ) * ( 2 / SH_XY );
		out->c[6][c] = DotProduct( unit[2], turned[2] ) * ( 0.5f / SH_ZZ );
		out->c[7][c] = DotProduct( unit[0], turned[2] ) * ( 2 / SH_XY );
		out->c[8][c] = ( DotProduct( unit[0], turned[0] ) - DotProduct( unit[1], turned[1] ) ) * ( 0.5f / SH_XX_YY );
	}
}

/*
===============
R_SHGridTurn
===============
*/
void R_SHGridTurn( shgrid_lighting *lighting, const vec3_t axis[3] ) {
	const shgrid_coeffs	rest = lighting->rest;
	vec3_t	unit[3];
	int		i;

	for ( i = 0 ; i < 3 ; i++ ) {
		VectorNormalize2( axis[i], unit[i] );
	}

	R_SHGridTurnCoeffs( &rest, (const vec3_t *)unit, &lighting->rest );
	for ( i = 0 ; i < lighting->count ; i++ ) {
		float			*to = lighting->direct[i].direction;
		const vec3_t	dir = { to[0], to[1], to[2] };

		VectorSet( to, DotProduct( dir, unit[0] ), DotProduct( dir, unit[1] ), DotProduct( dir, unit[2] ) );
	}
}

/*
===============
R_SHGridBytes

Turns linear light into what R_ColorShiftLightingBytes makes of the lightmap texel that the compiler stores for it
===============
*/
static void R_SHGridBytes( vec3_t rgb ) {
	float	most;

	if ( shGridWorld.hasTone ) {
		shgrid_apply_tone( &shGridWorld.tone, rgb );
	}

	// the plain tone limits light to 1, so one limit is enough; scale all channels alike to keep the hue
	most = MAX( rgb[0], MAX( rgb[1], rgb[2] ) );
	VectorScale( rgb, most > shGridWorld.limit ? shGridWorld.scale * shGridWorld.limit / most : shGridWorld.scale, rgb );
}

/*
===============
R_SHGridLight
===============
*/
void R_SHGridLight( const shgrid_lighting *lighting, const vec3_t normal, vec3_t rgb ) {
	shgrid_shade( lighting, normal, rgb );
	R_SHGridBytes( rgb );
}

/*
===============
R_SHGridLightMany
===============
*/
void R_SHGridLightMany( const shgrid_lighting *lighting, const float *normals, int stride, int count, vec3_t *rgb ) {
	int		i;

	shgrid_shade_many( lighting, normals, stride, count, rgb[0], 3 );
	for ( i = 0 ; i < count ; i++ ) {
		R_SHGridBytes( rgb[i] );
	}
}

/*
===============
R_SHGridStrongest

The light that the grid names which is stronger than the light of the rest from one direction, and than all others.
NULL: there is none
===============
*/
static const shgrid_direct *R_SHGridStrongest( const shgrid_lighting *lighting ) {
	const shgrid_direct	*strongest = NULL;
	vec3_t	linear;
	float	most;
	int		i;

	for ( i = 0 ; i < 3 ; i++ ) {
		const float	*band = lighting->rest.c[i + 1];

		linear[i] = band[0] + band[1] + band[2];
	}
	most = 2 * SH_BAND1 * VectorNormalize( linear );

	for ( i = 0 ; i < lighting->count ; i++ ) {
		const float	*color = lighting->direct[i].color;

		if ( color[0] + color[1] + color[2] > most ) {
			strongest = &lighting->direct[i];
			most = color[0] + color[1] + color[2];
		}
	}
	return strongest;
}

/*
===============
R_SHGridSplit

The clamped cosine has the mean 1/4 and band 1 is 1/2 n . dir
===============
*/
void R_SHGridSplit( const shgrid_lighting *lighting, vec3_t ambient, vec3_t directed, vec3_t dir ) {
	const shgrid_direct	*strongest = R_SHGridStrongest( lighting );
	vec3_t	mean, linear[3];	// of all but the strongest light: mean, and coefficients of band 1 as a vector
	int		i, c;

	for ( c = 0 ; c < 3 ; c++ ) {
		const shgrid_coeffs	*rest = &lighting->rest;

		mean[c] = SH_BAND0 * rest->c[0][c];
		VectorSet( linear[c], rest->c[3][c], rest->c[1][c], rest->c[2][c] );
	}
	for ( i = 0 ; i < lighting->count ; i++ ) {
		const shgrid_direct	*light = &lighting->direct[i];

		for ( c = 0 ; light != strongest && c < 3 ; c++ ) {
			mean[c] += light->color[c] * ( 0.25f + light->spread * light->spread / 12 );
			VectorMA( linear[c], 0.5f / SH_BAND1 * light->color[c], light->direction, linear[c] );
		}
	}

	for ( i = 0 ; i < 3 ; i++ ) {
		dir[i] = strongest ? strongest->direction[i] : linear[0][i] + linear[1][i] + linear[2][i];
	}
	if ( !strongest && !VectorNormalize( dir ) ) {
		VectorSet( dir, 0, 0, 1 );
	}

	for ( c = 0 ; c < 3 ; c++ ) {
		directed[c] = Com_Clamp( 0, 4 * MAX( mean[c], 0 ), 2 * ( SH_BAND1 * DotProduct( linear[c], dir ) ) );
		ambient[c] = MAX( mean[c], 0 ) - directed[c] / 4;
		directed[c] += ambient[c] + ( strongest ? strongest->color[c] : 0 );
	}

	// the tone is not linear: it applies to the light of the bright side, not to the directed part alone
	R_SHGridBytes( ambient );
	R_SHGridBytes( directed );
	VectorSubtract( directed, ambient, directed );
}

/*
===============
R_SHGridSphere
===============
*/
const shGridSphere_t *R_SHGridSphere( void ) {
	static shGridSphere_t	sphere;
	int		*index = sphere.indexes;
	int		ring, side;

	if ( sphere.indexes[1] ) {
		return &sphere;
	}

	for ( ring = 0 ; ring < SHGRID_SPHERE_RINGS ; ring++ ) {
		for ( side = 0 ; side < SHGRID_SPHERE_SIDES ; side++ ) {
			float	fromPole = M_PI * ring / ( SHGRID_SPHERE_RINGS - 1 ), around = 2 * M_PI * side / SHGRID_SPHERE_SIDES;

			VectorSet( sphere.normals[ring * SHGRID_SPHERE_SIDES + side], sinf( fromPole ) * cosf( around ),
				sinf( fromPole ) * sinf( around ), cosf( fromPole ) );
		}
	}

	for ( ring = 0 ; ring < SHGRID_SPHERE_RINGS - 1 ; ring++ ) {
		for ( side = 0 ; side < SHGRID_SPHERE_SIDES ; side++, index += 6 ) {
			int		next = ( side + 1 ) % SHGRID_SPHERE_SIDES;

			index[0] = index[3] = ring * SHGRID_SPHERE_SIDES + side;
			index[1] = ring * SHGRID_SPHERE_SIDES + next;
			index[2] = index[4] = ( ring + 1 ) * SHGRID_SPHERE_SIDES + next;
			index[5] = ( ring + 1 ) * SHGRID_SPHERE_SIDES + side;
		}
	}
	return &sphere;
}
