// SPDX-License-Identifier: MIT. Light of the SH grid of shgrid.h on a surface: HLSL, shader model 4 and later.
// Light is linear, 1.0 is lightmap byte 255; normals are unit vectors in map axes.

// The sum over the basis, which may be below zero.
float3 ShgridSum(float3 sh[9], float3 n)
{
    float3 light = sh[0] * 0.282094792;
    light += (sh[1] * n.y + sh[2] * n.z + sh[3] * n.x) * 0.488602512;
    light += (sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) + sh[7] * (n.x * n.z)) * 1.092548431;
    light += sh[6] * (0.315391565 * (3.0 * n.z * n.z - 1.0));
    light += sh[8] * (0.546274215 * (n.x * n.x - n.y * n.y));
    return light;
}

// Light on a surface with normal n, from the nine coefficients of shgrid_sample. Does the same as shgrid_evaluate.
float3 ShgridLight(float3 sh[9], float3 n)
{
    return max(ShgridSum(sh, n), float3(0.0, 0.0, 0.0));
}

// ---- lights that the grid names ----

// Light of one of shgrid_lights, to be added to ShgridSum of the rest. A light with an extent, spread being the sine of
// its angular radius, sets behind the horizon of the surface step by step.
float3 ShgridDirect(float3 direction, float spread, float3 color, float3 n)
{
    float s = spread + 1e-6;
    float above = max(dot(direction, n) + s, 0.0);
    float low = min(above, 2.0 * s);
    return color * (low * low * (0.25 / s) + (above - low));
}

// Light on a surface with that normal: shgrid_shade after shgrid_limit_lights(&lighting, 8). directions: spread in w.
float3 ShgridShade(float3 rest[9], float4 directions[8], float3 colors[8], int count, float3 n)
{
    float3 light = ShgridSum(rest, n);
    for (int i = 0; i < count; i++)
        light += ShgridDirect(float3(directions[i].x, directions[i].y, directions[i].z), directions[i].w, colors[i], n);
    return max(light, float3(0.0, 0.0, 0.0));
}

// ---- tone ----

struct ShgridTone { // of shgrid_tone
    float contrast;
    float power; // 1 / gamma
    float exposure;
    float saturation;
    float scale;
    float limit; // maxlight / 255
    float srgb; // 1 or 0
};

float3 ShgridSplat(float v)
{
    return float3(v, v, v);
}

float ShgridLargest(float3 v)
{
    return max(v.x, max(v.y, v.z));
}

float ShgridSrgb(float c)
{
    return c < 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055;
}

// Light as a lightmap texel / 255, 0 to 1: shgrid_apply_tone.
float3 ShgridApplyTone(ShgridTone tone, float3 light)
{
    float3 middle = ShgridSplat(128.0 / 255.0);
    float3 v = max((light - middle) * tone.contrast + middle, ShgridSplat(0.0));
    v = pow(v, ShgridSplat(tone.power));
    float most = ShgridLargest(v);
    if (tone.exposure != 0.0 && most > 0.0)
        v *= (1.0 - exp(most * -255.0 / tone.exposure)) / most;
    float gray = dot(v, float3(0.3086, 0.6094, 0.0820));
    v = max(lerp(ShgridSplat(gray), v, tone.saturation), ShgridSplat(0.0)) * tone.scale;
    v *= min(1.0, tone.limit / max(ShgridLargest(v), 1e-6));
    if (tone.srgb != 0.0)
        v = float3(ShgridSrgb(v.x), ShgridSrgb(v.y), ShgridSrgb(v.z));
    return v;
}

// ---- the whole grid as seven 3D textures RGBA16F ----
// Coefficient k of channel c is component (3 k + c) % 4 of texture (3 k + c) / 4.

struct ShgridGrid {
    float3 mins;   // of shgrid_grid
    float3 cell;   // of shgrid_grid
    float3 bounds; // of shgrid_grid, as floats
};

// Texture coordinates of a world position. The textures are filtered linearly and clamped to their edge.
float3 ShgridTexel(ShgridGrid grid, float3 position)
{
    return ((position - grid.mins) / grid.cell + float3(0.5, 0.5, 0.5)) / grid.bounds;
}

// The sum over the basis, from the seven texels.
float3 ShgridSumTexels(float4 t0, float4 t1, float4 t2, float4 t3, float4 t4, float4 t5, float4 t6, float3 n)
{
    float3 sh[9];
    sh[0] = float3(t0.x, t0.y, t0.z);
    sh[1] = float3(t0.w, t1.x, t1.y);
    sh[2] = float3(t1.z, t1.w, t2.x);
    sh[3] = float3(t2.y, t2.z, t2.w);
    sh[4] = float3(t3.x, t3.y, t3.z);
    sh[5] = float3(t3.w, t4.x, t4.y);
    sh[6] = float3(t4.z, t4.w, t5.x);
    sh[7] = float3(t5.y, t5.z, t5.w);
    sh[8] = float3(t6.x, t6.y, t6.z);
    return ShgridSum(sh, n);
}

// Light on a surface with that normal, from the seven texels.
float3 ShgridLightTexels(float4 t0, float4 t1, float4 t2, float4 t3, float4 t4, float4 t5, float4 t6, float3 n)
{
    return max(ShgridSumTexels(t0, t1, t2, t3, t4, t5, t6, n), float3(0.0, 0.0, 0.0));
}

// Light at a world position: shgrid_light.
float3 ShgridLightAt(Texture3D<float4> s0, Texture3D<float4> s1, Texture3D<float4> s2, Texture3D<float4> s3,
                     Texture3D<float4> s4, Texture3D<float4> s5, Texture3D<float4> s6, SamplerState filter,
                     ShgridGrid grid, float3 position, float3 normal)
{
    float3 p = ShgridTexel(grid, position);
    return ShgridLightTexels(s0.SampleLevel(filter, p, 0.0), s1.SampleLevel(filter, p, 0.0),
                             s2.SampleLevel(filter, p, 0.0), s3.SampleLevel(filter, p, 0.0),
                             s4.SampleLevel(filter, p, 0.0), s5.SampleLevel(filter, p, 0.0),
                             s6.SampleLevel(filter, p, 0.0), normal);
}
