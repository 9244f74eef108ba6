/* SPDX-License-Identifier: MIT. Sparse SH light grids as textures, for engines. C99 and C++.

   shgrid_atlas_measure gives the sizes of the textures, shgrid_atlas_fill their texels, with all light as coefficients.
   Of a grid that names lights, shgrid_atlas_fill_lights keeps the names: shaders work out each light where a pixel is.
   All memory is the caller's. See shgrid.h, LICENSE and README.md beside this file. */
#ifndef SHGRID_ATLAS_H
#define SHGRID_ATLAS_H

#include "shgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Bricks: shgrid_atlas.glsl and .hlsl sample them. ----

   A brick is a cube of 4 x 4 x 4 equal cells as 5 x 5 x 5 texels, its corners, so that filtering inside it needs no
   neighbor. Roots and those nodes that have a grandchild which is a cell have bricks, of cells of a quarter of their
   edge; each texel of the indirection texture, a cube as large as the smallest brick, names the finest brick there.
   Brick b of the atlas is at (b % bricks[0], b / bricks[0] % bricks[1], b / (bricks[0] * bricks[1])), times 5 texels.

   Of a grid that names lights each brick has a list of up to 16 of them. Where more are named at its texels, the nodes
   below it have bricks too, of half a cell; if there are still more, the list has those that give most, lights with a
   style first. Each texel has the visible shares of the lights in the list; its coefficients hold the rest of the light
   and the lights that are not in the list, these at full brightness. A table holds the numbers of all lights.
   Shares and coefficients are multiplied by the weight of the corners that have a value, which is the last component:
   divided by it after filtering, they are the blend of shgrid_lights, which leaves corners without a value out. */

#define SHGRID_BRICK_TEXELS 5   /* on an edge of a brick */
#define SHGRID_BRICK_VOLUME 125 /* texels of a brick */
#define SHGRID_BRICK_AXIS 255   /* maximum of bricks along an axis of the atlas */
#define SHGRID_BRICK_NAMES 16   /* maximum of lights in the list of a brick */
#define SHGRID_NO_NAME 65535    /* in a list, behind its last light */

/* Limits of graphics cards and of 32-bit programs. No atlas is made beyond them. */
#define SHGRID_ATLAS_BYTES 0x7fffffff         /* maximum of the 7 textures of SHGRID_ATLAS_HALF together */
#define SHGRID_INDIRECTION_AXIS 2048          /* maximum of entries along an axis */
#define SHGRID_INDIRECTION_ENTRIES (1L << 26) /* maximum of entries */
#define SHGRID_ENTRIES_PER_BRICK 4096         /* maximum, beyond the first 2^18 entries */
#define SHGRID_TABLE_ROWS 2048                /* maximum of rows of the table of lights */

/* Texels of the table of lights, numbered along its rows: 16 with the brightness of the 64 light styles, then those of
   lights, polygons and vertices. shgrid_put_light_ and shgrid_put_polygon_ have the layout. */
#define SHGRID_TABLE_WIDTH 1024
#define SHGRID_STYLE_TEXELS 16
#define SHGRID_LIGHT_TEXELS 8
#define SHGRID_POLYGON_TEXELS 3

#define SHGRID_FILLED_WEIGHT 0.0078125f /* of a texel without a value of its own that takes those of its neighbors */
#define SHGRID_CANDIDATES 256 /* lights of a brick among which its list is chosen; further ones are coefficients */

typedef enum {
    SHGRID_ATLAS_HALF, /* 7 textures RGBA16F, components as those of shgrid_fill_half */
    SHGRID_ATLAS_SNORM /* texture 0 RGB9_E5: coefficient 0; 6 textures RGBA8_SNORM: the others over coefficient 0 and
                          over `limits` of their band, in the same order. Not of shgrid_atlas_fill_lights, whose rest
                          may be negative */
} shgrid_atlas_format;

