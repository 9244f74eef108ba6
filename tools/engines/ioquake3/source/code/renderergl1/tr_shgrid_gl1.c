/*
===========================================================================
SPDX-License-Identifier: GPL-2.0-or-later

The SH light grid in renderer 1: light of entities, and drawing of the points.
===========================================================================
*/
// tr_shgrid_gl1.c

#include "tr_local.h"

#include <time.h>

/*
=============================================================================

LIGHT OF ENTITIES

=============================================================================
*/

#define	SHGRID_VERTEX_LIGHTS	4		// named lights of an entity: each costs time at every vertex

/*
=================
R_TurnEntitySHGrid

Into the axes of the model, so that vertexes need no transformation of their own
=================
*/
void R_TurnEntitySHGrid( trRefEntity_t *ent ) {
	vec3_t	dir;

	shgrid_limit_lights( &ent->shGrid.lighting, SHGRID_VERTEX_LIGHTS );
	R_SHGridTurn( &ent->shGrid.lighting, (const vec3_t *)ent->e.axis );

	VectorNormalize2( ent->shGrid.dynamicDir, dir );
	VectorSet( ent->shGrid.dynamicDir, DotProduct( dir, ent->e.axis[0] ), DotProduct( dir, ent->e.axis[1] ),
		DotProduct( dir, ent->e.axis[2] ) );
}

/*
=================
RB_CalcSHGridColor

RB_CalcDiffuseColor for an entity that is lit by the grid
=================
*/
void RB_CalcSHGridColor( unsigned char *colors ) {
	const trRefEntity_t	*ent = backEnd.currentEntity;
	const qboolean		dynamic = ent->shGrid.dynamicLight[0] || ent->shGrid.dynamicLight[1] || ent->shGrid.dynamicLight[2];
	static vec3_t		lit[SHADER_MAX_VERTEXES];
	int					i, j;

	R_SHGridLightMany( &ent->shGrid.lighting, tess.normal[0], ARRAY_LEN( tess.normal[0] ), tess.numVertexes, lit );
	for ( i = 0 ; i < tess.numVertexes ; i++, colors += 4 ) {
		if ( dynamic ) {
			float	incoming = DotProduct( tess.normal[i], ent->shGrid.dynamicDir );

			if ( incoming > 0 ) {
				VectorMA( lit[i], incoming, ent->shGrid.dynamicLight, lit[i] );
			}
		}
		for ( j = 0 ; j < 3 ; j++ ) {
			colors[j] = lit[i][j] < 255 ? (int)lit[i][j] : 255;
		}
		colors[3] = 255;
	}
}

/*
=================
R_SHGridSpeed_f

Measures the CPU time of lighting entities and vertexes around the viewer, by the grid that r_shgrid selects
=================
*/
void R_SHGridSpeed_f( void ) {
	enum { ENTITIES = 1000000, BATCHES = 5000, VERTEXES = 900 };
	trRefdef_t		refdef;
	trRefEntity_t	ent;
	clock_t			start, middle, end;
	int				i;

	if ( !tr.world ) {
		return;
	}
	R_IssuePendingRenderCommands();
	qglFinish();

	Com_Memset( &refdef, 0, sizeof( refdef ) );
	Com_Memset( &ent, 0, sizeof( ent ) );
	AxisCopy( axisDefault, ent.e.axis );
	for ( i = 0 ; i < VERTEXES ; i++ ) {
		VectorSet( tess.normal[i], tr.sinTable[i], tr.sinTable[i / 2], tr.sinTable[( i + FUNCTABLE_SIZE / 4 ) & FUNCTABLE_MASK] );
		VectorNormalize( tess.normal[i] );
	}
	tess.numVertexes = VERTEXES;
	backEnd.currentEntity = &ent;

	// a walk of 2 units a step in a box of 256 units
	start = clock();
	for ( i = 0 ; i < ENTITIES ; i++ ) {
		ent.lightingCalculated = qfalse;
		VectorCopy( tr.refdef.vieworg, ent.e.origin );
		ent.e.origin[0] += ( 2 * i & 255 ) - 128;
		ent.e.origin[1] += ( i >> 6 & 255 ) - 128;
		R_SetupEntityLighting( &refdef, &ent );
	}
	middle = clock();
	for ( i = 0 ; i < BATCHES ; i++ ) {
		RB_CalcDiffuseColor( (unsigned char *)tess.svars.colors );
	}
	end = clock();
	tess.numVertexes = 0;
	backEnd.currentEntity = &tr.worldEntity;

	ri.Printf( PRINT_ALL, "%s: %.0f ns an entity, %.1f ns a vertex\n", ent.shGrid.lit ? "SH light grid" : "legacy light grid",
		( middle - start ) * ( 1e9 / CLOCKS_PER_SEC / ENTITIES ), ( end - middle ) * ( 1e9 / CLOCKS_PER_SEC / BATCHES / VERTEXES ) );
}

/*
=============================================================================

DRAWING OF THE GRID

=============================================================================
*/

/*
=================
R_PointInSolid
=================
*/
static qboolean R_PointInSolid( const vec3_t point ) {
	const mnode_t	*node = tr.world->nodes;

	while ( node->contents == -1 ) {
		node = node->children[ DotProduct( point, node->plane->normal ) <= node->plane->dist ];
	}
	return node->cluster == -1;
}

/*
=================
RB_AddSphere
=================
*/
static void RB_AddSphere( const vec3_t origin ) {
	shgrid_lighting	lighting;
	const shGridSphere_t	*sphere = R_SHGridSphere();
	const float		*kind = NULL;
	int				i, j;

	RB_CHECKOVERFLOW( SHGRID_SPHERE_VERTEXES, SHGRID_SPHERE_INDEXES );

	R_SHGridSample( origin, backEnd.refdef.time, &lighting );
	if ( r_showshgrid->integer > 1 ) {
		kind = R_PointInSolid( origin ) ? colorRed : colorGreen;
	}

	for ( i = 0 ; i < SHGRID_SPHERE_INDEXES ; i++ ) {
		tess.indexes[tess.numIndexes++] = tess.numVertexes + sphere->indexes[i];
	}
	for ( i = 0 ; i < SHGRID_SPHERE_VERTEXES ; i++, tess.numVertexes++ ) {
		vec3_t	rgb;

		VectorMA( origin, SHGRID_SPHERE_RADIUS, sphere->normals[i], tess.xyz[tess.numVertexes] );
		tess.texCoords[tess.numVertexes][0][0] = tess.texCoords[tess.numVertexes][0][1] = 0;
		R_SHGridLight( &lighting, sphere->normals[i], rgb );
		for ( j = 0 ; j < 3 ; j++ ) {
			tess.vertexColors[tess.numVertexes][j] = kind ? 0.5f * ( rgb[j] + 255 * kind[j] ) : rgb[j];
		}
		tess.vertexColors[tess.numVertexes][3] = 255;
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
	if ( r_showshgrid->integer > 1 ) {
		qglDepthRange( 0, 0.3 );
	}
	RB_BeginSurface( R_FindShader( "*white", LIGHTMAP_BY_VERTEX, qfalse ), 0 );
	for ( i = 0 ; i < numPoints ; i++ ) {
		RB_AddSphere( points[i] );
	}
	RB_EndSurface();
	qglDepthRange( 0, 1 );
}
