/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/fit_check.h"

#include "material/point.h"
#include "material/low_density_foam.h"
#include <math.h>
#include <stdlib.h>

static const double CARD_STEP = 5e-4; /* strain, of the check by the solver's law */

static double counted(const sf_compression_fit *fit, int i) {
    const sf_compression_test *t = &fit->data.config->test[fit->data.test[i]];
    return fmax(fabs(fit->stress[i]), 0.01 * t->largest_stress);
}

static void compare_data(const sf_compression_fit *fit, sf_compression_check *check) {
    const sf_compression_data *d = &fit->data;
    for (int k = 0; k < d->config->test_count; k++)
        for (int side = 0; side < 2; side++) {
            int first, count;
            double sum = 0, relative = 0;
            sf_compression_branch(d, k, side == 1, &first, &count);
            for (int i = first; i < first + count; i++) {
                double deviation = d->stress[i] - fit->stress[i];
                sum += pow(deviation / d->sigma[i], 2);
                relative += pow(deviation / counted(fit, i), 2);
            }
            check->rms[k][side] = count ? sqrt(sum / count) : NAN;
            check->percent[k][side] = count ? 100 * sqrt(relative / count) : NAN;
        }
}

static sf_status compare_card(const sf_compression_fit *fit, const sf_foam_card *card,
                              sf_compression_check *check, sf_error *err) {
    const sf_compression_data *d = &fit->data;
    const sf_material material = sf_foam_material(card);
    sf_material_law law;
    if (sf_material_law_build(&material, &law, err) != SF_OK)
        return err->status;
    double *stress = sf_alloc(err, (unsigned long)d->count, sizeof *stress, "stresses of the card");
    for (int k = 0, first = 0; stress && k < d->config->test_count; k++) {
        const sf_compression_test *t = &d->config->test[k];
        sf_material_point_drive(&law, t->rate, CARD_STEP, t->count, &d->strain[first], &stress[first]);
        for (int i = first; i < first + t->count; i++)
            check->card_percent =
                fmax(check->card_percent, 100 * fabs(stress[i] - fit->stress[i]) / counted(fit, i));
        first += t->count;
    }
    free(stress);
    sf_material_law_free(&law);
    return err->status;
}

sf_status sf_compression_check_card(const sf_compression_fit *fit, const sf_foam_card *card,
                                    sf_compression_check *check, sf_error *err) {
    compare_data(fit, check);
    return compare_card(fit, card, check, err);
}