typedef struct {
    int32_t count;      /* of bricks; 0: the grid is not sparse, or too large for an atlas */
    int32_t bricks[3];  /* bricks along each axis of the atlas */
    int32_t entries[3]; /* texels of the indirection texture, 4 bytes each: RGBA8UI */
    int32_t shift;      /* log2 of the edge of an entry, in smallest cells */
    float limits[2];    /* SHGRID_ATLAS_SNORM: of bands 1 and 2 */
    int32_t tableRows;  /* of the table of lights; 0: the grid names none, or they do not fit into a table */
} shgrid_atlas;

/* State while bricks are counted or filled. */
typedef struct {
    const shgrid_grid *grid;
    shgrid_atlas *atlas;
    shgrid_path_ path;
    unsigned char *indirection; /* NULL: bricks are counted */
    void *const *textures;
    shgrid_atlas_format format;
    uint16_t *names; /* NULL: all light becomes coefficients */
    unsigned char *shares;
    int depth;      /* the deepest level with a brick */
    unsigned scale; /* the largest scale of nodes */
} shgrid_walk_;

/* Texels of each texture of the atlas; bytes of one, and of the indirection texture. */
static inline size_t shgrid_atlas_texels(const shgrid_atlas *atlas) {
    return (size_t)SHGRID_BRICK_VOLUME * (size_t)atlas->bricks[0] * (size_t)atlas->bricks[1] * (size_t)atlas->bricks[2];
}
static inline size_t shgrid_atlas_bytes(const shgrid_atlas *atlas, shgrid_atlas_format format) {
    return shgrid_atlas_texels(atlas) * (format == SHGRID_ATLAS_HALF ? 8 : 4);
}
static inline size_t shgrid_indirection_bytes(const shgrid_atlas *atlas) {
    return (size_t)4 * (size_t)atlas->entries[0] * (size_t)atlas->entries[1] * (size_t)atlas->entries[2];
}

/* Of a grid that names lights: bytes of the texture of names, RGBA16UI of bricks[0] x bricks[1] x 4 bricks[2] texels;
   of shares, RGBA8 of four times the depth of the atlas; of the table, RGBA32F of SHGRID_TABLE_WIDTH x tableRows. */
static inline size_t shgrid_names_bytes(const shgrid_atlas *atlas) {
    return (size_t)2 * SHGRID_BRICK_NAMES * (size_t)atlas->bricks[0] * (size_t)atlas->bricks[1] *
           (size_t)atlas->bricks[2];
}
static inline size_t shgrid_shares_bytes(const shgrid_atlas *atlas) {
    return SHGRID_BRICK_NAMES * shgrid_atlas_texels(atlas);
}
static inline size_t shgrid_table_bytes(const shgrid_atlas *atlas) {
    return (size_t)16 * SHGRID_TABLE_WIDTH * (size_t)atlas->tableRows;
}

/* GL's RGB9_E5, rounded to nearest; below zero and NaN are 0. */
static inline uint32_t shgrid_rgb9e5_(const float rgb[3]) {
    uint32_t code = 0;
    float c[3], most = 0;
    int exponent, i;
    for (i = 0; i < 3; i++) {
        c[i] = rgb[i] > 0 ? (rgb[i] < 65408 ? rgb[i] : 65408) : 0;
        most = c[i] > most ? c[i] : most;
    }
    frexpf(most, &exponent);
    exponent = exponent < -15 ? -15 : exponent;
    if (lrintf(ldexpf(most, 9 - exponent)) > 511)
        exponent++;
    for (i = 0; i < 3; i++)
        code |= (uint32_t)lrintf(ldexpf(c[i], 9 - exponent)) << 9 * i;
    return code | (uint32_t)(exponent + 15) << 27;
}

static inline void shgrid_put_texel_(const shgrid_walk_ *walk, size_t texel, const shgrid_coeffs *value) {
    int n;
    if (walk->format == SHGRID_ATLAS_HALF) {
        shgrid_put_half_(walk->textures, texel, value);
        return;
    }
    ((uint32_t *)walk->textures[0])[texel] = shgrid_rgb9e5_(value->c[0]);
    for (n = 3; n < 27; n++) {
        const float unit = value->c[0][n % 3] * walk->atlas->limits[n < 12 ? 0 : 1];
        float share = unit > 0 ? value->c[n / 3][n % 3] / unit : 0;
        share = share < -1 ? -1 : share > 1 ? 1 : share;
        ((int8_t *)walk->textures[1 + (n - 3) / 4])[4 * texel + (size_t)((n - 3) % 4)] = (int8_t)lrintf(127 * share);
    }
}

