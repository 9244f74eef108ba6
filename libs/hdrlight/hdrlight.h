/* SPDX-License-Identifier: MIT. Reader of the HDR light of Quake III maps, for engines. C99 and C++.

   Three BSPX lumps hold linear light that no byte limits; 1.0 is lightmap byte 255. LIGHTING_E5BGR9 has a code for each
   texel of the lightmaps, VERTEX_E5BGR9 one for each draw vertex, LIGHTING_RNM three maps of radiosity normal mapping
   for pages that need them. A code has 4 bytes, little endian: GL's RGB9_E5 (GL_UNSIGNED_INT_5_9_9_9_REV), so that
   pages are textures as they are. See LICENSE and README.md beside this file.

   LIGHTING_RNM begins with "RNM1" and four numbers of 32 bits: version 1, storage (0 raw, 1 rescaled), side of the
   maps in texels, number of pages. A page is the number of its lightmap and three maps of side * side codes. */
#ifndef HDRLIGHT_H
#define HDRLIGHT_H

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

#define HDRLIGHT_CODE_BYTES 4
#define HDRLIGHT_RNM_HEADER_BYTES 20
#define HDRLIGHT_RNM_SIDE 16384          /* maximum, texels */
#define HDRLIGHT_PAGE_TEXELS (128 * 128) /* of the smallest page of lightmaps */
#define HDRLIGHT_LIGHTMAP_TEXEL_BYTES 3  /* of lump 14 */
#define HDRLIGHT_DRAW_VERT_BYTES 44      /* of lump 10 of IBSP */
#define HDRLIGHT_STYLED_VERT_BYTES 80    /* of lump 10 of RBSP and FBSP */

typedef enum {
    HDRLIGHT_OK,
    HDRLIGHT_ABSENT,      /* a good map, without HDR light */
    HDRLIGHT_NOT_BSP,     /* neither IBSP of version 46 or 47 nor RBSP or FBSP of version 1 */
    HDRLIGHT_TRUNCATED,   /* the file is shorter than its header or its BSPX directory */
    HDRLIGHT_BAD_OFFSET,  /* a lump outside the file or inside the header */
    HDRLIGHT_BAD_LENGTH,  /* a lump is not as long as its codes or pages */
    HDRLIGHT_BAD_VERSION, /* not a LIGHTING_RNM lump of version 1 */
    HDRLIGHT_BAD_HEADER,  /* storage, side or number of pages of LIGHTING_RNM out of range */
    HDRLIGHT_BAD_PAGE,    /* a page of LIGHTING_RNM belongs to no lightmap */
    HDRLIGHT_NO_FIT       /* made for lightmaps or vertices of another number */
} hdrlight_result;

/* Points into the caller's memory: keep the file as long as this. What the map does not have is NULL and 0. */
typedef struct {
    const unsigned char *texels; /* LIGHTING_E5BGR9: HDRLIGHT_CODE_BYTES each, in the order of lump 14 */
    uint32_t texelCount;
    const unsigned char *vertices; /* VERTEX_E5BGR9: HDRLIGHT_CODE_BYTES each, in the order of lump 10 */
    uint32_t vertexCount;
    const unsigned char *rnmPages;  /* LIGHTING_RNM: number of the lightmap, then three maps of side * side codes */
    uint32_t rnmPageCount, rnmSide; /* rnmSide: texels */
    int rnmRescaled; /* 0: a map is the light of its basis vector; 1: the mean of the maps is the flat light */
} hdrlight;

static inline const char *hdrlight_message(hdrlight_result result) {
    switch (result) {
    case HDRLIGHT_OK:
        return "no error";
    case HDRLIGHT_ABSENT:
        return "the map has no HDR light";
    case HDRLIGHT_NOT_BSP:
        return "neither an IBSP file of version 46 or 47 nor an RBSP or FBSP file of version 1";
    case HDRLIGHT_TRUNCATED:
        return "the data ends early";
    case HDRLIGHT_BAD_OFFSET:
        return "a lump lies outside the file";
    case HDRLIGHT_BAD_LENGTH:
        return "a lump of HDR light is not as long as its codes or pages";
    case HDRLIGHT_BAD_VERSION:
        return "the maps of radiosity normal mapping are of another version";
    case HDRLIGHT_BAD_HEADER:
        return "storage, side or number of pages of radiosity normal mapping is out of range";
    case HDRLIGHT_BAD_PAGE:
        return "a page of radiosity normal mapping belongs to no lightmap";
    case HDRLIGHT_NO_FIT:
        return "the HDR light is of other lightmaps or vertices";
    }
    return "unknown result";
}

