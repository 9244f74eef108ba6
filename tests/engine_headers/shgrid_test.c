/* GPL-2.0-or-later. The engine-side reader as a C99 program sees it: both containers, cut and hostile files, sampling.
 */
#include "libs/shgrid/shgrid_atlas.h"
#include "tests/engine_headers/check.h"

#include <stdio.h>
#include <stdlib.h>

enum { kSlotBytes = 8, kNx = 4, kNy = 3, kNz = 2, kPoints = kNx * kNy * kNz };
enum { kLumpBytes = SHGRID_HEADER_BYTES + SHGRID_POINT_BYTES * kPoints };
enum { kSparseBytes = SHGRID_SPARSE_HEADER_BYTES + SHGRID_SPARSE_NODE_BYTES + 8 * SHGRID_SPARSE_POINT_BYTES };
enum { kTwoLevelsBytes = SHGRID_SPARSE_HEADER_BYTES + 2 * SHGRID_SPARSE_NODE_BYTES + 15 * SHGRID_SPARSE_POINT_BYTES };
enum { kHeader17 = 8 + 17 * kSlotBytes, kHeader18 = 8 + 18 * kSlotBytes, kHeader19 = 8 + 19 * kSlotBytes, kText = 12 };
enum { kArray = 6 }; /* a light array of three points */

static int Near(double a, double b, double tolerance) {
    return fabs(a - b) <= tolerance;
}

static void PutFloat(unsigned char *at, float value) {
    uint32_t bits;
    memcpy(&bits, &value, 4);
    Put32(at, bits);
}

/* A field that is linear in the position, different for every coefficient and channel. */
static double Linear(int k, int channel, double x, double y, double z) {
    return 1 + k - 0.5 * channel + 0.015625 * (k + 1) * x - 0.03125 * (channel + 1) * y + 0.0078125 * z;
}

static const float kMins[3] = {-64, 32, 0}, kCell[3] = {32, 16, 64};

static void PutLump(unsigned char *lump) {
    int i, k, channel, x, y, z;
    for (i = 0; i < 3; i++) {
        PutFloat(lump + 4 * i, kMins[i]);
        PutFloat(lump + 12 + 4 * i, kCell[i]);
    }
    Put32(lump + 24, kNx);
    Put32(lump + 28, kNy);
    Put32(lump + 32, kNz);
    Put32(lump + 36, kPoints);
    for (i = 0; i < kPoints; i++) {
        x = i % kNx, y = i / kNx % kNy, z = i / (kNx * kNy);
        for (k = 0; k < 9; k++)
            for (channel = 0; channel < 3; channel++)
                PutFloat(lump + SHGRID_HEADER_BYTES + SHGRID_POINT_BYTES * i + 12 * k + 4 * channel,
                         (float)Linear(k, channel, kMins[0] + (float)x * kCell[0], kMins[1] + (float)y * kCell[1],
                                       kMins[2] + (float)z * kCell[2]));
    }
}

static void PutSlot(unsigned char *file, int slot, uint32_t offset, uint32_t length) {
    Put32(file + 8 + kSlotBytes * slot, offset);
    Put32(file + 12 + kSlotBytes * slot, length);
}

/* A version 47 file with 19 slots: 12 bytes of entities, then the SH grid. Returns its size. */
static size_t PutFile19(unsigned char *file) {
    memset(file, 0, kHeader19 + kText);
    memcpy(file, "IBSP", 4);
    Put32(file + 4, 47);
    PutSlot(file, 0, kHeader19, kText);
    PutSlot(file, 18, kHeader19 + kText, kLumpBytes);
    PutLump(file + kHeader19 + kText);
    return kHeader19 + kText + kLumpBytes;
}

/* A BSPX directory of two lumps, and the lumps. Returns where they end. */
static size_t PutBspx(unsigned char *file, size_t directory) {
    const size_t data = directory + 8 + 2 * 32;
    memset(file + directory, 0, data + 4 - directory);
    memcpy(file + directory, "BSPX", 4);
    Put32(file + directory + 4, 2);
    memcpy(file + directory + 8, "LIGHTGRID_SHARED", 16); /* a longer name that begins alike */
    Put32(file + directory + 8 + 24, (uint32_t)data);
    Put32(file + directory + 8 + 28, 4);
    memcpy(file + directory + 40, "LIGHTGRID_SH", 12);
    Put32(file + directory + 40 + 24, (uint32_t)data + 4);
    Put32(file + directory + 40 + 28, kLumpBytes);
    PutLump(file + data + 4);
    return data + 4 + kLumpBytes;
}

/* A version 46 file with 17 slots, 10 bytes of entities, and a BSPX directory of two lumps. */
static size_t PutFileBspx(unsigned char *file) {
    memset(file, 0, kHeader17 + kText);
    memcpy(file, "IBSP", 4);
    Put32(file + 4, 46);
    PutSlot(file, 0, kHeader17, kText - 2);
    return PutBspx(file, kHeader17 + kText);
}