/* Adds coefficients and shares. */
static inline void shgrid_add_sum_(const shgrid_sum_ *from, shgrid_sum_ *to) {
    int n;
    for (n = 0; n < 27; n++)
        to->coeffs.c[n / 3][n % 3] += from->coeffs.c[n / 3][n % 3];
    for (n = 0; n < from->names; n++) {
        const int at = shgrid_name_(to, from->light[n]);
        if (at >= 0)
            to->share[at] += from->share[n];
    }
}

/* The value of a texel at a position in smallest cells. If it has none: the mean of the nearest with a value among its
   26 neighbors in the lattice of the brick's cells; black without such a neighbor. `ring` is the squared distance.
   Returns whether it has one itself. */
static inline int shgrid_texel_(shgrid_walk_ *walk, const double at[3], double step, shgrid_sum_ *out) {
    int ring, i, n, axis, found = 0;
    if (shgrid_blend_sparse_(walk->grid, at, 0, &walk->path, out))
        return 1;
    for (ring = 1; ring <= 3 && !found; ring++)
        for (i = 0; i < 27; i++) {
            const int offset[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
            shgrid_sum_ value;
            double neighbor[3];
            int inside = offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2] == ring;
            for (axis = 0; axis < 3; axis++) {
                neighbor[axis] = at[axis] + step * offset[axis];
                inside = inside && neighbor[axis] >= 0 && neighbor[axis] <= walk->grid->bounds[axis];
            }
            if (!inside || !shgrid_blend_sparse_(walk->grid, neighbor, 0, &walk->path, &value))
                continue;
            found++;
            shgrid_add_sum_(&value, out);
        }
    for (n = 0; found && n < 27; n++)
        out->coeffs.c[n / 3][n % 3] /= (float)found;
    for (n = 0; found && n < out->names; n++)
        out->share[n] /= (float)found;
    out->total = found ? SHGRID_FILLED_WEIGHT : 0;
    return 0;
}

static inline void shgrid_world_(const shgrid_grid *grid, const double at[3], float position[3]) {
    int axis;
    for (axis = 0; axis < 3; axis++)
        position[axis] = (float)(grid->mins[axis] + at[axis] * grid->cell[axis]);
}

/* Place of texel number i in a brick, x fastest, and its position in smallest cells: the brick is at `low`, its cells
   have edges of `step`. */
static inline void shgrid_brick_texel_(int i, const int32_t low[3], double step, int32_t texel[3], double at[3]) {
    int axis;
    for (axis = 0; axis < 3; axis++, i /= SHGRID_BRICK_TEXELS) {
        texel[axis] = i % SHGRID_BRICK_TEXELS;
        at[axis] = low[axis] + step * texel[axis];
    }
}

/* Lights that are named at the texels of a brick, and what they give there: of all texels, on surfaces that face them.
 */
typedef struct {
    int count;
    uint32_t light[SHGRID_CANDIDATES];
    float given[SHGRID_CANDIDATES];
} shgrid_candidates_;

/* What a light gives at a position on a surface that faces it, summed over colors. */
static inline float shgrid_given_(const shgrid_grid *grid, uint32_t number, const float position[3]) {
    const unsigned char *light = grid->lights + (size_t)SHGRID_LIGHT_BYTES * number;
    shgrid_beam_ beam;
    shgrid_beam_at_(grid, number, position, &beam);
    /* One direction of strength 1 has a mean of 1/4 over all normals, coefficient 0 one of 0.28. */
    return ((beam.strength > 0 ? beam.strength : 0) + 1.128379f * fabsf(beam.sh[0])) *
           (fabsf(shgrid_f32_(light + 4)) + fabsf(shgrid_f32_(light + 8)) + fabsf(shgrid_f32_(light + 12)));
}

