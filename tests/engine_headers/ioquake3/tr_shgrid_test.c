/* GPL-2.0-or-later. The part of the ioquake3 integration that both renderers share, without the engine. */
#include "tests/engine_headers/check.h"
#include "tr_shgrid.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { kText = 256, kHeader = 8 + 8 * 19, kLump = SHGRID_HEADER_BYTES + SHGRID_POINT_BYTES };
enum { kFile = kHeader + kText + kLump };

static int lines, warnings;
static char lastLine[512];
static cvar_t cvars[3];

/* Stand-ins for functions of the engine. */
static void Print(int level, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(lastLine, sizeof lastLine, format, arguments);
    va_end(arguments);
    lines++;
    warnings += level == PRINT_WARNING;
}

static cvar_t *CvarGet(const char *name, const char *value, int flags) {
    cvar_t *cvar = &cvars[flags == CVAR_CHEAT ? 0 : flags == CVAR_ARCHIVE ? 1 : 2];
    (void)name;
    cvar->integer = atoi(value);
    cvar->string = (char *)value;
    cvar->modificationCount++;
    return cvar;
}

refimport_t ri = {Print, CvarGet};

char *COM_ParseExt(char **data, qboolean allowLineBreak) {
    static char token[MAX_TOKEN_CHARS];
    size_t length = 0;
    char *at = *data;
    while (allowLineBreak && isspace((unsigned char)*at))
        at++;
    if (*at == '"') {
        for (at++; *at && *at != '"'; at++)
            token[length++] = *at;
        at += *at == '"';
    } else {
        while (*at && !isspace((unsigned char)*at))
            token[length++] = *at++;
    }
    token[length] = 0;
    *data = at;
    return token;
}

int Q_stricmp(const char *a, const char *b) {
    while (*a && tolower((unsigned char)*a) == tolower((unsigned char)*b))
        a++, b++;
    return tolower((unsigned char)*a) - tolower((unsigned char)*b);
}

void Q_strncpyz(char *to, const char *from, int size) {
    snprintf(to, (size_t)size, "%s", from);
}

float Com_Clamp(float min, float max, float value) {
    return value < min ? min : value > max ? max : value;
}

float VectorNormalize2(const vec3_t v, vec3_t out) {
    const float length = sqrtf(DotProduct(v, v));
    VectorScale(v, length > 0 ? 1 / length : 0, out);
    return length;
}

float VectorNormalize(vec3_t v) {
    return VectorNormalize2(v, v);
}

/* A version 47 file of one grid point; coefficient k of a channel is (k + 1) / (channel + 2). Memory of its own. */
static byte *MakeFile(const char *keys) {
    byte *file = calloc(1, kFile), *lump = file + kHeader + kText;
    const int header[2] = {47, 0}, entities[2] = {kHeader, kText}, grid[2] = {kHeader + kText, kLump};
    const float place[6] = {0, 0, 0, 64, 64, 64};
    const int32_t counts[4] = {1, 1, 1, 1};
    int k, channel;
    memcpy(file, "IBSP", 4);
    memcpy(file + 4, header, 4);
    memcpy(file + 8, entities, 8);
    memcpy(file + 8 + 8 * 18, grid, 8);
    snprintf((char *)file + kHeader, kText,
             "{\n\"classname\" \"worldspawn\"\n%s\n}\n{\n\"_q3map2_sh\" \"radiance\"\n}\n", keys);
    memcpy(lump, place, sizeof place);
    memcpy(lump + sizeof place, counts, sizeof counts);
    for (k = 0; k < 9; k++)
        for (channel = 0; channel < 3; channel++) {
            const float value = (float)(k + 1) / (float)(channel + 2);
            memcpy(lump + SHGRID_HEADER_BYTES + 12 * k + 4 * channel, &value, 4);
        }
    return file;
}

/* Loads a file of that size and frees it, as the engine does. */
static void Load(const char *keys, long size, int shift) {
    byte *file = MakeFile(keys);
    R_RegisterSHGrid();
    lines = warnings = 0;
    R_LoadSHGrid("maps/x.bsp", file, size, shift);
    free(file);
}

static void TestLoad(void) {
    const vec3_t origin = {10, 20, 30};
    shgrid_lighting lighting;
    Load("", kFile, 0);
    CHECK(lines == 1 && warnings == 0);
    CHECK(strstr(lastLine, "lump 18, 1 points") != NULL);
    CHECK(R_SHGridAt(origin, 0, &lighting) && lighting.rest.c[5][1] == 2 && !shGridWorld.isRadiance &&
          !shGridWorld.hasTone);
    r_shgrid->integer = 0;
    CHECK(!R_SHGridAt(origin, 0, &lighting));
    r_shgrid->integer = 1;
    R_FreeSHGrid();
    CHECK(!R_SHGridAt(origin, 0, &lighting));
    Load("\"_q3map2_sh\" \"radiance\"\n\"_q3map2_tone\" \"gamma 2\"", kFile, 0);
    CHECK(shGridWorld.isRadiance && shGridWorld.hasTone && shGridWorld.tone.gamma == 2);
    CHECK(R_SHGridAt(origin, 0, &lighting) && fabsf(lighting.rest.c[0][0] - 1.5707963f) < 1e-6f);
    R_FreeSHGrid();
    Load("\"_q3map2_tone\" \"gamma none\"", kFile, 0);
    CHECK(warnings == 1 && shGridWorld.grid.points != NULL && !shGridWorld.hasTone);
    R_FreeSHGrid();
    Load("", kFile - 1, 0);
    CHECK(lines == 1 && warnings == 1 && strstr(lastLine, "maps/x.bsp") != NULL);
    CHECK(!R_SHGridAt(origin, 0, &lighting));
}