/* An RBSP or FBSP file: entities, then the light array as the last of 18 lumps, which ends at no multiple of 4. */
static size_t PutFileRbsp(unsigned char *file, const char *ident) {
    memset(file, 0, kHeader18 + kText + kArray + 2);
    memcpy(file, ident, 4);
    Put32(file + 4, 1);
    PutSlot(file, 0, kHeader18, kText);
    PutSlot(file, 17, kHeader18 + kText, kArray);
    memset(file + kHeader18 + kText, 7, kArray);
    return PutBspx(file, kHeader18 + kText + kArray + 2);
}

/* Loads a copy in memory of exactly that size, so that a checker of addresses sees every byte too far. */
static shgrid_result LoadExact(const unsigned char *file, size_t size) {
    unsigned char *copy = (unsigned char *)malloc(size > 0 ? size : 1);
    shgrid_grid grid;
    shgrid_result result;
    if (!copy)
        exit(1);
    memcpy(copy, file, size);
    result = shgrid_load(copy, size, &grid);
    if (result == SHGRID_OK) {
        const float corner[3] = {1e9f, 1e9f, 1e9f}, up[3] = {0, 0, 1};
        float rgb[3];
        shgrid_light(&grid, corner, up, rgb);
    }
    free(copy);
    return result;
}

static void TestContainers(unsigned char *file) {
    shgrid_grid grid;
    size_t size, shift, cut;
    int kind;
    for (kind = 0; kind < 4; kind++) {
        size = kind == 0   ? PutFile19(file)
               : kind == 1 ? PutFileBspx(file)
                           : PutFileRbsp(file, kind == 2 ? "RBSP" : "FBSP");
        CHECK(shgrid_load(file, size, &grid) == SHGRID_OK);
        CHECK(grid.bounds[0] == kNx && grid.bounds[1] == kNy && grid.bounds[2] == kNz && grid.count == kPoints);
        CHECK(grid.mins[1] == kMins[1] && grid.cell[2] == kCell[2]);
        CHECK(grid.points == file + size - SHGRID_POINT_BYTES * kPoints);
        for (cut = 0; cut < size; cut++)
            CHECK(LoadExact(file, cut) != SHGRID_OK);
        for (shift = 1; shift < 4; shift++) { /* any alignment */
            memmove(file + shift, file, size);
            CHECK(LoadExact(file + shift, size) == SHGRID_OK);
            CHECK(shgrid_load(file + shift, size, &grid) == SHGRID_OK);
            memmove(file, file + shift, size);
        }
    }
    size = PutFile19(file);
    PutSlot(file, 18, 0, 0);
    CHECK(LoadExact(file, size) == SHGRID_ABSENT);
    size = PutFileBspx(file);
    CHECK(LoadExact(file, kHeader17 + kText) == SHGRID_ABSENT);
}

static void TestHostileOffsets(unsigned char *file) {
    static const uint32_t bad[] = {1, 100, 0x7fffffff, 0x80000000u, 0xffffffffu, 0xfffffff0u, kHeader19 + 20000};
    const size_t directory = kHeader17 + kText;
    size_t i, size;
    for (i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        size = PutFile19(file);
        PutSlot(file, 18, bad[i], kLumpBytes);
        CHECK(LoadExact(file, size) == SHGRID_BAD_OFFSET);
        PutSlot(file, 18, kHeader19 + kText, bad[i]);
        CHECK(LoadExact(file, size) != SHGRID_OK);
        PutFile19(file);
        PutSlot(file, 3, bad[i], 8);
        CHECK(LoadExact(file, size) == SHGRID_BAD_OFFSET);
        size = PutFileBspx(file);
        Put32(file + directory + 40 + 24, bad[i]);
        CHECK(LoadExact(file, size) == SHGRID_BAD_OFFSET);
        PutFileBspx(file);
        Put32(file + directory + 40 + 28, bad[i]);
        CHECK(LoadExact(file, size) != SHGRID_OK);
        PutFileBspx(file);
        Put32(file + directory + 4, bad[i] + 1);
        CHECK(LoadExact(file, size) == SHGRID_TRUNCATED || bad[i] + 1 <= 2);
    }
    size = PutFile19(file);
    Put32(file + 4, 45);
    CHECK(LoadExact(file, size) == SHGRID_NOT_BSP);
    Put32(file + 4, 1);
    CHECK(LoadExact(file, size) == SHGRID_NOT_BSP);
    memcpy(file, "VBSP", 4);
    CHECK(LoadExact(file, size) == SHGRID_NOT_BSP);
}

/* In a file with fewer slots the bytes of slot 18 are a lump: whatever they hold, they are no grid. */
static void TestOtherLayouts(unsigned char *file) {
    size_t size = PutFile19(file);
    PutSlot(file, 1, kHeader17, 16);
    CHECK(LoadExact(file, size) == SHGRID_ABSENT);
    size = PutFile19(file);
    Put32(file + 4, 46);
    CHECK(LoadExact(file, size) == SHGRID_ABSENT);
    /* A text before the first lump, as other compilers write it. */
    size = PutFile19(file);
    PutSlot(file, 0, kHeader19 + 4, kText - 4);
    memset(file + 8 + 18 * kSlotBytes, 'x', kSlotBytes);
    CHECK(LoadExact(file, size) == SHGRID_ABSENT);
}