/* Collects the lights that are named at a position. What they give counts only if lists are made. */
static inline void shgrid_add_candidates_(const shgrid_walk_ *walk, const double at[3], const shgrid_sum_ *value,
                                          shgrid_candidates_ *all) {
    float position[3];
    int i, n;
    shgrid_world_(walk->grid, at, position);
    for (i = 0; i < value->names; i++) {
        for (n = 0; n < all->count && all->light[n] != value->light[i]; n++) {
        }
        if (n == SHGRID_CANDIDATES)
            continue;
        if (n == all->count) {
            all->light[n] = value->light[i];
            all->given[n] = 0;
            all->count++;
        }
        if (walk->names != NULL)
            all->given[n] += value->share[i] * shgrid_given_(walk->grid, value->light[i], position);
    }
}

/* Whether a brick at `low` with cells of edge `step` has any value, and the lights that are named there. */
static inline int shgrid_survey_(shgrid_walk_ *walk, const int32_t low[3], double step, shgrid_candidates_ *all) {
    const int isNamed = walk->grid->lights != NULL;
    int isLit = 0, i;
    all->count = 0;
    for (i = 0; i < SHGRID_BRICK_VOLUME && (isNamed || !isLit); i++) {
        int32_t texel[3];
        double at[3];
        shgrid_sum_ value;
        shgrid_brick_texel_(i, low, step, texel, at);
        if (isNamed ? shgrid_texel_(walk, at, step, &value)
                    : shgrid_blend_sparse_(walk->grid, at, 0, &walk->path, &value))
            isLit = 1;
        if (isNamed)
            shgrid_add_candidates_(walk, at, &value, all);
    }
    return isLit;
}

/* The list of a brick: of all candidates those with a style first, then those that give most. Those that give nothing
   at the texels may do between them. */
static inline void shgrid_choose_names_(const shgrid_grid *grid, shgrid_candidates_ *all,
                                        uint32_t names[SHGRID_BRICK_NAMES]) {
    int n, i;
    for (n = 0; n < SHGRID_BRICK_NAMES; n++) {
        int best = -1, bestStyled = 0;
        for (i = 0; i < all->count; i++) {
            const int styled = grid->lights[(size_t)SHGRID_LIGHT_BYTES * all->light[i] + 2] != 0;
            if (best < 0 || styled > bestStyled || (styled == bestStyled && all->given[i] > all->given[best])) {
                best = i;
                bestStyled = styled;
            }
        }
        names[n] = SHGRID_NO_NAME;
        if (best < 0)
            continue;
        names[n] = all->light[best];
        all->count--;
        all->light[best] = all->light[all->count];
        all->given[best] = all->given[all->count];
    }
}

/* Removes a light from those that are named, and returns its share. */
static inline float shgrid_take_share_(shgrid_sum_ *sum, uint32_t light) {
    int i;
    for (i = 0; i < sum->names; i++)
        if (sum->light[i] == light) {
            const float share = sum->share[i];
            sum->names--;
            sum->light[i] = sum->light[sum->names];
            sum->share[i] = sum->share[sum->names];
            return share;
        }
    return 0;
}

/* Fills the list of a brick. */
static inline void shgrid_fill_names_(const shgrid_walk_ *walk, int32_t brick, shgrid_candidates_ *all,
                                      uint32_t names[SHGRID_BRICK_NAMES]) {
    const size_t bricks = shgrid_atlas_texels(walk->atlas) / SHGRID_BRICK_VOLUME;
    int i;
    shgrid_choose_names_(walk->grid, all, names);
    for (i = 0; i < SHGRID_BRICK_NAMES; i++)
        walk->names[4 * ((size_t)brick + bricks * (size_t)(i / 4)) + (size_t)(i % 4)] = (uint16_t)names[i];
}