/* An entity is lit by the grid, unless it has no world or r_shgrid is 0; dynamic lights of the last frame are gone. */
static void TestEntity(void) {
    const vec3_t origin = {10, 20, 30};
    shGridEntity_t ent;
    vec3_t light[3], split[3];
    memset(&ent, 1, sizeof ent);
    Load("", kFile, 0);
    CHECK(R_SetupSHGridEntity(&ent, qtrue, 0, origin, light[0], light[1], light[2]) && ent.lit &&
          ent.lighting.rest.c[5][1] == 2);
    CHECK(DotProduct(ent.dynamicLight, ent.dynamicLight) == 0 && DotProduct(ent.dynamicDir, ent.dynamicDir) == 0);
    R_SHGridSplit(&ent.lighting, split[0], split[1], split[2]);
    CHECK(memcmp(light, split, sizeof split) == 0);
    CHECK(!R_SetupSHGridEntity(&ent, qfalse, 0, origin, light[0], light[1], light[2]) && !ent.lit);
    r_shgrid->integer = 0;
    CHECK(!R_SetupSHGridEntity(&ent, qtrue, 0, origin, light[0], light[1], light[2]) && !ent.lit);
    r_shgrid->integer = 1;
    R_FreeSHGrid();
}

/* Coefficients in the axes of a model, which may have any length, against normals in map axes. */
static void TestTurn(void) {
    const vec3_t axis[3] = {{0.48f, 0.64f, -0.6f}, {-1.6f, 1.2f, 0}, {0.36f * 3, 0.48f * 3, 0.8f * 3}};
    shgrid_lighting lighting = {.count = 1, .direct = {{{0.6f, 0, 0.8f}, {1, 0.5f, 0.25f}, 0.1f, 7, 3}}}, turned;
    int i, j, k, channel;
    for (k = 0; k < 9; k++)
        for (channel = 0; channel < 3; channel++)
            lighting.rest.c[k][channel] = k ? 0.1f * (float)((7 * k + 3 * channel) % 11 - 5) : 8.0f;
    turned = lighting;
    R_SHGridTurn(&turned, axis);
    CHECK(turned.count == 1 && turned.direct[0].style == 7 && turned.direct[0].light == 3);
    for (i = 0; i < 200; i++) {
        const float z = cosf(0.1f * (float)i), r = sinf(0.1f * (float)i);
        const vec3_t normal = {r * cosf((float)i), r * sinf((float)i), z};
        vec3_t inMap = {0, 0, 0}, fromModel, fromMap;
        for (j = 0; j < 3; j++)
            for (k = 0; k < 3; k++)
                inMap[k] += normal[j] * axis[j][k] / sqrtf(DotProduct(axis[j], axis[j]));
        shgrid_shade(&turned, normal, fromModel);
        shgrid_shade(&lighting, inMap, fromMap);
        for (channel = 0; channel < 3; channel++)
            CHECK(fabsf(fromModel[channel] - fromMap[channel]) < 2e-6f);
    }
}

/* Light of one color from direction +x, and uniform light of another. */
static void MakeLight(const vec3_t color, const vec3_t even, shgrid_coeffs *coeffs) {
    const float pi = 3.14159265f;
    int channel;
    memset(coeffs, 0, sizeof *coeffs);
    for (channel = 0; channel < 3; channel++) {
        coeffs->c[0][channel] = pi * 0.2820948f * color[channel] + even[channel] / 0.2820948f;
        coeffs->c[3][channel] = 2 * pi / 3 * 0.4886025f * color[channel];
        coeffs->c[6][channel] = pi / 4 * -0.3153916f * color[channel];
        coeffs->c[8][channel] = pi / 4 * 0.5462742f * color[channel];
    }
}