/* RBSP and FBSP: slot 17 is the light array, and no bytes are slot 18, whatever lies behind the header. */
static void TestLightArray(unsigned char *file) {
    static const char *const idents[2] = {"RBSP", "FBSP"};
    bspx_file bsp;
    bspx_lump lump;
    shgrid_grid grid;
    size_t size;
    int i;
    for (i = 0; i < 2; i++) {
        size = PutFileRbsp(file, idents[i]);
        CHECK(bspx_open(file, size, &bsp) == BSPX_OK);
        CHECK(bspx_slot(&bsp, 17, &lump) == BSPX_OK && lump.data == file + kHeader18 + kText && lump.size == kArray);
        CHECK(bspx_slot(&bsp, 16, &lump) == BSPX_OK && lump.size == 0);
        CHECK(bspx_slot(&bsp, 18, &lump) == BSPX_ABSENT && lump.size == 0);
        PutSlot(file, 17, kHeader18 + kText, (uint32_t)size);
        CHECK(LoadExact(file, size) == SHGRID_BAD_OFFSET);
        PutSlot(file, 17, kHeader17, kArray);
        CHECK(LoadExact(file, size) == SHGRID_BAD_OFFSET);
        /* Without a grid: the directory is behind the entities. */
        PutSlot(file, 17, 0, 0);
        size = PutBspx(file, kHeader18 + kText);
        CHECK(shgrid_load(file, size, &grid) == SHGRID_OK && grid.count == kPoints);
        CHECK(bspx_open(file, size, &bsp) == BSPX_OK && bspx_slot(&bsp, 17, &lump) == BSPX_OK && lump.size == 0);
        /* Bytes that would be the slot of a good grid in an IBSP file. */
        size = PutFile19(file);
        memcpy(file, idents[i], 4);
        Put32(file + 4, 1);
        CHECK(LoadExact(file, size) == SHGRID_ABSENT);
        Put32(file + 4, 46);
        CHECK(LoadExact(file, size) == SHGRID_NOT_BSP);
    }
}

static void TestHostileHeader(unsigned char *lump) {
    static const struct {
        int at;
        uint32_t bits;
        shgrid_result expected;
    } cases[] = {
        {0, 0x7fc00000u, SHGRID_BAD_MINS},
        {8, 0x7f800000u, SHGRID_BAD_MINS},
        {12, 0, SHGRID_BAD_CELL},
        {16, 0xc2000000u, SHGRID_BAD_CELL},
        {20, 0x7f800000u, SHGRID_BAD_CELL},
        {24, 0, SHGRID_BAD_BOUNDS},
        {28, 0xffffffffu, SHGRID_BAD_BOUNDS},
        {32, 0x80000000u, SHGRID_BAD_BOUNDS},
        {24, 5, SHGRID_BAD_COUNT},
        {24, 0x7fffffff, SHGRID_BAD_COUNT},
        {36, 0, SHGRID_BAD_COUNT},
        {36, 0xffffffffu, SHGRID_BAD_COUNT},
    };
    shgrid_grid grid;
    size_t i;
    for (i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        PutLump(lump);
        Put32(lump + cases[i].at, cases[i].bits);
        CHECK(shgrid_parse(lump, kLumpBytes, &grid) == cases[i].expected);
        CHECK(grid.points == NULL);
    }
    /* Bounds whose product is right modulo 2^32. */
    PutLump(lump);
    Put32(lump + 24, 0x10000);
    Put32(lump + 28, 0x10000);
    Put32(lump + 32, 1);
    Put32(lump + 36, 0);
    CHECK(shgrid_parse(lump, kLumpBytes, &grid) == SHGRID_BAD_COUNT);
    PutLump(lump);
    CHECK(shgrid_parse(lump, kLumpBytes - 1, &grid) == SHGRID_TRUNCATED);
    lump[kLumpBytes] = 0;
    CHECK(shgrid_parse(lump, kLumpBytes + 1, &grid) == SHGRID_BAD_COUNT);
}

static void TestSampling(const shgrid_grid *grid) {
    int i, k, channel;
    for (i = 0; i < 1000; i++) {
        /* From a cell outside on one side to a cell outside on the other. */
        const double t[3] = {(i % 10) / 9.0 * 1.5 - 0.25, (i / 10 % 10) / 9.0 * 1.5 - 0.25,
                             (i / 100) / 9.0 * 1.5 - 0.25};
        float position[3];
        double clamped[3];
        shgrid_coeffs sampled;
        for (k = 0; k < 3; k++) {
            const double extent = (double)kCell[k] * (grid->bounds[k] - 1);
            position[k] = (float)(kMins[k] + t[k] * extent);
            clamped[k] = fmin(fmax(position[k], kMins[k]), kMins[k] + extent);
        }
        shgrid_sample(grid, position, &sampled);
        for (k = 0; k < 9; k++)
            for (channel = 0; channel < 3; channel++)
                CHECK(Near(sampled.c[k][channel], Linear(k, channel, clamped[0], clamped[1], clamped[2]), 1e-5));
    }
}

