// SPDX-License-Identifier: MIT. Light of the SH grid of shgrid.h on a surface: GLSL 1.30, GLSL ES 3.00 and later.
// Light is linear, 1.0 is lightmap byte 255; normals are unit vectors in map axes. In ES all samplers and numbers need
// highp.

// The sum over the basis, which may be below zero.
vec3 ShgridSum(vec3 sh[9], vec3 n)
{
    vec3 light = sh[0] * 0.282094792;
    light += (sh[1] * n.y + sh[2] * n.z + sh[3] * n.x) * 0.488602512;
    light += (sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) + sh[7] * (n.x * n.z)) * 1.092548431;
    light += sh[6] * (0.315391565 * (3.0 * n.z * n.z - 1.0));
    light += sh[8] * (0.546274215 * (n.x * n.x - n.y * n.y));
    return light;
}

// Light on a surface with normal n, from the nine coefficients of shgrid_sample. Does the same as shgrid_evaluate.
vec3 ShgridLight(vec3 sh[9], vec3 n)
{
    return max(ShgridSum(sh, n), vec3(0.0));
}

// ---- lights that the grid names ----

// Light of one of shgrid_lights, to be added to ShgridSum of the rest. A light with an extent, spread being the sine of
// its angular radius, sets behind the horizon of the surface step by step.
vec3 ShgridDirect(vec3 direction, float spread, vec3 color, vec3 n)
{
    float s = spread + 1e-6;
    float above = max(dot(direction, n) + s, 0.0);
    float low = min(above, 2.0 * s);
    return color * (low * low * (0.25 / s) + (above - low));
}

// Light on a surface with that normal: shgrid_shade after shgrid_limit_lights(&lighting, 8). directions: spread in w.
vec3 ShgridShade(vec3 rest[9], vec4 directions[8], vec3 colors[8], int count, vec3 n)
{
    vec3 light = ShgridSum(rest, n);
    for (int i = 0; i < count; i++)
        light += ShgridDirect(vec3(directions[i].x, directions[i].y, directions[i].z), directions[i].w, colors[i], n);
    return max(light, vec3(0.0));
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

float ShgridLargest(vec3 v)
{
    return max(v.x, max(v.y, v.z));
}

float ShgridSrgb(float c)
{
    return c < 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055;
}

// Light as a lightmap texel / 255, 0 to 1: shgrid_apply_tone.
vec3 ShgridApplyTone(ShgridTone tone, vec3 light)
{
    vec3 middle = vec3(128.0 / 255.0);
    vec3 v = pow(max((light - middle) * tone.contrast + middle, vec3(0.0)), vec3(tone.power));
    float most = ShgridLargest(v);
    if (tone.exposure != 0.0 && most > 0.0)
        v *= (1.0 - exp(most * -255.0 / tone.exposure)) / most;
    float gray = dot(v, vec3(0.3086, 0.6094, 0.0820));
    v = max(mix(vec3(gray), v, tone.saturation), vec3(0.0)) * tone.scale;
    v *= min(1.0, tone.limit / max(ShgridLargest(v), 1e-6));
    if (tone.srgb != 0.0)
        v = vec3(ShgridSrgb(v.x), ShgridSrgb(v.y), ShgridSrgb(v.z));
    return v;
}

// ---- the whole grid as seven 3D textures RGBA16F ----
// Coefficient k of channel c is component (3 k + c) % 4 of texture (3 k + c) / 4.

struct ShgridGrid {
    vec3 mins;   // of shgrid_grid
    vec3 cell;   // of shgrid_grid
    vec3 bounds; // of shgrid_grid, as floats
};

// Texture coordinates of a world position. The textures are filtered linearly and clamped to their edge.
vec3 ShgridTexel(ShgridGrid grid, vec3 position)
{
    return ((position - grid.mins) / grid.cell + vec3(0.5)) / grid.bounds;
}

// The sum over the basis, from the seven texels.
vec3 ShgridSumTexels(vec4 t0, vec4 t1, vec4 t2, vec4 t3, vec4 t4, vec4 t5, vec4 t6, vec3 n)
{
    vec3 sh[9];
    sh[0] = vec3(t0.x, t0.y, t0.z);
    sh[1] = vec3(t0.w, t1.x, t1.y);
    sh[2] = vec3(t1.z, t1.w, t2.x);
    sh[3] = vec3(t2.y, t2.z, t2.w);
    sh[4] = vec3(t3.x, t3.y, t3.z);
    sh[5] = vec3(t3.w, t4.x, t4.y);
    sh[6] = vec3(t4.z, t4.w, t5.x);
    sh[7] = vec3(t5.y, t5.z, t5.w);
    sh[8] = vec3(t6.x, t6.y, t6.z);
    return ShgridSum(sh, n);
}

// Light on a surface with that normal, from the seven texels.
vec3 ShgridLightTexels(vec4 t0, vec4 t1, vec4 t2, vec4 t3, vec4 t4, vec4 t5, vec4 t6, vec3 n)
{
    return max(ShgridSumTexels(t0, t1, t2, t3, t4, t5, t6, n), vec3(0.0));
}

// Light at a world position: shgrid_light.
vec3 ShgridLightAt(sampler3D s0, sampler3D s1, sampler3D s2, sampler3D s3, sampler3D s4, sampler3D s5, sampler3D s6,
                   ShgridGrid grid, vec3 position, vec3 normal)
{
    vec3 p = ShgridTexel(grid, position);
    return ShgridLightTexels(textureLod(s0, p, 0.0), textureLod(s1, p, 0.0), textureLod(s2, p, 0.0),
                             textureLod(s3, p, 0.0), textureLod(s4, p, 0.0), textureLod(s5, p, 0.0),
                             textureLod(s6, p, 0.0), normal);
}
