/* SPDX-License-Identifier: MIT. Reader of the light of static props of Quake III maps, for engines. C99 and C++.

   A prop is an entity with a model. It has a list of meshes in the order of the model file, and each mesh a color for
   each of its vertices. A color is linear light; 1.0 is vertex color 255. See LICENSE and README.md beside this file.

   The BSPX lump STATIC_PROP_LIGHT, numbers of 32 bits, little endian: "SPL1", version 1, propCount, meshCount,
   colorCount; the props, in ascending order of entities; the meshes of all props; the colors of all meshes. The members
   of a prop and of a mesh are those of staticprops_prop and staticprops_mesh in their order, a color is a code of GL's
   RGB9_E5. */
#ifndef STATICPROPS_H
#define STATICPROPS_H

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

#define STATICPROPS_HEADER_BYTES 20
#define STATICPROPS_PROP_BYTES 20
#define STATICPROPS_MESH_BYTES 8

typedef enum {
    STATICPROPS_OK,
    STATICPROPS_ABSENT,      /* a good map, without light of props */
    STATICPROPS_NOT_BSP,     /* neither IBSP of version 46 or 47 nor RBSP or FBSP of version 1 */
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

/* An entity with light. Its meshes are numbers firstMesh to firstMesh + meshCount - 1. */
typedef struct {
    uint32_t entity;   /* number in the map's entities, worldspawn is 0 */
    uint32_t nameCrc;  /* staticprops_crc of the entity's "model" in lower case */
    uint32_t modelCrc; /* staticprops_crc of the bytes of the model file */
    uint32_t firstMesh, meshCount;
} staticprops_prop;

/* A mesh of the model file. It has a color for each vertex, from color number firstColor on. */
typedef struct {
    uint32_t firstColor, colorCount;
} staticprops_mesh;

static inline const char *staticprops_message(staticprops_result result) {
    switch (result) {
    case STATICPROPS_OK:
        return "no error";
    case STATICPROPS_ABSENT:
        return "the map has no light of static props";
    case STATICPROPS_NOT_BSP:
        return "neither an IBSP file of version 46 or 47 nor an RBSP or FBSP file of version 1";
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

/* Prop number `index`, below propCount. */
static inline staticprops_prop staticprops_get(const staticprops_light *light, uint32_t index) {
    const unsigned char *p = light->props + (size_t)STATICPROPS_PROP_BYTES * index;
    staticprops_prop prop;
    prop.entity = bspx_u32(p);
    prop.nameCrc = bspx_u32(p + 4);
    prop.modelCrc = bspx_u32(p + 8);
    prop.firstMesh = bspx_u32(p + 12);
    prop.meshCount = bspx_u32(p + 16);
    return prop;
}

/* Mesh number `index`, below meshCount: those of a prop begin with its firstMesh. */
static inline staticprops_mesh staticprops_get_mesh(const staticprops_light *light, uint32_t index) {
    const unsigned char *p = light->meshes + (size_t)STATICPROPS_MESH_BYTES * index;
    staticprops_mesh mesh;
    mesh.firstColor = bspx_u32(p);
    mesh.colorCount = bspx_u32(p + 4);
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
    if (memcmp(lump, "SPL1", 4) != 0 || bspx_u32(lump + 4) != 1)
        return STATICPROPS_BAD_VERSION;
    found.propCount = bspx_u32(lump + 8);
    found.meshCount = bspx_u32(lump + 12);
    found.colorCount = bspx_u32(lump + 16);
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

/* Finds the BSPX lump STATIC_PROP_LIGHT of a whole .bsp file image. */
static inline staticprops_result staticprops_find(const void *data, size_t size, const unsigned char **lump,
                                                  size_t *lumpSize) {
    bspx_file bsp;
    bspx_lump found = {NULL, 0};
    bspx_result result = bspx_open(data, size, &bsp);
    if (result == BSPX_OK)
        result = bspx_find(&bsp, "STATIC_PROP_LIGHT", &found);
    *lump = found.data;
    *lumpSize = found.size;
    switch (result) {
    case BSPX_OK:
        return STATICPROPS_OK;
    case BSPX_ABSENT:
        return STATICPROPS_ABSENT;
    case BSPX_NOT_BSP:
        return STATICPROPS_NOT_BSP;
    case BSPX_TRUNCATED:
        return STATICPROPS_TRUNCATED;
    case BSPX_BAD_OFFSET:
        return STATICPROPS_BAD_OFFSET;
    }
    return STATICPROPS_BAD_OFFSET;
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

/* Linear light of color number `index`, below colorCount: those of a mesh begin with its firstColor. 1.0 is 255. A code
   has 9 bits each of red, green and blue from bit 0 up, then 5 of the exponent e: a channel is bits * 2^(e - 24). */
static inline void staticprops_color(const staticprops_light *light, uint32_t index, float rgb[3]) {
    const uint32_t code = bspx_u32(light->colors + (size_t)4 * index);
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