static void TestOddPositions(const shgrid_grid *grid) {
    const float first[3] = {-64, 32, 0}, last[3] = {32, 64, 64}, up[3] = {0, 0, 1};
    const float odd[][3] = {{NAN, NAN, NAN}, {-INFINITY, -INFINITY, -INFINITY}, {-3e38f, -3e38f, -3e38f}};
    const float high[][3] = {{INFINITY, INFINITY, INFINITY}, {3e38f, 3e38f, 3e38f}};
    const float noNormal[3] = {NAN, INFINITY, 0};
    float expected[3], rgb[3];
    size_t i;
    shgrid_light(grid, first, up, expected);
    for (i = 0; i < 3; i++) {
        shgrid_light(grid, odd[i], up, rgb);
        CHECK(memcmp(rgb, expected, sizeof rgb) == 0);
    }
    shgrid_light(grid, last, up, expected);
    for (i = 0; i < 2; i++) {
        shgrid_light(grid, high[i], up, rgb);
        CHECK(memcmp(rgb, expected, sizeof rgb) == 0);
    }
    shgrid_light(grid, first, noNormal, rgb);
    CHECK(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
}

/* One light of color 1 from +x, +y, +z or a slanted direction: V = 0.09375 + 0.5 t + 0.46875 t^2, t = cosine. */
static void TestDeltaLight(void) {
    static const double kLobe[9] = {3.141592653589793, 2.094395102393195, 2.094395102393195,
                                    2.094395102393195, 0.785398163397448, 0.785398163397448,
                                    0.785398163397448, 0.785398163397448, 0.785398163397448};
    static const double lights[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.48, -0.6, 0.64}};
    int light, i, k;
    for (light = 0; light < 4; light++) {
        const double x = lights[light][0], y = lights[light][1], z = lights[light][2];
        const double basis[9] = {0.28209479177387814,
                                 0.4886025119029199 * y,
                                 0.4886025119029199 * z,
                                 0.4886025119029199 * x,
                                 1.092548430592079 * x * y,
                                 1.092548430592079 * y * z,
                                 0.31539156525252 * (3 * z * z - 1),
                                 1.092548430592079 * x * z,
                                 0.5462742152960395 * (x * x - y * y)};
        shgrid_coeffs plain, coeffs;
        for (k = 0; k < 9; k++) {
            coeffs.c[k][0] = (float)(kLobe[k] * basis[k]);
            coeffs.c[k][1] = coeffs.c[k][2] = 0;
            plain.c[k][0] = plain.c[k][1] = plain.c[k][2] = (float)basis[k];
        }
        shgrid_convolve(&plain);
        for (k = 0; k < 9; k++)
            CHECK(Near(plain.c[k][1], coeffs.c[k][0], 1e-6));
        for (i = 0; i < 400; i++) {
            const double h = 1 - (2 * i + 1) / 400.0, angle = 2.399963229728653 * i, r = sqrt(1 - h * h);
            const float normal[3] = {(float)(r * cos(angle)), (float)(r * sin(angle)), (float)h};
            const double t = normal[0] * x + normal[1] * y + normal[2] * z;
            float rgb[3];
            shgrid_evaluate(&coeffs, normal, rgb);
            CHECK(Near(rgb[0], fmax(0, 0.09375 + 0.5 * t + 0.46875 * t * t), 2e-6));
            CHECK(rgb[1] == 0 && rgb[2] == 0);
        }
    }
}

static void TestMessages(void) {
    int a, b;
    for (a = SHGRID_OK; a <= SHGRID_BAD_NODES; a++)
        for (b = SHGRID_OK; b < a; b++)
            CHECK(strcmp(shgrid_message((shgrid_result)a), shgrid_message((shgrid_result)b)) != 0);
}

static int IsPlain(const shgrid_tone *tone) {
    return tone->contrast == 1 && tone->gamma == 1 && tone->exposure == 0 && tone->saturation == 1 &&
           tone->scale == 1 && tone->maxlight == 255 && tone->srgb == 0;
}

