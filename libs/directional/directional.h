/* SPDX-License-Identifier: MIT. Decoders of directional lightmaps, for engines. C99 and C++.

   A luxel holds the light of a surface as one of several encodings; each function here turns one of them into the light
   that a matte surface with a given normal receives, or a packed color into three floats. Light is linear, unit scale:
   1.0 is lightmap byte 255. Normals and directions are unit vectors and point away from the surface, towards the light.
   World space is the map's: x east, y north, z up. Tangent space is x along the texture coordinate s, y along t (down
   the image), z the normal of the surface. Results are never negative. See LICENSE and README.md beside this file. */
#ifndef DIRECTIONAL_H
#define DIRECTIONAL_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Factor of directional_ssbump: maps as they were gathered, or maps rescaled to the flat light (1 / sqrt(3)). */
#define DIRECTIONAL_RAW 1.0f
#define DIRECTIONAL_RESCALED 0.577350269f

/* Factors of coefficients L0 and L1 of radiance in the light of a matte surface, irradiance / pi: 1 / (2 sqrt(pi)), and
   2/3 of sqrt(3) / (2 sqrt(pi)). Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, 2001. */
#define DIRECTIONAL_L0 0.282094792f
#define DIRECTIONAL_L1 0.325735008f

static inline float directional_positive_(float value) {
    return value > 0 ? value : 0; /* NaN gives 0 */
}

static inline float directional_dot_(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- packed colors ---- */

/* Shared exponent, as GL's RGB9_E5: 9 bits each of red, green, blue from bit 0 up, then 5 of the exponent. Any code is
   valid; values are 0 to 65408. Exact. */
static inline void directional_e5bgr9(uint32_t code, float rgb[3]) {
    const float scale = ldexpf(1.0f, (int)(code >> 27) - 24);
    rgb[0] = (float)(code & 511) * scale;
    rgb[1] = (float)(code >> 9 & 511) * scale;
    rgb[2] = (float)(code >> 18 & 511) * scale;
}

/* Radiance RGBE: three bytes and an exponent, m * 2^(e - 136); exponent 0 is black. Any bytes are valid. Exact. */
static inline void directional_rgbe(const unsigned char rgbe[4], float rgb[3]) {
    const float scale = rgbe[3] == 0 ? 0.0f : ldexpf(1.0f, (int)rgbe[3] - 136);
    int i;
    for (i = 0; i < 3; i++)
        rgb[i] = (float)rgbe[i] * scale;
}

/* Source's ColorRGBExp32: three bytes and a signed exponent, m * 2^e with 255 as full light; the result is unit scale,
   that is, divided by 255. Any bytes are valid. Relative error 2^-24, from the division. */
static inline void directional_exp32(const unsigned char color[4], float rgb[3]) {
    const int exponent = color[3] < 128 ? color[3] : (int)color[3] - 256;
    int i;
    for (i = 0; i < 3; i++)
        rgb[i] = (float)ldexp((double)color[i] / 255, exponent);
}

/* ---- one light direction ---- */

/* Deluxe map: a lightmap color and the mean direction d of its light; gives the color times max(0, n . d). Normal and
   direction in the same space. This is the plain form of the Quake III family, in which the lightmap holds the light as
   if it came straight down on a flat surface: a flat normal gives light * (flat . d). Exact for one light of which the
   lightmap holds the full strength. */
static inline void directional_deluxe(const float light[3], const float direction[3], const float normal[3],
                                      float rgb[3]) {
    const float cosine = directional_positive_(directional_dot_(direction, normal));
    int i;
    for (i = 0; i < 3; i++)
        rgb[i] = directional_positive_(light[i]) * cosine;
}

/* The same for a lightmap that holds what the flat surface receives, as this compiler writes it: divided by flat . d,
   but not by less than `least` (above 0; 0.25 is usual), so that a flat normal gives the lightmap's light. Exact for
   one light whose flat . d is at least `least`. */
static inline void directional_deluxe_received(const float light[3], const float direction[3], const float flat[3],
                                               float least, const float normal[3], float rgb[3]) {
    const float down = directional_dot_(direction, flat);
    int i;
    directional_deluxe(light, direction, normal, rgb);
    for (i = 0; i < 3; i++)
        rgb[i] /= down > least ? down : least;
}

/* ---- radiosity normal mapping ---- */

/* The basis in tangent space. Orthonormal. */
static inline void directional_rnm_basis(float basis[3][3]) {
    static const float b[3][3] = {{0.816496581f, 0, 0.577350269f},
                                  {-0.408248290f, 0.707106781f, 0.577350269f},
                                  {-0.408248290f, -0.707106781f, 0.577350269f}};
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++)
            basis[i][k] = b[i][k];
}

/* max(0, n . b_i) for a normal in tangent space: the weights of the maps, and an SSBump texel without occlusion. */
static inline void directional_rnm_weights(const float normal[3], float weight[3]) {
    float basis[3][3];
    int i;
    directional_rnm_basis(basis);
    for (i = 0; i < 3; i++)
        weight[i] = directional_positive_(directional_dot_(normal, basis[i]));
}