/* Moves the shares of the lights in a list to a texel, and multiplies all by the weight of the texel. */
static inline void shgrid_put_shares_(const shgrid_walk_ *walk, size_t texel, const uint32_t names[SHGRID_BRICK_NAMES],
                                      shgrid_sum_ *value) {
    const size_t texels = shgrid_atlas_texels(walk->atlas);
    const float weight = value->total < 1 ? value->total : 1;
    int n;
    for (n = 0; n < SHGRID_BRICK_NAMES; n++) {
        const float share = shgrid_take_share_(value, names[n]);
        walk->shares[4 * (texel + texels * (size_t)(n / 4)) + (size_t)(n % 4)] =
            (unsigned char)lrintf(255 * weight * (share < 1 ? share : 1));
    }
    for (n = 0; n < value->names; n++)
        value->share[n] *= weight;
    for (n = 0; n < 27; n++)
        value->coeffs.c[n / 3][n % 3] *= weight;
}

/* Fills the texels of a brick of the atlas, and its list, for which `all` is used up. */
static inline void shgrid_fill_brick_(shgrid_walk_ *walk, int32_t brick, const int32_t low[3], double step,
                                      shgrid_candidates_ *all) {
    const shgrid_atlas *atlas = walk->atlas;
    const int32_t place[3] = {brick % atlas->bricks[0], brick / atlas->bricks[0] % atlas->bricks[1],
                              brick / atlas->bricks[0] / atlas->bricks[1]};
    const size_t side = SHGRID_BRICK_TEXELS, width = side * (size_t)atlas->bricks[0],
                 height = side * (size_t)atlas->bricks[1];
    uint32_t names[SHGRID_BRICK_NAMES];
    int i;
    if (walk->names != NULL)
        shgrid_fill_names_(walk, brick, all, names);
    for (i = 0; i < SHGRID_BRICK_VOLUME; i++) {
        int32_t texel[3];
        double at[3];
        float position[3];
        size_t to;
        shgrid_sum_ value;
        shgrid_brick_texel_(i, low, step, texel, at);
        to = side * (size_t)place[0] + (size_t)texel[0] +
             width *
                 (side * (size_t)place[1] + (size_t)texel[1] + height * (side * (size_t)place[2] + (size_t)texel[2]));
        shgrid_texel_(walk, at, step, &value);
        if (walk->names != NULL)
            shgrid_put_shares_(walk, to, names, &value);
        shgrid_world_(walk->grid, at, position);
        shgrid_add_named_lights_(walk->grid, position, &value);
        shgrid_put_texel_(walk, to, &value.coeffs);
        if (walk->names != NULL)
            ((uint16_t *)walk->textures[6])[4 * to + 3] = shgrid_half_(value.total < 1 ? value.total : 1);
    }
}

/* Sets the entries of a cube: the place of its brick, and log2 of the edge of the brick; all 0: no brick. */
static inline void shgrid_fill_entries_(const shgrid_walk_ *walk, int32_t brick, const int32_t low[3], int edge) {
    const shgrid_atlas *atlas = walk->atlas;
    const int32_t count = (int32_t)1 << (edge - atlas->shift),
                  from[3] = {low[0] >> atlas->shift, low[1] >> atlas->shift, low[2] >> atlas->shift};
    int32_t x, y, z;
    unsigned char entry[4] = {0, 0, 0, 0};
    if (brick >= 0) {
        entry[0] = (unsigned char)(brick % atlas->bricks[0]);
        entry[1] = (unsigned char)(brick / atlas->bricks[0] % atlas->bricks[1]);
        entry[2] = (unsigned char)(brick / atlas->bricks[0] / atlas->bricks[1]);
        entry[3] = (unsigned char)edge;
    }
    for (z = from[2]; z < from[2] + count; z++)
        for (y = from[1]; y < from[1] + count; y++)
            for (x = from[0]; x < from[0] + count; x++)
                memcpy(walk->indirection + 4 * ((size_t)x + (size_t)atlas->entries[0] *
                                                                ((size_t)y + (size_t)atlas->entries[1] * (size_t)z)),
                       entry, 4);
}

/* Counts or fills the brick of a node, then those of the nodes below it, whose entries replace its own. isCrowded: the
   list of the brick around the node is too short. */
