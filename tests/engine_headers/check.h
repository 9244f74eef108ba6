/* GPL-2.0-or-later. Checks of the tests in C: a check that does not hold prints its file and line and goes on. */
#ifndef Q3_TESTS_CHECK_H
#define Q3_TESTS_CHECK_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>

/* Checks that did not hold. Each test is one source. */
static int failures;

#define CHECK(condition) Check((condition) ? 1 : 0, #condition, __FILE__, __LINE__)
#define CHECK_NEAR(got, expected, tolerance) CheckNear(got, expected, tolerance, __FILE__, __LINE__)

static inline void Check(int holds, const char *what, const char *file, int line) {
    if (!holds) {
        printf("%s:%d: does not hold: %s\n", file, line, what);
        failures++;
    }
}

/* Not a number is near nothing. */
static inline void CheckNear(double got, double expected, double tolerance, const char *file, int line) {
    if (!(fabs(got - expected) < tolerance)) {
        printf("%s:%d: %g, expected %g\n", file, line, got, expected);
        failures++;
    }
}

/* What main returns. */
static int CheckResult(void) {
    if (failures == 0)
        printf("all checks hold\n");
    return failures != 0;
}

/* Bytes of a number as files have it, lowest first. */
static inline void Put32(unsigned char *at, uint32_t value) {
    int byte;
    for (byte = 0; byte < 4; byte++)
        at[byte] = (unsigned char)(value >> (8 * byte));
}

#endif
