/* SPDX-License-Identifier: MIT. Reader of the ambient cubes of Quake III maps, for engines. C99 and C++.

   A cube is the light on six matte surfaces that face the axes of the map, at a position: x east, y north, z up. Each
   leaf of the map's tree has some cubes, usually up to 16, or uses those of another leaf. 1.0 is lightmap byte 255,
   linear. See LICENSE and README.md beside this file. */
#ifndef AMBIENT_CUBES_H
#define AMBIENT_CUBES_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* ---- bspx.h: begin ---- */
#ifndef BSPX_H
#define BSPX_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    BSPX_OK,
    BSPX_ABSENT,    /* a good map, without that lump */
    BSPX_NOT_BSP,   /* neither IBSP of version 46 or 47 nor RBSP or FBSP of version 1 */
    BSPX_TRUNCATED, /* shorter than its header or its BSPX directory */
    BSPX_BAD_OFFSET /* a lump outside the file or inside the header */
} bspx_result;

/* Bytes in the caller's memory, at any alignment. */
typedef struct {
    const unsigned char *data;
    size_t size;
} bspx_lump;

/* A whole .bsp file in the caller's memory. */
typedef struct {
    const unsigned char *data;
    size_t size;
    uint32_t version;   /* 46 or 47: IBSP; 1: RBSP or FBSP */
    unsigned slots;     /* of the header, that every file of the format has */
    uint64_t firstLump; /* offset of the first lump that is not empty */
    uint64_t directory; /* where the BSPX directory begins, if there is one */
} bspx_file;

static inline uint32_t bspx_u32(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* The lump in a slot of the header: 0 to 16; of RBSP and FBSP also 17, the light array; of IBSP 47 also 17 and 18,
   which not every file has. `bsp` is what bspx_open gave. An empty lump of a slot that every file has is BSPX_OK with
   size 0. */
static inline bspx_result bspx_slot(const bspx_file *bsp, unsigned slot, bspx_lump *lump) {
    const uint64_t header = 8 + 8 * (slot < bsp->slots ? bsp->slots : (uint64_t)slot + 1);
    uint64_t offset, length;
    lump->data = NULL;
    lump->size = 0;
    /* IBSP does not store its number of slots: 17 and 18 exist only if no lump begins before they end. */
    if (slot >= bsp->slots && (slot > 18 || bsp->version != 47 || bsp->firstLump < header || bsp->size < header))
        return BSPX_ABSENT;
    offset = bspx_u32(bsp->data + 8 + 8 * slot);
    length = bspx_u32(bsp->data + 12 + 8 * slot);
    if (slot >= bsp->slots && length == 0)
        return BSPX_ABSENT;
    /* Numbers above 2^31 - 1 are negative in the format. */
    if (offset > INT32_MAX || length > INT32_MAX || offset + length > bsp->size || (length > 0 && offset < header))
        /* Slots 17 and 18 of IBSP are sure to exist only where the first lump begins right behind the header. Where it
           begins later, the bytes may be text of another compiler, so bad numbers mean that there is no such slot. */
        return slot >= bsp->slots && bsp->firstLump != header ? BSPX_ABSENT : BSPX_BAD_OFFSET;
    lump->data = bsp->data + offset;
    lump->size = (size_t)length;
    return BSPX_OK;
}

/* Checks the header of a file image, which must be kept as long as `bsp` and its lumps. */
static inline bspx_result bspx_open(const void *data, size_t size, bspx_file *bsp) {
    uint64_t end = 0;
    unsigned slot;
    bspx_lump lump;
    bsp->data = (const unsigned char *)data;
    bsp->size = size;
    bsp->version = 0;
    bsp->slots = 0;
    bsp->firstLump = UINT64_MAX;
    bsp->directory = 0;
    if (size < 8)
        return BSPX_NOT_BSP;
    bsp->version = bspx_u32(bsp->data + 4);
    if (memcmp(data, "IBSP", 4) == 0 && (bsp->version == 46 || bsp->version == 47))
        bsp->slots = 17;
    else if ((memcmp(data, "RBSP", 4) == 0 || memcmp(data, "FBSP", 4) == 0) && bsp->version == 1)
        bsp->slots = 18;
    else
        return BSPX_NOT_BSP;
    if (size < 8 + 8 * (uint64_t)bsp->slots)
        return BSPX_TRUNCATED;
    for (slot = 0; slot < bsp->slots; slot++) {
        const uint64_t offset = bspx_u32(bsp->data + 8 + 8 * slot);
        if (bspx_slot(bsp, slot, &lump) != BSPX_OK)
            return BSPX_BAD_OFFSET;
        if (lump.size > 0 && offset < bsp->firstLump)
            bsp->firstLump = offset;
        if (offset + lump.size > end)
            end = offset + lump.size;
    }
    for (; slot < 19; slot++) {
        /* IBSP 47: advertisements have 128 bytes each, the SH light grid a header of 40. */
        if (bspx_slot(bsp, slot, &lump) != BSPX_OK || (slot == 17 ? lump.size % 128 != 0 : lump.size <= 40))
            continue;
        if ((uint64_t)(lump.data - bsp->data) + lump.size > end)
            end = (uint64_t)(lump.data - bsp->data) + lump.size;
    }
    bsp->directory = (end + 3) & ~(uint64_t)3;
    return BSPX_OK;
}

/* The BSPX lump of that name (at most 23 characters); the first, if there are two. */
static inline bspx_result bspx_find(const bspx_file *bsp, const char *name, bspx_lump *lump) {
    const uint64_t start = bsp->directory;
    uint64_t count, i;
    lump->data = NULL;
    lump->size = 0;
    if (start == 0 || start + 8 > bsp->size || memcmp(bsp->data + start, "BSPX", 4) != 0)
        return BSPX_ABSENT;
    count = bspx_u32(bsp->data + start + 4);
    if (count > (bsp->size - start - 8) / 32)
        return BSPX_TRUNCATED;
    for (i = 0; i < count; i++) {
        const unsigned char *entry = bsp->data + start + 8 + 32 * i;
        const uint64_t offset = bspx_u32(entry + 24), length = bspx_u32(entry + 28);
        if (strlen(name) > 23 || memcmp(entry, name, strlen(name) + 1) != 0)
            continue;
        if (offset < start + 8 + 32 * count || offset + length > bsp->size)
            return BSPX_BAD_OFFSET;
        lump->data = bsp->data + offset;
        lump->size = (size_t)length;
        return BSPX_OK;
    }
    return BSPX_ABSENT;
}

#ifdef __cplusplus
}
#endif