static void TestToneText(void) {
    static const char *const good[] = {"",         "  \t\n",  "gamma 1",           "unknown 7 other -1e-3",
                                       "scale 1.", "gAmMa 3", "exposure -0.0e+05", "saturation +1 maxlight 255.000"};
    static const char *const bad[] = {
        "gamma",       "gamma x",        "1.4",           "gamma 1.4 scale",   "gamma 1,4", "gamma 1.4x",
        "gamma .",     "gamma 1e",       "gamma 0",       "gamma -1",          "scale 0",   "maxlight 256",
        "maxlight -1", "gamma 1e39",     "gamma nan",     "gamma inf",         "gamma 0x2", "unknown gamma 2",
        "gamma - 1.4", "contrast 1e999", "gamma 2 gamma", "scale 2 \"gamma\"", "srgb on"};
    shgrid_tone tone;
    size_t i;
    CHECK(shgrid_parse_tone(NULL, &tone) == SHGRID_OK && IsPlain(&tone));
    for (i = 0; i < sizeof good / sizeof good[0]; i++)
        CHECK(shgrid_parse_tone(good[i], &tone) == SHGRID_OK && IsPlain(&tone));
    for (i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK(shgrid_parse_tone(bad[i], &tone) == SHGRID_BAD_TONE && IsPlain(&tone));
    CHECK(shgrid_parse_tone("contrast 0.75 gamma 1.4 exposure 2e2 saturation -.5 scale 0.25 maxlight 99.5 srgb 1",
                            &tone) == SHGRID_OK);
    CHECK(tone.contrast == 0.75f && tone.gamma == 1.4f && tone.exposure == 200 && tone.saturation == -0.5f);
    CHECK(tone.scale == 0.25f && tone.maxlight == 99.5f && tone.srgb == 1);
    CHECK(shgrid_parse_tone("\tscale 1.1754944e-38 gamma 3.4028235e38 later 5 gamma 16777217", &tone) == SHGRID_OK);
    CHECK(tone.scale == 1.1754944e-38f && tone.gamma == 16777216);
}

static void ExpectTone(const char *text, double r, double g, double b, double wantR, double wantG, double wantB) {
    float rgb[3] = {(float)r, (float)g, (float)b};
    shgrid_tone tone;
    CHECK(shgrid_parse_tone(text, &tone) == SHGRID_OK);
    shgrid_apply_tone(&tone, rgb);
    if (!Near(rgb[0], wantR, 1e-6) || !Near(rgb[1], wantG, 1e-6) || !Near(rgb[2], wantB, 1e-6)) {
        printf("%s: %g %g %g\n", text, (double)rgb[0], (double)rgb[1], (double)rgb[2]);
        failures++;
    }
}

/* Each step by its formula, and their order. */
static void TestTone(void) {
    ExpectTone("", 0.25, 0.5, 1, 0.25, 0.5, 1);
    ExpectTone("", 0.5, 1, 4, 0.125, 0.25, 1);
    ExpectTone("gamma 2", 0.25, 0.49, 0.0625, 0.5, 0.7, 0.25);
    ExpectTone("contrast 0.5", 0, 128 / 255.0, 1, 64 / 255.0, 128 / 255.0, 191.5 / 255);
    ExpectTone("contrast 3", 0, 128 / 255.0, 130 / 255.0, 0, 128 / 255.0, 134 / 255.0);
    ExpectTone("exposure 200", 0.4, 0.8, 0, 0.5 * (1 - exp(-1.02)), 1 - exp(-1.02), 0);
    ExpectTone("saturation 0", 1, 0, 0, 0.3086, 0.3086, 0.3086);
    ExpectTone("saturation 2", 0, 0.5, 0, 0, 1 - 0.5 * 0.6094, 0);
    ExpectTone("scale 0.5 maxlight 51", 0.2, 0.4, 0.8, 0.05, 0.1, 0.2);
    ExpectTone("srgb 1", 0.002, 0.5, 1, 0.02584, 0.735356983, 1);
    ExpectTone("scale 2 gamma 2 maxlight 204", 0.04, 0.16, 0.01, 0.4, 0.8, 0.2);
    ExpectTone("gamma 2 exposure 255", 0.25, 0, 0, 1 - exp(-0.5), 0, 0);
    ExpectTone("gamma 2 srgb 1", 0.25, 0, 0, 0.735356983, 0, 0);
    ExpectTone("gamma 2", NAN, 0.25, -3, 0, 0.5, 0);
}

/* A root of eight cells; coefficient 0 of point i is (i + 1) / 256, coefficient 1 is half its limit. */
static void PutSparse(unsigned char *lump) {
    int i;
    memset(lump, 0, kSparseBytes);
    memcpy(lump, "SHGS", 4);
    Put32(lump + 4, 1);
    Put32(lump + 8, kSparseBytes);
    for (i = 0; i < 3; i++) {
        PutFloat(lump + 12 + 4 * i, kMins[i]);
        PutFloat(lump + 24 + 4 * i, kCell[i]);
        Put32(lump + 36 + 4 * i, 1);
    }
    Put32(lump + 48, 1); /* levels */
    Put32(lump + 52, 1); /* nodes */
    Put32(lump + 56, 8); /* points */
    Put32(lump + 64, 1); /* the next child */
    lump[73] = 255;      /* all stored */
    lump[75] = 128;      /* plain scale */
    for (i = 0; i < 8; i++) {
        unsigned char *point = lump + 76 + SHGRID_SPARSE_POINT_BYTES * i;
        Put32(point, (uint32_t)((i + 1) * (1 + 512 + 262144)) | 16u << 27);
        point[4] = 64; /* of 127 */
    }
}

static void TestSparse(void) {
    static unsigned char lump[kSparseBytes];
    static uint32_t texels[7][125];
    unsigned char indirection[4];
    void *textures[7];
    const float center[3] = {-48, 40, 32};
    const int32_t bounds[3] = {1, 1, 1};
    shgrid_grid grid;
    shgrid_atlas atlas;
    shgrid_coeffs coeffs, expanded;
    size_t size;
    int i;
    PutSparse(lump);
    CHECK(shgrid_parse(lump, kSparseBytes, &grid) == SHGRID_OK);
    CHECK(grid.levels == 1 && grid.count == 8 && grid.bounds[2] == 2);
    shgrid_sample(&grid, center, &coeffs);
    CHECK(Near(coeffs.c[0][2], 4.5 / 256, 1e-7));
    CHECK(Near(coeffs.c[1][0], 4.5 / 256 * 64 / 127 * 1.1547005384, 1e-7));
    CHECK(coeffs.c[1][1] == 0 && coeffs.c[8][2] == 0);
    shgrid_expand(&grid, center, kCell, bounds, &expanded);
    CHECK(memcmp(&coeffs, &expanded, sizeof coeffs) == 0);
    shgrid_point(&grid, 1, 0, 1, &coeffs);
    CHECK(Near(coeffs.c[0][0], 6.0 / 256, 1e-7));
    shgrid_atlas_measure(&grid, &atlas);
    CHECK(atlas.count == 1 && shgrid_atlas_bytes(&atlas, SHGRID_ATLAS_SNORM) == sizeof texels[0]);
    CHECK(shgrid_indirection_bytes(&atlas) == sizeof indirection);
    for (i = 0; i < 7; i++)
        textures[i] = texels[i];
    shgrid_atlas_fill(&grid, &atlas, SHGRID_ATLAS_SNORM, indirection, textures);
    CHECK(indirection[0] == 0 && indirection[3] == 1);               /* a brick of two cells */
    CHECK((texels[0][0] >> 27) == 8 && (texels[0][0] & 511) == 256); /* 1 / 256 */
    CHECK((texels[1][0] & 255) == 64);
    CHECK(shgrid_fill_half(&grid, textures) == 0 && (texels[0][0] & 511) == 256); /* that is for uniform grids */
    for (size = 0; size < kSparseBytes; size++)
        CHECK(shgrid_parse(lump, size, &grid) != SHGRID_OK && grid.nodes == NULL);
}

/* One root with a chain of nodes down to the smallest cells at its lower corner, where the only point is stored.
   Returns the bytes of the lump. */
static uint32_t PutChain(unsigned char *lump, uint32_t levels) {
    const uint32_t size = SHGRID_SPARSE_HEADER_BYTES + SHGRID_SPARSE_NODE_BYTES * levels + SHGRID_SPARSE_POINT_BYTES;
    uint32_t i;
    PutSparse(lump);
    memset(lump + SHGRID_SPARSE_HEADER_BYTES, 0, size - SHGRID_SPARSE_HEADER_BYTES);
    Put32(lump + 8, size);
    Put32(lump + 48, levels);
    Put32(lump + 52, levels);
    Put32(lump + 56, 1);
    for (i = 0; i < levels; i++) {
        unsigned char *node = lump + SHGRID_SPARSE_HEADER_BYTES + SHGRID_SPARSE_NODE_BYTES * i;
        Put32(node, i + 1);
        node[i + 1 < levels ? 8 : 9] = 1;
        node[11] = 128;
    }
    Put32(lump + size - SHGRID_SPARSE_POINT_BYTES, 0x80404040u);
    return size;
}

/* A file of 236 bytes may not ask for gigabytes of textures. */
static void TestChain(void) {
    static unsigned char lump[1024];
    uint32_t levels;
    for (levels = 2; levels <= SHGRID_SPARSE_LEVELS; levels++) {
        shgrid_grid grid;
        shgrid_atlas atlas;
        shgrid_coeffs coeffs;
        CHECK(shgrid_parse(lump, PutChain(lump, levels), &grid) == SHGRID_OK);
        shgrid_sample(&grid, kMins, &coeffs);
        CHECK(coeffs.c[0][0] > 0);
        shgrid_atlas_measure(&grid, &atlas);
        CHECK((atlas.count > 0) == (levels <= 8)); /* a brick has 4 cells: 2^21 entries for 9 levels */
        CHECK(shgrid_indirection_bytes(&atlas) <= 4u << 20);
        CHECK((double)shgrid_indirection_bytes(&atlas) == 4.0 * atlas.entries[0] * atlas.entries[1] * atlas.entries[2]);
    }
}

/* Loading takes the uniform grid if the sparse one is damaged or of a version to come. */
static void TestFallback(unsigned char *file) {
    const size_t directory = kHeader17 + kText, size = PutFileBspx(file), sparse = (size + 3) & ~(size_t)3;
    shgrid_grid grid;
    PutSparse(file + sparse);
    memset(file + directory + 8, 0, 24);
    memcpy(file + directory + 8, "LIGHTGRID_SH_SPARSE", 19); /* in place of the lump with a longer name */
    Put32(file + directory + 8 + 24, (uint32_t)sparse);
    Put32(file + directory + 8 + 28, kSparseBytes);
    CHECK(shgrid_load(file, sparse + kSparseBytes, &grid) == SHGRID_OK && grid.levels == 1);
    file[sparse + 72] = 1; /* a node in the last level */
    CHECK(shgrid_load(file, sparse + kSparseBytes, &grid) == SHGRID_OK && grid.levels == 0 && grid.count == kPoints);
    CHECK(shgrid_load_form(file, sparse + kSparseBytes, SHGRID_SPARSE, &grid) == SHGRID_BAD_NODES);
    Put32(file + sparse + 4, 2);
    CHECK(shgrid_load(file, sparse + kSparseBytes, &grid) == SHGRID_OK && grid.levels == 0);
    Put32(file + directory + 8 + 24, 0xfffffff0u);
    CHECK(shgrid_load(file, sparse + kSparseBytes, &grid) == SHGRID_OK && grid.levels == 0);
    Put32(file + directory + 40 + 28, kLumpBytes - 1); /* both are bad: what is wrong with the one that was preferred */
    CHECK(shgrid_load(file, sparse + kSparseBytes, &grid) == SHGRID_BAD_OFFSET && grid.points == NULL);
}

/* A grid that failed to load is black. */
static void TestEmptyGrid(void) {
    const float at[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    float rgb[3] = {9, 9, 9};
    uint16_t texels[4] = {7, 7, 7, 7};
    void *textures[7] = {texels, texels, texels, texels, texels, texels, texels};
    shgrid_grid grid;
    shgrid_atlas atlas;
    shgrid_coeffs coeffs;
    CHECK(shgrid_load("no map", 6, &grid) == SHGRID_NOT_BSP);
    shgrid_light(&grid, at, up, rgb);
    CHECK(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
    shgrid_point(&grid, 0, 0, 0, &coeffs);
    CHECK(coeffs.c[0][0] == 0);
    shgrid_atlas_measure(&grid, &atlas);
    CHECK(atlas.count == 0 && shgrid_points_near(&grid, at, 100, 0, NULL) == 0);
    CHECK(shgrid_fill_half(&grid, textures) == 0 && texels[0] == 7);
}

/* A root of 4 x 4 x 4 smallest cells whose first child is a node; all 15 points are stored. */
static void PutTwoLevels(unsigned char *lump) {
    PutSparse(lump);
    memset(lump + 64, 0, kTwoLevelsBytes - 64);
    Put32(lump + 8, kTwoLevelsBytes);
    Put32(lump + 48, 2);
    Put32(lump + 52, 2);
    Put32(lump + 56, 15);
    Put32(lump + 64, 1); /* children and points of the root */
    lump[72] = 1;
    lump[73] = 254;
    Put32(lump + 76, 2); /* of its child */
    Put32(lump + 80, 7);
    lump[85] = 255;
}

/* Points of a grid with that many steps along each axis of the lattice; `stores` says which points it has. */
static void ExpectPointsNear(const shgrid_grid *grid, const int steps[3], int (*stores)(int, int, int)) {
    static const float radii[5] = {0, 20, 40, 70, 1000};
    const float positions[3][3] = {{-64, 32, 0}, {-20, 50, 70}, {100, -30, 300}};
    int r, p, x, y, z;
    for (r = 0; r < 5; r++)
        for (p = 0; p < 3; p++) {
            float points[64][3];
            const size_t count = shgrid_points_near(grid, positions[p], radii[r], 64, points);
            size_t expected = 0, found = 0, i;
            for (z = 0; z < steps[2]; z++)
                for (y = 0; y < steps[1]; y++)
                    for (x = 0; x < steps[0]; x++) {
                        const float at[3] = {kMins[0] + (float)x * kCell[0], kMins[1] + (float)y * kCell[1],
                                             kMins[2] + (float)z * kCell[2]};
                        const double dx = at[0] - positions[p][0], dy = at[1] - positions[p][1],
                                     dz = at[2] - positions[p][2];
                        if (!stores(x, y, z) || sqrt(dx * dx + dy * dy + dz * dz) > radii[r])
                            continue;
                        expected++;
                        for (i = 0; i < count; i++)
                            found += memcmp(points[i], at, sizeof at) == 0;
                    }
            CHECK(count == expected && found == expected);
            CHECK(shgrid_points_near(grid, positions[p], radii[r], 0, NULL) == expected);
        }
}

static int StoresAll(int x, int y, int z) {
    return x >= 0 && y >= 0 && z >= 0;
}

static int StoresTwoLevels(int x, int y, int z) {
    return (x < 2 && y < 2 && z < 2) || (x % 2 == 0 && y % 2 == 0 && z % 2 == 0);
}

static void TestPointsNear(const shgrid_grid *uniform) {
    static unsigned char lump[kTwoLevelsBytes];
    const int uniformSteps[3] = {kNx, kNy, kNz}, sparseSteps[3] = {4, 4, 4};
    const float nan[3] = {NAN, 0, 0};
    shgrid_grid sparse;
    ExpectPointsNear(uniform, uniformSteps, StoresAll);
    PutTwoLevels(lump);
    CHECK(shgrid_parse(lump, kTwoLevelsBytes, &sparse) == SHGRID_OK);
    ExpectPointsNear(&sparse, sparseSteps, StoresTwoLevels);
    CHECK(shgrid_points_near(uniform, nan, 1000, 0, NULL) == 0);
    CHECK(shgrid_points_near(&sparse, nan, 1000, 0, NULL) == 0);
}

/* `count` lights of directions all over the sphere, light i 10 times dimmer than light i - 1. */
static shgrid_lighting MakeLights(int count) {
    shgrid_lighting lighting;
    float brightness = 1;
    int i;
    memset(&lighting, 0, sizeof lighting);
    lighting.rest.c[0][0] = lighting.rest.c[0][1] = lighting.rest.c[0][2] = 1;
    for (i = 0; i < count; i++, brightness *= 0.1f) {
        shgrid_direct *direct = lighting.direct + (i * 7 + 3) % count;
        const float z = 1 - (float)i * 0.2f, r = sqrtf(1 - z * z);
        direct->direction[0] = r * cosf((float)i);
        direct->direction[1] = r * sinf((float)i);
        direct->direction[2] = z;
        direct->color[0] = brightness;
        direct->color[1] = direct->color[2] = 0.5f * brightness;
        direct->spread = 0.1f * (float)i;
        direct->light = i;
    }
    lighting.count = count;
    return lighting;
}

/* Light of a direction with that spread at a cosine to the normal. */
static float Lobe(float cosine, float spread) {
    const float normal[3] = {0, 0, 1};
    shgrid_lighting lighting;
    float rgb[3];
    memset(&lighting, 0, sizeof lighting);
    lighting.count = 1;
    lighting.direct[0].direction[0] = sqrtf(1 - cosine * cosine);
    lighting.direct[0].direction[2] = cosine;
    lighting.direct[0].color[1] = 2;
    lighting.direct[0].spread = spread;
    shgrid_shade(&lighting, normal, rgb);
    CHECK(rgb[0] == 0 && rgb[2] == 0);
    return rgb[1] / 2;
}

static void TestNamedLights(void) {
    enum { kNormals = 37, kStride = 4 };
    static float normals[kNormals][kStride], colors[kNormals + 1][3];
    const shgrid_lighting all = MakeLights(10);
    shgrid_lighting some = all, none = all, equal;
    float rgb[3], limited[3], worst = 0;
    int i, channel;
    CHECK(Near(Lobe(0.75f, 0), 0.75, 2e-6) && Near(Lobe(0.75f, 0.5f), 0.75, 2e-6) && Near(Lobe(-0.25f, 0), 0, 2e-6));
    CHECK(Near(Lobe(0.25f, 0.5f), 0.28125, 2e-6) && Near(Lobe(0, 1), 0.25, 2e-6) && Near(Lobe(-0.5f, 0.5f), 0, 2e-6));

    shgrid_limit_lights(&some, 3);
    shgrid_limit_lights(&none, -1);
    CHECK(some.count == 3 && none.count == 0);
    for (i = 0; i < 3; i++) /* the three brightest, in their old order, unchanged */
        CHECK(memcmp(&some.direct[i], &all.direct[(some.direct[i].light * 7 + 3) % 10], sizeof(shgrid_direct)) == 0 &&
              some.direct[i].light < 3);
    equal = some;
    shgrid_limit_lights(&equal, 3);
    CHECK(memcmp(&equal, &some, sizeof some) == 0);
    /* Two lights that are alike, with room for one: neither is preferred. */
    memcpy(&equal.direct[1], &equal.direct[0], sizeof equal.direct[0]);
    equal.count = 2;
    shgrid_limit_lights(&equal, 1);
    CHECK(equal.count == 0);

    for (i = 0; i < kNormals; i++) {
        const float z = 1 - 2 * (float)i / (kNormals - 1), r = sqrtf(1 - z * z);
        normals[i][0] = r * cosf(3 * (float)i);
        normals[i][1] = r * sinf(3 * (float)i);
        normals[i][2] = z;
    }
    colors[kNormals][0] = -1;
    shgrid_shade_many(&all, normals[0], kStride, kNormals, colors[0], 3);
    CHECK(colors[kNormals][0] == -1);
    for (i = 0; i < kNormals; i++) {
        shgrid_shade(&all, normals[i], rgb);
        shgrid_shade(&some, normals[i], limited);
        for (channel = 0; channel < 3; channel++) {
            CHECK(Near(rgb[channel], colors[i][channel], 1e-6));
            worst = fmaxf(worst, fabsf(rgb[channel] - limited[channel]));
        }
    }
    CHECK(worst > 0 && worst < 0.1f * 0.0011f); /* of L2 for the lights that are coefficients: a tenth of their light */
}

int main(void) {
    static unsigned char file[kHeader19 + 256 + kLumpBytes + kSparseBytes];
    shgrid_grid grid;
    TestContainers(file);
    TestNamedLights();
    TestHostileOffsets(file);
    TestOtherLayouts(file);
    TestLightArray(file);
    TestHostileHeader(file);
    CHECK(shgrid_load(file, PutFile19(file), &grid) == SHGRID_OK);
    TestSampling(&grid);
    TestOddPositions(&grid);
    TestPointsNear(&grid);
    TestDeltaLight();
    TestSparse();
    TestChain();
    TestFallback(file);
    TestEmptyGrid();
    TestMessages();
    TestToneText();
    TestTone();
    return CheckResult();
}
