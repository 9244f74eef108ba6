/* GPL-2.0-or-later. The reader of HDR light as a C99 program sees it: good, cut and hostile files. */
#include "libs/hdrlight/hdrlight.h"
#include "tests/engine_headers/check.h"

#include <stdio.h>
#include <stdlib.h>

/* Two pages of 128 x 128 texels, three draw vertices, and maps of side 128 of page 1. */
enum { kSide = 128, kTexels = 2 * kSide * kSide, kVertices = 3, kHeader = 8 + 18 * 8, kEntries = 3 };
enum { kLightmapsAt = kHeader, kDrawVertsAt = kLightmapsAt + 3 * kTexels };
enum { kDirectoryAt = kDrawVertsAt + 44 * kVertices, kTexelsAt = kDirectoryAt + 8 + 32 * kEntries };
enum { kVerticesAt = kTexelsAt + 4 * kTexels, kRnmAt = kVerticesAt + 4 * kVertices };
enum { kRnmBytes = 20 + 4 + 12 * kSide * kSide, kFileBytes = kRnmAt + kRnmBytes };

static void PutLump(unsigned char *file, int slot, uint32_t offset, uint32_t length) {
    Put32(file + 8 + 8 * slot, offset);
    Put32(file + 12 + 8 * slot, length);
}

static void PutEntry(unsigned char *file, int entry, const char *name, uint32_t offset, uint32_t length) {
    unsigned char *at = file + kDirectoryAt + 8 + 32 * entry;
    memcpy(at, name, strlen(name));
    Put32(at + 24, offset);
    Put32(at + 28, length);
}

/* Codes have the exponent 15 (unit 1 / 512) and a mantissa that tells them apart. */
static uint32_t Code(uint32_t red, uint32_t green, uint32_t blue) {
    return red | green << 9 | blue << 18 | (uint32_t)15 << 27;
}

static void PutFile(unsigned char *file) {
    unsigned char *rnm = file + kRnmAt;
    int i;
    memset(file, 0, kFileBytes);
    memcpy(file, "IBSP", 4);
    Put32(file + 4, 46);
    PutLump(file, 14, kLightmapsAt, 3 * kTexels);
    PutLump(file, 10, kDrawVertsAt, 44 * kVertices);
    memcpy(file + kDirectoryAt, "BSPX", 4);
    Put32(file + kDirectoryAt + 4, kEntries);
    PutEntry(file, 0, "LIGHTING_E5BGR9", kTexelsAt, 4 * kTexels);
    PutEntry(file, 1, "VERTEX_E5BGR9", kVerticesAt, 4 * kVertices);
    PutEntry(file, 2, "LIGHTING_RNM", kRnmAt, kRnmBytes);
    for (i = 0; i < kTexels; i++)
        Put32(file + kTexelsAt + 4 * i, Code((uint32_t)i % 512, (uint32_t)i / 512, 256));
    for (i = 0; i < kVertices; i++)
        Put32(file + kVerticesAt + 4 * i, Code(128, 256, 64u * (uint32_t)i));
    memcpy(rnm, "RNM1", 4);
    Put32(rnm + 4, 1);
    Put32(rnm + 8, 1);
    Put32(rnm + 12, kSide);
    Put32(rnm + 16, 1);
    Put32(rnm + 20, 1);
    for (i = 0; i < 3 * kSide * kSide; i++)
        Put32(rnm + 24 + 4 * i, Code(511, 0, (uint32_t)(i / (kSide * kSide))));
}

