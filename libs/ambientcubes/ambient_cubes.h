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
    AMBIENT_CUBES_NOT_BSP,     /* not an IBSP file of version 46 or 47 */
    AMBIENT_CUBES_TRUNCATED,   /* shorter than its header, or than its samples need */
    AMBIENT_CUBES_BAD_OFFSET,  /* a lump outside the file or inside the header */
    AMBIENT_CUBES_BAD_VERSION, /* not a lump of ambient cubes of version 1 */
    AMBIENT_CUBES_BAD_LEAFS,   /* made for another number of leafs */
    AMBIENT_CUBES_BAD_INDEX    /* a leaf names samples or a leaf that are not there */
} ambient_cubes_result;

/* Points into the caller's memory: keep the file or the lumps as long as this. */
typedef struct {
    uint32_t leaf_count, sample_count;
    const unsigned char *index;   /* AMBIENT_CUBES_LEAF_BYTES for each leaf */
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
        return "not an IBSP file of version 46 or 47";
    case AMBIENT_CUBES_TRUNCATED:
        return "the data ends early";
    case AMBIENT_CUBES_BAD_OFFSET:
        return "a lump lies outside the file";
    case AMBIENT_CUBES_BAD_VERSION:
        return "ambient cubes of an unknown version";
    case AMBIENT_CUBES_BAD_LEAFS:
        return "ambient cubes of another number of leafs";
    case AMBIENT_CUBES_BAD_INDEX:
        return "a leaf refers to ambient cubes that are not there";
    }
    return "unknown result";
}

