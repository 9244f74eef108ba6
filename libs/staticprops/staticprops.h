/* SPDX-License-Identifier: MIT. Reader of the light of static props of Quake III maps, for engines. C99 and C++.

   A prop is an entity with a model. It has a list of meshes in the order of the model file, and each mesh a color for
   each of its vertices. A color is linear light; 1.0 is vertex color 255. See LICENSE and README.md beside this file.
 */
#ifndef STATICPROPS_H
#define STATICPROPS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

#define STATICPROPS_HEADER_BYTES 20
#define STATICPROPS_PROP_BYTES 20
#define STATICPROPS_MESH_BYTES 8

typedef enum {
    STATICPROPS_OK,
    STATICPROPS_ABSENT,      /* a good map, without light of props */
    STATICPROPS_NOT_BSP,     /* not an IBSP file of version 46 or 47 */
    STATICPROPS_TRUNCATED,   /* the file is shorter than its header or directory */
    STATICPROPS_BAD_OFFSET,  /* a lump outside the file or inside the header */
    STATICPROPS_BAD_VERSION, /* another magic number or version */
    STATICPROPS_BAD_LENGTH,  /* the length of the lump does not fit its counts */
    STATICPROPS_BAD_ORDER    /* props or meshes do not follow each other */
} staticprops_result;

/* Points into the caller's memory: keep the file or the lump as long as this. */
typedef struct {
    uint32_t propCount, meshCount, colorCount;
    const unsigned char *props, *meshes, *colors; /* any alignment, little endian */
} staticprops_light;

typedef struct {
    uint32_t entity;   /* number in the map's entities, worldspawn is 0 */
    uint32_t nameCrc;  /* staticprops_crc of the entity's "model" in lower case */
    uint32_t modelCrc; /* staticprops_crc of the bytes of the model file */
    uint32_t firstMesh, meshCount;
} staticprops_prop;

typedef struct {
    uint32_t firstColor, colorCount; /* one for each vertex */
} staticprops_mesh;

static inline const char *staticprops_message(staticprops_result result) {
    switch (result) {
    case STATICPROPS_OK:
        return "no error";
    case STATICPROPS_ABSENT:
        return "the map has no light of static props";
    case STATICPROPS_NOT_BSP:
        return "not an IBSP file of version 46 or 47";
    case STATICPROPS_TRUNCATED:
        return "the data ends early";
    case STATICPROPS_BAD_OFFSET:
        return "a lump lies outside the file";
    case STATICPROPS_BAD_VERSION:
        return "the light of static props is of another version";
    case STATICPROPS_BAD_LENGTH:
        return "the length of the light of static props does not fit its counts";
    case STATICPROPS_BAD_ORDER:
        return "props or meshes do not follow each other";
    }
    return "unknown result";
}

