/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "order.h"

#include <math.h>

double sf_order_fit(int levels, const double *h, const double *error, int count) {
    double x = 0, y = 0, xx = 0, xy = 0;
    for (int k = levels - count; k < levels; k++) {
        if (!(h[k] > 0) || !(error[k] > 0))
            return NAN;
        x += log(h[k]);
        y += log(error[k]);
        xx += log(h[k]) * log(h[k]);
        xy += log(h[k]) * log(error[k]);
    }
    return (count * xy - x * y) / (count * xx - x * x);
}