/* Raw maps by linear weights, for a normal in tangent space. Exact for lights and normals in the octant of the basis,
   which holds all within 35.26 degrees of the flat normal. Beyond it too bright: at a flat normal by up to 0.24 of a
   light at 60 degrees, 0.47 of one at 90, and 1.73 times under uniform light. maps: red, green, blue of map 0, then of
   maps 1 and 2, nine floats, as everywhere below. */
static inline void directional_rnm_raw(const float *maps, const float normal[3], float rgb[3]) {
    float weight[3];
    int i;
    directional_rnm_weights(normal, weight);
    for (i = 0; i < 3; i++)
        rgb[i] = directional_positive_(weight[0] * maps[i] + weight[1] * maps[3 + i] + weight[2] * maps[6 + i]);
}

/* Rescaled maps (their mean is the flat light) by linear weights. A flat normal gives the flat light whatever the
   lights are; where raw maps are exact for a light, so are these. */
static inline void directional_rnm_rescaled(const float *maps, const float normal[3], float rgb[3]) {
    int i;
    directional_rnm_raw(maps, normal, rgb);
    for (i = 0; i < 3; i++)
        rgb[i] *= DIRECTIONAL_RESCALED;
}

/* Source's weights, squared and normalized: a weighted mean of the maps. Of rescaled maps a flat normal gives the flat
   light; of raw maps 0.577 of a light straight above. A normal that faces away from all of the basis gives 0. */
static inline void directional_rnm_squared(const float *maps, const float normal[3], float rgb[3]) {
    float weight[3], sum = 0;
    int i;
    directional_rnm_weights(normal, weight);
    for (i = 0; i < 3; i++) {
        weight[i] *= weight[i];
        sum += weight[i];
    }
    for (i = 0; i < 3; i++) {
        const float light = weight[0] * maps[i] + weight[1] * maps[3 + i] + weight[2] * maps[6 + i];
        rgb[i] = sum > 0 ? directional_positive_(light / sum) : 0;
    }
}

/* Self-shadowed bump map: texel is the response to each basis vector, 0 to 1, bytes / 255; not normalized. factor:
   DIRECTIONAL_RAW or DIRECTIONAL_RESCALED, as the maps are. With rescaled maps and factor 1, a flat texel is sqrt(3) =
   1.732 times too bright. */
static inline void directional_ssbump(const float texel[3], const float *maps, float factor, float rgb[3]) {
    int i;
    for (i = 0; i < 3; i++)
        rgb[i] = directional_positive_(factor * (texel[0] * maps[i] + texel[1] * maps[3 + i] + texel[2] * maps[6 + i]));
}

/* Normal of an SSBump texel in tangent space, unit length; a black texel gives the flat normal. */
static inline void directional_ssbump_normal(const float texel[3], float normal[3]) {
    float basis[3][3], length;
    int k;
    directional_rnm_basis(basis);
    for (k = 0; k < 3; k++)
        normal[k] = texel[0] * basis[0][k] + texel[1] * basis[1][k] + texel[2] * basis[2][k];
    length = sqrtf(directional_dot_(normal, normal));
    for (k = 0; k < 3; k++)
        normal[k] = length > 0 ? normal[k] / length : (k == 2 ? 1.0f : 0.0f);
}

/* A dynamic light on an SSBump texel: the share of it that the texel receives; direction to the light, tangent space.
 */
static inline float directional_ssbump_light(const float texel[3], const float direction[3]) {
    float basis[3][3];
    directional_rnm_basis(basis);
    return directional_positive_(texel[0] * directional_dot_(basis[0], direction) +
                                 texel[1] * directional_dot_(basis[1], direction) +
                                 texel[2] * directional_dot_(basis[2], direction));
}

/* ---- L1 spherical harmonics ---- */

/* Radiance coefficients L0, y, z, x, red green blue each, twelve floats, not convolved; normal in their space, which is
   the world's.
   One light of 1 gives 0.25 + 0.5 cos: 0.75 facing it, 0.25 at right angles, and less than 0 beyond 120 degrees, which
   is cut to 0. Root mean square error over all normals, before the cut: 0.144. */
static inline void directional_l1(const float *sh, const float normal[3], float rgb[3]) {
    int i;
    for (i = 0; i < 3; i++)
        rgb[i] = directional_positive_(DIRECTIONAL_L0 * sh[i] +
                                       DIRECTIONAL_L1 *
                                           (sh[3 + i] * normal[1] + sh[6 + i] * normal[2] + sh[9 + i] * normal[0]));
}

/* A curve in place of the linear form, never negative and of the same mean over all normals (Geomerics):
   R0 (a + (1 - a) (p + 1) q^p), where the linear form is R0 + 2 R1 . n. One light c gives c q^3, q = (1 + cos) / 2, so
   c facing it; uniform light is exact. R1 longer than R0, which no light has, counts as R0. */
