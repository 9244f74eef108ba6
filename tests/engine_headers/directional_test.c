/* GPL-2.0-or-later. The decoders of directional lightmaps as a C99 program sees them: every function once, on values
   that follow from its formula. */
#include "libs/directional/directional.h"
#include "tests/engine_headers/check.h"

#include <stdio.h>
#include <stdlib.h>

/* Of the decoders, which compute in float. */
#define CHECK_VALUE(got, expected) CHECK_NEAR(got, expected, 2e-5)

static const float flat[3] = {0, 0, 1}, east[3] = {1, 0, 0};

static void test_packed(void) {
    const unsigned char rgbe[4] = {128, 64, 0, 129}, exp32[4] = {255, 51, 0, 255};
    float rgb[3];
    directional_e5bgr9(256u | 128u << 9 | 64u << 18 | 16u << 27, rgb);
    CHECK_VALUE(rgb[0], 1);
    CHECK_VALUE(rgb[1], 0.5);
    CHECK_VALUE(rgb[2], 0.25);
    directional_rgbe(rgbe, rgb);
    CHECK_VALUE(rgb[0], 1);
    CHECK_VALUE(rgb[1], 0.5);
    directional_exp32(exp32, rgb); /* exponent -1 */
    CHECK_VALUE(rgb[0], 0.5);
    CHECK_VALUE(rgb[1], 0.1);
}

static void test_deluxe(void) {
    const float light[3] = {0.8f, 0.4f, 0}, slanted[3] = {0.6f, 0, 0.8f};
    float rgb[3];
    directional_deluxe(light, slanted, flat, rgb);
    CHECK_VALUE(rgb[0], 0.64);
    directional_deluxe_received(light, slanted, flat, 0.25f, flat, rgb);
    CHECK_VALUE(rgb[0], 0.8);
    CHECK_VALUE(rgb[1], 0.4);
    directional_deluxe_received(light, east, flat, 0.25f, east, rgb);
    CHECK_VALUE(rgb[0], 3.2);
}

static void test_rnm(void) {
    const float maps[3][3] = {{0.6f, 0, 1}, {0.3f, 0, 1}, {0, 0, 1}}, down[3] = {0, 0, -1};
    float basis[3][3], weight[3], rgb[3];
    directional_rnm_basis(basis);
    CHECK_VALUE(basis[1][1], 0.70710678);
    directional_rnm_weights(east, weight);
    CHECK_VALUE(weight[0], 0.81649658);
    CHECK_VALUE(weight[1], 0);
    directional_rnm_raw(&maps[0][0], flat, rgb);
    CHECK_VALUE(rgb[0], 0.9 * 0.57735027);
    directional_rnm_rescaled(&maps[0][0], flat, rgb);
    CHECK_VALUE(rgb[0], 0.3);
    CHECK_VALUE(rgb[2], 1);
    directional_rnm_squared(&maps[0][0], flat, rgb);
    CHECK_VALUE(rgb[0], 0.3);
    directional_rnm_squared(&maps[0][0], down, rgb);
    CHECK_VALUE(rgb[2], 0);
}

static void test_ssbump(void) {
    const float texel[3] = {0.5f, 0.25f, 0}, maps[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    float basis[3][3], rgb[3], normal[3];
    directional_ssbump(texel, &maps[0][0], DIRECTIONAL_RAW, rgb);
    CHECK_VALUE(rgb[0], 0.5);
    CHECK_VALUE(rgb[1], 0.25);
    directional_ssbump(texel, &maps[0][0], DIRECTIONAL_RESCALED, rgb);
    CHECK_VALUE(rgb[0], 0.5 * 0.57735027);
    directional_ssbump_normal(texel, normal);
    directional_rnm_basis(basis);
    CHECK_VALUE(normal[0] * basis[0][0] + normal[1] * basis[0][1] + normal[2] * basis[0][2], 2 / sqrt(5));
    CHECK_VALUE(directional_ssbump_light(texel, basis[1]), 0.25);
}

static void test_l1(void) {
    const float sh[4][3] = {{3.5449077f, 0, 1}, {0, 1, 0}, {0, 0, 0}, {0, 0, -4}}, north[3] = {0, 1, 0};
    float rgb[3];
    directional_l1(&sh[0][0], north, rgb);
    CHECK_VALUE(rgb[0], 1);
    CHECK_VALUE(rgb[1], 0.325735);
    CHECK_VALUE(rgb[2], 0.282095);
    directional_l1(&sh[0][0], east, rgb);
    CHECK_VALUE(rgb[2], 0);
    directional_l1_with_flat(&sh[0][0], north, north, north, rgb);
    CHECK_VALUE(rgb[0], 0);
    CHECK_VALUE(rgb[1], 1);
    directional_l1_curved(&sh[0][0], north, rgb);
    CHECK_VALUE(rgb[0], 1);
}

/* Luminance 1 over 0.846285, the factor of a light that comes along z; white. */
static void test_lightmass(void) {
    const unsigned char bytes[4] = {255, 255, 255, 0};
    const directional_range range = {{{0, 0, 0, 2}, {0, 0.564190f, 0, 0}},
                                     {{1, 1, 1, log2f(1 / 0.846285f + 0.01858136f)}, {0, 0, 0, 0.282095f}}};
    const float direction[4] = {0, 1, 0, 0.5f}, below[3] = {0, 0, -1};
    float color[4], rgb[3], sky[3];
    const float seen[4] = {0.5f, 0.5f, 1, 0.5f};
    directional_texel(bytes, color);
    CHECK_VALUE(color[0], 1);
    directional_lightmass_high(color, direction, &range, flat, rgb);
    CHECK_VALUE(rgb[0], 1);
    directional_lightmass_high(color, direction, &range, below, rgb);
    CHECK_VALUE(rgb[0], 0);
    directional_lightmass_high(color, direction, &range, NULL, rgb);
    CHECK_VALUE(rgb[1], 0.6 / 0.846285);
    directional_lightmass_low(color, direction, &range, flat, rgb);
    CHECK_VALUE(rgb[0], 1 + (0.01858136 - 0.00390625) * 0.846285);
    directional_sky_occlusion(seen, sky);
    CHECK_VALUE(sky[2], 0.25);
    CHECK_VALUE(directional_unoccluded(0.5f), 0.25);
}

int main(void) {
    test_packed();
    test_deluxe();
    test_rnm();
    test_ssbump();
    test_l1();
    test_lightmass();
    return CheckResult();
}
