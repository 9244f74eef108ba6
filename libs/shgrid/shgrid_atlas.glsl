// SPDX-License-Identifier: MIT. Sampling of a sparse SH grid in the textures of shgrid.h: GLSL 1.30, GLSL ES 3.00 and
// later. Include shgrid.glsl first. Light is linear, 1.0 is lightmap byte 255. Textures of the atlas are filtered
// linearly, without mipmaps. In ES all samplers and numbers need highp.

struct ShgridAtlas {
    vec3 mins;   // of shgrid_grid: world position of the lowest point
    vec3 cell;   // of shgrid_grid
    vec3 bounds; // of shgrid_grid, as floats
    vec3 bricks; // of shgrid_atlas, as floats
    float entry; // 2^shift of shgrid_atlas
    float limit1; // of shgrid_atlas
    float limit2;
};

// xyz: texture coordinates in the atlas of a world position. w: 1, or 0 where the grid has no light.
vec4 ShgridPlace(usampler3D indirection, ShgridAtlas atlas, vec3 position)
{
    vec3 at = min(max((position - atlas.mins) / atlas.cell, vec3(0.0)), atlas.bounds * 0.999999);
    uvec4 brick = texelFetch(indirection, ivec3(at / atlas.entry), 0);
    vec3 texel = fract(at / exp2(float(brick.w))) * 4.0 + vec3(0.5);
    vec3 place = (vec3(float(brick.x), float(brick.y), float(brick.z)) * 5.0 + texel) / (atlas.bricks * 5.0);
    return vec4(place.x, place.y, place.z, brick.w > 0u ? 1.0 : 0.0);
}

// Light on a surface with that unit normal, from the seven texels of SHGRID_ATLAS_SNORM. Those of SHGRID_ATLAS_HALF are
// in the order of ShgridLightTexels.
vec3 ShgridLightSnorm(ShgridAtlas atlas, vec3 mean, vec4 t1, vec4 t2, vec4 t3, vec4 t4, vec4 t5, vec4 t6, vec3 n)
{
    vec3 band1 = vec3(t1.x, t1.y, t1.z) * (0.488602512 * n.y) + vec3(t1.w, t2.x, t2.y) * (0.488602512 * n.z);
    band1 += vec3(t2.z, t2.w, t3.x) * (0.488602512 * n.x);
    vec3 band2 = vec3(t3.y, t3.z, t3.w) * (1.092548431 * n.x * n.y);
    band2 += vec3(t4.x, t4.y, t4.z) * (1.092548431 * n.y * n.z);
    band2 += vec3(t4.w, t5.x, t5.y) * (0.315391565 * (3.0 * n.z * n.z - 1.0));
    band2 += vec3(t5.z, t5.w, t6.x) * (1.092548431 * n.x * n.z);
    band2 += vec3(t6.y, t6.z, t6.w) * (0.546274215 * (n.x * n.x - n.y * n.y));
    return max(mean * (vec3(0.282094792) + band1 * atlas.limit1 + band2 * atlas.limit2), vec3(0.0));
}

// Light at a world position, SHGRID_ATLAS_HALF.
vec3 ShgridHalf(usampler3D indirection, sampler3D s0, sampler3D s1, sampler3D s2, sampler3D s3, sampler3D s4,
                sampler3D s5, sampler3D s6, ShgridAtlas atlas, vec3 position, vec3 normal)
{
    vec4 at = ShgridPlace(indirection, atlas, position);
    vec3 p = vec3(at.x, at.y, at.z);
    return ShgridLightTexels(textureLod(s0, p, 0.0), textureLod(s1, p, 0.0), textureLod(s2, p, 0.0),
                             textureLod(s3, p, 0.0), textureLod(s4, p, 0.0), textureLod(s5, p, 0.0),
                             textureLod(s6, p, 0.0), normal) * at.w;
}

// Light at a world position, SHGRID_ATLAS_SNORM.
vec3 ShgridSnorm(usampler3D indirection, sampler3D s0, sampler3D s1, sampler3D s2, sampler3D s3, sampler3D s4,
                 sampler3D s5, sampler3D s6, ShgridAtlas atlas, vec3 position, vec3 normal)
{
    vec4 at = ShgridPlace(indirection, atlas, position);
    vec3 p = vec3(at.x, at.y, at.z);
    vec4 mean = textureLod(s0, p, 0.0);
    return ShgridLightSnorm(atlas, vec3(mean.x, mean.y, mean.z), textureLod(s1, p, 0.0), textureLod(s2, p, 0.0),
                            textureLod(s3, p, 0.0), textureLod(s4, p, 0.0), textureLod(s5, p, 0.0),
                            textureLod(s6, p, 0.0), normal) * at.w;
}
