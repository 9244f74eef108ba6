/* GPL-2.0-or-later. The reader of ambient cubes as a C99 program sees it: cut and hostile files, blending, colors. */
#include "libs/ambientcubes/ambient_cubes.h"
#include "tests/engine_headers/check.h"

#include <stdio.h>
#include <stdlib.h>

enum { kSlotBytes = 8, kHeader = 8 + 18 * kSlotBytes, kLeafs = 4, kSamples = 3 };
enum { kLeafsBytes = kLeafs * AMBIENT_CUBES_BSP_LEAF_BYTES };
enum {
    kLumpBytes = AMBIENT_CUBES_HEADER_BYTES + kLeafs * AMBIENT_CUBES_LEAF_BYTES + kSamples * AMBIENT_CUBES_SAMPLE_BYTES
};
enum { kDirectory = kHeader + kLeafsBytes, kLump = kDirectory + 8 + 32, kFileBytes = kLump + kLumpBytes };

static int Near(double a, double b) {
    return fabs(a - b) <= 1e-5 * (1 + fabs(b));
}

static void Put16(unsigned char *at, uint32_t value) {
    at[0] = (unsigned char)value, at[1] = (unsigned char)(value >> 8);
}

static void PutLeafIndex(unsigned char *lump, int leaf, uint32_t count, uint32_t first) {
    Put16(lump + AMBIENT_CUBES_HEADER_BYTES + 4 * leaf, count);
    Put16(lump + AMBIENT_CUBES_HEADER_BYTES + 4 * leaf + 2, first);
}

static unsigned char *SampleAt(unsigned char *lump, int sample) {
    return lump + AMBIENT_CUBES_HEADER_BYTES + kLeafs * AMBIENT_CUBES_LEAF_BYTES + sample * AMBIENT_CUBES_SAMPLE_BYTES;
}

static void PutColor(unsigned char *sample, int side, int r, int g, int b, int exponent) {
    unsigned char *at = sample + 4 * side;
    at[0] = (unsigned char)r, at[1] = (unsigned char)g, at[2] = (unsigned char)b, at[3] = (unsigned char)exponent;
}

/* Leaf 0 has no samples and uses leaf 2; leaf 1 has sample 0; leaf 2 has samples 1 and 2; leaf 3 uses leaf 1. Leaf 2
   is from (-100, 0, 50) to (155, 255, 305), so that a unit is a step of positions. */
static void PutFile(unsigned char *file) {
    static const int32_t mins[3] = {-100, 0, 50}, maxs[3] = {155, 255, 305};
    unsigned char *lump = file + kLump;
    int leaf, i, side;
    memset(file, 0, kFileBytes);
    memcpy(file, "IBSP", 4);
    Put32(file + 4, 46);
    Put32(file + 8 + kSlotBytes * 4, kHeader);
    Put32(file + 12 + kSlotBytes * 4, kLeafsBytes);
    for (leaf = 0; leaf < kLeafs; leaf++)
        for (i = 0; i < 3; i++) {
            Put32(file + kHeader + leaf * AMBIENT_CUBES_BSP_LEAF_BYTES + 8 + 4 * i, (uint32_t)mins[i]);
            Put32(file + kHeader + leaf * AMBIENT_CUBES_BSP_LEAF_BYTES + 20 + 4 * i, (uint32_t)maxs[i]);
        }
    memcpy(file + kDirectory, "BSPX", 4);
    Put32(file + kDirectory + 4, 1);
    memcpy(file + kDirectory + 8, "AMBIENT_CUBES", 13);
    Put32(file + kDirectory + 8 + 24, kLump);
    Put32(file + kDirectory + 8 + 28, kLumpBytes);
    memcpy(lump, "ACUB", 4);
    Put32(lump + 4, 1);
    Put32(lump + 8, kLeafs);
    Put32(lump + 12, kSamples);
    PutLeafIndex(lump, 0, 0, 2);
    PutLeafIndex(lump, 1, 1, 0);
    PutLeafIndex(lump, 2, 2, 1);
    PutLeafIndex(lump, 3, 0, 1);
    /* Colors of Source's format on the scale where 255 is full light. */
    PutColor(SampleAt(lump, 0), 0, 150, 75, 0, 1);   /* 300 150 0 */
    PutColor(SampleAt(lump, 0), 1, 128, 64, 25, -8); /* 0.5 0.25 0.098 */
    PutColor(SampleAt(lump, 0), 2, 0, 0, 0, 0);
    PutColor(SampleAt(lump, 0), 5, 255, 0, 0, 127);
    for (side = 0; side < 6; side++) {
        PutColor(SampleAt(lump, 1), side, 255, 0, 0, 0);
        PutColor(SampleAt(lump, 2), side, 0, 255, 0, 0);
    }
    SampleAt(lump, 1)[24] = 100, SampleAt(lump, 1)[25] = 10, SampleAt(lump, 1)[26] = 20;
    SampleAt(lump, 2)[24] = 104, SampleAt(lump, 2)[25] = 10, SampleAt(lump, 2)[26] = 20;
}