#endif
/* ---- bspx.h: end ---- */

#ifdef __cplusplus
extern "C" {
#endif

#define AMBIENT_CUBES_HEADER_BYTES 16
#define AMBIENT_CUBES_LEAF_BYTES 4
#define AMBIENT_CUBES_SAMPLE_BYTES 28
#define AMBIENT_CUBES_BSP_LEAF_BYTES 48

typedef enum {
    AMBIENT_CUBES_OK,
    AMBIENT_CUBES_ABSENT,      /* a good map, without ambient cubes */
    AMBIENT_CUBES_NOT_BSP,     /* neither IBSP of version 46 or 47 nor RBSP or FBSP of version 1 */
    AMBIENT_CUBES_TRUNCATED,   /* shorter than its header, or than its samples need */
    AMBIENT_CUBES_BAD_OFFSET,  /* a lump outside the file or inside the header */
    AMBIENT_CUBES_BAD_VERSION, /* not a lump of ambient cubes of version 1 */
    AMBIENT_CUBES_BAD_LEAFS,   /* made for another number of leafs */
    AMBIENT_CUBES_BAD_LENGTH,  /* longer than its leafs and samples need */
    AMBIENT_CUBES_BAD_INDEX,   /* a leaf names samples or a leaf that are not there */
    AMBIENT_CUBES_BAD_SAMPLE   /* the last byte of a sample is not 0 */
} ambient_cubes_result;

/* Points into the caller's memory: keep the file or the lumps as long as this. */
typedef struct {
    uint32_t leafCount, sampleCount;
    /* AMBIENT_CUBES_LEAF_BYTES for each leaf: number of its samples and number of the first one, 16 bits each. A leaf
       with 0 samples has the number of the leaf whose samples it uses in place of the second. */
    const unsigned char *index;
    const unsigned char *samples; /* AMBIENT_CUBES_SAMPLE_BYTES each */
    const unsigned char *leafs;   /* the lump of leafs, AMBIENT_CUBES_BSP_LEAF_BYTES each */
} ambient_cubes;

/* Light on surfaces that face +x, -x, +y, -y, +z, -z; red green blue. */
typedef struct {
    float side[6][3];
} ambient_cube;

static inline const char *ambient_cubes_message(ambient_cubes_result result) {
    switch (result) {
    case AMBIENT_CUBES_OK:
        return "no error";
    case AMBIENT_CUBES_ABSENT:
        return "the map has no ambient cubes";
    case AMBIENT_CUBES_NOT_BSP:
        return "neither an IBSP file of version 46 or 47 nor an RBSP or FBSP file of version 1";
    case AMBIENT_CUBES_TRUNCATED:
        return "the data ends early";
    case AMBIENT_CUBES_BAD_OFFSET:
        return "a lump lies outside the file";
    case AMBIENT_CUBES_BAD_VERSION:
        return "ambient cubes of an unknown version";
    case AMBIENT_CUBES_BAD_LEAFS:
        return "ambient cubes of another number of leafs";
    case AMBIENT_CUBES_BAD_LENGTH:
        return "the lump is longer than its ambient cubes need";
    case AMBIENT_CUBES_BAD_INDEX:
        return "a leaf refers to ambient cubes that are not there";
    case AMBIENT_CUBES_BAD_SAMPLE:
        return "a reserved byte of the ambient cubes is not 0";
    }
    return "unknown result";
}

static inline uint32_t ambient_cubes_u16_(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

/* A signed number of 32 bits; negative ones without signed overflow. */
static inline float ambient_cubes_float_of_i32_(const unsigned char *p) {
    const uint32_t bits = bspx_u32(p);
    return bits < 0x80000000u ? (float)bits : -(float)(0xffffffffu - bits) - 1;
}

/* Parses the bytes of the BSPX lump AMBIENT_CUBES; `leafs` is lump 4 of the map. Both must be kept. On failure the
   cubes are empty, and all light is black. */
static inline ambient_cubes_result ambient_cubes_parse(const void *lump, size_t lumpSize, const void *leafs,
                                                       size_t leafsSize, ambient_cubes *cubes) {
    const unsigned char *data = (const unsigned char *)lump;
    uint64_t leafCount, sampleCount, bytes, i;
    memset(cubes, 0, sizeof *cubes);
    if (lumpSize < AMBIENT_CUBES_HEADER_BYTES)
        return AMBIENT_CUBES_TRUNCATED;
    if (memcmp(data, "ACUB", 4) != 0 || bspx_u32(data + 4) != 1)
        return AMBIENT_CUBES_BAD_VERSION;
    leafCount = bspx_u32(data + 8);
    sampleCount = bspx_u32(data + 12);
    bytes =
        AMBIENT_CUBES_HEADER_BYTES + leafCount * AMBIENT_CUBES_LEAF_BYTES + sampleCount * AMBIENT_CUBES_SAMPLE_BYTES;
    if (bytes != lumpSize)
        return bytes > lumpSize ? AMBIENT_CUBES_TRUNCATED : AMBIENT_CUBES_BAD_LENGTH;
    if (leafsSize != leafCount * AMBIENT_CUBES_BSP_LEAF_BYTES)
        return AMBIENT_CUBES_BAD_LEAFS;
    data += AMBIENT_CUBES_HEADER_BYTES;
    for (i = 0; i < leafCount; i++) {
        const uint64_t count = ambient_cubes_u16_(data + 4 * i), first = ambient_cubes_u16_(data + 4 * i + 2);
        if (count > 0 ? first + count > sampleCount : first >= leafCount || ambient_cubes_u16_(data + 4 * first) == 0)
            return AMBIENT_CUBES_BAD_INDEX;
    }
    for (i = 0; i < sampleCount; i++)
        if (data[AMBIENT_CUBES_LEAF_BYTES * leafCount + AMBIENT_CUBES_SAMPLE_BYTES * i + 27] != 0)
            return AMBIENT_CUBES_BAD_SAMPLE;
    cubes->leafCount = (uint32_t)leafCount;
    cubes->sampleCount = (uint32_t)sampleCount;
    cubes->index = data;
    cubes->samples = data + leafCount * AMBIENT_CUBES_LEAF_BYTES;
    cubes->leafs = (const unsigned char *)leafs;
    return AMBIENT_CUBES_OK;
}

static inline ambient_cubes_result ambient_cubes_from_bspx_(bspx_result result) {
    switch (result) {
    case BSPX_OK:
        return AMBIENT_CUBES_OK;
    case BSPX_ABSENT:
        return AMBIENT_CUBES_ABSENT;
    case BSPX_NOT_BSP:
        return AMBIENT_CUBES_NOT_BSP;
    case BSPX_TRUNCATED:
        return AMBIENT_CUBES_TRUNCATED;
    case BSPX_BAD_OFFSET:
        return AMBIENT_CUBES_BAD_OFFSET;
    }
    return AMBIENT_CUBES_BAD_OFFSET;
}

/* Finds both lumps of a whole .bsp file image, which must be kept, and parses them. */
static inline ambient_cubes_result ambient_cubes_load(const void *file, size_t size, ambient_cubes *cubes) {
    bspx_file bsp;
    bspx_lump lump = {NULL, 0}, leafs = {NULL, 0};
    bspx_result result = bspx_open(file, size, &bsp);
    memset(cubes, 0, sizeof *cubes);
    if (result == BSPX_OK)
        result = bspx_slot(&bsp, 4, &leafs);
    if (result == BSPX_OK)
        result = bspx_find(&bsp, "AMBIENT_CUBES", &lump);
    return result == BSPX_OK ? ambient_cubes_parse(lump.data, lump.size, leafs.data, leafs.size, cubes)
                             : ambient_cubes_from_bspx_(result);
}

/* Source's ColorRGBExp32: mantissas of red, green, blue and a signed exponent; 255 is full light. */
static inline void ambient_cubes_color_(const unsigned char *code, float rgb[3]) {
    const float scale = ldexpf(1.0f / 255, code[3] < 128 ? code[3] : (int)code[3] - 256);
    rgb[0] = (float)code[0] * scale;
    rgb[1] = (float)code[1] * scale;
    rgb[2] = (float)code[2] * scale;
}

/* The samples of a leaf, its own or those that it refers to: their number, and the first. `owner` is the leaf whose
   bounds their positions refer to. 0 for a leaf that is not there. */
static inline uint32_t ambient_cubes_of_leaf(const ambient_cubes *cubes, uint32_t leaf, uint32_t *first,
                                             uint32_t *owner) {
    *first = *owner = 0;
    if (leaf >= cubes->leafCount)
        return 0;
    if (ambient_cubes_u16_(cubes->index + 4 * (size_t)leaf) == 0)
        leaf = ambient_cubes_u16_(cubes->index + 4 * (size_t)leaf + 2);
    *owner = leaf;
    *first = ambient_cubes_u16_(cubes->index + 4 * (size_t)leaf + 2);
    return ambient_cubes_u16_(cubes->index + 4 * (size_t)leaf);
}

/* One sample: its position, by the bounds of the leaf that owns it, and its cube. `sample` and `owner` as from
   ambient_cubes_of_leaf. */
static inline void ambient_cubes_sample(const ambient_cubes *cubes, uint32_t sample, uint32_t owner, float position[3],
                                        ambient_cube *cube) {
    const unsigned char *p = cubes->samples + AMBIENT_CUBES_SAMPLE_BYTES * (size_t)sample;
    const unsigned char *leaf = cubes->leafs + AMBIENT_CUBES_BSP_LEAF_BYTES * (size_t)owner;
    int i;
    for (i = 0; i < 6; i++)
        ambient_cubes_color_(p + 4 * i, cube->side[i]);
    for (i = 0; i < 3; i++) {
        const float mins = ambient_cubes_float_of_i32_(leaf + 8 + 4 * i),
                    maxs = ambient_cubes_float_of_i32_(leaf + 20 + 4 * i);
        position[i] = mins + (maxs > mins ? maxs - mins : 0) * ((float)p[24 + i] / 255);
    }
}

/* Blend of the cubes of a leaf at a position, with weights 1 / (distance^2 + 1). `leaf`: the number of the leaf that
   holds the position, as the engine finds it in the tree. Black for a leaf that is not there. */
static inline void ambient_cubes_blend(const ambient_cubes *cubes, uint32_t leaf, const float position[3],
                                       ambient_cube *out) {
    uint32_t first, owner, i, count = ambient_cubes_of_leaf(cubes, leaf, &first, &owner);
    float weights = 0;
    int side, channel;
    memset(out, 0, sizeof *out);
    for (i = 0; i < count; i++) {
        ambient_cube cube;
        float at[3], x, y, z, weight;
        ambient_cubes_sample(cubes, first + i, owner, at, &cube);
        x = at[0] - position[0], y = at[1] - position[1], z = at[2] - position[2];
        weight = 1 / (x * x + y * y + z * z + 1);
        if (!(weight > 1e-12f)) /* too far to count, or no number: all samples weigh the same */
            weight = 1e-12f;
        weights += weight;
        for (side = 0; side < 6; side++)
            for (channel = 0; channel < 3; channel++)
                out->side[side][channel] += weight * cube.side[side][channel];
    }
    for (side = 0; side < 6 && weights > 0; side++)
        for (channel = 0; channel < 3; channel++)
            out->side[side][channel] /= weights;
}

/* Light on a matte surface with that unit normal. */
static inline void ambient_cube_evaluate(const ambient_cube *cube, const float normal[3], float rgb[3]) {
    int axis, channel;
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (axis = 0; axis < 3; axis++) {
        const float *side = cube->side[2 * axis + (normal[axis] < 0 ? 1 : 0)];
        for (channel = 0; channel < 3; channel++)
            rgb[channel] += normal[axis] * normal[axis] * side[channel];
    }
}

/* Light at a position in a leaf on a surface with that unit normal. */
static inline void ambient_cubes_light(const ambient_cubes *cubes, uint32_t leaf, const float position[3],
                                       const float normal[3], float rgb[3]) {
    ambient_cube cube;
    ambient_cubes_blend(cubes, leaf, position, &cube);
    ambient_cube_evaluate(&cube, normal, rgb);
}

#ifdef __cplusplus
}
#endif

#endif