static inline void shgrid_visit_(shgrid_walk_ *walk, uint32_t index, int level, int isCrowded, const int32_t low[3]) {
    const unsigned char *node = shgrid_node_(walk->grid, index);
    const int edge = walk->grid->levels - level;
    uint32_t child = bspx_u32(node), octant;
    int hasBrick = level == 0 || isCrowded;
    if (walk->grid->lights != NULL)
        walk->scale = 128; /* scale 1: lights are among the coefficients */
    else if (node[9] && node[11] > walk->scale)
        walk->scale = node[11];
    for (octant = 0; octant < shgrid_bits_(node[8]); octant++)
        hasBrick = hasBrick || shgrid_node_(walk->grid, child + octant)[8] != 255;
    if (hasBrick) {
        const double step = (double)((int32_t)1 << edge) / 4;
        shgrid_candidates_ all;
        const int isLit = shgrid_survey_(walk, low, step, &all);
        isCrowded = all.count > SHGRID_BRICK_NAMES;
        walk->depth = level > walk->depth ? level : walk->depth;
        if (walk->indirection) {
            if (isLit)
                shgrid_fill_brick_(walk, walk->atlas->count, low, step, &all);
            shgrid_fill_entries_(walk, isLit ? walk->atlas->count : -1, low, edge);
        }
        if (walk->atlas->count < INT32_MAX)
            walk->atlas->count += isLit;
    }
    for (octant = 0; octant < 8; octant++)
        if (node[8] >> octant & 1) {
            const int32_t at[3] = {low[0] + ((int32_t)(octant & 1) << (edge - 1)),
                                   low[1] + ((int32_t)(octant >> 1 & 1) << (edge - 1)),
                                   low[2] + ((int32_t)(octant >> 2) << (edge - 1))};
            shgrid_visit_(walk, child++, level + 1, isCrowded, at);
        }
}

static inline void shgrid_visit_roots_(shgrid_walk_ *walk) {
    const int levels = walk->grid->levels;
    int32_t x, y, z;
    uint32_t root = 0;
    walk->path.level = -1;
    for (z = 0; z < walk->grid->bounds[2]; z += (int32_t)1 << levels)
        for (y = 0; y < walk->grid->bounds[1]; y += (int32_t)1 << levels)
            for (x = 0; x < walk->grid->bounds[0]; x += (int32_t)1 << levels) {
                const int32_t low[3] = {x, y, z};
                shgrid_visit_(walk, root++, 0, 0, low);
            }
}

/* Whether the sizes of an atlas are within the limits. In double, where no product overflows. */
static inline int shgrid_atlas_fits_(const shgrid_atlas *atlas) {
    const double texels = (double)SHGRID_BRICK_VOLUME * atlas->bricks[0] * atlas->bricks[1] * atlas->bricks[2],
                 entries = (double)atlas->entries[0] * atlas->entries[1] * atlas->entries[2];
    int axis;
    for (axis = 0; axis < 3; axis++)
        if (atlas->bricks[axis] > SHGRID_BRICK_AXIS || atlas->entries[axis] > SHGRID_INDIRECTION_AXIS)
            return 0;
    return 7 * 8 * texels <= SHGRID_ATLAS_BYTES && entries <= SHGRID_INDIRECTION_ENTRIES &&
           entries <= (1L << 18) + (double)SHGRID_ENTRIES_PER_BRICK * atlas->count;
}

/* ---- The table of lights ---- */

/* Texels of light number n of the grid, from SHGRID_STYLE_TEXELS + SHGRID_LIGHT_TEXELS * n on: fields of the lump's
   table (docs/reference/bsp_format.md), in `light`, 4 a texel. The last texel also has the number of the texel of its
   first polygon, and the number of its polygons. */
static inline void shgrid_put_light_(const unsigned char *light, size_t polygonTexel, float *to) {
    static const unsigned char fields[26] = {4,  8,  12, 40, 16, 20, 24, 96, 28, 32, 36, 92,  44,
                                             48, 52, 56, 60, 64, 68, 72, 76, 80, 84, 88, 100, 0};
    int i;
    memset(to, 0, 16 * SHGRID_LIGHT_TEXELS);
    for (i = 0; i < 4; i++)
        to[i] = light[i]; /* type, curve, style, flags */
    for (i = 0; fields[i] != 0; i++)
        to[4 + i] = shgrid_f32_(light + fields[i]);
    to[29] = (float)(polygonTexel + SHGRID_POLYGON_TEXELS * bspx_u32(light + 104));
    to[30] = (float)bspx_u32(light + 108);
}