static void TestScale(void) {
    const vec3_t color = {0.4f, 0.2f, 0.1f}, even = {0.1f, 0.05f, 0}, away = {-1, 0, 0}, toward = {1, 0, 0};
    shgrid_lighting lighting = {.count = 0};
    vec3_t ambient, directed, dir, rgb;
    int channel;
    MakeLight(color, even, &lighting.rest);
    Load("", kFile, 0);
    R_SHGridSplit(&lighting, ambient, directed, dir);
    for (channel = 0; channel < 3; channel++) {
        CHECK(fabsf(ambient[channel] - 255 * even[channel]) < 1e-3f);
        CHECK(fabsf(directed[channel] - 255 * color[channel]) < 1e-3f);
        CHECK(fabsf(dir[channel] - toward[channel]) < 1e-6f);
    }
    R_SHGridLight(&lighting, away, rgb); /* 0.0625 = 0.09375 - 0.5 + 0.46875: docs/engines/conformance.md */
    CHECK(fabsf(rgb[0] - 255 * (0.1f + 0.0625f * 0.4f)) < 1e-3f);
    R_FreeSHGrid();
    /* With an overbright shift of 2 light is above 255, and is scaled down keeping its hue. */
    Load("", kFile, 2);
    R_SHGridLight(&lighting, toward, rgb);
    CHECK(fabsf(rgb[0] - 255) < 1e-3f && fabsf(rgb[1] - 127.5f) < 0.1f);
    CHECK(fabsf(rgb[2] / rgb[0] - 0.10625f / 0.525f) < 1e-5f);
    R_FreeSHGrid();
    /* Gamma 2 acts on light before the shift. */
    Load("\"_q3map2_tone\" \"gamma 2 scale 0.25\"", kFile, 1);
    R_SHGridLight(&lighting, toward, rgb);
    CHECK(fabsf(rgb[0] - 2 * 255 * 0.25f * sqrtf(0.525f)) < 1e-2f);
    R_FreeSHGrid();
}

/* Directed light has the direction of the strongest named light, and its color; other light that comes from there is
   added, and the rest is ambient. */
static void TestNamedLights(void) {
    const vec3_t none = {0, 0, 0}, even = {0.1f, 0.05f, 0}, normal = {0.6f, 0, 0.8f};
    shgrid_lighting lighting = {
        .count = 2, .direct = {{{0, 1, 0}, {0.2f, 0, 0}, 0, 0, 0}, {{0, 0, 1}, {0.4f, 0.2f, 0.1f}, 0, 0, 1}}};
    vec3_t ambient, directed, dir, rgb, many[2];
    Load("", kFile, 0);
    MakeLight(none, even, &lighting.rest);
    R_SHGridSplit(&lighting, ambient, directed, dir);
    CHECK(dir[0] == 0 && dir[1] == 0 && dir[2] == 1);
    CHECK(fabsf(directed[0] - 255 * 0.4f) < 1e-3f && fabsf(directed[2] - 255 * 0.1f) < 1e-3f);
    CHECK(fabsf(ambient[0] - 255 * (0.1f + 0.2f / 4)) < 1e-3f && fabsf(ambient[1] - 255 * 0.05f) < 1e-3f);
    R_SHGridLight(&lighting, normal, rgb);
    CHECK(fabsf(rgb[0] - 255 * (0.1f + 0.4f * 0.8f)) < 1e-3f);
    R_SHGridLightMany(&lighting, normal, 0, 2, many);
    CHECK(memcmp(many[0], many[1], sizeof rgb) == 0 && fabsf(many[0][1] - rgb[1]) < 1e-4f);
    /* Without names it is the mean direction. */
    shgrid_limit_lights(&lighting, 0);
    R_SHGridSplit(&lighting, ambient, directed, dir);
    CHECK(lighting.count == 0 && dir[1] > 0.2f && dir[2] > 0.9f);
    R_FreeSHGrid();
}

static void SetStyles(const char *words) {
    r_shgridStyles->string = (char *)words;
    r_shgridStyles->modificationCount++;
}

static void TestStyles(void) {
    Load("", kFile, 0);
    CHECK(R_SHGridStyles(0)[0] == 1 && R_SHGridStyles(0)[63] == 1);
    SetStyles("1:az 2:mmamz 64:a -1:a 3: 4:?");
    CHECK(R_SHGridStyles(0)[1] == 0 && R_SHGridStyles(99)[1] == 0);
    CHECK(fabsf(R_SHGridStyles(100)[1] - 25.0f / 12) < 1e-6f && R_SHGridStyles(200)[1] == 0);
    CHECK(R_SHGridStyles(200)[2] == 0 && R_SHGridStyles(799)[2] == 0 && R_SHGridStyles(800)[2] == 1);
    CHECK(R_SHGridStyles(0)[0] == 1 && R_SHGridStyles(0)[3] == 1 && R_SHGridStyles(0)[4] == 1);
    /* All styles at once, which light without a style is not a part of. */
    SetStyles("0 5:m");
    CHECK(R_SHGridStyles(0)[0] == 1 && R_SHGridStyles(0)[1] == 0 && R_SHGridStyles(0)[5] == 1);
    SetStyles("a");
    CHECK(R_SHGridStyles(0)[63] == 0);
    SetStyles("");
    CHECK(R_SHGridStyles(0)[63] == 1);
    R_FreeSHGrid();
}

int main(void) {
    TestLoad();
    TestEntity();
    TestTurn();
    TestScale();
    TestNamedLights();
    TestStyles();
    return CheckResult();
}
