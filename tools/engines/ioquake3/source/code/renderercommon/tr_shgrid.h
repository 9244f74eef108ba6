/*
===========================================================================
SPDX-License-Identifier: GPL-2.0-or-later

The SH light grid of the map, as both renderers use it.
===========================================================================
*/
#ifndef TR_SHGRID_H
#define TR_SHGRID_H

#include "tr_common.h"
#include "shgrid.h"

typedef struct {
	shgrid_grid	grid;			// points is NULL without a grid
	shgrid_tone	tone;			// what the compiler did to the lightmaps
	qboolean	hasTone;		// the map has a tone that is not plain
	qboolean	isRadiance;		// the coefficients are not convolved with the cosine
	float		scale;			// from light to lightmap bytes after the overbright shift: 255 * 2^shift
	float		limit;			// brightest light that lightmap bytes hold
} shGridWorld_t;

// light of an entity
typedef struct {
	qboolean		lit;			// by the SH light grid; ambient and directed light approximate it
	shgrid_lighting	lighting;		// in map axes; renderer 1 turns it into the axes of the model
	vec3_t			dynamicLight;	// sum of the dynamic lights, 0 to 255 and above
	vec3_t			dynamicDir;		// towards them, in the axes of lighting
} shGridEntity_t;

#define	SHGRID_ENTITY_LIGHTS	8		// named lights of an entity at most; the weakest others become coefficients
#define	SHGRID_STYLES			64		// light styles

#define	SHGRID_RADIUS			512		// r_showshgrid draws points this near to the viewer, world units
#define	SHGRID_SPHERES			400		// at most
#define	SHGRID_SPHERE_RADIUS	3		// world units
#define	SHGRID_SPHERE_RINGS		6		// of vertexes, the two poles included
#define	SHGRID_SPHERE_SIDES		8
#define	SHGRID_SPHERE_VERTEXES	( SHGRID_SPHERE_RINGS * SHGRID_SPHERE_SIDES )
#define	SHGRID_SPHERE_INDEXES	( 6 * ( SHGRID_SPHERE_RINGS - 1 ) * SHGRID_SPHERE_SIDES )

// a sphere of radius 1, for drawing the points of the grid
typedef struct {
	vec3_t	normals[SHGRID_SPHERE_VERTEXES];	// these are the positions too
	int		indexes[SHGRID_SPHERE_INDEXES];		// of triangles
} shGridSphere_t;

extern	shGridWorld_t	shGridWorld;

extern	cvar_t	*r_shgrid;		// 0: entities are lit by the legacy grid
extern	cvar_t	*r_showshgrid;	// 1: draw the points near the viewer, 2: colored by kind
extern	cvar_t	*r_shgridStyles;	// how the lights flicker that have a style, see R_SHGridStyles

// registers the cvars
void		R_RegisterSHGrid( void );

// frees the grid of the last map. To be called when the renderer shuts down, which it does between maps too
void		R_FreeSHGrid( void );

// copies the grid of a map file. The file must be as it was read, before its header is swapped;
// shift is that of R_ColorShiftLightingBytes. A damaged grid is reported and left out.
void		R_LoadSHGrid( const char *mapName, const byte *file, long fileBytes, int shift );

// convolved light at a position, in map axes. time: of the scene in milliseconds, for lights with a style. False if
// entities are lit by the legacy grid.
qboolean	R_SHGridAt( const vec3_t origin, int time, shgrid_lighting *lighting );

// the same, whatever r_shgrid is; the map must have a grid
void		R_SHGridSample( const vec3_t origin, int time, shgrid_lighting *lighting );

// brightness of each light style at that time. r_shgridStyles holds words: letters a (dark) to z for all styles but 0,
// or number:letters for one; a letter lasts a tenth of a second, m is the brightness of the map, 0 is dark
const float	*R_SHGridStyles( int time );

// samples the grid for an entity and clears its dynamic lights, which the caller adds; also sets the legacy form of the
// light. False if the entity is lit by the legacy grid, as without a world
qboolean	R_SetupSHGridEntity( shGridEntity_t *ent, qboolean hasWorld, int time, const vec3_t origin,
				vec3_t ambient, vec3_t directed, vec3_t dir );

// positions of the stored points within the radius; the radius shrinks until they are at most max. Returns their number
int			R_SHGridNear( const vec3_t origin, float radius, int max, vec3_t *points );

// made on the first call
const shGridSphere_t	*R_SHGridSphere( void );

// turns light into the axes of a model, whatever their length, for normals in these axes
void		R_SHGridTurn( shgrid_lighting *lighting, const vec3_t axis[3] );

// light on a surface with that unit normal, 0 to 255: what a lightmap texel of a wall with that normal becomes
// in R_ColorShiftLightingBytes
void		R_SHGridLight( const shgrid_lighting *lighting, const vec3_t normal, vec3_t rgb );

// the same for many normals, stride floats apart
void		R_SHGridLightMany( const shgrid_lighting *lighting, const float *normals, int stride, int count, vec3_t *rgb );

// the legacy form of the light, ambient + directed * max( 0, n . dir ), 0 to 255, with the direction of the strongest
// light that the grid names, or of band 1. It has the same mean and, unless there are lights opposite, the same band 1
// along dir, so it is exact for uniform light and for light of one direction.
void		R_SHGridSplit( const shgrid_lighting *lighting, vec3_t ambient, vec3_t directed, vec3_t dir );

#endif
