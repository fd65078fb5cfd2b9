/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparisons of doubles for the tests of src/post: cmocka 1.1.5 compares in single precision. Include after
 * the header of cmocka. */
#ifndef SF_TESTS_POST_CHECK_H
#define SF_TESTS_POST_CHECK_H

#include <math.h>

#define assert_close(value, expected, tolerance)                                                             \
    do {                                                                                                     \
        double close_value = (value), close_expected = (expected);                                           \
        if (!(fabs(close_value - close_expected) <= (tolerance)))                                            \
            fail_msg("%s = %.17g, expected %.17g +- %.3g", #value, close_value, close_expected,              \
                     (double)(tolerance));                                                                   \
    } while (0)

#define assert_relative(value, expected, tolerance) assert_close((value) / (expected), 1, (tolerance))

#endif