static inline void directional_l1_curved(const float *sh, const float normal[3], float rgb[3]) {
    int i;
    for (i = 0; i < 3; i++) {
        const float r0 = DIRECTIONAL_L0 * sh[i];
        const float r1[3] = {DIRECTIONAL_L1 / 2 * sh[9 + i], DIRECTIONAL_L1 / 2 * sh[3 + i],
                             DIRECTIONAL_L1 / 2 * sh[6 + i]};
        const float length = sqrtf(directional_dot_(r1, r1)), ratio = length < r0 ? length / r0 : 1;
        const float q = length > 0 ? 0.5f * (1 + directional_dot_(r1, normal) / length) : 0.5f;
        const float p = 1 + 2 * ratio, a = (1 - ratio) / (1 + ratio);
        rgb[i] = r0 > 0 ? r0 * (a + (1 - a) * (p + 1) * powf(directional_positive_(q), p)) : 0;
    }
}

/* The curve, scaled per channel to the light that a lightmap holds for the flat normal: a flat normal gives that light,
   whatever the two bands miss. Where the curve gives the flat normal less than a sixteenth of R0, a sixteenth counts.
 */
static inline void directional_l1_with_flat(const float *sh, const float light[3], const float flat[3],
                                            const float normal[3], float rgb[3]) {
    float down[3];
    int i;
    directional_l1_curved(sh, flat, down);
    directional_l1_curved(sh, normal, rgb);
    for (i = 0; i < 3; i++) {
        const float least = DIRECTIONAL_L0 * sh[i] / 16;
        const float scale = down[i] > least ? down[i] : least;
        rgb[i] = scale > 0 ? rgb[i] * (directional_positive_(light[i]) / scale) : directional_positive_(light[i]);
    }
}

/* ---- Lightmass layout ---- */

/* From the values of texels, 0 to 1, to coefficients: value * multiply + add for each channel, [0] of the color image,
   [1] of the direction image. add[1][3] is the constant term of the luminance factor. */
typedef struct {
    float multiply[2][4], add[2][4];
} directional_range;

/* Luminance factor of a normal from its constant term and the direction image's three coefficients (y, z, x). */
static inline float directional_lightmass_factor_(const float direction[3], float constant, const float normal[3]) {
    return directional_positive_(constant + direction[0] * normal[1] + direction[1] * normal[2] +
                                 direction[2] * normal[0]);
}

/* Color of two coefficient images at values 0 to 1 (texels as a sampler returns them, filtered or not). Color image:
   square roots of the chromaticity, then log2 of the luminance; direction image: (y, z, x). residual: added to the
   value of the log, at most half a step of 1 / 255; black: what was added to the luminance before its log was taken,
   2^-5.75 or 2^-8. */
static inline void directional_lightmass_(const float color[4], const float direction[4],
                                          const directional_range *range, float residual, float black,
                                          const float *normal, float rgb[3]) {
    const float logged = (color[3] + residual) * range->multiply[0][3] + range->add[0][3];
    float luminance = directional_positive_(exp2f(logged) - black), d[3];
    int i;
    for (i = 0; i < 3; i++)
        d[i] = direction[i] * range->multiply[1][i] + range->add[1][i];
    if (normal)
        luminance *= directional_lightmass_factor_(d, range->add[1][3], normal);
    else
        luminance *= 0.6f; /* as Unreal Engine does without directions */
    for (i = 0; i < 3; i++) {
        const float root = color[i] * range->multiply[0][i] + range->add[0][i];
        rgb[i] = luminance * root * root;
    }
}

/* High quality: texels 0 to 1; normal in the space of the baked directions, which is the world's, or NULL for no
   direction: 0.6 takes the factor's place. At the normal that the luxel was baked with, the error of the
   luminance is at most 1.2e-4 (luminance + 2^-5.75). */
static inline void directional_lightmass_high(const float color[4], const float direction[4],
                                              const directional_range *range, const float *normal, float rgb[3]) {
    directional_lightmass_(color, direction, range, (direction[3] - 0.5f) / 255, 0.01858136f, normal, rgb);
}

/* Low quality: log luminance in one byte, error up to 2.2 % of (luminance + 2^-8) over the whole range of 2^16, less
   where the map's own range is smaller. */
static inline void directional_lightmass_low(const float color[4], const float direction[4],
                                             const directional_range *range, const float *normal, float rgb[3]) {
    directional_lightmass_(color, direction, range, 0, 0.00390625f, normal, rgb);
}

/* Bytes of an image as values 0 to 1. */
static inline void directional_texel(const unsigned char bytes[4], float value[4]) {
    int i;
    for (i = 0; i < 4; i++)
        value[i] = (float)bytes[i] / 255;
}

/* Ambient occlusion, 1 is open: stored as the square root. Error 1 / 255. */
static inline float directional_unoccluded(float value) {
    return value * value;
}

/* Mean direction of the visible sky; its length is the visible share. texel, 0 to 1: the direction, of which 0.5 is 0,
   and the square root of the share. */
static inline void directional_sky_occlusion(const float texel[4], float sky[3]) {
    float length;
    int i;
    for (i = 0; i < 3; i++)
        sky[i] = texel[i] * 2 - 1;
    length = sqrtf(directional_dot_(sky, sky));
    for (i = 0; i < 3; i++)
        sky[i] *= length > 0 ? texel[3] * texel[3] / length : 0;
}

#ifdef __cplusplus
}
#endif

#endif