static inline uint32_t ambient_cubes_u16_(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

static inline uint32_t ambient_cubes_u32_(const unsigned char *p) {
    return ambient_cubes_u16_(p) | ambient_cubes_u16_(p + 2) << 16;
}

static inline float ambient_cubes_i32_(const unsigned char *p) {
    const uint32_t bits = ambient_cubes_u32_(p);
    return bits < 0x80000000u ? (float)bits : -(float)(0xffffffffu - bits) - 1;
}

/* Parses the bytes of the BSPX lump AMBIENT_CUBES; `leafs` is lump 4 of the map. Both must be kept. On failure the
   cubes are empty and must not be used. */
static inline ambient_cubes_result ambient_cubes_parse(const void *lump, size_t lump_size, const void *leafs,
                                                       size_t leafs_size, ambient_cubes *cubes) {
    const unsigned char *data = (const unsigned char *)lump;
    uint64_t leaf_count, sample_count, i;
    memset(cubes, 0, sizeof *cubes);
    if (lump_size < AMBIENT_CUBES_HEADER_BYTES)
        return AMBIENT_CUBES_TRUNCATED;
    if (memcmp(data, "ACUB", 4) != 0 || ambient_cubes_u32_(data + 4) != 1)
        return AMBIENT_CUBES_BAD_VERSION;
    leaf_count = ambient_cubes_u32_(data + 8);
    sample_count = ambient_cubes_u32_(data + 12);
    if (AMBIENT_CUBES_HEADER_BYTES + leaf_count * AMBIENT_CUBES_LEAF_BYTES +
            sample_count * AMBIENT_CUBES_SAMPLE_BYTES >
        lump_size)
        return AMBIENT_CUBES_TRUNCATED;
    if (leafs_size / AMBIENT_CUBES_BSP_LEAF_BYTES != leaf_count)
        return AMBIENT_CUBES_BAD_LEAFS;
    data += AMBIENT_CUBES_HEADER_BYTES;
    for (i = 0; i < leaf_count; i++) {
        const uint64_t count = ambient_cubes_u16_(data + 4 * i), first = ambient_cubes_u16_(data + 4 * i + 2);
        if (count > 0 ? first + count > sample_count
                      : first >= leaf_count || ambient_cubes_u16_(data + 4 * first) == 0)
            return AMBIENT_CUBES_BAD_INDEX;
    }
    cubes->leaf_count = (uint32_t)leaf_count;
    cubes->sample_count = (uint32_t)sample_count;
    cubes->index = data;
    cubes->samples = data + leaf_count * AMBIENT_CUBES_LEAF_BYTES;
    cubes->leafs = (const unsigned char *)leafs;
    return AMBIENT_CUBES_OK;
}

static inline int ambient_cubes_slot_(const unsigned char *file, size_t size, unsigned slot, uint64_t *offset,
                                      uint64_t *length) {
    *offset = ambient_cubes_u32_(file + 8 + 8 * slot);
    *length = ambient_cubes_u32_(file + 12 + 8 * slot);
    return *offset <= INT32_MAX && *length <= INT32_MAX && *offset + *length <= size;
}

/* The end of slots 17 and 18 where a version 47 file has them: no lump begins before they end, and what stands there is
   a lump inside the file. */
static inline uint64_t ambient_cubes_more_slots_(const unsigned char *file, size_t size, uint64_t first, uint64_t end) {
    unsigned slot;
    for (slot = 17; slot < 19; slot++) {
        const uint64_t header = 8 + 8 * ((uint64_t)slot + 1);
        uint64_t offset, length;
        if (first < header || size < header)
            break;
        if (ambient_cubes_slot_(file, size, slot, &offset, &length) && offset >= header &&
            (slot == 18 || length % 128 == 0) && offset + length > end)
            end = offset + length;
    }
    return end;
}

/* Finds both lumps of a whole .bsp file image, which must be kept, and parses them. */
static inline ambient_cubes_result ambient_cubes_load(const void *data, size_t size, ambient_cubes *cubes) {
    static const char name[] = "AMBIENT_CUBES";
    const unsigned char *file = (const unsigned char *)data, *entry;
    uint64_t offset, length, leafs = 0, leafs_length = 0, first = UINT64_MAX, end = 0, count, i;
    unsigned slot;
    memset(cubes, 0, sizeof *cubes);
    if (size < 8 || memcmp(file, "IBSP", 4) != 0)
        return AMBIENT_CUBES_NOT_BSP;
    if (ambient_cubes_u32_(file + 4) != 46 && ambient_cubes_u32_(file + 4) != 47)
        return AMBIENT_CUBES_NOT_BSP;
    if (size < 8 + 8 * 17)
        return AMBIENT_CUBES_TRUNCATED;
    for (slot = 0; slot < 17; slot++) {
        if (!ambient_cubes_slot_(file, size, slot, &offset, &length) || (length > 0 && offset < 8 + 8 * 17))
            return AMBIENT_CUBES_BAD_OFFSET;
        if (slot == 4)
            leafs = offset, leafs_length = length;
        if (length > 0 && offset < first)
            first = offset;
        if (offset + length > end)
            end = offset + length;
    }
    if (ambient_cubes_u32_(file + 4) == 47)
        end = ambient_cubes_more_slots_(file, size, first, end);
    end = (end + 3) & ~(uint64_t)3;
    if (end + 8 > size || memcmp(file + end, "BSPX", 4) != 0)
        return AMBIENT_CUBES_ABSENT;
    count = ambient_cubes_u32_(file + end + 4);
    if (count > (size - end - 8) / 32)
        return AMBIENT_CUBES_TRUNCATED;
    for (i = 0; i < count; i++) {
        entry = file + end + 8 + 32 * i;
        if (memcmp(entry, name, sizeof name) != 0)
            continue;
        offset = ambient_cubes_u32_(entry + 24);
        length = ambient_cubes_u32_(entry + 28);
        if (offset < end + 8 + 32 * count || offset + length > size)
            return AMBIENT_CUBES_BAD_OFFSET;
        return ambient_cubes_parse(file + offset, (size_t)length, file + leafs, (size_t)leafs_length, cubes);
    }
    return AMBIENT_CUBES_ABSENT;
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
    if (leaf >= cubes->leaf_count)
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
        const float mins = ambient_cubes_i32_(leaf + 8 + 4 * i), maxs = ambient_cubes_i32_(leaf + 20 + 4 * i);
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
