/* SPDX-License-Identifier: MIT. Reader of the SH light grid of Quake III maps, for engines. C99 and C++.

   The grid is a box of points with nine L2 spherical-harmonics coefficients each, red green blue. A uniform grid has
   points at equal distances; the points of a sparse one are the corners of the cells of octrees. Both are sampled by
   the same calls.
   Axes are the map's: x east, y north, z up. By default the coefficients are convolved with the cosine, so that the
   plain sum over the basis is the light that a matte surface receives; 1.0 is lightmap byte 255, linear. See LICENSE
   and README.md beside this file. */
#ifndef SHGRID_H
#define SHGRID_H

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

#define SHGRID_HEADER_BYTES 40
#define SHGRID_POINT_BYTES 108
#define SHGRID_SPARSE_HEADER_BYTES 64
#define SHGRID_SPARSE_NODE_BYTES 12
#define SHGRID_SPARSE_POINT_BYTES 28
#define SHGRID_LIGHTS_HEADER_BYTES 96
#define SHGRID_LIGHTS_NODE_BYTES 20
#define SHGRID_LIGHT_BYTES 116
#define SHGRID_POLYGON_BYTES 44
#define SHGRID_SPARSE_LEVELS 12        /* maximum */
#define SHGRID_SPARSE_CELLS (1L << 24) /* maximum of the smallest cells on an axis */
#define SHGRID_LIGHTS 65535            /* maximum of lights that a grid can name */
#define SHGRID_LIGHT_POLYGONS 64       /* maximum of a light: more would be slow to sample */
#define SHGRID_POLYGON_VERTICES 64     /* maximum of a polygon of a light */
#define SHGRID_NAMES_AT_PLACE 64       /* lights that act at a place; a grid of this project has fewer */
#define SHGRID_DIRECT_LIGHTS 32        /* maximum of directional lights for an entity */

typedef enum {
    SHGRID_OK,
    SHGRID_ABSENT,      /* a good map, without an SH light grid */
    SHGRID_NOT_BSP,     /* neither IBSP of version 46 or 47 nor RBSP or FBSP of version 1 */
    SHGRID_TRUNCATED,   /* shorter than its header, or than its points need */
    SHGRID_BAD_OFFSET,  /* a lump outside the file or inside the header */
    SHGRID_BAD_MINS,    /* position of the first point is not finite */
    SHGRID_BAD_CELL,    /* distance between points is not above zero */
    SHGRID_BAD_BOUNDS,  /* fewer than one point on an axis */
    SHGRID_BAD_COUNT,   /* number of points is not the product of the bounds, or not what the lump holds */
    SHGRID_BAD_TONE,    /* tone text is not pairs of a word and a number, or a number is out of range */
    SHGRID_BAD_VERSION, /* a sparse grid of another version */
    SHGRID_BAD_LEVELS,  /* a sparse grid of no level, or more than SHGRID_SPARSE_LEVELS */
    SHGRID_BAD_NODES,   /* the tree of a sparse grid contradicts itself */
    SHGRID_BAD_LIGHTS   /* a light that the grid names, its polygons or its name are out of range */
} shgrid_result;

typedef enum {
    SHGRID_ANY,     /* the first good one of these, from the last to the first: the most accurate */
    SHGRID_UNIFORM, /* lump 18 or BSPX LIGHTGRID_SH */
    SHGRID_SPARSE,  /* BSPX LIGHTGRID_SH_SPARSE */
    SHGRID_NAMED    /* BSPX LIGHTGRID_SH_LIGHTS: names its strongest lights */
} shgrid_form;

/* Types of lights, curves of their falloff, and flags, in the table of a grid that names lights. */
enum { SHGRID_POINT, SHGRID_SPOT, SHGRID_SUN, SHGRID_POLYGONS };
enum { SHGRID_INVERSE_SQUARE, SHGRID_LINEAR, SHGRID_WINDOWED, SHGRID_POLYNOMIAL };
enum { SHGRID_TWO_SIDED = 1, SHGRID_CONE_BY_ANGLES = 2 };

/* Points into the caller's memory: keep the file or the lump as long as the grid. */
typedef struct {
    float mins[3];     /* world position of point (0, 0, 0) */
    float cell[3];     /* distance between points, world units; sparse: of the smallest cells */
    int32_t bounds[3]; /* points per axis, each at least 1; sparse: those that its smallest cells would have */
    int32_t count;     /* product of bounds; sparse: stored points */
    const unsigned char *points;   /* SHGRID_POINT_BYTES each, or SHGRID_SPARSE_POINT_BYTES; any alignment */
    int32_t levels;                /* 0: uniform. Sparse: the edge of a root is 2^levels smallest cells */
    int32_t nodeCount;             /* sparse */
    int32_t nodeBytes;             /* sparse */
    const unsigned char *nodes;    /* sparse: nodeBytes each */
    int32_t lightCount, nameCount; /* of a grid that names lights */
    const unsigned char *lights, *polygons, *vertices, *names, *shares; /* of such a grid; else NULL */
    const char *text;                                                   /* names of lights */
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
        return "neither an IBSP file of version 46 or 47 nor an RBSP or FBSP file of version 1";
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
    case SHGRID_BAD_VERSION:
        return "the sparse grid is of another version";
    case SHGRID_BAD_LEVELS:
        return "the sparse grid's number of levels is out of range";
    case SHGRID_BAD_NODES:
        return "the sparse grid's tree contradicts itself";
    case SHGRID_BAD_LIGHTS:
        return "a light that the grid names is out of range";
    }
    return "unknown result";
}