/* Texels of a polygon: normal and dist; center and radius; area, number of the texel of its first vertex, number of its
   vertices, 0. Vertices have a texel each: position, 0. */
static inline void shgrid_put_polygon_(const unsigned char *polygon, size_t vertexTexel, float *to) {
    int i;
    for (i = 0; i < 7; i++)
        to[i] = shgrid_f32_(polygon + 8 + 4 * i);
    to[7] = shgrid_f32_(polygon + 40);
    to[8] = shgrid_f32_(polygon + 36);
    to[9] = (float)(vertexTexel + bspx_u32(polygon));
    to[10] = (float)bspx_u32(polygon + 4);
    to[11] = 0;
}

/* Where polygons and vertices begin in the table, and where it ends, in texels. */
typedef struct {
    size_t polygons, vertices, end;
} shgrid_table_;

static inline void shgrid_measure_table_(const shgrid_grid *grid, shgrid_table_ *table) {
    size_t polygons = 0, vertices = 0, i;
    for (i = 0; i < (size_t)grid->lightCount; i++) {
        const unsigned char *light = grid->lights + SHGRID_LIGHT_BYTES * i;
        const size_t end = (size_t)bspx_u32(light + 104) + bspx_u32(light + 108);
        polygons = light[0] == SHGRID_POLYGONS && end > polygons ? end : polygons;
    }
    for (i = 0; i < polygons; i++) {
        const unsigned char *polygon = grid->polygons + SHGRID_POLYGON_BYTES * i;
        const size_t end = (size_t)bspx_u32(polygon) + bspx_u32(polygon + 4);
        vertices = end > vertices ? end : vertices;
    }
    table->polygons = SHGRID_STYLE_TEXELS + SHGRID_LIGHT_TEXELS * (size_t)grid->lightCount;
    table->vertices = table->polygons + SHGRID_POLYGON_TEXELS * polygons;
    table->end = table->vertices + vertices;
}

static inline void shgrid_fill_table_(const shgrid_grid *grid, const shgrid_atlas *atlas, float *to) {
    shgrid_table_ table;
    size_t i;
    int axis;
    shgrid_measure_table_(grid, &table);
    memset(to, 0, shgrid_table_bytes(atlas));
    for (i = 0; i < 4 * SHGRID_STYLE_TEXELS; i++)
        to[i] = 1;
    for (i = 0; i < (size_t)grid->lightCount; i++)
        shgrid_put_light_(grid->lights + SHGRID_LIGHT_BYTES * i, table.polygons,
                          to + 4 * (SHGRID_STYLE_TEXELS + SHGRID_LIGHT_TEXELS * i));
    for (i = 0; i < (table.vertices - table.polygons) / SHGRID_POLYGON_TEXELS; i++)
        shgrid_put_polygon_(grid->polygons + SHGRID_POLYGON_BYTES * i, table.vertices,
                            to + 4 * (table.polygons + SHGRID_POLYGON_TEXELS * i));
    for (i = 0; i < table.end - table.vertices; i++)
        for (axis = 0; axis < 3; axis++)
            to[4 * (table.vertices + i) + (size_t)axis] = shgrid_f32_(grid->vertices + 12 * i + 4 * axis);
}

/* ---- Calls ---- */

