// SPDX-License-Identifier: GPL-2.0-or-later
//
// Light of the SH light grid on entities. Include shgrid.glsl and shgrid_atlas.glsl first.

// of the entity: nine RGB coefficients; color and direction of the dynamic lights
uniform float u_SHGridEntity[33];

#if defined(USE_SHGRID_LIGHTS)
// number of lights that the grid names; direction, spread and color of each
uniform float u_SHGridLights[57];
#endif

// fields of ShgridTone; brightest light that lightmap bytes hold, scale of the overbright shift
uniform float u_SHGridTone[9];

#if defined(USE_SHGRID_TEXTURES)
uniform sampler3D u_SHGridMap0;
uniform sampler3D u_SHGridMap1;
uniform sampler3D u_SHGridMap2;
uniform sampler3D u_SHGridMap3;
uniform sampler3D u_SHGridMap4;
uniform sampler3D u_SHGridMap5;
uniform sampler3D u_SHGridMap6;

// fields of ShgridGrid; bricks and entry of ShgridAtlas; factors of bands 0, 1 and 2
uniform float u_SHGridPlace[16];

vec3 SHGridVector(int first)
{
	return vec3(u_SHGridPlace[first], u_SHGridPlace[first + 1], u_SHGridPlace[first + 2]);
}
#endif

// xyz: texture coordinates of a position; w: 0 where the grid has no light
#if defined(USE_SHGRID_SPARSE)
uniform usampler3D u_SHGridIndirection;

ShgridAtlas SHGridAtlas()
{
	return ShgridAtlas(SHGridVector(0), SHGridVector(3), SHGridVector(6), SHGridVector(9), u_SHGridPlace[12], 0.0, 0.0);
}

vec4 SHGridTexel(vec3 position)
{
	return ShgridPlace(u_SHGridIndirection, SHGridAtlas(), position);
}
#elif defined(USE_SHGRID_TEXTURES)
vec4 SHGridTexel(vec3 position)
{
	return vec4(ShgridTexel(ShgridGrid(SHGridVector(0), SHGridVector(3), SHGridVector(6)), position), 1.0);
}
#endif

// names of lights, their shares, and the table of lights
#if defined(USE_SHGRID_NAMES)
uniform usampler3D u_SHGridNames;
uniform sampler3D u_SHGridShares;
uniform sampler2D u_SHGridTable;
#endif

// linear light by the coefficients and the named lights of the entity
vec3 SHGridEntityLight(vec3 normal)
{
	vec3 sh[9];

	for (int k = 0; k < 9; k++)
		sh[k] = vec3(u_SHGridEntity[3 * k], u_SHGridEntity[3 * k + 1], u_SHGridEntity[3 * k + 2]);

#if defined(USE_SHGRID_LIGHTS)
	vec3 light = ShgridSum(sh, normal);
	int end = 1 + 7 * int(u_SHGridLights[0]);

	for (int i = 1; i < end; i += 7)
		light += ShgridDirect(vec3(u_SHGridLights[i], u_SHGridLights[i + 1], u_SHGridLights[i + 2]), u_SHGridLights[i + 3],
			vec3(u_SHGridLights[i + 4], u_SHGridLights[i + 5], u_SHGridLights[i + 6]), normal);

	return max(light, vec3(0.0));
#else
	return ShgridLight(sh, normal);
#endif
}

// linear light: of the position with textures, else of the entity
vec3 SHGridLinearLight(vec3 normal, vec3 position)
{
#if defined(USE_SHGRID_TEXTURES)
	vec4 at = SHGridTexel(position);

	if (at.w > 0.0)
	{
		vec3 bands = SHGridVector(13);

		vec3 light = ShgridSumTexels(
			textureLod(u_SHGridMap0, at.xyz, 0.0) * bands.xxxy,
			textureLod(u_SHGridMap1, at.xyz, 0.0) * bands.y,
			textureLod(u_SHGridMap2, at.xyz, 0.0) * bands.y,
			textureLod(u_SHGridMap3, at.xyz, 0.0) * bands.z,
			textureLod(u_SHGridMap4, at.xyz, 0.0) * bands.z,
			textureLod(u_SHGridMap5, at.xyz, 0.0) * bands.z,
			textureLod(u_SHGridMap6, at.xyz, 0.0) * bands.z, normal);

#if defined(USE_SHGRID_NAMES)
		light += ShgridBrickLights(u_SHGridNames, u_SHGridShares, u_SHGridTable, SHGridAtlas(), at.xyz, position, normal);
		light /= max(textureLod(u_SHGridMap6, at.xyz, 0.0).w, 1e-3);
#endif
		return max(light, vec3(0.0));
	}
#endif
	return SHGridEntityLight(normal);
}

// Light on a surface with that unit normal in map axes, as lightmaps are displayed, plus dynamic lights.
// The same steps as R_SHGridLight.
vec3 SHGridLight(vec3 normal, vec3 position)
{
	vec3 light = SHGridLinearLight(normal, position);
	vec3 dynamicLight = vec3(u_SHGridEntity[27], u_SHGridEntity[28], u_SHGridEntity[29]);
	vec3 dynamicDir = vec3(u_SHGridEntity[30], u_SHGridEntity[31], u_SHGridEntity[32]);

#if defined(USE_SHGRID_TONE)
	light = ShgridApplyTone(ShgridTone(u_SHGridTone[0], u_SHGridTone[1], u_SHGridTone[2], u_SHGridTone[3],
		u_SHGridTone[4], u_SHGridTone[5], u_SHGridTone[6]), light);
#endif

	// scale all channels alike to keep the hue
	light *= u_SHGridTone[8] * min(1.0, u_SHGridTone[7] / max(ShgridLargest(light), 1e-6));

#if defined(USE_PBR) && defined(USE_LIGHT) && !defined(USE_FAST_LIGHT)
	light *= light;
	dynamicLight *= dynamicLight;
#endif

	return light + dynamicLight * max(dot(normal, dynamicDir), 0.0);
}