static void TestGood(unsigned char *file) {
    hdrlight light;
    const unsigned char *page;
    float rgb[3] = {0, 0, 0};
    PutFile(file);
    CHECK(hdrlight_load(file, kFileBytes, &light) == HDRLIGHT_OK);
    CHECK(light.texelCount == kTexels && light.vertexCount == kVertices);
    page = hdrlight_page(&light, 1, kSide);
    CHECK(page == file + kTexelsAt + 4 * kSide * kSide);
    if (page == NULL)
        return;
    hdrlight_color(page + 4 * (3 + kSide), rgb); /* texel (3, 1) of page 1 is number 16384 + 131 */
    CHECK(rgb[0] == 131.0f / 512 && rgb[1] == 32.0f / 512 && rgb[2] == 0.5f);
    CHECK(hdrlight_page(&light, 2, kSide) == NULL && hdrlight_page(&light, -3, kSide) == NULL);
    CHECK(hdrlight_page(&light, 0, 256) == NULL && hdrlight_page(&light, 0, 0) == NULL);
    hdrlight_vertex(&light, 2, rgb);
    CHECK(rgb[0] == 0.25f && rgb[1] == 0.5f && rgb[2] == 0.25f);
    hdrlight_vertex(&light, kVertices, rgb);
    CHECK(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
    CHECK(light.rnmRescaled && light.rnmSide == kSide && light.rnmPageCount == 1);
    page = hdrlight_rnm_map(&light, 1, 2);
    CHECK(page == file + kRnmAt + 24 + 8 * kSide * kSide);
    if (page == NULL)
        return;
    hdrlight_color(page, rgb);
    CHECK(rgb[0] == 511.0f / 512 && rgb[2] == 2.0f / 512);
    CHECK(hdrlight_rnm_map(&light, 0, 0) == NULL && hdrlight_rnm_map(&light, 1, 3) == NULL);
    CHECK(hdrlight_rnm_map(&light, -1, 0) == NULL);
}

/* Vertices of RBSP and FBSP files have 80 bytes. */
static void TestOtherFormats(unsigned char *file) {
    static const char *const idents[2] = {"RBSP", "FBSP"};
    hdrlight light;
    float rgb[3];
    int i;
    for (i = 0; i < 2; i++) {
        PutFile(file);
        memcpy(file, idents[i], 4);
        Put32(file + 4, 1);
        CHECK(hdrlight_load(file, kFileBytes, &light) == HDRLIGHT_NO_FIT && light.vertexCount == 0);
        PutLump(file, 10, kDirectoryAt - 80 * kVertices, 80 * kVertices); /* over the last texels, which nobody reads */
        CHECK(hdrlight_load(file, kFileBytes, &light) == HDRLIGHT_OK);
        CHECK(light.texelCount == kTexels && light.vertexCount == kVertices && light.rnmPageCount == 1);
        hdrlight_vertex(&light, 2, rgb);
        CHECK(rgb[0] == 0.25f && rgb[1] == 0.5f && rgb[2] == 0.25f);
        PutLump(file, 17, kFileBytes, 2); /* a light array outside the file */
        CHECK(hdrlight_load(file, kFileBytes, &light) == HDRLIGHT_BAD_OFFSET);
    }
}

static void TestColors(void) {
    static const unsigned char least[4] = {1, 0, 0, 0}, most[4] = {255, 255, 255, 255};
    float rgb[3];
    hdrlight_color(least, rgb);
    CHECK(rgb[0] == 1.0f / 16777216 && rgb[1] == 0);
    hdrlight_color(most, rgb);
    CHECK(rgb[0] == 65408 && rgb[1] == 65408 && rgb[2] == 65408);
}

/* One number of a good file, and what is said of it. */
static void TestBad(unsigned char *file) {
    static const struct {
        int at;
        uint32_t value;
        hdrlight_result expected;
    } cases[] = {
        {4, 48, HDRLIGHT_NOT_BSP},
        {8 + 8 * 14, 0x7fffffff, HDRLIGHT_BAD_OFFSET},
        {12 + 8 * 14, 3 * kTexels - 3, HDRLIGHT_NO_FIT},
        {kDirectoryAt + 4, 0xffffffffu, HDRLIGHT_TRUNCATED},
        {kDirectoryAt + 8 + 24, 4, HDRLIGHT_BAD_OFFSET},
        {kDirectoryAt + 8 + 28, 0xffffffffu, HDRLIGHT_BAD_OFFSET},
        {kDirectoryAt + 8 + 28, 6, HDRLIGHT_BAD_LENGTH},
        {kDirectoryAt + 8 + 28, 4, HDRLIGHT_NO_FIT},
        {kDirectoryAt + 40 + 28, 4, HDRLIGHT_NO_FIT},
        {kDirectoryAt + 72 + 28, 19, HDRLIGHT_BAD_LENGTH},
        {kDirectoryAt + 72 + 28, kRnmBytes - 4, HDRLIGHT_BAD_LENGTH},
        {kRnmAt, 0, HDRLIGHT_BAD_VERSION},
        {kRnmAt + 4, 2, HDRLIGHT_BAD_VERSION},
        {kRnmAt + 8, 2, HDRLIGHT_BAD_HEADER},
        {kRnmAt + 12, 0, HDRLIGHT_BAD_HEADER},
        {kRnmAt + 12, 0x80000000u, HDRLIGHT_BAD_HEADER},
        {kRnmAt + 12, 64, HDRLIGHT_BAD_LENGTH},
        {kRnmAt + 16, 0, HDRLIGHT_BAD_HEADER},
        {kRnmAt + 16, 0xffffffffu, HDRLIGHT_BAD_LENGTH},
        {kRnmAt + 20, 2, HDRLIGHT_BAD_PAGE},
        {kRnmAt + 20, 0xffffffffu, HDRLIGHT_BAD_PAGE},
    };
    hdrlight light;
    size_t i;
    PutFile(file);
    for (i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        unsigned char saved[4];
        memcpy(saved, file + cases[i].at, 4);
        Put32(file + cases[i].at, cases[i].value);
        if (hdrlight_load(file, kFileBytes, &light) != cases[i].expected) {
            printf("case %d: %s\n", (int)i, hdrlight_message(hdrlight_load(file, kFileBytes, &light)));
            failures++;
        }
        memcpy(file + cases[i].at, saved, 4);
    }
    memcpy(file + kRnmAt, "NONE", 4); /* the others are there all the same */
    CHECK(hdrlight_load(file, kFileBytes, &light) == HDRLIGHT_BAD_VERSION);
    CHECK(light.texelCount == kTexels && light.vertexCount == kVertices && light.rnmPages == NULL);
    memcpy(file + kDirectoryAt, "NONE", 4);
    CHECK(hdrlight_load(file, kFileBytes, &light) == HDRLIGHT_ABSENT);
    CHECK(hdrlight_page(&light, 0, kSide) == NULL && hdrlight_rnm_map(&light, 0, 0) == NULL);
}

/* The file cut near the ends of its parts: a result, and no read outside (the sanitizers look). */
static void TestCut(unsigned char *file) {
    static const int ends[] = {0,           kHeader, kDrawVertsAt, kDirectoryAt,  kTexelsAt,
                               kVerticesAt, kRnmAt,  kRnmAt + 24,  kFileBytes - 5};
    hdrlight light;
    size_t i;
    int size;
    PutFile(file);
    for (i = 0; i < sizeof ends / sizeof ends[0]; i++)
        for (size = ends[i] < 9 ? 0 : ends[i] - 9; size < ends[i] + 5; size++) {
            unsigned char *cut = (unsigned char *)malloc(size ? (size_t)size : 1);
            if (!cut)
                exit(1);
            memcpy(cut, file, (size_t)size);
            CHECK(hdrlight_load(cut, (size_t)size, &light) != HDRLIGHT_OK);
            free(cut);
        }
}

/* Each result has words of its own. */
static void TestMessages(void) {
    int i;
    for (i = 0; i <= HDRLIGHT_NO_FIT; i++)
        CHECK(strcmp(hdrlight_message((hdrlight_result)i), hdrlight_message((hdrlight_result)(i + 1))) != 0);
    CHECK(strcmp(hdrlight_message((hdrlight_result)(HDRLIGHT_NO_FIT + 1)), "unknown result") == 0);
}

int main(void) {
    unsigned char *file = (unsigned char *)malloc(kFileBytes); /* sanitizers guard its ends */
    if (file == NULL)
        return 1;
    TestGood(file);
    TestOtherFormats(file);
    TestColors();
    TestBad(file);
    TestCut(file);
    TestMessages();
    free(file);
    return CheckResult();
}