/* Loads a copy in memory of exactly that size, so that a checker of addresses sees every byte too far. */
static ambient_cubes_result LoadExact(const unsigned char *file, size_t size) {
    unsigned char *copy = (unsigned char *)malloc(size > 0 ? size : 1);
    const float position[3] = {1e30f, 0, 0}, up[3] = {0, 0, 1};
    ambient_cubes cubes;
    ambient_cubes_result result;
    float rgb[3];
    uint32_t leaf;
    if (!copy)
        exit(1);
    memcpy(copy, file, size);
    result = ambient_cubes_load(copy, size, &cubes);
    if (result == AMBIENT_CUBES_OK)
        for (leaf = 0; leaf < cubes.leafCount + 1; leaf++)
            ambient_cubes_light(&cubes, leaf, position, up, rgb);
    free(copy);
    return result;
}

static void TestColors(const unsigned char *file) {
    ambient_cubes cubes;
    ambient_cube cube;
    float position[3];
    const float normal[3] = {0.6f, 0, -0.8f};
    float rgb[3];
    CHECK(ambient_cubes_load(file, kFileBytes, &cubes) == AMBIENT_CUBES_OK);
    ambient_cubes_sample(&cubes, 0, 1, position, &cube);
    CHECK(Near(cube.side[0][0], 300 / 255.0) && Near(cube.side[0][1], 150 / 255.0) && cube.side[0][2] == 0);
    CHECK(Near(cube.side[1][0], 0.5 / 255) && Near(cube.side[1][1], 0.25 / 255));
    CHECK(Near(cube.side[1][2], 25.0 / 256 / 255));
    CHECK(cube.side[2][0] == 0 && cube.side[2][1] == 0 && cube.side[2][2] == 0);
    CHECK(Near(cube.side[5][0] / 1.7014118346046923e38, 1));
    cube.side[0][0] = 1, cube.side[5][0] = 2, cube.side[4][0] = 100, cube.side[1][0] = 100;
    ambient_cube_evaluate(&cube, normal, rgb);
    CHECK(Near(rgb[0], 0.36 + 0.64 * 2));
}

