// SPDX-License-Identifier: MIT. Decoders of directional lightmaps for shaders: GLSL 1.30, GLSL ES 3.00 and later.
// The functions of directional.h, which says what they take and how exact they are: light is linear, 1.0 is lightmap
// byte 255; normals and directions are unit vectors; tangent space is s, t (down the image) and the normal. Texels are
// what samplers of 8-bit textures return, 0 to 1. In ES they need highp.

// ---- packed colors ----

vec3 DecodeE5bgr9(uint code)
{
    float scale = exp2(float(code >> 27u) - 24.0);
    return vec3(float(code & 511u), float((code >> 9u) & 511u), float((code >> 18u) & 511u)) * scale;
}

vec3 DecodeRgbe(vec4 texel)
{
    float scale = texel.w > 0.0 ? exp2(texel.w * 255.0 - 136.0) * 255.0 : 0.0;
    return vec3(texel.x, texel.y, texel.z) * scale;
}

vec3 DecodeExp32(vec4 texel) // 255 of the format is 1.0 here
{
    float exponent = texel.w * 255.0;
    return vec3(texel.x, texel.y, texel.z) * exp2(exponent < 127.5 ? exponent : exponent - 256.0);
}

// ---- one light direction ----

vec3 DeluxeLight(vec3 light, vec3 direction, vec3 normal)
{
    return light * max(0.0, dot(normal, direction));
}

// For lightmaps of received light. least: 0.25 is usual.
vec3 DeluxeReceived(vec3 light, vec3 direction, vec3 flatNormal, float least, vec3 normal)
{
    return light * (max(0.0, dot(normal, direction)) / max(least, dot(flatNormal, direction)));
}

// ---- radiosity normal mapping: normals in tangent space ----

vec3 RnmWeights(vec3 normal)
{
    return max(vec3(dot(normal, vec3(0.816496581, 0.0, 0.577350269)),
                    dot(normal, vec3(-0.408248290, 0.707106781, 0.577350269)),
                    dot(normal, vec3(-0.408248290, -0.707106781, 0.577350269))),
               vec3(0.0));
}

vec3 RnmRaw(vec3 map1, vec3 map2, vec3 map3, vec3 normal)
{
    vec3 w = RnmWeights(normal);
    return map1 * w.x + map2 * w.y + map3 * w.z;
}

vec3 RnmRescaled(vec3 map1, vec3 map2, vec3 map3, vec3 normal)
{
    return RnmRaw(map1, map2, map3, normal) * 0.577350269;
}

// Source's weights.
vec3 RnmSquared(vec3 map1, vec3 map2, vec3 map3, vec3 normal)
{
    vec3 w = RnmWeights(normal);
    w = w * w;
    return (map1 * w.x + map2 * w.y + map3 * w.z) / max(w.x + w.y + w.z, 1e-6);
}

// ---- self-shadowed bump maps ----

// factor: 1.0 for raw maps, 0.577350269 for rescaled ones.
vec3 SsbumpLight(vec3 texel, vec3 map1, vec3 map2, vec3 map3, float factor)
{
    return (map1 * texel.x + map2 * texel.y + map3 * texel.z) * factor;
}

vec3 SsbumpNormal(vec3 texel)
{
    return normalize(vec3(0.816496581, 0.0, 0.577350269) * texel.x +
                     vec3(-0.408248290, 0.707106781, 0.577350269) * texel.y +
                     vec3(-0.408248290, -0.707106781, 0.577350269) * texel.z);
}

// Share of a dynamic light that the texel receives.
float SsbumpDynamic(vec3 texel, vec3 direction)
{
    return max(0.0, dot(texel, vec3(dot(direction, vec3(0.816496581, 0.0, 0.577350269)),
                                    dot(direction, vec3(-0.408248290, 0.707106781, 0.577350269)),
                                    dot(direction, vec3(-0.408248290, -0.707106781, 0.577350269)))));
}

// ---- L1 spherical harmonics: coefficients L0, y, z, x; normal in world space ----