/* Bytes of a page of LIGHTING_RNM. */
static inline uint64_t hdrlight_rnm_page_bytes_(uint32_t side) {
    return 4 + 3 * HDRLIGHT_CODE_BYTES * (uint64_t)side * side;
}

static inline const unsigned char *hdrlight_rnm_page_at_(const hdrlight *light, uint32_t index) {
    return light->rnmPages + (size_t)hdrlight_rnm_page_bytes_(light->rnmSide) * index;
}

/* LIGHTING_E5BGR9 beside lump 14, which may be empty. */
static inline hdrlight_result hdrlight_parse_texels_(bspx_lump lump, size_t lightmapBytes, hdrlight *light) {
    const size_t count = lump.size / HDRLIGHT_CODE_BYTES;
    if (lump.size % HDRLIGHT_CODE_BYTES != 0)
        return HDRLIGHT_BAD_LENGTH;
    if (lightmapBytes > 0 ? count != lightmapBytes / HDRLIGHT_LIGHTMAP_TEXEL_BYTES : count % HDRLIGHT_PAGE_TEXELS != 0)
        return HDRLIGHT_NO_FIT;
    light->texels = count > 0 ? lump.data : NULL;
    light->texelCount = (uint32_t)count;
    return HDRLIGHT_OK;
}

/* VERTEX_E5BGR9 beside lump 10 with that number of vertices. */
static inline hdrlight_result hdrlight_parse_vertices_(bspx_lump lump, size_t drawVerts, hdrlight *light) {
    const size_t count = lump.size / HDRLIGHT_CODE_BYTES;
    if (lump.size % HDRLIGHT_CODE_BYTES != 0)
        return HDRLIGHT_BAD_LENGTH;
    if (count > 0 && count != drawVerts)
        return HDRLIGHT_NO_FIT;
    light->vertices = count > 0 ? lump.data : NULL;
    light->vertexCount = (uint32_t)count;
    return HDRLIGHT_OK;
}

/* LIGHTING_RNM beside lump 14, which may be empty. */
static inline hdrlight_result hdrlight_parse_rnm_(bspx_lump lump, size_t lightmapBytes, hdrlight *light) {
    hdrlight found = *light;
    uint32_t storage, i;
    uint64_t pageBytes, lightmapPageBytes;
    if (lump.size < HDRLIGHT_RNM_HEADER_BYTES)
        return HDRLIGHT_BAD_LENGTH;
    if (memcmp(lump.data, "RNM1", 4) != 0 || bspx_u32(lump.data + 4) != 1)
        return HDRLIGHT_BAD_VERSION;
    storage = bspx_u32(lump.data + 8);
    found.rnmSide = bspx_u32(lump.data + 12);
    found.rnmPageCount = bspx_u32(lump.data + 16);
    if (storage > 1 || found.rnmSide < 1 || found.rnmSide > HDRLIGHT_RNM_SIDE || found.rnmPageCount < 1)
        return HDRLIGHT_BAD_HEADER;
    pageBytes = hdrlight_rnm_page_bytes_(found.rnmSide);
    if ((lump.size - HDRLIGHT_RNM_HEADER_BYTES) / pageBytes != found.rnmPageCount ||
        (lump.size - HDRLIGHT_RNM_HEADER_BYTES) % pageBytes != 0)
        return HDRLIGHT_BAD_LENGTH;
    found.rnmRescaled = storage == 1;
    found.rnmPages = lump.data + HDRLIGHT_RNM_HEADER_BYTES;
    lightmapPageBytes = (uint64_t)HDRLIGHT_LIGHTMAP_TEXEL_BYTES * found.rnmSide * found.rnmSide;
    if (lightmapBytes % lightmapPageBytes != 0)
        return HDRLIGHT_NO_FIT;
    for (i = 0; i < found.rnmPageCount; i++) {
        const uint32_t number = bspx_u32(hdrlight_rnm_page_at_(&found, i));
        if (number > INT32_MAX || (lightmapBytes > 0 && number >= lightmapBytes / lightmapPageBytes))
            return HDRLIGHT_BAD_PAGE;
    }
    *light = found;
    return HDRLIGHT_OK;
}

/* Finds and parses the three lumps of a whole .bsp file image, which must be kept. A damaged lump is left out, and the
   others are there all the same; the result is then that of the first damaged one. HDRLIGHT_OK: at least one lump, and
   none is damaged. */
