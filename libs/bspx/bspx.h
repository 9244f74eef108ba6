/* SPDX-License-Identifier: MIT. Lumps of Quake III maps by number and by name, for engines. C99 and C++.

   The part between the two lines of dashes is also in shgrid.h, ambient_cubes.h, staticprops.h and hdrlight.h, so that
   each of them can be used without any other file. It takes effect once, however many of them are included. */

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
