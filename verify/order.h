/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Observed order of convergence. */
#ifndef SF_VERIFY_ORDER_H
#define SF_VERIFY_ORDER_H

/* Slope of the least-squares line through (log h, log error) of the last `count` of `levels` measurements;
 * NAN if one of them is not positive. */
double sf_order_fit(int levels, const double *h, const double *error, int count);

#endif