static inline hdrlight_result hdrlight_load(const void *file, size_t size, hdrlight *light) {
    static const char *const names[3] = {"LIGHTING_E5BGR9", "VERTEX_E5BGR9", "LIGHTING_RNM"};
    /* By bspx_result. */
    static const hdrlight_result ofContainer[5] = {HDRLIGHT_OK, HDRLIGHT_ABSENT, HDRLIGHT_NOT_BSP, HDRLIGHT_TRUNCATED,
                                                   HDRLIGHT_BAD_OFFSET};
    bspx_file bsp;
    bspx_lump lightmaps = {NULL, 0}, drawVerts = {NULL, 0}, lump;
    const bspx_result opened = bspx_open(file, size, &bsp);
    const size_t vertBytes = bsp.version == 1 ? HDRLIGHT_STYLED_VERT_BYTES : HDRLIGHT_DRAW_VERT_BYTES;
    hdrlight_result firstFault = HDRLIGHT_OK;
    int i, found = 0;
    memset(light, 0, sizeof *light);
    if (opened != BSPX_OK)
        return ofContainer[opened];
    bspx_slot(&bsp, 14, &lightmaps);
    bspx_slot(&bsp, 10, &drawVerts);
    for (i = 0; i < 3; i++) {
        hdrlight_result result = ofContainer[bspx_find(&bsp, names[i], &lump)];
        if (result == HDRLIGHT_ABSENT)
            continue;
        found = 1;
        if (result == HDRLIGHT_OK)
            result = i == 0   ? hdrlight_parse_texels_(lump, lightmaps.size, light)
                     : i == 1 ? hdrlight_parse_vertices_(lump, drawVerts.size / vertBytes, light)
                              : hdrlight_parse_rnm_(lump, lightmaps.size, light);
        if (firstFault == HDRLIGHT_OK)
            firstFault = result;
    }
    return found ? firstFault : HDRLIGHT_ABSENT;
}

/* Red, green and blue of a code, 0 to 65408: 9 bits each from bit 0 up, times 2^(e - 24), where e is the 5 bits above.
   Exact. */
static inline void hdrlight_color(const unsigned char *code, float rgb[3]) {
    const uint32_t bits = bspx_u32(code), exponent = bits >> 27;
    float scale = exponent < 24 ? 1.0f / (float)((uint32_t)1 << (24 - exponent)) : (float)(1 << (exponent - 24));
    int channel;
    for (channel = 0; channel < 3; channel++)
        rgb[channel] = (float)(bits >> (9 * channel) & 511) * scale;
}

/* The codes of a page of lightmaps of side * side texels (128, unless the game has larger pages): row 0 first. NULL:
   there is no such page. */
static inline const unsigned char *hdrlight_page(const hdrlight *light, int32_t lightmapNum, uint32_t side) {
    const uint64_t texels = (uint64_t)side * side;
    if (lightmapNum < 0 || texels == 0 || light->texels == NULL || (uint64_t)lightmapNum >= light->texelCount / texels)
        return NULL;
    return light->texels + HDRLIGHT_CODE_BYTES * (size_t)texels * (size_t)lightmapNum;
}

/* Light of a draw vertex; black if there is none of that number. */
static inline void hdrlight_vertex(const hdrlight *light, uint32_t vertex, float rgb[3]) {
    rgb[0] = rgb[1] = rgb[2] = 0;
    if (vertex < light->vertexCount)
        hdrlight_color(light->vertices + HDRLIGHT_CODE_BYTES * (size_t)vertex, rgb);
}

/* The codes of one of the three maps of a lightmap, rnmSide * rnmSide, row 0 first. `basis` is 0 to 2: the vectors of
   directional_rnm_basis in libs/directional. NULL: this lightmap has no maps. Takes time in proportion to the pages:
   ask once, when textures are made. */
static inline const unsigned char *hdrlight_rnm_map(const hdrlight *light, int32_t lightmapNum, unsigned basis) {
    uint32_t i;
    if (lightmapNum < 0 || basis > 2)
        return NULL;
    for (i = 0; i < light->rnmPageCount; i++) {
        const unsigned char *page = hdrlight_rnm_page_at_(light, i);
        if (bspx_u32(page) == (uint32_t)lightmapNum)
            return page + 4 + HDRLIGHT_CODE_BYTES * (size_t)basis * light->rnmSide * light->rnmSide;
    }
    return NULL;
}

#ifdef __cplusplus
}
#endif

#endif
