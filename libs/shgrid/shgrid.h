/* SPDX-License-Identifier: MIT. Reader of the SH light grid of Quake III maps, for engines. C99 and C++.

   The grid is a box of points with nine L2 spherical-harmonics coefficients each, red green blue. Axes are the map's: x
   east, y north, z up. By default the coefficients are convolved with the cosine, so that the plain sum over the basis
   is the light that a matte surface receives; 1.0 is lightmap byte 255, linear. See LICENSE and README.md beside this
   file. */
#ifndef SHGRID_H
#define SHGRID_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SHGRID_HEADER_BYTES 40
#define SHGRID_POINT_BYTES 108

typedef enum {
    SHGRID_OK,
    SHGRID_ABSENT,     /* a good map, without an SH light grid */
    SHGRID_NOT_BSP,    /* not an IBSP file of version 46 or 47 */
    SHGRID_TRUNCATED,  /* shorter than its header, or than its points need */
    SHGRID_BAD_OFFSET, /* a lump outside the file or inside the header */
    SHGRID_BAD_MINS,   /* position of the first point is not finite */
    SHGRID_BAD_CELL,   /* distance between points is not above zero */
    SHGRID_BAD_BOUNDS, /* fewer than one point on an axis */
    SHGRID_BAD_COUNT,  /* number of points is not the product of the bounds, or not what the lump holds */
    SHGRID_BAD_TONE    /* tone text is not pairs of a word and a number, or a number is out of range */
} shgrid_result;

/* Points into the caller's memory: keep the file or the lump as long as the grid. */
typedef struct {
    float mins[3];               /* world position of point (0, 0, 0) */
    float cell[3];               /* distance between points, world units */
    int32_t bounds[3];           /* points per axis, each at least 1 */
    int32_t count;               /* product of bounds */
    const unsigned char *points; /* SHGRID_POINT_BYTES each, any alignment, little endian */
} shgrid_grid;

/* Nine coefficients, index l * l + l + m, red green blue. */
typedef struct {
    float c[9][3];
} shgrid_coeffs;

/* How the light of a map became lightmap bytes; all numbers are finite. Plain values change nothing but light above
   255. See shgrid_apply_tone. */
typedef struct {
    float contrast;   /* factor around byte 128, plain 1 */
    float gamma;      /* above 0, plain 1 */
    float exposure;   /* byte scale, plain 0: none */
    float saturation; /* plain 1 */
    float scale;      /* above 0, plain 1 */
    float maxlight;   /* byte scale, 0 to 255, plain 255 */
    int srgb;         /* plain 0 */
} shgrid_tone;

static inline const char *shgrid_message(shgrid_result result) {
    switch (result) {
    case SHGRID_OK:
        return "no error";
    case SHGRID_ABSENT:
        return "the map has no SH light grid";
    case SHGRID_NOT_BSP:
        return "not an IBSP file of version 46 or 47";
    case SHGRID_TRUNCATED:
        return "the data ends early";
    case SHGRID_BAD_OFFSET:
        return "a lump lies outside the file";
    case SHGRID_BAD_MINS:
        return "the grid's origin is not finite";
    case SHGRID_BAD_CELL:
        return "the grid's cell size is not above zero";
    case SHGRID_BAD_BOUNDS:
        return "the grid has less than one point on an axis";
    case SHGRID_BAD_COUNT:
        return "the number of points disagrees with the grid's bounds or its lump";
    case SHGRID_BAD_TONE:
        return "the tone is not words with numbers in range";
    }
    return "unknown result";
}

