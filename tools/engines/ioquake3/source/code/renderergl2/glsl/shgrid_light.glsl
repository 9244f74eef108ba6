// SPDX-License-Identifier: GPL-2.0-or-later
//
// Light of the SH light grid on entities. Include shgrid.glsl and shgrid_atlas.glsl first.

// of the entity: nine RGB coefficients; color and direction of the dynamic lights
uniform float u_ShGridEntity[33];

// fields of ShgridTone; brightest light that lightmap bytes hold, scale of the overbright shift
uniform float u_ShGridTone[9];

#if defined(USE_SHGRID_TEXTURES)
uniform sampler3D u_ShGridMap0;
uniform sampler3D u_ShGridMap1;
uniform sampler3D u_ShGridMap2;
uniform sampler3D u_ShGridMap3;
uniform sampler3D u_ShGridMap4;
uniform sampler3D u_ShGridMap5;
uniform sampler3D u_ShGridMap6;

// fields of ShgridGrid; bricks and entry of ShgridAtlas; factors of bands 0, 1 and 2
uniform float u_ShGridPlace[16];

vec3 ShGridVector(int first)
{
	return vec3(u_ShGridPlace[first], u_ShGridPlace[first + 1], u_ShGridPlace[first + 2]);
}
#endif

// xyz: texture coordinates of a position; w: 0 where the grid has no light
#if defined(USE_SHGRID_SPARSE)
uniform usampler3D u_ShGridIndirection;

vec4 ShGridTexel(vec3 position)
{
	ShgridAtlas atlas = ShgridAtlas(ShGridVector(0), ShGridVector(3), ShGridVector(6), ShGridVector(9), u_ShGridPlace[12], 0.0, 0.0);

	return ShgridPlace(u_ShGridIndirection, atlas, position);
}
#elif defined(USE_SHGRID_TEXTURES)
vec4 ShGridTexel(vec3 position)
{
	return vec4(ShgridTexel(ShgridGrid(ShGridVector(0), ShGridVector(3), ShGridVector(6)), position), 1.0);
}
#endif

// linear light by the coefficients of the entity
vec3 ShGridEntityLight(vec3 normal)
{
	vec3 sh[9];

	for (int k = 0; k < 9; k++)
		sh[k] = vec3(u_ShGridEntity[3 * k], u_ShGridEntity[3 * k + 1], u_ShGridEntity[3 * k + 2]);

	return ShgridLight(sh, normal);
}

// linear light: of the position with textures, else of the entity
vec3 ShGridLinearLight(vec3 normal, vec3 position)
{
#if defined(USE_SHGRID_TEXTURES)
	vec4 at = ShGridTexel(position);

	if (at.w > 0.0)
	{
		vec3 bands = ShGridVector(13);

		return ShgridLightTexels(
			textureLod(u_ShGridMap0, at.xyz, 0.0) * bands.xxxy,
			textureLod(u_ShGridMap1, at.xyz, 0.0) * bands.y,
			textureLod(u_ShGridMap2, at.xyz, 0.0) * bands.y,
			textureLod(u_ShGridMap3, at.xyz, 0.0) * bands.z,
			textureLod(u_ShGridMap4, at.xyz, 0.0) * bands.z,
			textureLod(u_ShGridMap5, at.xyz, 0.0) * bands.z,
			textureLod(u_ShGridMap6, at.xyz, 0.0) * bands.z, normal);
	}
#endif
	return ShGridEntityLight(normal);
}

// Light on a surface with that unit normal in map axes, as lightmaps are displayed, plus dynamic lights.
// The same steps as R_ShGridLight.
vec3 ShGridLight(vec3 normal, vec3 position)
{
	vec3 light = ShGridLinearLight(normal, position);
	vec3 dynamicLight = vec3(u_ShGridEntity[27], u_ShGridEntity[28], u_ShGridEntity[29]);
	vec3 dynamicDir = vec3(u_ShGridEntity[30], u_ShGridEntity[31], u_ShGridEntity[32]);

#if defined(USE_SHGRID_TONE)
	light = ShgridApplyTone(ShgridTone(u_ShGridTone[0], u_ShGridTone[1], u_ShGridTone[2], u_ShGridTone[3],
		u_ShGridTone[4], u_ShGridTone[5], u_ShGridTone[6]), light);
#endif

	// scale all channels alike to keep the hue
	light *= u_ShGridTone[8] * min(1.0, u_ShGridTone[7] / max(ShgridLargest(light), 1e-6));

#if defined(USE_PBR) && defined(USE_LIGHT) && !defined(USE_FAST_LIGHT)
	light *= light;
	dynamicLight *= dynamicLight;
#endif

	return light + dynamicLight * max(dot(normal, dynamicDir), 0.0);
}