static void TestBlend(const unsigned char *file) {
    ambient_cubes cubes;
    const float up[3] = {0, 0, 1};
    float at[3] = {0, 10, 70}, rgb[3];
    uint32_t first, owner;
    CHECK(ambient_cubes_load(file, kFileBytes, &cubes) == AMBIENT_CUBES_OK);
    /* At sample 1, 4 units from sample 2: weights 1 and 1 / 17. */
    ambient_cubes_light(&cubes, 2, at, up, rgb);
    CHECK(Near(rgb[0], 17 / 18.0) && Near(rgb[1], 1 / 18.0));
    at[0] = 2; /* half way */
    ambient_cubes_light(&cubes, 2, at, up, rgb);
    CHECK(Near(rgb[0], 0.5) && Near(rgb[1], 0.5));
    ambient_cubes_light(&cubes, 0, at, up, rgb); /* refers to leaf 2 */
    CHECK(Near(rgb[0], 0.5) && Near(rgb[1], 0.5));
    at[0] = 1e30f; /* so far that no weight is left */
    ambient_cubes_light(&cubes, 2, at, up, rgb);
    CHECK(Near(rgb[0], 0.5) && Near(rgb[1], 0.5));
    at[0] = (float)NAN;
    ambient_cubes_light(&cubes, 2, at, up, rgb);
    CHECK(Near(rgb[0], 0.5) && Near(rgb[1], 0.5));
    CHECK(ambient_cubes_of_leaf(&cubes, 3, &first, &owner) == 1 && first == 0 && owner == 1);
    CHECK(ambient_cubes_of_leaf(&cubes, kLeafs, &first, &owner) == 0);
    ambient_cubes_light(&cubes, kLeafs, at, up, rgb);
    CHECK(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
}

static void TestOtherFormats(unsigned char *file) {
    static const char *const idents[2] = {"RBSP", "FBSP"};
    int i;
    for (i = 0; i < 2; i++) {
        PutFile(file);
        memcpy(file, idents[i], 4);
        CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_NOT_BSP);
        Put32(file + 4, 1);
        CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_OK);
        TestBlend(file);
        CHECK(LoadExact(file, kHeader - 1) == AMBIENT_CUBES_TRUNCATED);
    }
    PutFile(file);
}

static void TestDamage(unsigned char *file) {
    static const uint32_t bad[] = {kLeafs, 1, 3, 0x7fff, 0xffff};
    size_t cut, i, bit;
    for (cut = 0; cut < kFileBytes; cut++)
        CHECK(LoadExact(file, cut) != AMBIENT_CUBES_OK);
    for (i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        PutFile(file);
        PutLeafIndex(file + kLump, 2, 2, bad[i] == 1 ? 2 : bad[i]); /* past the samples */
        CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_BAD_INDEX);
        PutFile(file);
        PutLeafIndex(file + kLump, 0, 0, bad[i] == 1 ? 0 : bad[i]); /* no leaf, or one without samples */
        CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_BAD_INDEX);
    }
    PutFile(file);
    Put32(file + kLump + 4, 2);
    CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_BAD_VERSION);
    PutFile(file);
    SampleAt(file + kLump, 1)[27] = 1;
    CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_BAD_SAMPLE);
    PutFile(file);
    Put32(file + kLump - 4, kLumpBytes + 4); /* longer than its samples */
    memset(file + kFileBytes, 0, 4);
    CHECK(LoadExact(file, kFileBytes + 4) == AMBIENT_CUBES_BAD_LENGTH);
    PutFile(file);
    Put32(file + 12 + kSlotBytes * 4, kLeafsBytes - AMBIENT_CUBES_BSP_LEAF_BYTES);
    Put32(file + kLump - 4, kLumpBytes); /* the directory now stands elsewhere than the lumps end */
    CHECK(LoadExact(file, kFileBytes) != AMBIENT_CUBES_OK);
    PutFile(file);
    memset(file + kDirectory + 8, 'X', 13);
    CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_ABSENT);
    /* Every bit of the file flipped in turn: any result, but no byte outside. */
    for (bit = 0; bit < 8 * (size_t)kFileBytes; bit++) {
        PutFile(file);
        file[bit / 8] = (unsigned char)(file[bit / 8] ^ 1u << bit % 8);
        CHECK(ambient_cubes_message(LoadExact(file, kFileBytes)) != NULL);
    }
    PutFile(file);
}

int main(void) {
    unsigned char *file = (unsigned char *)malloc(kFileBytes + 4);
    if (!file)
        return 1;
    PutFile(file);
    CHECK(LoadExact(file, kFileBytes) == AMBIENT_CUBES_OK);
    TestColors(file);
    TestBlend(file);
    TestOtherFormats(file);
    TestDamage(file);
    memmove(file + 1, file, kFileBytes); /* any alignment */
    CHECK(LoadExact(file + 1, kFileBytes) == AMBIENT_CUBES_OK);
    TestBlend(file + 1);
    free(file);
    return CheckResult();
}
