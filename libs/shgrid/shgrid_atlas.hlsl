// SPDX-License-Identifier: MIT. Sampling of a sparse SH grid in the textures of shgrid.h: HLSL, shader model 4 and
// later. Include shgrid.hlsl first. Light is linear, 1.0 is lightmap byte 255. Textures of the atlas are filtered
// linearly, without mipmaps.

struct ShgridAtlas {
    float3 mins;   // of shgrid_grid: world position of the lowest point
    float3 cell;   // of shgrid_grid
    float3 bounds; // of shgrid_grid, as floats
    float3 bricks; // of shgrid_atlas, as floats
    float entry; // 2^shift of shgrid_atlas
    float limit1; // of shgrid_atlas
    float limit2;
};

// xyz: texture coordinates in the atlas of a world position. w: 1, or 0 where the grid has no light.
float4 ShgridPlace(Texture3D<uint4> indirection, ShgridAtlas atlas, float3 position)
{
    float3 at = min(max((position - atlas.mins) / atlas.cell, float3(0.0, 0.0, 0.0)), atlas.bounds * 0.999999);
    int3 entry = int3(at / atlas.entry);
    uint4 brick = indirection.Load(int4(entry, 0));
    float3 texel = frac(at / exp2(float(brick.w))) * 4.0 + float3(0.5, 0.5, 0.5);
    float3 place = (float3(float(brick.x), float(brick.y), float(brick.z)) * 5.0 + texel) / (atlas.bricks * 5.0);
    return float4(place.x, place.y, place.z, brick.w > 0u ? 1.0 : 0.0);
}

// Light on a surface with that unit normal, from the seven texels of SHGRID_ATLAS_SNORM. Those of SHGRID_ATLAS_HALF are
// in the order of ShgridLightTexels.
float3 ShgridLightSnorm(ShgridAtlas atlas, float3 mean, float4 t1, float4 t2, float4 t3, float4 t4,
                        float4 t5, float4 t6, float3 n)
{
    float3 band1 = float3(t1.x, t1.y, t1.z) * (0.488602512 * n.y) + float3(t1.w, t2.x, t2.y) * (0.488602512 * n.z);
    band1 += float3(t2.z, t2.w, t3.x) * (0.488602512 * n.x);
    float3 band2 = float3(t3.y, t3.z, t3.w) * (1.092548431 * n.x * n.y);
    band2 += float3(t4.x, t4.y, t4.z) * (1.092548431 * n.y * n.z);
    band2 += float3(t4.w, t5.x, t5.y) * (0.315391565 * (3.0 * n.z * n.z - 1.0));
    band2 += float3(t5.z, t5.w, t6.x) * (1.092548431 * n.x * n.z);
    band2 += float3(t6.y, t6.z, t6.w) * (0.546274215 * (n.x * n.x - n.y * n.y));
    float3 share = float3(0.282094792, 0.282094792, 0.282094792) + band1 * atlas.limit1 + band2 * atlas.limit2;
    return max(mean * share, float3(0.0, 0.0, 0.0));
}

// Light at a world position, SHGRID_ATLAS_HALF.
float3 ShgridHalf(Texture3D<uint4> indirection, Texture3D<float4> s0, Texture3D<float4> s1, Texture3D<float4> s2,
                  Texture3D<float4> s3, Texture3D<float4> s4, Texture3D<float4> s5, Texture3D<float4> s6,
                  SamplerState filter, ShgridAtlas atlas, float3 position, float3 normal)
{
    float4 at = ShgridPlace(indirection, atlas, position);
    float3 p = float3(at.x, at.y, at.z);
    return ShgridLightTexels(s0.SampleLevel(filter, p, 0.0), s1.SampleLevel(filter, p, 0.0),
                             s2.SampleLevel(filter, p, 0.0), s3.SampleLevel(filter, p, 0.0),
                             s4.SampleLevel(filter, p, 0.0), s5.SampleLevel(filter, p, 0.0),
                             s6.SampleLevel(filter, p, 0.0), normal) * at.w;
}

// Light at a world position, SHGRID_ATLAS_SNORM.
float3 ShgridSnorm(Texture3D<uint4> indirection, Texture3D<float4> s0, Texture3D<float4> s1, Texture3D<float4> s2,
                  Texture3D<float4> s3, Texture3D<float4> s4, Texture3D<float4> s5, Texture3D<float4> s6,
                  SamplerState filter, ShgridAtlas atlas, float3 position, float3 normal)
{
    float4 at = ShgridPlace(indirection, atlas, position);
    float3 p = float3(at.x, at.y, at.z);
    float4 mean = s0.SampleLevel(filter, p, 0.0);
    return ShgridLightSnorm(atlas, float3(mean.x, mean.y, mean.z), s1.SampleLevel(filter, p, 0.0),
                            s2.SampleLevel(filter, p, 0.0), s3.SampleLevel(filter, p, 0.0),
                            s4.SampleLevel(filter, p, 0.0), s5.SampleLevel(filter, p, 0.0),
                            s6.SampleLevel(filter, p, 0.0), normal) * at.w;
}