vec3 L1Light(vec3 c0, vec3 cy, vec3 cz, vec3 cx, vec3 normal)
{
    return max(c0 * 0.282094792 + (cy * normal.y + cz * normal.z + cx * normal.x) * 0.325735008, vec3(0.0));
}

// One channel of L1LightCurved; l1: its x, y and z.
float L1CurvedChannel(float l0, vec3 l1, vec3 normal)
{
    float r0 = l0 * 0.282094792;
    float r1 = length(l1) * 0.162867504;
    float ratio = min(r1 / max(r0, 1e-9), 1.0);
    float q = 0.5 + 0.5 * dot(l1, normal) / max(length(l1), 1e-9);
    float p = 1.0 + 2.0 * ratio;
    float a = (1.0 - ratio) / (1.0 + ratio);
    return max(0.0, r0) * (a + (1.0 - a) * (p + 1.0) * pow(max(0.0, q), p));
}

vec3 L1LightCurved(vec3 c0, vec3 cy, vec3 cz, vec3 cx, vec3 normal)
{
    return vec3(L1CurvedChannel(c0.x, vec3(cx.x, cy.x, cz.x), normal),
                L1CurvedChannel(c0.y, vec3(cx.y, cy.y, cz.y), normal),
                L1CurvedChannel(c0.z, vec3(cx.z, cy.z, cz.z), normal));
}

// The curve, scaled per channel so that the flat normal gives the light of a lightmap.
vec3 L1LightWithFlat(vec3 c0, vec3 cy, vec3 cz, vec3 cx, vec3 light, vec3 flatNormal, vec3 normal)
{
    vec3 least = max(c0 * (0.282094792 / 16.0), vec3(1e-9));
    vec3 down = max(L1LightCurved(c0, cy, cz, cx, flatNormal), least);
    return L1LightCurved(c0, cy, cz, cx, normal) * light / down;
}

// ---- Lightmass layout: normal in world space ----

// The color image alone. residual: of the other image's alpha, high quality: (alpha - 0.5) / 255, low quality: 0.
// black: 0.01858136 or 0.00390625.
vec3 LightmassColor(vec4 color, vec4 multiply, vec4 add, float residual, float black)
{
    float luminance = max(0.0, exp2((color.w + residual) * multiply.w + add.w) - black);
    vec3 root = vec3(color.x * multiply.x + add.x, color.y * multiply.y + add.y, color.z * multiply.z + add.z);
    return root * root * luminance;
}

// Factor of the direction image on LightmassColor; surfaces without a normal map can use 0.6 instead.
float LightmassFactor(vec4 direction, vec4 multiply, vec4 add, vec3 normal)
{
    return max(0.0, (direction.x * multiply.x + add.x) * normal.y + (direction.y * multiply.y + add.y) * normal.z +
                        (direction.z * multiply.z + add.z) * normal.x + add.w);
}

vec3 LightmassHigh(vec4 color, vec4 direction, vec4 colorMultiply, vec4 colorAdd, vec4 directionMultiply,
                   vec4 directionAdd, vec3 normal)
{
    return LightmassColor(color, colorMultiply, colorAdd, (direction.w - 0.5) / 255.0, 0.01858136) *
           LightmassFactor(direction, directionMultiply, directionAdd, normal);
}

vec3 LightmassLow(vec4 color, vec4 direction, vec4 colorMultiply, vec4 colorAdd, vec4 directionMultiply,
                  vec4 directionAdd, vec3 normal)
{
    return LightmassColor(color, colorMultiply, colorAdd, 0.0, 0.00390625) *
           LightmassFactor(direction, directionMultiply, directionAdd, normal);
}

// Ambient occlusion, 1 is open.
float Unoccluded(float texel)
{
    return texel * texel;
}

// Mean direction of the visible sky; its length is the visible share.
vec3 SkyOcclusion(vec4 texel)
{
    vec3 sky = vec3(texel.x, texel.y, texel.z) * 2.0 - vec3(1.0);
    return sky * (texel.w * texel.w / max(length(sky), 1e-3));
}
