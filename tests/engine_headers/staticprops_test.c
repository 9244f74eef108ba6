/* GPL-2.0-or-later. The engine-side reader of prop light as a C99 program sees it: good, cut and hostile files. */
#include "libs/staticprops/staticprops.h"
#include "tests/engine_headers/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { kProps = 2, kMeshes = 3, kColors = 5, kText = 12, kHeader = 8 + 18 * 8, kDirectory = 8 + 2 * 32 };
enum {
    kLumpBytes =
        STATICPROPS_HEADER_BYTES + kProps * STATICPROPS_PROP_BYTES + kMeshes * STATICPROPS_MESH_BYTES + 4 * kColors
};
enum { kLumpAt = kHeader + kText + kDirectory, kFileBytes = kLumpAt + kLumpBytes };

static void PutLump(unsigned char *lump) {
    static const uint32_t words[] = {1, kProps, kMeshes, kColors, 3, 10, 20, 0, 2, 7, 11, 21, 2, 1, 0, 2, 2, 2, 4, 1};
    size_t i;
    memcpy(lump, "SPL1", 4);
    for (i = 0; i < sizeof words / sizeof *words; i++)
        Put32(lump + 4 + 4 * i, words[i]);
    for (i = 0; i < kColors; i++) /* red 256 + i, green 128, blue 1, exponent 15 + i */
        Put32(lump + kLumpBytes - 4 * kColors + 4 * i, (uint32_t)((256 + i) | 128 << 9 | 1 << 18 | (15 + i) << 27));
}

static void PutFile(unsigned char *file) {
    unsigned char *entry = file + kHeader + kText + 8;
    memset(file, 0, kFileBytes);
    memcpy(file, "IBSP", 4);
    Put32(file + 4, 46);
    Put32(file + 8, kHeader);
    Put32(file + 12, kText);
    memcpy(file + kHeader + kText, "BSPX", 4);
    Put32(file + kHeader + kText + 4, 2);
    memcpy(entry, "OTHER", 5);
    memcpy(entry + 32, "STATIC_PROP_LIGHT", 17);
    Put32(entry + 24, kLumpAt);
    Put32(entry + 32 + 24, kLumpAt);
    Put32(entry + 32 + 28, kLumpBytes);
    PutLump(file + kLumpAt);
}

static void TestGood(unsigned char *file) {
    staticprops_light light;
    staticprops_prop prop;
    staticprops_mesh mesh;
    float rgb[3];
    PutFile(file);
    CHECK(staticprops_load(file, kFileBytes, &light) == STATICPROPS_OK);
    CHECK(light.propCount == kProps && light.meshCount == kMeshes && light.colorCount == kColors);
    CHECK(staticprops_of_entity(&light, 7, &prop) && prop.nameCrc == 11 && prop.modelCrc == 21);
    CHECK(prop.firstMesh == 2 && prop.meshCount == 1);
    CHECK(staticprops_of_entity(&light, 3, &prop) && prop.meshCount == 2);
    CHECK(!staticprops_of_entity(&light, 4, &prop) && !staticprops_of_entity(&light, 8, &prop));
    mesh = staticprops_get_mesh(&light, 1);
    CHECK(mesh.firstColor == 2 && mesh.colorCount == 2);
    staticprops_color(&light, 0, rgb);
    CHECK(rgb[0] == 0.5f && rgb[1] == 0.25f && rgb[2] == 1.0f / 512);
    staticprops_color(&light, 4, rgb);
    CHECK(fabs(rgb[0] - 260.0 / 32) < 1e-6);
    CHECK(staticprops_crc("123456789", 9) == 0xCBF43926u);
}

static void TestOtherFormats(unsigned char *file) {
    static const char *const idents[2] = {"RBSP", "FBSP"};
    staticprops_light light;
    int i;
    for (i = 0; i < 2; i++) {
        PutFile(file);
        memcpy(file, idents[i], 4);
        CHECK(staticprops_load(file, kFileBytes, &light) == STATICPROPS_NOT_BSP);
        Put32(file + 4, 1);
        CHECK(staticprops_load(file, kFileBytes, &light) == STATICPROPS_OK && light.colorCount == kColors);
        CHECK(staticprops_load(file, kHeader - 1, &light) == STATICPROPS_TRUNCATED);
    }
}

/* Every prefix and every changed byte: a result and no read outside (the sanitizers look). */
static void TestBad(unsigned char *file) {
    staticprops_light light;
    size_t size, i;
    int bit;
    for (size = 0; size < kFileBytes; size++) {
        unsigned char *cut = (unsigned char *)malloc(size ? size : 1);
        PutFile(file);
        memcpy(cut, file, size);
        CHECK(staticprops_load(cut, size, &light) != STATICPROPS_OK);
        CHECK(light.propCount == 0);
        free(cut);
    }
    for (i = 0; i < kFileBytes; i++)
        for (bit = 0; bit < 8; bit++) {
            staticprops_prop prop;
            uint32_t k;
            PutFile(file);
            file[i] = (unsigned char)(file[i] ^ 1 << bit);
            if (staticprops_load(file, kFileBytes, &light) != STATICPROPS_OK)
                continue;
            for (k = 0; k < light.propCount; k++) {
                float rgb[3];
                prop = staticprops_get(&light, k);
                for (; prop.meshCount-- > 0; prop.firstMesh++) {
                    const staticprops_mesh mesh = staticprops_get_mesh(&light, prop.firstMesh);
                    if (mesh.colorCount > 0)
                        staticprops_color(&light, mesh.firstColor + mesh.colorCount - 1, rgb);
                }
            }
        }
    PutFile(file);
    Put32(file + kLumpAt + 4, 2);
    CHECK(staticprops_load(file, kFileBytes, &light) == STATICPROPS_BAD_VERSION);
    PutFile(file);
    Put32(file + kLumpAt + STATICPROPS_HEADER_BYTES + STATICPROPS_PROP_BYTES, 3);
    CHECK(staticprops_load(file, kFileBytes, &light) == STATICPROPS_BAD_ORDER);
    PutFile(file);
    Put32(file + kLumpAt + 16, kColors + 1);
    CHECK(staticprops_load(file, kFileBytes, &light) == STATICPROPS_BAD_LENGTH);
    PutFile(file);
    memcpy(file + kHeader + kText, "NONE", 4);
    CHECK(staticprops_load(file, kFileBytes, &light) == STATICPROPS_ABSENT);
    CHECK(staticprops_message(STATICPROPS_ABSENT)[0] != 0);
}

/* Each result has words of its own. */
static void TestMessages(void) {
    int i;
    for (i = 0; i <= STATICPROPS_BAD_ORDER; i++)
        CHECK(strcmp(staticprops_message((staticprops_result)i), staticprops_message((staticprops_result)(i + 1))) != 0);
    CHECK(strcmp(staticprops_message((staticprops_result)(STATICPROPS_BAD_ORDER + 1)), "unknown result") == 0);
}

int main(void) {
    unsigned char *file = (unsigned char *)malloc(kFileBytes); /* sanitizers guard its ends */
    if (file == NULL)
        return 1;
    TestGood(file);
    TestOtherFormats(file);
    TestBad(file);
    TestMessages();
    free(file);
    return CheckResult();
}
