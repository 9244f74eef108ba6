/* GPL-2.0-or-later. What the viewer should show of an SH light grid, by the reader for engines.

   usage: probe FILE.bsp uniform|sparse [TONE]
   TONE is the worldspawn key _q3map2_tone. Reads lines "x y z nx ny nz", a position and a unit normal. For each it
   writes the 27 coefficients there and the light on that normal as displayed: three bytes, not rounded. */
#include "libs/shgrid/shgrid.h"

#include <stdio.h>
#include <stdlib.h>

static unsigned char *ReadFile(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    if (file == NULL)
        return NULL;
    if (fseek(file, 0, SEEK_END) == 0) {
        *size = (size_t)ftell(file);
        rewind(file);
        bytes = (unsigned char *)malloc(*size);
        if (bytes != NULL && fread(bytes, 1, *size, file) != *size) {
            free(bytes);
            bytes = NULL;
        }
    }
    fclose(file);
    return bytes;
}

/* Light of the map to bytes on the screen: a bit of overbright on loading, which keeps the hue of what is too bright,
   and one on display, which cuts each channel. */
static void Display(float rgb[3]) {
    float most = 1;
    int i;
    for (i = 0; i < 3; i++) {
        rgb[i] *= 2;
        most = rgb[i] > most ? rgb[i] : most;
    }
    for (i = 0; i < 3; i++) {
        rgb[i] = 2 * rgb[i] / most;
        rgb[i] = 255 * (rgb[i] < 1 ? rgb[i] : 1);
    }
}

int main(int argc, char **argv) {
    shgrid_grid grid;
    shgrid_tone tone;
    float position[3], normal[3];
    size_t size = 0;
    unsigned char *file = argc >= 3 ? ReadFile(argv[1], &size) : NULL;
    const shgrid_form form = argc >= 3 && strcmp(argv[2], "sparse") == 0 ? SHGRID_SPARSE : SHGRID_UNIFORM;
    if (file == NULL || shgrid_load_form(file, size, form, &grid) != SHGRID_OK ||
        shgrid_parse_tone(argc > 3 ? argv[3] : NULL, &tone) != SHGRID_OK) {
        fprintf(stderr, "usage: probe FILE.bsp uniform|sparse [TONE]; the map must have that grid\n");
        return 1;
    }
    while (scanf("%f %f %f %f %f %f", position, position + 1, position + 2, normal, normal + 1, normal + 2) == 6) {
        shgrid_coeffs coeffs;
        float rgb[3];
        int k;
        shgrid_sample(&grid, position, &coeffs);
        shgrid_evaluate(&coeffs, normal, rgb);
        shgrid_apply_tone(&tone, rgb);
        Display(rgb);
        for (k = 0; k < 27; k++)
            printf("%.9g ", (double)coeffs.c[k / 3][k % 3]);
        printf("%.9g %.9g %.9g\n", (double)rgb[0], (double)rgb[1], (double)rgb[2]);
    }
    free(file);
    return 0;
}