/* Sizes of the textures of a sparse grid. All sizes of the atlas are 0 if the grid is not sparse or too large. */
static inline void shgrid_atlas_measure(const shgrid_grid *grid, shgrid_atlas *atlas) {
    shgrid_walk_ walk;
    int32_t side = 1;
    double scale;
    int axis;
    memset(&walk, 0, sizeof walk);
    memset(atlas, 0, sizeof *atlas);
    walk.grid = grid;
    walk.atlas = atlas;
    if (grid->levels == 0)
        return;
    shgrid_visit_roots_(&walk);
    while (side < SHGRID_BRICK_AXIS && (double)side * side * side < atlas->count)
        side++;
    atlas->bricks[0] = atlas->bricks[1] = side;
    atlas->bricks[2] = (int32_t)(((int64_t)atlas->count + side * side - 1) / (side * side));
    if (atlas->count < side * side)
        atlas->bricks[1] = (atlas->count + side - 1) / side;
    atlas->shift = grid->levels - walk.depth;
    for (axis = 0; axis < 3; axis++)
        atlas->entries[axis] = grid->bounds[axis] >> atlas->shift;
    if (atlas->count == 0 || !shgrid_atlas_fits_(atlas)) {
        memset(atlas, 0, sizeof *atlas);
        return;
    }
    scale = (double)shgrid_scale_(walk.scale);
    scale = scale < 4 ? scale : 4;
    atlas->limits[0] = (float)(1.15470054 * scale);
    atlas->limits[1] = (float)(0.559016994 * scale);
    if (grid->lights != NULL) {
        shgrid_table_ table;
        shgrid_measure_table_(grid, &table);
        if (table.end <= (size_t)SHGRID_TABLE_WIDTH * SHGRID_TABLE_ROWS)
            atlas->tableRows = (int32_t)((table.end + SHGRID_TABLE_WIDTH - 1) / SHGRID_TABLE_WIDTH);
    }
}

static inline void shgrid_fill_walk_(shgrid_walk_ *walk, const shgrid_grid *grid, const shgrid_atlas *atlas,
                                     shgrid_atlas_format format, unsigned char *indirection, void *const textures[7]) {
    shgrid_atlas counted = *atlas;
    int i;
    walk->grid = grid;
    walk->atlas = &counted;
    walk->indirection = indirection;
    walk->textures = textures;
    walk->format = format;
    counted.count = 0;
    for (i = 0; i < 7; i++)
        memset(textures[i], 0, shgrid_atlas_bytes(atlas, format));
    shgrid_visit_roots_(walk);
}

/* Fills the textures: shgrid_indirection_bytes for `indirection`, 7 of shgrid_atlas_bytes, aligned to 4, for
   `textures`. `atlas` is what shgrid_atlas_measure gave. Lights that the grid names are among the coefficients. */
static inline void shgrid_atlas_fill(const shgrid_grid *grid, const shgrid_atlas *atlas, shgrid_atlas_format format,
                                     unsigned char *indirection, void *const textures[7]) {
    shgrid_walk_ walk;
    if (atlas->count == 0)
        return;
    memset(&walk, 0, sizeof walk);
    shgrid_fill_walk_(&walk, grid, atlas, format, indirection, textures);
}

/* The same in SHGRID_ATLAS_HALF for a grid that names lights, with shgrid_names_bytes for `names`, aligned to 2,
   shgrid_shares_bytes for `shares` and shgrid_table_bytes for `table`, aligned to 4. The first quarter of the depth of
   names and shares has the first four lights of all lists, and so on. The first 64 floats of the table are the
   brightness of the light styles, 1 each: set them again whenever a style changes. Does nothing if atlas->tableRows is
   0: then shgrid_atlas_fill is left. */
static inline void shgrid_atlas_fill_lights(const shgrid_grid *grid, const shgrid_atlas *atlas,
                                            unsigned char *indirection, void *const textures[7], uint16_t *names,
                                            unsigned char *shares, float *table) {
    shgrid_walk_ walk;
    if (atlas->count == 0 || atlas->tableRows == 0)
        return;
    memset(&walk, 0, sizeof walk);
    walk.names = names;
    walk.shares = shares;
    memset(names, 0xff, shgrid_names_bytes(atlas));
    memset(shares, 0, shgrid_shares_bytes(atlas));
    shgrid_fill_table_(grid, atlas, table);
    shgrid_fill_walk_(&walk, grid, atlas, SHGRID_ATLAS_HALF, indirection, textures);
}

#ifdef __cplusplus
}
#endif

#endif