static inline uint32_t staticprops_u32_(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* Prop number `index`, below propCount. */
static inline staticprops_prop staticprops_get(const staticprops_light *light, uint32_t index) {
    const unsigned char *p = light->props + (size_t)STATICPROPS_PROP_BYTES * index;
    staticprops_prop prop;
    prop.entity = staticprops_u32_(p);
    prop.nameCrc = staticprops_u32_(p + 4);
    prop.modelCrc = staticprops_u32_(p + 8);
    prop.firstMesh = staticprops_u32_(p + 12);
    prop.meshCount = staticprops_u32_(p + 16);
    return prop;
}

/* Mesh number `index`, below meshCount: those of a prop begin with its firstMesh. */
static inline staticprops_mesh staticprops_get_mesh(const staticprops_light *light, uint32_t index) {
    const unsigned char *p = light->meshes + (size_t)STATICPROPS_MESH_BYTES * index;
    staticprops_mesh mesh;
    mesh.firstColor = staticprops_u32_(p);
    mesh.colorCount = staticprops_u32_(p + 4);
    return mesh;
}

/* Parses the bytes of the lump; `light` points into them. On failure it is empty. */
static inline staticprops_result staticprops_parse(const void *data, size_t size, staticprops_light *light) {
    const unsigned char *lump = (const unsigned char *)data;
    staticprops_light found;
    uint64_t length, mesh = 0, color = 0;
    uint32_t i;
    memset(light, 0, sizeof *light);
    if (size < STATICPROPS_HEADER_BYTES)
        return STATICPROPS_BAD_LENGTH;
    if (memcmp(lump, "SPL1", 4) != 0 || staticprops_u32_(lump + 4) != 1)
        return STATICPROPS_BAD_VERSION;
    found.propCount = staticprops_u32_(lump + 8);
    found.meshCount = staticprops_u32_(lump + 12);
    found.colorCount = staticprops_u32_(lump + 16);
    length = STATICPROPS_HEADER_BYTES + (uint64_t)STATICPROPS_PROP_BYTES * found.propCount +
             (uint64_t)STATICPROPS_MESH_BYTES * found.meshCount + (uint64_t)4 * found.colorCount;
    if (length != size)
        return STATICPROPS_BAD_LENGTH;
    found.props = lump + STATICPROPS_HEADER_BYTES;
    found.meshes = found.props + (size_t)STATICPROPS_PROP_BYTES * found.propCount;
    found.colors = found.meshes + (size_t)STATICPROPS_MESH_BYTES * found.meshCount;
    for (i = 0; i < found.propCount; i++) {
        const staticprops_prop prop = staticprops_get(&found, i);
        if (prop.firstMesh != mesh || (i > 0 && prop.entity <= staticprops_get(&found, i - 1).entity))
            return STATICPROPS_BAD_ORDER;
        mesh += prop.meshCount;
    }
    for (i = 0; i < found.meshCount; i++) {
        const staticprops_mesh one = staticprops_get_mesh(&found, i);
        if (one.firstColor != color)
            return STATICPROPS_BAD_ORDER;
        color += one.colorCount;
    }
    if (mesh != found.meshCount || color != found.colorCount)
        return STATICPROPS_BAD_ORDER;
    *light = found;
    return STATICPROPS_OK;
}

/* Finds the lump of a whole .bsp file image: BSPX behind the lumps of the header. */
static inline staticprops_result staticprops_find(const void *data, size_t size, const unsigned char **lump,
                                                  size_t *lumpSize) {
    static const char name[24] = "STATIC_PROP_LIGHT";
    const unsigned char *file = (const unsigned char *)data;
    uint64_t end = 0, first = UINT64_MAX, start, count, i;
    uint32_t version;
    unsigned slot;
    *lump = NULL;
    *lumpSize = 0;
    if (size < 8 || memcmp(file, "IBSP", 4) != 0)
        return STATICPROPS_NOT_BSP;
    version = staticprops_u32_(file + 4);
    if (version != 46 && version != 47)
        return STATICPROPS_NOT_BSP;
    if (size < 8 + 8 * 17)
        return STATICPROPS_TRUNCATED;
    for (slot = 0; slot < 19; slot++) {
        const uint64_t head = 8 + 8 * (uint64_t)(slot + 1);
        uint64_t offset, length;
        /* Slots 17 and 18 are those of some version 47 files only: they exist if no lump begins before they end. */
        if (slot >= 17 && (version != 47 || first < head || size < head))
            break;
        offset = staticprops_u32_(file + 8 + 8 * slot);
        length = staticprops_u32_(file + 12 + 8 * slot);
        if (offset > INT32_MAX || length > INT32_MAX || offset + length > size ||
            (length > 0 && offset < (slot < 17 ? 8 + 8 * 17 : head))) {
            if (slot >= 17)
                break;
            return STATICPROPS_BAD_OFFSET;
        }
        if (length > 0 && offset < first)
            first = offset;
        if (length > 0 && offset + length > end)
            end = offset + length;
    }
    start = (end + 3) & ~(uint64_t)3;
    if (start + 8 > size || memcmp(file + start, "BSPX", 4) != 0)
        return STATICPROPS_ABSENT;
    count = staticprops_u32_(file + start + 4);
    if (count > (size - start - 8) / 32)
        return STATICPROPS_TRUNCATED;
    for (i = 0; i < count; i++) {
        const unsigned char *entry = file + start + 8 + 32 * i;
        const uint64_t offset = staticprops_u32_(entry + 24), length = staticprops_u32_(entry + 28);
        if (memcmp(entry, name, sizeof "STATIC_PROP_LIGHT") != 0)
            continue;
        if (offset < start + 8 + 32 * count || offset + length > size)
            return STATICPROPS_BAD_OFFSET;
        *lump = file + offset;
        *lumpSize = (size_t)length;
        return STATICPROPS_OK;
    }
    return STATICPROPS_ABSENT;
}

/* Finds and parses the lump of a whole .bsp file image. */
static inline staticprops_result staticprops_load(const void *file, size_t size, staticprops_light *light) {
    const unsigned char *lump;
    size_t lumpSize;
    const staticprops_result result = staticprops_find(file, size, &lump, &lumpSize);
    memset(light, 0, sizeof *light);
    return result == STATICPROPS_OK ? staticprops_parse(lump, lumpSize, light) : result;
}

/* The prop of an entity; 0: the map has no light for it. */
static inline int staticprops_of_entity(const staticprops_light *light, uint32_t entity, staticprops_prop *prop) {
    uint32_t low = 0, high = light->propCount;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        *prop = staticprops_get(light, middle);
        if (prop->entity == entity)
            return 1;
        if (prop->entity < entity)
            low = middle + 1;
        else
            high = middle;
    }
    memset(prop, 0, sizeof *prop);
    return 0;
}

/* Linear light of color number `index`, below colorCount: those of a mesh begin with its firstColor. 1.0 is 255. */
static inline void staticprops_color(const staticprops_light *light, uint32_t index, float rgb[3]) {
    const uint32_t code = staticprops_u32_(light->colors + (size_t)4 * index);
    int power = (int)(code >> 27) - 24, channel;
    float scale = 1;
    for (; power > 0; power--)
        scale *= 2;
    for (; power < 0; power++)
        scale *= 0.5f;
    for (channel = 0; channel < 3; channel++)
        rgb[channel] = (float)(code >> (9 * channel) & 511) * scale;
}

/* CRC-32 of ISO 3309, as zip archives have it. */
static inline uint32_t staticprops_crc(const void *data, size_t size) {
    const unsigned char *bytes = (const unsigned char *)data;
    uint32_t crc = 0xFFFFFFFFu;
    size_t i;
    int bit;
    for (i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
    return ~crc;
}

#ifdef __cplusplus
}
#endif

#endif
