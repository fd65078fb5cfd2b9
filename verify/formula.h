/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A compression curve given by a formula, for comparisons in closed form: a yield, a plateau and a rise,
 * known to the program as a table up to 80 % strain, where its densification law H1 takes over. */
#ifndef SF_VERIFY_FORMULA_H
#define SF_VERIFY_FORMULA_H

#include "material/foam_card.h"

/* Nominal stress (Pa), slope (Pa) and energy (J m-3, by quadrature) at a compressive strain below 1; beyond
 * 80 % the densification law that continues the formula. */
double sf_formula_stress(double strain);
double sf_formula_slope(double strain);
double sf_formula_energy(double strain);

/* Puts tables of it into the card: `curves` of them, multiplied by `factor`, at `rate` (s-1). The card's
 * arrays are replaced; densification is H1 from the table's end. */
void sf_formula_table(sf_foam_card *card, int curves, const double *rate, const double *factor);

#endif
