/* GPL-2.0-or-later. What tr_shgrid.c uses of the engine: the engine's own names and meanings, as little as it needs. */
#ifndef TR_COMMON_H
#define TR_COMMON_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#define M_PI 3.14159265358979323846f
#define MAX_TOKEN_CHARS 1024
#define CVAR_ARCHIVE 0x0001
#define CVAR_CHEAT 0x0200
#define MAX(x, y) ((x) > (y) ? (x) : (y))
#define MIN(x, y) ((x) < (y) ? (x) : (y))
#define DotProduct(x, y) ((x)[0] * (y)[0] + (x)[1] * (y)[1] + (x)[2] * (y)[2])
#define VectorSubtract(a, b, c) ((c)[0] = (a)[0] - (b)[0], (c)[1] = (a)[1] - (b)[1], (c)[2] = (a)[2] - (b)[2])
#define VectorScale(v, s, o) ((o)[0] = (v)[0] * (s), (o)[1] = (v)[1] * (s), (o)[2] = (v)[2] * (s))
#define VectorMA(v, s, b, o)                                                                                           \
    ((o)[0] = (v)[0] + (b)[0] * (s), (o)[1] = (v)[1] + (b)[1] * (s), (o)[2] = (v)[2] + (b)[2] * (s))
#define VectorSet(v, x, y, z) ((v)[0] = (x), (v)[1] = (y), (v)[2] = (z))
#define VectorClear(v) VectorSet(v, 0, 0, 0)
#define Com_Memset memset
#define Com_Memcpy memcpy
#define LittleLong(x) (x)

typedef enum { qfalse, qtrue } qboolean;
typedef unsigned char byte;
typedef float vec3_t[3];
typedef struct {
    int integer, modificationCount;
    char *string;
} cvar_t;
typedef enum { PRINT_ALL, PRINT_DEVELOPER, PRINT_WARNING } printParm_t;
typedef struct {
    void (*Printf)(int level, const char *format, ...);
    cvar_t *(*Cvar_Get)(const char *name, const char *value, int flags);
} refimport_t;

extern refimport_t ri;

char *COM_ParseExt(char **data, qboolean allowLineBreak);
int Q_stricmp(const char *a, const char *b);
void Q_strncpyz(char *to, const char *from, int size);
float Com_Clamp(float min, float max, float value);
float VectorNormalize(vec3_t v);
float VectorNormalize2(const vec3_t v, vec3_t out);

#endif