static inline uint32_t shgrid_u32_(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static inline float shgrid_f32_(const unsigned char *p) {
    const uint32_t bits = shgrid_u32_(p);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Entry `slot` of the lump table. Offsets and lengths above 2^31 - 1 are negative numbers in the format: out of range.
 */
static inline int shgrid_slot_(const unsigned char *file, size_t size, unsigned slot, uint64_t *offset,
                               uint64_t *length) {
    *offset = shgrid_u32_(file + 8 + 8 * slot);
    *length = shgrid_u32_(file + 12 + 8 * slot);
    return *offset <= INT32_MAX && *length <= INT32_MAX && *offset + *length <= size;
}

static inline shgrid_result shgrid_find_bspx_(const unsigned char *file, size_t size, uint64_t start,
                                              const unsigned char **lump, size_t *lumpSize) {
    static const char name[24] = "LIGHTGRID_SH";
    uint64_t count, i;
    if (start + 8 > size || memcmp(file + start, "BSPX", 4) != 0)
        return SHGRID_ABSENT;
    count = shgrid_u32_(file + start + 4);
    if (count > (size - start - 8) / 32)
        return SHGRID_TRUNCATED;
    for (i = 0; i < count; i++) {
        const unsigned char *entry = file + start + 8 + 32 * i;
        const uint64_t offset = shgrid_u32_(entry + 24), length = shgrid_u32_(entry + 28);
        if (memcmp(entry, name, sizeof "LIGHTGRID_SH") != 0)
            continue;
        if (offset < start + 8 + 32 * count || offset + length > size)
            return SHGRID_BAD_OFFSET;
        *lump = file + offset;
        *lumpSize = (size_t)length;
        return SHGRID_OK;
    }
    return SHGRID_ABSENT;
}

/* Finds the SH lump of a whole .bsp file image: slot 18 of a version 47 file with 19 slots, else BSPX. */
static inline shgrid_result shgrid_find(const void *data, size_t size, const unsigned char **lump, size_t *lumpSize) {
    const unsigned char *file = (const unsigned char *)data;
    uint64_t offset, length, first = UINT64_MAX, end = 0;
    uint32_t version;
    unsigned slot;
    *lump = NULL;
    *lumpSize = 0;
    if (size < 8 || memcmp(file, "IBSP", 4) != 0)
        return SHGRID_NOT_BSP;
    version = shgrid_u32_(file + 4);
    if (version != 46 && version != 47)
        return SHGRID_NOT_BSP;
    if (size < 8 + 8 * 17)
        return SHGRID_TRUNCATED;
    for (slot = 0; slot < 17; slot++) {
        if (!shgrid_slot_(file, size, slot, &offset, &length) || (length > 0 && offset < 8 + 8 * 17))
            return SHGRID_BAD_OFFSET;
        if (length > 0 && offset < first)
            first = offset;
        if (offset + length > end)
            end = offset + length;
    }
    /* The format does not store its number of slots: slots 17 and 18 exist only if no lump begins before they end.
       Their bytes may also be text, so an entry that cannot be a lump is ignored, unless the first lump begins right
       after slot 18. */
    if (version == 47 && first >= 8 + 8 * 18 && size >= 8 + 8 * 18)
        if (shgrid_slot_(file, size, 17, &offset, &length) && offset >= 8 + 8 * 18 && length % 128 == 0 &&
            offset + length > end)
            end = offset + length;
    if (version == 47 && first >= 8 + 8 * 19 && size >= 8 + 8 * 19) {
        const int inside = shgrid_slot_(file, size, 18, &offset, &length) && offset >= 8 + 8 * 19;
        if (inside && length > SHGRID_HEADER_BYTES) {
            *lump = file + offset;
            *lumpSize = (size_t)length;
            return SHGRID_OK;
        }
        if (length > 0 && first == 8 + 8 * 19)
            return inside ? SHGRID_TRUNCATED : SHGRID_BAD_OFFSET;
    }
    return shgrid_find_bspx_(file, size, (end + 3) & ~(uint64_t)3, lump, lumpSize);
}

/* Parses the bytes of the lump; the grid points into them. On failure the grid is empty and must not be sampled. */
static inline shgrid_result shgrid_parse(const void *data, size_t size, shgrid_grid *grid) {
    const unsigned char *lump = (const unsigned char *)data;
    uint64_t product = 1;
    uint32_t count;
    int i;
    memset(grid, 0, sizeof *grid);
    if (size < SHGRID_HEADER_BYTES)
        return SHGRID_TRUNCATED;
    count = shgrid_u32_(lump + 36);
    for (i = 0; i < 3; i++) {
        const uint32_t bounds = shgrid_u32_(lump + 24 + 4 * i);
        grid->mins[i] = shgrid_f32_(lump + 4 * i);
        grid->cell[i] = shgrid_f32_(lump + 12 + 4 * i);
        if (!isfinite(grid->mins[i]))
            return SHGRID_BAD_MINS;
        if (!isfinite(grid->cell[i]) || !(grid->cell[i] > 0))
            return SHGRID_BAD_CELL;
        if (bounds < 1 || bounds > INT32_MAX)
            return SHGRID_BAD_BOUNDS;
        grid->bounds[i] = (int32_t)bounds;
        product *= bounds;
        if (product > INT32_MAX)
            return SHGRID_BAD_COUNT;
    }
    if (product != count)
        return SHGRID_BAD_COUNT;
    if ((size - SHGRID_HEADER_BYTES) / SHGRID_POINT_BYTES < count)
        return SHGRID_TRUNCATED;
    if (size != SHGRID_HEADER_BYTES + SHGRID_POINT_BYTES * (uint64_t)count)
        return SHGRID_BAD_COUNT;
    grid->count = (int32_t)count;
    grid->points = lump + SHGRID_HEADER_BYTES;
    return SHGRID_OK;
}

/* Finds and parses the grid of a whole .bsp file image. */
static inline shgrid_result shgrid_load(const void *file, size_t size, shgrid_grid *grid) {
    const unsigned char *lump;
    size_t lumpSize;
    const shgrid_result result = shgrid_find(file, size, &lump, &lumpSize);
    memset(grid, 0, sizeof *grid);
    return result == SHGRID_OK ? shgrid_parse(lump, lumpSize, grid) : result;
}

/* Coefficients of point (x, y, z); each coordinate in 0 .. bounds - 1. */
static inline void shgrid_point(const shgrid_grid *grid, int32_t x, int32_t y, int32_t z, shgrid_coeffs *out) {
    const size_t index = (size_t)x + (size_t)grid->bounds[0] * ((size_t)y + (size_t)grid->bounds[1] * (size_t)z);
    const unsigned char *p = grid->points + SHGRID_POINT_BYTES * index;
    int k, channel;
    for (k = 0; k < 9; k++)
        for (channel = 0; channel < 3; channel++)
            out->c[k][channel] = shgrid_f32_(p + 12 * k + 4 * channel);
}

/* Trilinear blend at a world position; positions outside the grid are clamped to it. */
static inline void shgrid_sample(const shgrid_grid *grid, const float position[3], shgrid_coeffs *out) {
    int32_t low[3];
    float fraction[3];
    int axis, corner, k, channel;
    memset(out, 0, sizeof *out);
    for (axis = 0; axis < 3; axis++) {
        const int32_t last = grid->bounds[axis] - 1;
        double at = ((double)position[axis] - grid->mins[axis]) / grid->cell[axis];
        if (!(at > 0)) /* NaN too */
            at = 0;
        if (at > last)
            at = last;
        low[axis] = (int32_t)at;
        fraction[axis] = (float)(at - low[axis]);
    }
    for (corner = 0; corner < 8; corner++) {
        shgrid_coeffs point;
        int32_t at[3];
        float weight = 1;
        for (axis = 0; axis < 3; axis++) {
            const int upper = corner >> axis & 1;
            at[axis] = low[axis] + upper;
            weight *= upper ? fraction[axis] : 1 - fraction[axis];
        }
        if (!(weight > 0)) /* on the far border, `at` may be one past the end: its weight is zero */
            continue;
        shgrid_point(grid, at[0], at[1], at[2], &point);
        for (k = 0; k < 9; k++)
            for (channel = 0; channel < 3; channel++)
                out->c[k][channel] += weight * point.c[k][channel];
    }
}

/* Light on a matte surface with that unit normal; not below zero. */
static inline void shgrid_evaluate(const shgrid_coeffs *coeffs, const float normal[3], float rgb[3]) {
    const float x = normal[0], y = normal[1], z = normal[2];
    const float basis[9] = {0.282094791773878f,
                            0.488602511902920f * y,
                            0.488602511902920f * z,
                            0.488602511902920f * x,
                            1.092548430592079f * x * y,
                            1.092548430592079f * y * z,
                            0.315391565252520f * (3 * z * z - 1),
                            1.092548430592079f * x * z,
                            0.546274215296040f * (x * x - y * y)};
    int k, channel;
    for (channel = 0; channel < 3; channel++) {
        float sum = 0;
        for (k = 0; k < 9; k++)
            sum += coeffs->c[k][channel] * basis[k];
        rgb[channel] = sum > 0 ? sum : 0; /* NaN gives 0 */
    }
}

/* Light at a world position on a surface with that unit normal. */
static inline void shgrid_light(const shgrid_grid *grid, const float position[3], const float normal[3], float rgb[3]) {
    shgrid_coeffs coeffs;
    shgrid_sample(grid, position, &coeffs);
    shgrid_evaluate(&coeffs, normal, rgb);
}

/* For maps baked with -shradiance (worldspawn key _q3map2_sh has the value radiance), which hold the plain projection:
   multiplies each band by its factor of the clamped cosine (pi, 2 pi / 3, pi / 4), which gives the default form. */
static inline void shgrid_convolve(shgrid_coeffs *coeffs) {
    static const float lobe[3] = {3.14159265358979f, 2.09439510239320f, 0.785398163397448f};
    int k, channel;
    for (k = 0; k < 9; k++)
        for (channel = 0; channel < 3; channel++)
            coeffs->c[k][channel] *= lobe[k == 0 ? 0 : k < 4 ? 1 : 2];
}

static inline int shgrid_blank_(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static inline int shgrid_digit_(char c) {
    return c >= '0' && c <= '9';
}

/* Parses a decimal number up to the next blank, without strtod, which depends on the locale. Returns its end; NULL if
   it is not a number or not finite as a float. */
static inline const char *shgrid_number_(const char *at, float *value) {
    const int negative = *at == '-';
    double mantissa = 0;
    int digits = 0, scale = 0, power = 0, minus;
    for (at += negative || *at == '+'; shgrid_digit_(*at); at++, digits = 1)
        mantissa = 10 * mantissa + (*at - '0');
    if (*at == '.')
        for (at++; shgrid_digit_(*at); at++, digits = 1, scale -= scale > -400)
            mantissa = scale > -400 ? 10 * mantissa + (*at - '0') : mantissa;
    if (!digits)
        return NULL;
    if (*at == 'e' || *at == 'E') {
        minus = at[1] == '-';
        at += minus || at[1] == '+' ? 2 : 1;
        if (!shgrid_digit_(*at))
            return NULL;
        for (; shgrid_digit_(*at); at++)
            power = power < 1000 ? 10 * power + (*at - '0') : power;
        scale += minus ? -power : power;
    }
    mantissa = scale < 0 ? mantissa / pow(10, -scale) : mantissa * pow(10, scale);
    *value = (float)(negative ? -mantissa : mantissa);
    return isfinite(*value) && (*at == '\0' || shgrid_blank_(*at)) ? at : NULL;
}

/* Parses the value of the worldspawn key _q3map2_tone, such as "gamma 1.4 scale 0.5". Unknown words are skipped with
   their number; what is not named is plain. NULL or no words is a map without the key: SHGRID_OK and a plain tone. Any
   other text gives a plain tone and SHGRID_BAD_TONE. */
static inline shgrid_result shgrid_parse_tone(const char *text, shgrid_tone *tone) {
    static const char *const words[7] = {"contrast", "gamma", "exposure", "saturation", "scale", "maxlight", "srgb"};
    static const shgrid_tone plain = {1, 1, 0, 1, 1, 255, 0};
    float values[7] = {1, 1, 0, 1, 1, 255, 0};
    const char *at = text ? text : "";
    int i;
    *tone = plain;
    for (;;) {
        const char *word;
        size_t length;
        float value;
        while (shgrid_blank_(*at))
            at++;
        if (*at == '\0')
            break;
        for (word = at; *at != '\0' && !shgrid_blank_(*at);)
            at++;
        length = (size_t)(at - word);
        while (shgrid_blank_(*at))
            at++;
        at = shgrid_number_(at, &value);
        if (at == NULL)
            return SHGRID_BAD_TONE;
        for (i = 0; i < 7; i++)
            if (strlen(words[i]) == length && memcmp(words[i], word, length) == 0)
                values[i] = value;
    }
    if (!(values[1] > 0) || !(values[4] > 0) || !(values[5] >= 0 && values[5] <= 255))
        return SHGRID_BAD_TONE;
    tone->contrast = values[0];
    tone->gamma = values[1];
    tone->exposure = values[2];
    tone->saturation = values[3];
    tone->scale = values[4];
    tone->maxlight = values[5];
    tone->srgb = values[6] != 0;
    return SHGRID_OK;
}

static inline float shgrid_largest_(const float rgb[3]) {
    const float most = rgb[0] > rgb[1] ? rgb[0] : rgb[1];
    return most > rgb[2] ? most : rgb[2];
}

/* Contrast, gamma, exposure and saturation; byte scale. */
static inline void shgrid_grade_(const shgrid_tone *tone, float v[3]) {
    float most, gray;
    int i;
    for (i = 0; i < 3; i++) {
        if (tone->contrast != 1)
            v[i] = tone->contrast * (v[i] - 128) + 128;
        v[i] = v[i] > 0 ? v[i] : 0; /* NaN gives 0 */
        if (tone->gamma != 1)
            v[i] = 255 * powf(v[i] / 255, 1 / tone->gamma);
    }
    most = shgrid_largest_(v);
    if (tone->exposure != 0 && most > 0)
        for (i = 0; i < 3; i++)
            v[i] *= (1 - expf(-most / tone->exposure)) * 255 / most;
    gray = 0.3086f * v[0] + 0.6094f * v[1] + 0.0820f * v[2];
    if (tone->saturation != 1)
        for (i = 0; i < 3; i++) {
            v[i] = gray * (1 - tone->saturation) + v[i] * tone->saturation;
            v[i] = v[i] > 0 ? v[i] : 0;
        }
}

/* Turns light from shgrid_evaluate or shgrid_light (1.0 is byte 255, linear) into what the compiler would have stored
   in a lightmap: texel / 255, from 0 to 1, not yet rounded to a byte. A color that is too bright keeps its hue. */
static inline void shgrid_apply_tone(const shgrid_tone *tone, float rgb[3]) {
    float v[3], most;
    int i;
    for (i = 0; i < 3; i++)
        v[i] = 255 * rgb[i];
    shgrid_grade_(tone, v);
    for (i = 0; i < 3; i++)
        v[i] *= tone->scale;
    most = shgrid_largest_(v);
    for (i = 0; i < 3; i++) {
        float c = (most > tone->maxlight ? v[i] * (tone->maxlight / most) : v[i]) / 255;
        if (tone->srgb)
            c = c < 0.0031308f ? 12.92f * c : 1.055f * powf(c, 1 / 2.4f) - 0.055f;
        rgb[i] = c > 0 ? (c < 1 ? c : 1) : 0;
    }
}

#ifdef __cplusplus
}
#endif

#endif