static inline float shgrid_f32_(const unsigned char *p) {
    const uint32_t bits = bspx_u32(p);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline uint32_t shgrid_u16_(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

/* Number of bits set in a byte. */
static inline uint32_t shgrid_bits_(uint32_t mask) {
    mask -= mask >> 1 & 0x55;
    mask = (mask & 0x33) + (mask >> 2 & 0x33);
    return (mask + (mask >> 4)) & 15;
}

static inline const unsigned char *shgrid_node_(const shgrid_grid *grid, uint32_t index) {
    return grid->nodes + (size_t)grid->nodeBytes * index;
}

/* One pass over the nodes, level by level. Children and points of each node follow those of the node before, so that
   there is no cycle and every index is below its count; nothing is checked later. */
static inline shgrid_result shgrid_check_nodes_(const shgrid_grid *grid, uint64_t roots) {
    uint64_t children = roots, points = 0, levelEnd = roots, i;
    int32_t level = 0;
    for (i = 0; i < (uint64_t)grid->nodeCount; i++) {
        const unsigned char *node = shgrid_node_(grid, (uint32_t)i);
        const uint32_t inner = node[8], stored = node[9], hanging = node[10];
        if (i == levelEnd) {
            level++;
            levelEnd = children;
        }
        if (i >= children || bspx_u32(node) != children || bspx_u32(node + 4) != points)
            return SHGRID_BAD_NODES;
        if ((inner & stored) || (inner & hanging) || (stored & hanging))
            return SHGRID_BAD_NODES;
        if ((level == grid->levels - 1 && inner) || (level == 0 && hanging))
            return SHGRID_BAD_NODES;
        children += shgrid_bits_(inner);
        points += shgrid_bits_(stored);
    }
    return children == (uint64_t)grid->nodeCount && points == (uint64_t)grid->count ? SHGRID_OK : SHGRID_BAD_NODES;
}

/* Origin, cells, roots and levels of a tree, which all sparse forms have at the same place. */
static inline shgrid_result shgrid_parse_box_(const unsigned char *lump, uint64_t nodes, shgrid_grid *grid,
                                              uint64_t *rootCount) {
    const uint32_t levels = bspx_u32(lump + 48);
    uint64_t product = 1;
    int i;
    if (levels < 1 || levels > SHGRID_SPARSE_LEVELS)
        return SHGRID_BAD_LEVELS;
    for (i = 0; i < 3; i++) {
        const uint32_t roots = bspx_u32(lump + 36 + 4 * i);
        grid->mins[i] = shgrid_f32_(lump + 12 + 4 * i);
        grid->cell[i] = shgrid_f32_(lump + 24 + 4 * i);
        if (!isfinite(grid->mins[i]))
            return SHGRID_BAD_MINS;
        if (!isfinite(grid->cell[i]) || !(grid->cell[i] > 0))
            return SHGRID_BAD_CELL;
        if (roots < 1 || roots > (uint32_t)SHGRID_SPARSE_CELLS >> levels)
            return SHGRID_BAD_BOUNDS;
        grid->bounds[i] = (int32_t)(roots << levels);
        if (!isfinite((float)(grid->mins[i] + grid->cell[i] * (float)grid->bounds[i])))
            return SHGRID_BAD_CELL;
        product *= roots; /* at most 2^23 each */
        if (product > nodes)
            return SHGRID_BAD_NODES;
    }
    grid->levels = (int32_t)levels;
    *rootCount = product;
    return SHGRID_OK;
}

static inline shgrid_result shgrid_parse_sparse_(const unsigned char *lump, size_t size, shgrid_grid *grid) {
    const uint64_t nodes = bspx_u32(lump + 52), points = bspx_u32(lump + 56);
    uint64_t roots;
    shgrid_result result;
    if (bspx_u32(lump + 60) != 0 || nodes > INT32_MAX || points > INT32_MAX ||
        size != SHGRID_SPARSE_HEADER_BYTES + SHGRID_SPARSE_NODE_BYTES * nodes + SHGRID_SPARSE_POINT_BYTES * points)
        return SHGRID_BAD_COUNT;
    result = shgrid_parse_box_(lump, nodes, grid, &roots);
    if (result != SHGRID_OK)
        return result;
    grid->count = (int32_t)points;
    grid->nodeCount = (int32_t)nodes;
    grid->nodeBytes = SHGRID_SPARSE_NODE_BYTES;
    grid->nodes = lump + SHGRID_SPARSE_HEADER_BYTES;
    grid->points = grid->nodes + (size_t)SHGRID_SPARSE_NODE_BYTES * nodes;
    return shgrid_check_nodes_(grid, roots);
}

/* ---- BSPX LIGHTGRID_SH_LIGHTS: a tree whose points name lights ---- */

static inline int shgrid_finite_(const unsigned char *floats, int count) {
    int i;
    for (i = 0; i < count; i++)
        if (!isfinite(shgrid_f32_(floats + 4 * i)))
            return 0;
    return 1;
}

/* The table of lights, their polygons and vertices. */
static inline shgrid_result shgrid_check_lights_(const shgrid_grid *grid, uint32_t polygonCount, uint32_t vertexCount,
                                                 uint32_t textBytes) {
    uint32_t i;
    for (i = 0; i < (uint32_t)grid->lightCount; i++) {
        const unsigned char *light = grid->lights + (size_t)SHGRID_LIGHT_BYTES * i;
        const uint32_t first = bspx_u32(light + 104), count = bspx_u32(light + 108);
        if (light[0] > SHGRID_POLYGONS || light[1] > SHGRID_POLYNOMIAL || light[2] > 63 || light[3] > 3 ||
            !shgrid_finite_(light + 4, 25) || bspx_u32(light + 112) >= textBytes)
            return SHGRID_BAD_LIGHTS;
        if (first > polygonCount || count > polygonCount - first || count > SHGRID_LIGHT_POLYGONS ||
            (light[0] == SHGRID_POLYGONS) != (count > 0))
            return SHGRID_BAD_LIGHTS;
    }
    for (i = 0; i < polygonCount; i++) {
        const unsigned char *polygon = grid->polygons + (size_t)SHGRID_POLYGON_BYTES * i;
        const uint32_t first = bspx_u32(polygon), count = bspx_u32(polygon + 4);
        if (first > vertexCount || count > vertexCount - first || count < 3 || count > SHGRID_POLYGON_VERTICES ||
            !shgrid_finite_(polygon + 8, 9))
            return SHGRID_BAD_LIGHTS;
    }
    for (i = 0; i < vertexCount; i++)
        if (!shgrid_finite_(grid->vertices + 12 * (size_t)i, 3))
            return SHGRID_BAD_LIGHTS;
    for (i = 0; i < (uint32_t)grid->nameCount; i++)
        if (shgrid_u16_(grid->names + 2 * (size_t)i) >= (uint32_t)grid->lightCount)
            return SHGRID_BAD_LIGHTS;
    return grid->text == NULL || grid->text[textBytes - 1] == 0 ? SHGRID_OK : SHGRID_BAD_LIGHTS;
}

/* Names and shares of the nodes: running sums, as those of children and points. */
static inline shgrid_result shgrid_check_names_(const shgrid_grid *grid, uint64_t shareCount) {
    uint64_t names = 0, shares = 0;
    uint32_t i;
    for (i = 0; i < (uint32_t)grid->nodeCount; i++) {
        const unsigned char *node = shgrid_node_(grid, i);
        if (bspx_u32(node + 12) != names || bspx_u32(node + 16) != shares)
            return SHGRID_BAD_NODES;
        names += node[11];
        shares += (uint64_t)node[11] * shgrid_bits_(node[9]);
    }
    return names == (uint64_t)grid->nameCount && shares == shareCount ? SHGRID_OK : SHGRID_BAD_NODES;
}

static inline uint64_t shgrid_padded_(uint64_t bytes) {
    return (bytes + 3) & ~(uint64_t)3;
}

static inline shgrid_result shgrid_parse_lights_(const unsigned char *lump, size_t size, shgrid_grid *grid) {
    const uint64_t nodes = bspx_u32(lump + 52), points = bspx_u32(lump + 56), lights = bspx_u32(lump + 60),
                   polygons = bspx_u32(lump + 64), vertices = bspx_u32(lump + 68), names = bspx_u32(lump + 72),
                   shares = bspx_u32(lump + 76), text = bspx_u32(lump + 80);
    const uint64_t lightBytes = SHGRID_LIGHT_BYTES * lights, polygonBytes = SHGRID_POLYGON_BYTES * polygons,
                   vertexBytes = 12 * vertices, nodeBytes = SHGRID_LIGHTS_NODE_BYTES * nodes,
                   pointBytes = SHGRID_SPARSE_POINT_BYTES * points, nameBytes = shgrid_padded_(2 * names),
                   shareBytes = shgrid_padded_(shares);
    uint64_t roots;
    shgrid_result result;
    if (bspx_u32(lump + 84) != 0 || bspx_u32(lump + 88) != 0 || bspx_u32(lump + 92) != 0 || nodes > INT32_MAX ||
        points > INT32_MAX || names > INT32_MAX || lights > SHGRID_LIGHTS ||
        size != SHGRID_LIGHTS_HEADER_BYTES + lightBytes + polygonBytes + vertexBytes + nodeBytes + pointBytes +
                    nameBytes + shareBytes + shgrid_padded_(text))
        return SHGRID_BAD_COUNT;
    result = shgrid_parse_box_(lump, nodes, grid, &roots);
    if (result != SHGRID_OK)
        return result;
    grid->nodeBytes = SHGRID_LIGHTS_NODE_BYTES;
    grid->count = (int32_t)points;
    grid->nodeCount = (int32_t)nodes;
    grid->lightCount = (int32_t)lights;
    grid->nameCount = (int32_t)names;
    grid->lights = lump + SHGRID_LIGHTS_HEADER_BYTES;
    grid->polygons = grid->lights + lightBytes;
    grid->vertices = grid->polygons + polygonBytes;
    grid->nodes = grid->vertices + vertexBytes;
    grid->points = grid->nodes + nodeBytes;
    grid->names = grid->points + pointBytes;
    grid->shares = grid->names + nameBytes;
    grid->text = text > 0 ? (const char *)(grid->shares + shareBytes) : NULL;
    result = shgrid_check_nodes_(grid, roots);
    if (result == SHGRID_OK)
        result = shgrid_check_names_(grid, shares);
    if (result == SHGRID_OK)
        result = shgrid_check_lights_(grid, (uint32_t)polygons, (uint32_t)vertices, (uint32_t)text);
    return result;
}

static inline shgrid_result shgrid_parse_uniform_(const unsigned char *lump, size_t size, shgrid_grid *grid) {
    uint64_t product = 1;
    uint32_t count;
    int i;
    if (size < SHGRID_HEADER_BYTES)
        return SHGRID_TRUNCATED;
    count = bspx_u32(lump + 36);
    for (i = 0; i < 3; i++) {
        const uint32_t bounds = bspx_u32(lump + 24 + 4 * i);
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

/* A form with a tree: magic, version, and the number of bytes of the lump. */
static inline shgrid_result shgrid_parse_tree_(const unsigned char *lump, size_t size, shgrid_grid *grid) {
    const int named = memcmp(lump, "SHGL", 4) == 0;
    if (size < (named ? SHGRID_LIGHTS_HEADER_BYTES : SHGRID_SPARSE_HEADER_BYTES))
        return SHGRID_TRUNCATED;
    if (bspx_u32(lump + 4) != 1)
        return SHGRID_BAD_VERSION;
    if (bspx_u32(lump + 8) > size)
        return SHGRID_TRUNCATED;
    if (bspx_u32(lump + 8) != size)
        return SHGRID_BAD_COUNT;
    return named ? shgrid_parse_lights_(lump, size, grid) : shgrid_parse_sparse_(lump, size, grid);
}

/* Parses the bytes of the lump, of any form; the grid points into them. On failure the grid is empty and must not be
   sampled. */
static inline shgrid_result shgrid_parse(const void *data, size_t size, shgrid_grid *grid) {
    const unsigned char *lump = (const unsigned char *)data;
    shgrid_result result;
    memset(grid, 0, sizeof *grid);
    if (size >= 4 && (memcmp(lump, "SHGS", 4) == 0 || memcmp(lump, "SHGL", 4) == 0))
        result = shgrid_parse_tree_(lump, size, grid);
    else
        result = shgrid_parse_uniform_(lump, size, grid);
    if (result != SHGRID_OK)
        memset(grid, 0, sizeof *grid);
    return result;
}

static inline shgrid_result shgrid_from_bspx_(bspx_result result) {
    switch (result) {
    case BSPX_OK:
        return SHGRID_OK;
    case BSPX_ABSENT:
        return SHGRID_ABSENT;
    case BSPX_NOT_BSP:
        return SHGRID_NOT_BSP;
    case BSPX_TRUNCATED:
        return SHGRID_TRUNCATED;
    case BSPX_BAD_OFFSET:
        return SHGRID_BAD_OFFSET;
    }
    return SHGRID_BAD_OFFSET;
}

/* Slot 18, else BSPX LIGHTGRID_SH. A lump in slot 18 that is too short for a grid is a fault if the first lump begins
   right after the slot; otherwise it is text of another compiler. */
static inline shgrid_result shgrid_find_uniform_(const bspx_file *bsp, bspx_lump *lump) {
    const bspx_result slot18 = bspx_slot(bsp, 18, lump);
    if (slot18 == BSPX_BAD_OFFSET)
        return SHGRID_BAD_OFFSET;
    if (slot18 == BSPX_OK && lump->size > SHGRID_HEADER_BYTES)
        return SHGRID_OK;
    if (slot18 == BSPX_OK && bsp->firstLump == 8 + 8 * 19)
        return SHGRID_TRUNCATED;
    return shgrid_from_bspx_(bspx_find(bsp, "LIGHTGRID_SH", lump));
}

/* Finds the lump of one form. */
static inline shgrid_result shgrid_find_one_(const bspx_file *bsp, shgrid_form form, bspx_lump *lump) {
    if (form == SHGRID_UNIFORM)
        return shgrid_find_uniform_(bsp, lump);
    return shgrid_from_bspx_(
        bspx_find(bsp, form == SHGRID_NAMED ? "LIGHTGRID_SH_LIGHTS" : "LIGHTGRID_SH_SPARSE", lump));
}

/* Finds the lump of that form in a whole .bsp file image. SHGRID_ANY: the most accurate one that the file has and that
   is good; if all are damaged or of another version, the first of them. */
static inline shgrid_result shgrid_find_form(const void *data, size_t size, shgrid_form form,
                                             const unsigned char **lump, size_t *lumpSize) {
    static const shgrid_form forms[3] = {SHGRID_NAMED, SHGRID_SPARSE, SHGRID_UNIFORM};
    bspx_file bsp;
    shgrid_grid grid;
    shgrid_result first = shgrid_from_bspx_(bspx_open(data, size, &bsp));
    int i, found = 0;
    *lump = NULL;
    *lumpSize = 0;
    if (first != SHGRID_OK)
        return first;
    first = SHGRID_ABSENT;
    for (i = 0; i < 3; i++) {
        bspx_lump one = {NULL, 0};
        shgrid_result result;
        if (form != SHGRID_ANY && form != forms[i])
            continue;
        result = shgrid_find_one_(&bsp, forms[i], &one);
        if (result == SHGRID_ABSENT)
            continue;
        if (!found) {
            first = result;
            *lump = one.data;
            *lumpSize = one.size;
            found = 1;
        }
        if (form != SHGRID_ANY || result != SHGRID_OK || shgrid_parse(one.data, one.size, &grid) != SHGRID_OK)
            continue;
        *lump = one.data;
        *lumpSize = one.size;
        return SHGRID_OK;
    }
    return first;
}

/* The same of SHGRID_ANY. */
static inline shgrid_result shgrid_find(const void *data, size_t size, const unsigned char **lump, size_t *lumpSize) {
    return shgrid_find_form(data, size, SHGRID_ANY, lump, lumpSize);
}

/* Finds and parses the grid of that form in a whole .bsp file image. */
static inline shgrid_result shgrid_load_form(const void *file, size_t size, shgrid_form form, shgrid_grid *grid) {
    const unsigned char *lump;
    size_t lumpSize;
    const shgrid_result result = shgrid_find_form(file, size, form, &lump, &lumpSize);
    memset(grid, 0, sizeof *grid);
    return result == SHGRID_OK ? shgrid_parse(lump, lumpSize, grid) : result;
}

/* The same of SHGRID_ANY. */
static inline shgrid_result shgrid_load(const void *file, size_t size, shgrid_grid *grid) {
    return shgrid_load_form(file, size, SHGRID_ANY, grid);
}

static inline void shgrid_uniform_point_(const shgrid_grid *grid, int32_t x, int32_t y, int32_t z, shgrid_coeffs *out) {
    const size_t index = (size_t)x + (size_t)grid->bounds[0] * ((size_t)y + (size_t)grid->bounds[1] * (size_t)z);
    const unsigned char *p = grid->points + SHGRID_POINT_BYTES * index;
    int k, channel;
    for (k = 0; k < 9; k++)
        for (channel = 0; channel < 3; channel++)
            out->c[k][channel] = shgrid_f32_(p + 12 * k + 4 * channel);
}

static inline void shgrid_sample_uniform_(const shgrid_grid *grid, const float position[3], shgrid_coeffs *out) {
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
        shgrid_uniform_point_(grid, at[0], at[1], at[2], &point);
        for (k = 0; k < 9; k++)
            for (channel = 0; channel < 3; channel++)
                out->c[k][channel] += weight * point.c[k][channel];
    }
}

/* 2^exponent, exponents -126 to 127. */
static inline float shgrid_exp2_(int exponent) {
    const uint32_t bits = (uint32_t)(exponent + 127) << 23;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* A node's scale: 2^((code - 128) / 8). */
static inline float shgrid_scale_(unsigned code) {
    static const float eighths[8] = {1.0f,        1.09050773f, 1.18920712f, 1.29683955f,
                                     1.41421356f, 1.54221083f, 1.68179283f, 1.83400809f};
    return eighths[code & 7] * shgrid_exp2_((int)(code >> 3) - 16);
}

/* A sum of weighted points. */
typedef struct {
    shgrid_coeffs coeffs;
    float total; /* weight */
    int names;   /* number of lights that are named by points so far */
    uint32_t light[SHGRID_NAMES_AT_PLACE];
    float share[SHGRID_NAMES_AT_PLACE];      /* of each: weighted sum of its visible shares */
    unsigned char at[SHGRID_NAMES_AT_PLACE]; /* by the last bits of a number: where that light was named last, or */
} shgrid_sum_;

#define SHGRID_NOWHERE 255 /* no light with these bits was named */

static inline void shgrid_clear_(shgrid_sum_ *sum) {
    memset(&sum->coeffs, 0, sizeof sum->coeffs);
    sum->total = 0;
    sum->names = 0;
    memset(sum->at, SHGRID_NOWHERE, sizeof sum->at);
}

/* Adds weight times a quantized point of a node with that scale. Coefficients of bands 1 and 2 are stored over the
   largest that light from one direction has: 2 / sqrt(3) and sqrt(5) / 4 of coefficient 0. */
static inline void shgrid_add_point_(const unsigned char *p, unsigned scale, float weight, shgrid_coeffs *sum) {
    const uint32_t code = bspx_u32(p);
    const float unit = weight * shgrid_exp2_((int)(code >> 27) - 24);
    const float mean[3] = {unit * (float)(code & 511), unit * (float)(code >> 9 & 511),
                           unit * (float)(code >> 18 & 511)};
    const float factor = shgrid_scale_(scale) / 127;
    int k, channel;
    for (channel = 0; channel < 3; channel++)
        sum->c[0][channel] += mean[channel];
    for (k = 1; k < 9; k++) {
        const float bound = factor * (k < 4 ? 1.15470054f : 0.559016994f);
        for (channel = 0; channel < 3; channel++) {
            const int code8 = p[1 + 3 * k + channel], q = code8 < 128 ? code8 : code8 == 128 ? -127 : code8 - 256;
            sum->c[k][channel] += (float)q * bound * mean[channel];
        }
    }
}

/* The same for a grid that names lights: a byte for the scale, then 27 signed bytes. */
static inline void shgrid_add_named_point_(const unsigned char *p, float weight, shgrid_coeffs *sum) {
    const float unit = weight * shgrid_scale_(p[0]) / 127;
    int8_t q[27];
    int k, channel;
    memcpy(q, p + 1, sizeof q);
    for (k = 0; k < 9; k++) {
        const float step = unit * (k == 0 ? 1 : k < 4 ? 1.15470054f : 0.559016994f);
        for (channel = 0; channel < 3; channel++)
            sum->c[k][channel] += step * (float)(q[3 * k + channel] < -127 ? -127 : q[3 * k + channel]);
    }
}

/* Where a light is among those that are named so far, or is added; -1: there is no room for it. */
static inline int shgrid_name_(shgrid_sum_ *sum, uint32_t light) {
    unsigned char *guess = sum->at + light % SHGRID_NAMES_AT_PLACE;
    int at = *guess;
    if (at != SHGRID_NOWHERE && sum->light[at] == light)
        return at;
    at = at == SHGRID_NOWHERE ? sum->names : 0;
    while (at < sum->names && sum->light[at] != light)
        at++;
    if (at == SHGRID_NAMES_AT_PLACE)
        return -1;
    if (at == sum->names) {
        sum->light[at] = light;
        sum->share[at] = 0;
        sum->names++;
    }
    *guess = (unsigned char)at;
    return at;
}

/* Adds weight times the shares of point number `point` of a node. */
static inline void shgrid_add_shares_(const shgrid_grid *grid, const unsigned char *node, uint32_t point, float weight,
                                      shgrid_sum_ *sum) {
    const uint32_t count = node[11];
    const unsigned char *names = grid->names + 2 * (size_t)bspx_u32(node + 12),
                        *shares = grid->shares + bspx_u32(node + 16) + (size_t)count * point;
    const float unit = weight / 255;
    uint32_t i;
    for (i = 0; i < count; i++)
        if (shares[i] != 0) {
            const int at = shgrid_name_(sum, shgrid_u16_(names + 2 * i));
            if (at >= 0)
                sum->share[at] += unit * (float)shares[i];
        }
}

/* The nodes from a root down to the one that owns the cell found last. The next search starts at the deepest of them
   that contains its position. */
typedef struct {
    const unsigned char *node[SHGRID_SPARSE_LEVELS];
    int32_t at[3];   /* position of the last search, in smallest cells */
    int level;       /* of the last node; -1: none yet */
    uint32_t octant; /* of the cell in the last node */
    int size;        /* log2 of the edge of the cell, in smallest cells */
} shgrid_path_;

/* Finds the cell that contains a position inside the roots. */
static inline void shgrid_descend_(const shgrid_grid *grid, const int32_t at[3], shgrid_path_ *path) {
    const int levels = grid->levels;
    const uint32_t other = (uint32_t)((path->at[0] ^ at[0]) | (path->at[1] ^ at[1]) | (path->at[2] ^ at[2]));
    int level = path->level;
    while (level >= 0 && other >> (levels - level))
        level--;
    if (level < 0) {
        const size_t nx = (size_t)(grid->bounds[0] >> levels), ny = (size_t)(grid->bounds[1] >> levels);
        const size_t root =
            (size_t)(at[0] >> levels) + nx * ((size_t)(at[1] >> levels) + ny * (size_t)(at[2] >> levels));
        level = 0;
        path->node[0] = shgrid_node_(grid, (uint32_t)root);
    }
    for (;;) {
        const unsigned char *node = path->node[level];
        const int size = levels - 1 - level;
        const uint32_t octant = (uint32_t)((at[0] >> size & 1) | (at[1] >> size & 1) << 1 | (at[2] >> size & 1) << 2);
        if (!(node[8] >> octant & 1)) {
            path->level = level;
            path->octant = octant;
            path->size = size;
            memcpy(path->at, at, sizeof path->at);
            return;
        }
        level++;
        path->node[level] = shgrid_node_(grid, bspx_u32(node) + shgrid_bits_(node[8] & ((1u << octant) - 1)));
    }
}

/* Adds weight times the value stored at a point of the lattice of smallest cells, and the weight; nothing at a point
   without a value. Returns 0 if the value follows from larger cells: its weight is still to be added. */
static inline int shgrid_add_corner_(const shgrid_grid *grid, const int32_t at[3], float weight, shgrid_path_ *path,
                                     shgrid_sum_ *sum) {
    const unsigned char *node;
    int32_t mask;
    int axis;
    for (axis = 0; axis < 3; axis++)
        if (at[axis] < 0 || at[axis] >= grid->bounds[axis])
            return 1;
    shgrid_descend_(grid, at, path);
    node = path->node[path->level];
    mask = ((int32_t)1 << path->size) - 1;
    if ((at[0] | at[1] | at[2]) & mask) /* inside or on a larger cell, not its corner */
        return 0;
    if (node[9] >> path->octant & 1) {
        const uint32_t inNode = shgrid_bits_(node[9] & ((1u << path->octant) - 1));
        const unsigned char *point =
            grid->points + (size_t)SHGRID_SPARSE_POINT_BYTES * ((size_t)bspx_u32(node + 4) + inNode);
        if (grid->lights == NULL) {
            shgrid_add_point_(point, node[11], weight, &sum->coeffs);
        } else {
            shgrid_add_named_point_(point, weight, &sum->coeffs);
            shgrid_add_shares_(grid, node, inNode, weight, sum);
        }
        sum->total += weight;
        return 1;
    }
    return !(node[10] >> path->octant & 1);
}

/* Distributes the weights of the corners of a cube of edge 2^size to those of the cube of twice the edge around it, by
   trilinear interpolation; `low` becomes its lower corner. */
static inline void shgrid_widen_(int32_t low[3], int size, float weights[8]) {
    int axis, i;
    for (axis = 0; axis < 3; axis++) {
        const int upper = low[axis] >> size & 1;
        low[axis] -= (int32_t)upper << size;
        for (i = 0; i < 8; i++)
            if (!(i >> axis & 1)) {
                float *first = weights + i, *second = weights + (i | 1 << axis), *middle = upper ? first : second;
                const float half = *middle / 2;
                *middle = half;
                *(upper ? second : first) += half;
            }
    }
}

/* Adds the corners of a cube of edge 2^size with these weights, which are changed. The weights of corners that follow
   from larger cells go on to the cube around, and so on up to the roots: at most 8 searches per level, whatever the
   tree is like. */
static inline void shgrid_add_cube_(const shgrid_grid *grid, int32_t low[3], int size, float weights[8],
                                    shgrid_path_ *path, shgrid_sum_ *sum) {
    int pending = 1, i;
    for (; pending && size < grid->levels; size++) {
        pending = 0;
        for (i = 0; i < 8; i++) {
            const int32_t at[3] = {low[0] + ((int32_t)(i & 1) << size), low[1] + ((int32_t)(i >> 1 & 1) << size),
                                   low[2] + ((int32_t)(i >> 2) << size)};
            if (!(weights[i] > 0))
                continue;
            if (shgrid_add_corner_(grid, at, weights[i], path, sum))
                weights[i] = 0;
            else
                pending = 1;
        }
        if (pending)
            shgrid_widen_(low, size, weights);
    }
}

/* Divides by the total weight; 0 if there is hardly any. */
static inline void shgrid_divide_(shgrid_sum_ *sum) {
    const float factor = sum->total > 1e-20f ? 1 / sum->total : 0;
    int k, channel;
    for (k = 0; k < 9; k++)
        for (channel = 0; channel < 3; channel++)
            sum->coeffs.c[k][channel] *= factor;
    for (k = 0; k < sum->names; k++)
        sum->share[k] *= factor;
}

/* Trilinear blend in the cell that contains a position inside the roots, in smallest cells. equalWeights: the mean of
   the corners instead. Returns 0, and black, if no corner with a weight has a value. */
static inline int shgrid_blend_sparse_(const shgrid_grid *grid, const double at[3], int equalWeights,
                                       shgrid_path_ *path, shgrid_sum_ *out) {
    int32_t low[3];
    float weights[8], fraction[3];
    int axis, i;
    for (axis = 0; axis < 3; axis++) {
        low[axis] = (int32_t)at[axis];
        if (low[axis] >= grid->bounds[axis])
            low[axis] = grid->bounds[axis] - 1;
    }
    shgrid_descend_(grid, low, path);
    for (axis = 0; axis < 3; axis++) {
        low[axis] = low[axis] >> path->size << path->size;
        fraction[axis] = (float)((at[axis] - low[axis]) / (double)((int32_t)1 << path->size));
    }
    for (i = 0; i < 8; i++) {
        weights[i] = 1;
        for (axis = 0; axis < 3; axis++)
            weights[i] *= equalWeights ? 0.5f : i >> axis & 1 ? fraction[axis] : 1 - fraction[axis];
    }
    shgrid_clear_(out);
    shgrid_add_cube_(grid, low, path->size, weights, path, out);
    shgrid_divide_(out);
    return out->total > 1e-20f;
}

static inline void shgrid_sample_tree_(const shgrid_grid *grid, const float position[3], shgrid_sum_ *out) {
    shgrid_path_ path;
    double at[3];
    int axis;
    for (axis = 0; axis < 3; axis++) {
        at[axis] = ((double)position[axis] - grid->mins[axis]) / grid->cell[axis];
        if (!(at[axis] > 0)) /* NaN too */
            at[axis] = 0;
        if (at[axis] > grid->bounds[axis])
            at[axis] = grid->bounds[axis];
    }
    memset(&path, 0, sizeof path);
    path.level = -1;
    if (!shgrid_blend_sparse_(grid, at, 0, &path, out)) /* right on a corner without a value */
        shgrid_blend_sparse_(grid, at, 1, &path, out);
}

/* ---- What a light of the table gives at a position ---- */

/* Integrals over the solid angle that a light covers: of 1, of w, and of w w^T, w the unit direction. */
typedef struct {
    double solidAngle, first[3], xx, yy, zz, xy, yz, xz;
} shgrid_moments_;

/* Adds solid angle `w` around the unit direction d. */
static inline void shgrid_add_direction_(shgrid_moments_ *m, const double d[3], double w) {
    m->solidAngle += w;
    m->first[0] += d[0] * w;
    m->first[1] += d[1] * w;
    m->first[2] += d[2] * w;
    m->xx += d[0] * d[0] * w;
    m->yy += d[1] * d[1] * w;
    m->zz += d[2] * d[2] * w;
    m->xy += d[0] * d[1] * w;
    m->yz += d[1] * d[2] * w;
    m->xz += d[0] * d[2] * w;
}

static inline double shgrid_dot_(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void shgrid_cross_(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The angle with that tangent, which is above 0. Up to 20 degrees by a series, exact to 1e-8. */
static inline double shgrid_arctangent_(double tangent) {
    const double t = tangent * tangent;
    if (t > 0.1325)
        return atan(tangent);
    return tangent *
           (1 - t * (1.0 / 3 - t * (1.0 / 5 - t * (1.0 / 7 - t * (1.0 / 9 - t * (1.0 / 11 - t * (1.0 / 13)))))));
}

/* Half of the angle between two unit vectors over its sine. Up to 36 degrees by a series in the square of the sine of
   half the angle, exact to 1e-9. */
static inline double shgrid_angle_over_sine_(double cosine, const double cross[3]) {
    const double t = 0.5 - 0.5 * cosine;
    double sine;
    if (t < 0.1)
        return 0.5 +
               t * (1.0 / 3 +
                    t * (4.0 / 15 +
                         t * (8.0 / 35 + t * (64.0 / 315 +
                                              t * (128.0 / 693 + t * (512.0 / 3003 + t * (1024.0 / 6435 +
                                                                                          t * (16384.0 / 109395))))))));
    sine = sqrt(shgrid_dot_(cross, cross));
    return sine > 0 ? atan2(sine, cosine) / (2 * sine) : 0;
}

/* The unit vector from a position to a vertex. */
static inline void shgrid_unit_to_(const unsigned char *vertex, const float position[3], double unit[3]) {
    double inverse;
    int axis;
    for (axis = 0; axis < 3; axis++)
        unit[axis] = (double)shgrid_f32_(vertex + 4 * axis) - position[axis];
    inverse = shgrid_dot_(unit, unit);
    inverse = inverse > 0 ? 1 / sqrt(inverse) : 0;
    for (axis = 0; axis < 3; axis++)
        unit[axis] *= inverse;
}

/* Adds six times the integral of w w^T along an edge of a polygon, without the identity matrix. */
static inline void shgrid_add_arc_(const double a[3], const double b[3], const double cross[3], double cosine,
                                   shgrid_moments_ *m) {
    const double sine = sqrt(shgrid_dot_(cross, cross)), scale = cosine > 0 ? 1 / (1 + cosine) : 1 / sine;
    double arc[3], difference[3], inward[3];
    int axis;
    if (!(sine > 0))
        return;
    for (axis = 0; axis < 3; axis++) {
        inward[axis] = cross[axis] * scale;
        arc[axis] = a[axis] + b[axis];
        difference[axis] = a[axis] - b[axis];
    }
    if (!(cosine > 0)) /* the same vector, exact for obtuse angles */
        shgrid_cross_(inward, difference, arc);
    m->xx += 2 * arc[0] * inward[0];
    m->yy += 2 * arc[1] * inward[1];
    m->zz += 2 * arc[2] * inward[2];
    m->xy += arc[0] * inward[1] + arc[1] * inward[0];
    m->yz += arc[1] * inward[2] + arc[2] * inward[1];
    m->xz += arc[0] * inward[2] + arc[2] * inward[0];
}

/* Adds `weight` times the moments of a polygon in closed form: integrals along its edges, which are arcs of great
   circles (by the divergence theorem), and its solid angle as the sum of triangles from the foot of the perpendicular.
   The position is in front, or behind a polygon that shines to both sides. second: w w^T too. */
static inline void shgrid_add_polygon_(const shgrid_grid *grid, const unsigned char *polygon, const float position[3],
                                       int behind, int second, double weight, shgrid_moments_ *sum) {
    const uint32_t count = bspx_u32(polygon + 4);
    const unsigned char *vertices = grid->vertices + 12 * (size_t)bspx_u32(polygon);
    const double side = behind ? 1 : -1;
    double normal[3], a[3], heightA, re = 1, im = 0;
    shgrid_moments_ m;
    uint32_t i;
    int axis;
    memset(&m, 0, sizeof m);
    for (axis = 0; axis < 3; axis++)
        normal[axis] = side * shgrid_f32_(polygon + 8 + 4 * axis);
    shgrid_unit_to_(vertices + 12 * (size_t)(behind ? 0 : count - 1), position, a);
    heightA = shgrid_dot_(normal, a);
    for (i = 0; i < count; i++) {
        double b[3], cross[3], heightB, cosine, weightOfEdge, x, y, t;
        shgrid_unit_to_(vertices + 12 * (size_t)(behind ? count - 1 - i : i), position, b);
        heightB = shgrid_dot_(normal, b);
        shgrid_cross_(a, b, cross);
        cosine = shgrid_dot_(a, b);
        weightOfEdge = shgrid_angle_over_sine_(cosine, cross);
        for (axis = 0; axis < 3; axis++)
            m.first[axis] += cross[axis] * weightOfEdge;
        if (second)
            shgrid_add_arc_(a, b, cross, cosine, &m);
        /* The product of complex numbers whose arguments are half the solid angles of the triangles. */
        x = 1 + heightA + heightB + cosine;
        y = shgrid_dot_(normal, cross);
        t = re * x - im * y;
        im = re * y + im * x;
        re = t;
        memcpy(a, b, sizeof a);
        heightA = heightB;
    }
    m.solidAngle = 2 * (re > 0 && im > 0 ? shgrid_arctangent_(im / re) : atan2(im, re));
    if (m.solidAngle < 0) /* past half a turn */
        m.solidAngle += 12.566370614359172;
    if (!(m.solidAngle > 0 && m.solidAngle < 6.2832))
        return;
    sum->solidAngle += weight * m.solidAngle;
    for (axis = 0; axis < 3; axis++)
        sum->first[axis] += weight * m.first[axis];
    if (!second)
        return;
    sum->xx += weight * (m.xx / 6 + m.solidAngle / 3);
    sum->yy += weight * (m.yy / 6 + m.solidAngle / 3);
    sum->zz += weight * (m.zz / 6 + m.solidAngle / 3);
    sum->xy += weight / 6 * m.xy;
    sum->yz += weight / 6 * m.yz;
    sum->xz += weight / 6 * m.xz;
}

/* Moments of the polygons of a light: as points from beyond 8 times their radius, exact within 6 times, a blend of the
   two between. second: w w^T too, else it is not right. */
static inline void shgrid_polygon_moments_(const shgrid_grid *grid, const unsigned char *light, const float position[3],
                                           int second, shgrid_moments_ *m) {
    const uint32_t first = bspx_u32(light + 104), end = first + bspx_u32(light + 108);
    uint32_t i;
    int axis;
    memset(m, 0, sizeof *m);
    for (i = first; i < end; i++) {
        const unsigned char *polygon = grid->polygons + (size_t)SHGRID_POLYGON_BYTES * i;
        const double area = shgrid_f32_(polygon + 36), radius = shgrid_f32_(polygon + 40);
        double to[3], height = -(double)shgrid_f32_(polygon + 20), distance, exact;
        for (axis = 0; axis < 3; axis++) {
            height += (double)shgrid_f32_(polygon + 8 + 4 * axis) * position[axis];
            to[axis] = (double)shgrid_f32_(polygon + 24 + 4 * axis) - position[axis];
        }
        if (!(height > 0) && !(light[3] & SHGRID_TWO_SIDED))
            continue;
        distance = sqrt(shgrid_dot_(to, to));
        exact = radius > 0 ? (8 * radius - distance) / (2 * radius) : 0;
        exact = exact < 0 ? 0 : exact < 1 ? exact : 1;
        if (exact > 0)
            shgrid_add_polygon_(grid, polygon, position, height < 0, second, exact, m);
        if (exact < 1) {
            const double inverse = 1 / distance;
            for (axis = 0; axis < 3; axis++)
                to[axis] *= inverse;
            shgrid_add_direction_(m, to, (1 - exact) * area * fabs(height) * (inverse * inverse * inverse));
        }
    }
}

/* Falloff of a point light or a spotlight with distance, for color 1. */
static inline float shgrid_falloff_(const unsigned char *light, float distance) {
    const float intensity = shgrid_f32_(light + 40), extra = shgrid_f32_(light + 44), end = shgrid_f32_(light + 52);
    const float nearest = shgrid_f32_(light + 96);
    const float spaced = sqrtf(distance * distance + extra * extra), d = spaced > nearest ? spaced : nearest;
    float e, x;
    switch (light[1]) {
    case SHGRID_LINEAR:
        return intensity * (1.0f / 8000) - d * shgrid_f32_(light + 48);
    case SHGRID_WINDOWED:
        x = 1 - d * d * d * d / (end * end * end * end);
        x = x > 0 ? x : 0;
        return intensity / (d * d) * (x * x);
    case SHGRID_POLYNOMIAL:
        e = d < shgrid_f32_(light + 60) ? d : shgrid_f32_(light + 60);
        x = (end - d) / (end - shgrid_f32_(light + 56));
        x = x < 0 ? 0 : x < 1 ? x : 1;
        return intensity / (shgrid_f32_(light + 64) + e * (shgrid_f32_(light + 68) + e * shgrid_f32_(light + 72))) *
               (x * x * x * (x * (6 * x - 15) + 10));
    default:
        return intensity / (d * d);
    }
}

/* The fraction of a spotlight that its cone lets through; `to` points from the position to the light. */
static inline float shgrid_cone_(const unsigned char *light, const float to[3], float distance) {
    const float fade = shgrid_f32_(light + 100);
    float normal[3], along = 0, square = 0, radius, off, cosine, fringe;
    int axis;
    for (axis = 0; axis < 3; axis++) {
        normal[axis] = shgrid_f32_(light + 28 + 4 * axis);
        along -= to[axis] * normal[axis];
    }
    if (along < 0)
        return 0;
    if (light[3] & SHGRID_CONE_BY_ANGLES) {
        const float inner = shgrid_f32_(light + 76), outer = shgrid_f32_(light + 80);
        cosine = distance > 0 ? along / distance : 0;
        if (cosine <= outer)
            return 0;
        fringe = cosine < inner ? (cosine - outer) / (inner - outer) : 1;
        return cosine * powf(fringe, shgrid_f32_(light + 84));
    }
    for (axis = 0; axis < 3; axis++)
        square += (to[axis] + normal[axis] * along) * (to[axis] + normal[axis] * along);
    radius = shgrid_f32_(light + 88) * along;
    off = sqrtf(square);
    return off >= radius ? 0 : off > radius - fade ? (radius - off) / fade : 1;
}

/* A light at a position, for color 1: `strength` on a surface that faces `direction`, from a source that appears with
   the sine `spread` of its angular radius; and nine coefficients, convolved with the cosine, of what is too near to be
   a direction. Visibility is not included. */
typedef struct {
    float direction[3], strength, spread, sh[9];
    int hasSH;
} shgrid_beam_;

/* Adds `scale` times the coefficients of the polygons of a light, from all of their moments, to a beam. */
static inline void shgrid_polygon_coeffs_(const shgrid_moments_ *m, double scale, shgrid_beam_ *beam) {
    static const float lobe[3] = {1, 2.0f / 3, 0.25f};
    double basis[9];
    int k;
    basis[0] = 0.282094791773878 * m->solidAngle;
    basis[1] = 0.488602511902920 * m->first[1];
    basis[2] = 0.488602511902920 * m->first[2];
    basis[3] = 0.488602511902920 * m->first[0];
    basis[4] = 1.092548430592079 * m->xy;
    basis[5] = 1.092548430592079 * m->yz;
    basis[6] = 0.315391565252520 * (2 * m->zz - m->xx - m->yy);
    basis[7] = 1.092548430592079 * m->xz;
    basis[8] = 0.546274215296040 * (m->xx - m->yy);
    beam->hasSH = 1;
    for (k = 0; k < 9; k++)
        beam->sh[k] = (float)(scale * basis[k]) * lobe[k == 0 ? 0 : k < 4 ? 1 : 2];
}

/* The largest variance of the directions to a light along any axis at right angles to the mean direction, from all of
   its moments. (2 - c - c^2) / 6 for a disc whose angular radius has the cosine c. */
static inline double shgrid_variance_(const shgrid_moments_ *m, double length) {
    const double inverse = 1 / m->solidAngle, x = m->first[0] / length, y = m->first[1] / length,
                 z = m->first[2] / length;
    /* M are the second moments, P projects along the mean direction. P M P has the eigenvalues that are looked for,
       and 0. Here are M times the mean direction, the trace of P M P, and the sum of the squares of its elements. */
    const double rowX = x * m->xx + y * m->xy + z * m->xz, rowY = x * m->xy + y * m->yy + z * m->yz,
                 rowZ = x * m->xz + y * m->yz + z * m->zz, along = x * rowX + y * rowY + z * rowZ;
    const double trace = m->xx + m->yy + m->zz - along;
    const double squares = m->xx * m->xx + m->yy * m->yy + m->zz * m->zz +
                           2 * (m->xy * m->xy + m->yz * m->yz + m->xz * m->xz) -
                           2 * (rowX * rowX + rowY * rowY + rowZ * rowZ) + along * along;
    const double difference = 2 * squares - trace * trace;
    return 0.5 * inverse * (trace + sqrt(difference > 0 ? difference : 0));
}

/* Polygons that appear with up to 40 degrees of angular radius act as a direction, from 50 degrees on as coefficients:
   there both have an error under 0.5 % of the light. The radius is that of the disc with the same variance of
   directions along the longest axis. A mean cosine of `narrow` excludes larger ones, whatever the shape. */
static inline void shgrid_polygon_beam_(const shgrid_grid *grid, const unsigned char *light, const float position[3],
                                        shgrid_beam_ *beam) {
    const double smallest = 0.4314, largest = 0.6294, narrow = 1 - smallest / 8; /* four variances */
    const float intensity = shgrid_f32_(light + 40);
    shgrid_moments_ m;
    double length, inverse, cosine, alpha, directed = 1;
    int axis;
    shgrid_polygon_moments_(grid, light, position, 0, &m);
    length = sqrt(shgrid_dot_(m.first, m.first));
    if (!(length > 0) || !isfinite(length) || !(m.solidAngle > 0))
        return;
    cosine = length / m.solidAngle;
    if (cosine < narrow) {
        shgrid_polygon_moments_(grid, light, position, 1, &m);
        directed = (largest - 4 * shgrid_variance_(&m, length)) * (1 / (largest - smallest));
        directed = directed < 0 ? 0 : directed < 1 ? directed : 1;
        directed = directed * directed * (3 - 2 * directed);
    }
    if (directed > 0) {
        alpha = 2 * cosine - 1;
        beam->strength = (float)(directed * intensity * length * (1 / 3.14159265358979));
        beam->spread = (float)sqrt(alpha < 1 ? 1 - alpha * alpha : 0);
        inverse = 1 / length;
        for (axis = 0; axis < 3; axis++)
            beam->direction[axis] = (float)(m.first[axis] * inverse);
    }
    if (directed < 1)
        shgrid_polygon_coeffs_(&m, (1 - directed) * intensity, beam);
}

static inline void shgrid_beam_at_(const shgrid_grid *grid, uint32_t number, const float position[3],
                                   shgrid_beam_ *beam) {
    const unsigned char *light = grid->lights + (size_t)SHGRID_LIGHT_BYTES * number;
    float to[3], square = 0, distance;
    int axis;
    memset(beam, 0, sizeof *beam);
    if (light[0] == SHGRID_POLYGONS) {
        shgrid_polygon_beam_(grid, light, position, beam);
        return;
    }
    if (light[0] == SHGRID_SUN) {
        beam->strength = shgrid_f32_(light + 40);
        beam->spread = shgrid_f32_(light + 92);
        for (axis = 0; axis < 3; axis++)
            beam->direction[axis] = shgrid_f32_(light + 28 + 4 * axis);
        return;
    }
    for (axis = 0; axis < 3; axis++) {
        to[axis] = shgrid_f32_(light + 16 + 4 * axis) - position[axis];
        square += to[axis] * to[axis];
    }
    distance = sqrtf(square);
    beam->strength = shgrid_falloff_(light, distance);
    if (light[0] == SHGRID_SPOT)
        beam->strength *= shgrid_cone_(light, to, distance);
    if (!(beam->strength > 0) || !isfinite(beam->strength)) /* no number, or right at a light that has no `nearest` */
        beam->strength = 0;
    for (axis = 0; axis < 3; axis++)
        beam->direction[axis] = distance > 0 ? to[axis] / distance : 0;
}

/* Adds coefficients of `color` from one direction, as shgrid_shade shows it. */
static inline void shgrid_add_direct_(const float direction[3], float spread, const float color[3],
                                      shgrid_coeffs *sum) {
    const float x = direction[0], y = direction[1], z = direction[2], s2 = spread * spread;
    const float band0 = 3.14159265f * (1 + s2 / 3), band1 = 2.09439510f,
                band2 = 3.14159265f * (0.25f - s2 / 6 + s2 * s2 / 20);
    const float basis[9] = {0.282094792f * band0,
                            0.488602512f * band1 * y,
                            0.488602512f * band1 * z,
                            0.488602512f * band1 * x,
                            1.092548431f * band2 * x * y,
                            1.092548431f * band2 * y * z,
                            0.315391565f * band2 * (2 * z * z - x * x - y * y),
                            1.092548431f * band2 * x * z,
                            0.546274215f * band2 * (x * x - y * y)};
    int k, channel;
    for (k = 0; k < 9; k++)
        for (channel = 0; channel < 3; channel++)
            sum->c[k][channel] += basis[k] * color[channel];
}

/* Adds the lights that are named at a world position to the coefficients there. */
static inline void shgrid_add_named_lights_(const shgrid_grid *grid, const float position[3], shgrid_sum_ *sum) {
    int i, k, channel;
    for (i = 0; i < sum->names; i++) {
        const unsigned char *light = grid->lights + (size_t)SHGRID_LIGHT_BYTES * sum->light[i];
        shgrid_beam_ beam;
        float color[3];
        if (sum->share[i] == 0)
            continue;
        shgrid_beam_at_(grid, sum->light[i], position, &beam);
        for (channel = 0; channel < 3; channel++)
            color[channel] = sum->share[i] * shgrid_f32_(light + 4 + 4 * channel);
        for (k = 0; beam.hasSH && k < 9; k++)
            for (channel = 0; channel < 3; channel++)
                sum->coeffs.c[k][channel] += beam.sh[k] * color[channel];
        for (channel = 0; channel < 3; channel++)
            color[channel] *= beam.strength;
        if (beam.strength > 0)
            shgrid_add_direct_(beam.direction, beam.spread, color, &sum->coeffs);
    }
}

/* shgrid_blend_sparse_, with named lights as coefficients. */
static inline int shgrid_blend_coeffs_(const shgrid_grid *grid, const double at[3], shgrid_path_ *path,
                                       shgrid_coeffs *out) {
    shgrid_sum_ sum;
    const int found = shgrid_blend_sparse_(grid, at, 0, path, &sum);
    if (grid->lights != NULL) {
        const float position[3] = {(float)(grid->mins[0] + at[0] * grid->cell[0]),
                                   (float)(grid->mins[1] + at[1] * grid->cell[1]),
                                   (float)(grid->mins[2] + at[2] * grid->cell[2])};
        shgrid_add_named_lights_(grid, position, &sum);
    }
    *out = sum.coeffs;
    return found;
}

/* Coefficients of point (x, y, z); each coordinate in 0 .. bounds - 1. Sparse: the value at the corner of a smallest
   cell; black in solid space and void. */
static inline void shgrid_point(const shgrid_grid *grid, int32_t x, int32_t y, int32_t z, shgrid_coeffs *out) {
    if (grid->points == NULL) {
        memset(out, 0, sizeof *out);
    } else if (grid->levels == 0) {
        shgrid_uniform_point_(grid, x, y, z, out);
    } else {
        const double at[3] = {(double)x, (double)y, (double)z};
        shgrid_path_ path;
        memset(&path, 0, sizeof path);
        path.level = -1;
        shgrid_blend_coeffs_(grid, at, &path, out);
    }
}

/* Trilinear blend at a world position; positions outside the grid are clamped to it. Corners of sparse cells without a
   value are left out, and the weights of the others are made to add up to 1; where no corner has one, it is black.
   Lights that the grid names are among the coefficients. A grid that failed to load is black everywhere. */
static inline void shgrid_sample(const shgrid_grid *grid, const float position[3], shgrid_coeffs *out) {
    if (grid->points == NULL)
        memset(out, 0, sizeof *out);
    else if (grid->levels == 0)
        shgrid_sample_uniform_(grid, position, out);
    else {
        shgrid_sum_ sum;
        shgrid_sample_tree_(grid, position, &sum);
        if (grid->lights != NULL)
            shgrid_add_named_lights_(grid, position, &sum);
        *out = sum.coeffs;
    }
}

/* Samples at all points of another lattice, x fastest, then y, then z: a grid of one cell size for engines that want
   no tree. `out` has room for the product of bounds. */
static inline void shgrid_expand(const shgrid_grid *grid, const float mins[3], const float cell[3],
                                 const int32_t bounds[3], shgrid_coeffs *out) {
    int32_t x, y, z;
    for (z = 0; z < bounds[2]; z++)
        for (y = 0; y < bounds[1]; y++)
            for (x = 0; x < bounds[0]; x++, out++) {
                const float position[3] = {mins[0] + (float)x * cell[0], mins[1] + (float)y * cell[1],
                                           mins[2] + (float)z * cell[2]};
                shgrid_sample(grid, position, out);
            }
}

/* State while the points near a position are collected. */
typedef struct {
    const shgrid_grid *grid;
    const float *position;
    float radius;
    float (*points)[3];
    size_t limit, count;
} shgrid_search_;

static inline void shgrid_add_near_(shgrid_search_ *search, const int32_t at[3]) {
    float point[3], square = 0;
    int axis;
    for (axis = 0; axis < 3; axis++) {
        point[axis] = search->grid->mins[axis] + search->grid->cell[axis] * (float)at[axis];
        square += (point[axis] - search->position[axis]) * (point[axis] - search->position[axis]);
    }
    if (!(square <= search->radius * search->radius))
        return;
    if (search->count < search->limit)
        memcpy(search->points[search->count], point, sizeof point);
    search->count++;
}

/* The points of a node and of the nodes below it; `size` is log2 of the edge of its children, in smallest cells. */
static inline void shgrid_search_node_(shgrid_search_ *search, uint32_t index, int size, const int32_t low[3]) {
    const unsigned char *node = shgrid_node_(search->grid, index);
    uint32_t child = bspx_u32(node), octant;
    int axis;
    for (axis = 0; axis < 3; axis++) {
        const float cell = search->grid->cell[axis], from = search->grid->mins[axis] + cell * (float)low[axis];
        if (!(search->position[axis] >= from - search->radius) ||
            !(search->position[axis] <= from + cell * (float)((int32_t)2 << size) + search->radius))
            return;
    }
    for (octant = 0; octant < 8; octant++) {
        const int32_t at[3] = {low[0] + ((int32_t)(octant & 1) << size), low[1] + ((int32_t)(octant >> 1 & 1) << size),
                               low[2] + ((int32_t)(octant >> 2) << size)};
        if (node[9] >> octant & 1)
            shgrid_add_near_(search, at);
        else if (node[8] >> octant & 1)
            shgrid_search_node_(search, child++, size - 1, at);
    }
}

static inline void shgrid_search_uniform_(shgrid_search_ *search) {
    const shgrid_grid *grid = search->grid;
    int32_t from[3], to[3], at[3];
    int axis;
    for (axis = 0; axis < 3; axis++) {
        const double at0 = ((double)search->position[axis] - search->radius - grid->mins[axis]) / grid->cell[axis],
                     at1 = ((double)search->position[axis] + search->radius - grid->mins[axis]) / grid->cell[axis];
        if (!(at0 < grid->bounds[axis]) || !(at1 >= 0))
            return;
        from[axis] = at0 > 0 ? (int32_t)at0 : 0;
        to[axis] = at1 < grid->bounds[axis] - 1 ? (int32_t)at1 : grid->bounds[axis] - 1;
    }
    for (at[2] = from[2]; at[2] <= to[2]; at[2]++)
        for (at[1] = from[1]; at[1] <= to[1]; at[1]++)
            for (at[0] = from[0]; at[0] <= to[0]; at[0]++)
                shgrid_add_near_(search, at);
}

/* The points that are stored within `radius` of a position, for a picture of the grid: returns their number, which may
   be above `limit`, and the world positions of the first `limit`. */
static inline size_t shgrid_points_near(const shgrid_grid *grid, const float position[3], float radius, size_t limit,
                                        float (*points)[3]) {
    shgrid_search_ search = {grid, position, radius, points, limit, 0};
    const int levels = grid->levels;
    int32_t low[3];
    uint32_t root = 0;
    if (grid->points == NULL)
        return 0;
    if (levels == 0) {
        shgrid_search_uniform_(&search);
        return search.count;
    }
    for (low[2] = 0; low[2] < grid->bounds[2]; low[2] += (int32_t)1 << levels)
        for (low[1] = 0; low[1] < grid->bounds[1]; low[1] += (int32_t)1 << levels)
            for (low[0] = 0; low[0] < grid->bounds[0]; low[0] += (int32_t)1 << levels)
                shgrid_search_node_(&search, root++, levels - 1, low);
    return search.count;
}

/* The sum over the basis for a unit normal. */
static inline void shgrid_sum_basis_(const shgrid_coeffs *coeffs, const float normal[3], float rgb[3]) {
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
        rgb[channel] = 0;
        for (k = 0; k < 9; k++)
            rgb[channel] += coeffs->c[k][channel] * basis[k];
    }
}

/* Light on a matte surface with that unit normal; not below zero. */
static inline void shgrid_evaluate(const shgrid_coeffs *coeffs, const float normal[3], float rgb[3]) {
    int channel;
    shgrid_sum_basis_(coeffs, normal, rgb);
    for (channel = 0; channel < 3; channel++)
        rgb[channel] = rgb[channel] > 0 ? rgb[channel] : 0; /* NaN gives 0 */
}

/* Light of one entity: nine coefficients, and the lights that are named where it is. A surface there gets
   shgrid_shade. */
typedef struct {
    float direction[3]; /* unit, toward the light */
    float color[3];     /* on a surface that faces it, red green blue; what hides it is taken off */
    float spread;       /* sine of its angular radius: 0 for a point */
    int style;
    int light; /* its number, for shgrid_light_name */
} shgrid_direct;

typedef struct {
    shgrid_coeffs rest; /* all other light, convolved with the cosine */
    int count;
    shgrid_direct direct[SHGRID_DIRECT_LIGHTS];
} shgrid_lighting;

/* Light at a world position, as shgrid_sample gives it, with named lights apart. styles: the brightness of each of the
   64 light styles; NULL: all are 1. Of grids without names all light is in `rest`. */
static inline void shgrid_lights(const shgrid_grid *grid, const float position[3], const float *styles,
                                 shgrid_lighting *out) {
    shgrid_sum_ sum;
    int i, k, channel;
    out->count = 0;
    if (grid->lights == NULL) {
        shgrid_sample(grid, position, &out->rest);
        return;
    }
    shgrid_sample_tree_(grid, position, &sum);
    out->rest = sum.coeffs;
    for (i = 0; i < sum.names; i++) {
        const unsigned char *light = grid->lights + (size_t)SHGRID_LIGHT_BYTES * sum.light[i];
        const float share = sum.share[i] * (styles ? styles[light[2]] : 1);
        shgrid_direct *direct = out->direct + out->count;
        shgrid_beam_ beam;
        float color[3];
        if (share == 0)
            continue;
        shgrid_beam_at_(grid, sum.light[i], position, &beam);
        for (channel = 0; channel < 3; channel++)
            color[channel] = share * shgrid_f32_(light + 4 + 4 * channel);
        for (k = 0; beam.hasSH && k < 9; k++)
            for (channel = 0; channel < 3; channel++)
                out->rest.c[k][channel] += beam.sh[k] * color[channel];
        if (!(beam.strength > 0))
            continue;
        for (channel = 0; channel < 3; channel++)
            color[channel] *= beam.strength;
        if (out->count == SHGRID_DIRECT_LIGHTS) {
            shgrid_add_direct_(beam.direction, beam.spread, color, &out->rest);
            continue;
        }
        memcpy(direct->direction, beam.direction, sizeof direct->direction);
        memcpy(direct->color, color, sizeof direct->color);
        direct->spread = beam.spread;
        direct->style = light[2];
        direct->light = (int)sum.light[i];
        out->count++;
    }
}

static inline float shgrid_brightness_(const shgrid_direct *direct) {
    return direct->color[0] + direct->color[1] + direct->color[2];
}

/* Keeps the `count` brightest lights and makes coefficients of the others, for shaders with an array of that size. Of
   the kept ones, those less than a quarter brighter than the brightest of the others go in part, so that nothing jumps
   where two lights change their places. */
static inline void shgrid_limit_lights(shgrid_lighting *lighting, int count) {
    float sorted[SHGRID_DIRECT_LIGHTS], gone; /* the brightest so far, at most count + 1 */
    int i, kept = 0, channel;
    count = count > 0 ? count : 0;
    if (lighting->count <= count)
        return;
    for (i = 0; i < lighting->count; i++) {
        const float brightness = shgrid_brightness_(lighting->direct + i);
        int at = i < count ? i : count;
        if (i > count && !(brightness > sorted[count]))
            continue;
        for (; at > 0 && sorted[at - 1] < brightness; at--)
            sorted[at] = sorted[at - 1];
        sorted[at] = brightness;
    }
    gone = sorted[count];
    for (i = 0; i < lighting->count; i++) {
        shgrid_direct direct = lighting->direct[i];
        const float brightness = shgrid_brightness_(&direct);
        float part = brightness > gone ? 5 * gone / brightness - 4 : 1, color[3];
        part = part > 0 ? part : 0;
        for (channel = 0; channel < 3; channel++) {
            color[channel] = part * direct.color[channel];
            direct.color[channel] -= color[channel];
        }
        if (part > 0)
            shgrid_add_direct_(direct.direction, direct.spread, color, &lighting->rest);
        if (part < 1)
            lighting->direct[kept++] = direct;
    }
    lighting->count = kept;
}

/* What a surface receives of a light of brightness 1 at that cosine to its normal. A light with an extent sets behind
   the horizon of the surface step by step: the cosine c where it is above the sine s of the angular radius,
   (c + s)^2 / (4 s) from -s to s, 0 below. Absolute values instead of branches, which processors predict badly here. */
static inline float shgrid_lobe_(float cosine, float spread) {
    const float s = spread + 1e-6f, rise = cosine + s, above = 0.5f * (rise + fabsf(rise)), more = above - 2 * s,
                over = 0.5f * (more + fabsf(more)), low = above - over;
    return low * low * (0.25f / s) + over;
}

/* Light on a matte surface with that unit normal; not below zero. */
static inline void shgrid_shade(const shgrid_lighting *lighting, const float normal[3], float rgb[3]) {
    const float x = normal[0], y = normal[1], z = normal[2];
    float sum[3];
    int i, channel;
    shgrid_sum_basis_(&lighting->rest, normal, sum);
    for (i = 0; i < lighting->count; i++) {
        const shgrid_direct *direct = lighting->direct + i;
        const float cosine = direct->direction[0] * x + direct->direction[1] * y + direct->direction[2] * z,
                    factor = shgrid_lobe_(cosine, direct->spread);
        sum[0] += factor * direct->color[0];
        sum[1] += factor * direct->color[1];
        sum[2] += factor * direct->color[2];
    }
    for (channel = 0; channel < 3; channel++)
        rgb[channel] = sum[channel] > 0 ? sum[channel] : 0; /* NaN gives 0 */
}

#define SHGRID_BATCH 16 /* normals that shgrid_shade_many takes together */

/* The same for 16 normals, by components, which compilers turn into vector instructions. */
static inline void shgrid_shade_batch_(const shgrid_lighting *lighting, const float x[SHGRID_BATCH],
                                       const float y[SHGRID_BATCH], const float z[SHGRID_BATCH],
                                       float rgb[3][SHGRID_BATCH]) {
    float basis[9][SHGRID_BATCH];
    int i, j, k, channel;
    for (j = 0; j < SHGRID_BATCH; j++) {
        basis[0][j] = 0.282094791773878f;
        basis[1][j] = 0.488602511902920f * y[j];
        basis[2][j] = 0.488602511902920f * z[j];
        basis[3][j] = 0.488602511902920f * x[j];
        basis[4][j] = 1.092548430592079f * x[j] * y[j];
        basis[5][j] = 1.092548430592079f * y[j] * z[j];
        basis[6][j] = 0.315391565252520f * (3 * z[j] * z[j] - 1);
        basis[7][j] = 1.092548430592079f * x[j] * z[j];
        basis[8][j] = 0.546274215296040f * (x[j] * x[j] - y[j] * y[j]);
    }
    for (channel = 0; channel < 3; channel++) {
        const float *const c = &lighting->rest.c[0][channel];
        for (j = 0; j < SHGRID_BATCH; j++) {
            float sum = 0;
            for (k = 0; k < 9; k++)
                sum += c[3 * k] * basis[k][j];
            rgb[channel][j] = sum;
        }
    }
    for (i = 0; i < lighting->count; i++) {
        const shgrid_direct *direct = lighting->direct + i;
        for (j = 0; j < SHGRID_BATCH; j++) {
            const float cosine =
                            direct->direction[0] * x[j] + direct->direction[1] * y[j] + direct->direction[2] * z[j],
                        factor = shgrid_lobe_(cosine, direct->spread);
            rgb[0][j] += factor * direct->color[0];
            rgb[1][j] += factor * direct->color[1];
            rgb[2][j] += factor * direct->color[2];
        }
    }
    for (channel = 0; channel < 3; channel++)
        for (j = 0; j < SHGRID_BATCH; j++)
            rgb[channel][j] = rgb[channel][j] > 0 ? rgb[channel][j] : 0;
}

/* The same for many unit normals, a third of the time each: they are `stride` floats apart, at least 3,
   and the colors `rgbStride`. */
static inline void shgrid_shade_many(const shgrid_lighting *lighting, const float *normals, size_t stride, size_t count,
                                     float *rgb, size_t rgbStride) {
    float x[SHGRID_BATCH], y[SHGRID_BATCH], z[SHGRID_BATCH], out[3][SHGRID_BATCH];
    size_t done, j;
    memset(x, 0, sizeof x);
    memset(y, 0, sizeof y);
    memset(z, 0, sizeof z);
    for (done = 0; done < count; done += SHGRID_BATCH) {
        const size_t here = count - done < SHGRID_BATCH ? count - done : SHGRID_BATCH;
        for (j = 0; j < here; j++) {
            const float *normal = normals + stride * (done + j);
            x[j] = normal[0];
            y[j] = normal[1];
            z[j] = normal[2];
        }
        shgrid_shade_batch_(lighting, x, y, z, out);
        for (j = 0; j < here; j++) {
            float *color = rgb + rgbStride * (done + j);
            color[0] = out[0][j];
            color[1] = out[1][j];
            color[2] = out[2][j];
        }
    }
}

/* Name of the entity of a light of the table, or of its shader; empty if it has none. */
static inline const char *shgrid_light_name(const shgrid_grid *grid, int light) {
    if (light < 0 || light >= grid->lightCount)
        return "";
    return grid->text + bspx_u32(grid->lights + (size_t)SHGRID_LIGHT_BYTES * (size_t)light + 112);
}

/* Light at a world position on a surface with that unit normal, all styles at full brightness. */
static inline void shgrid_light(const shgrid_grid *grid, const float position[3], const float normal[3], float rgb[3]) {
    shgrid_lighting lighting;
    shgrid_lights(grid, position, NULL, &lighting);
    shgrid_shade(&lighting, normal, rgb);
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
    gray =
        0.3086f * v[0] + 0.6094f * v[1] + 0.0820f * v[2]; /* Haeberli, Matrix Operations for Image Processing, 1993 */
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

/* ---- A uniform grid as textures: shgrid.glsl and .hlsl sample them. ---- */

/* IEEE half precision, rounded to nearest; above 65504 it is 65504, NaN is 0. */
static inline uint16_t shgrid_half_(float value) {
    const float size = value < 0 ? -value : value;
    const unsigned sign = value < 0 ? 0x8000u : 0;
    int exponent;
    unsigned mantissa;
    if (!(size >= 2.98023224e-8f)) /* 2^-25, half of the smallest number */
        return (uint16_t)sign;
    if (size >= 65504)
        return (uint16_t)(sign | 0x7bffu);
    frexpf(size, &exponent); /* size is in [2^(exponent - 1), 2^exponent) */
    exponent = exponent < -13 ? -13 : exponent;
    /* The mantissa has 11 bits. Its leading one adds 1 to the exponent field of the sum; if rounding gives 2^11, 2. */
    mantissa = (unsigned)lrintf(ldexpf(size, 11 - exponent));
    return (uint16_t)(sign | (((unsigned)(exponent + 13) << 10) + mantissa));
}

static inline void shgrid_put_half_(void *const textures[7], size_t texel, const shgrid_coeffs *value) {
    int n;
    for (n = 0; n < 28; n++)
        ((uint16_t *)textures[n / 4])[4 * texel + (size_t)(n % 4)] = n < 27 ? shgrid_half_(value->c[n / 3][n % 3]) : 0;
}

/* Fills 7 textures RGBA16F of grid->bounds texels, 8 * grid->count bytes each, aligned to 2: coefficient k of channel c
   is component (3 k + c) % 4 of texture (3 k + c) / 4; the last component is 0. Returns the number of texels. Writes
   nothing and returns 0 if the grid is sparse: shgrid_atlas_fill is for those, or shgrid_expand. */
static inline size_t shgrid_fill_half(const shgrid_grid *grid, void *const textures[7]) {
    size_t texel = 0;
    int32_t x, y, z;
    if (grid->points == NULL || grid->levels != 0)
        return 0;
    for (z = 0; z < grid->bounds[2]; z++)
        for (y = 0; y < grid->bounds[1]; y++)
            for (x = 0; x < grid->bounds[0]; x++) {
                shgrid_coeffs value;
                shgrid_point(grid, x, y, z, &value);
                shgrid_put_half_(textures, texel++, &value);
            }
    return texel;
}

#ifdef __cplusplus
}
#endif

/* The atlas of sparse grids. Define SHGRID_NO_ATLAS to use shgrid.h without that file. */
#ifndef SHGRID_NO_ATLAS
#include "shgrid_atlas.h"
#endif

#endif
