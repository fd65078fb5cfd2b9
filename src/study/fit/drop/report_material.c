/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/report_parts.h"

#include "build_info.h"
#include "study/material_file.h"
#include "study/fit/drop/inference_report.h"
#include "material/foam.h"
#include <math.h>
#include <stdlib.h>

/* " a_max 59.2 g measured, 58.9 simulated;" */
static void put_comment(FILE *f, const sf_drop_fit *fit, int d, int kind) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    fprintf(f, " %s %.4g%s%s measured, %.*f simulated;", about->name, fit->input->drop[d].value[kind],
            *about->unit ? " " : "", about->unit, about->digits, sf_report_response(fit, d, kind));
}

sf_status sf_report_material(const sf_drop_fit *fit, const sf_drop_average *average, const char *input_path,
                             const sf_staging *output, sf_error *err) {
    char *provenance = NULL;
    size_t size = 0;
    sf_foam_card card;
    FILE *f = open_memstream(&provenance, &size);
    if (!f)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the material's comments");
    fprintf(f, "Identified by softfall-fit drop %s from %s; everything else is that of its start material.\n",
            SF_VERSION, input_path);
    if (average)
        sf_inference_comment(f, average);
    for (int d = 0; d < fit->input->drop_count && !fit->input->drop[d].predicted; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        fprintf(f, "%s:", drop->name);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (!isnan(drop->value[kind]))
                put_comment(f, fit, d, kind);
        if (drop->samples > 0)
            fprintf(f, " measured curve, RMSE %.2f g;", sf_report_curve_rmse(fit, d));
        fputc('\n', f);
    }
    for (int t = 0; t < fit->input->joint.test_count; t++)
        fprintf(f, "Compression test %s, %.4g 1/s.\n", fit->input->joint.test[t].name,
                fit->input->joint.test[t].rate);
    for (int c = 0; c < fit->input->joint.cushion_count; c++)
        fprintf(f, "Cushion curve %s, %d points.\n", fit->input->joint.cushion[c].name,
                fit->input->joint.cushion[c].count);
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_estimate_shown e = sf_report_estimate(fit, k);
        double s = e.about->per_unit;
        fprintf(f, "%s = %.4g%s%s (95 %%, linearised: %.4g to %.4g; %s)\n", e.about->name, e.value / s,
                *e.about->unit ? " " : "", e.about->unit, e.low / s, e.high / s, e.about->description);
    }
    double low, high;
    sf_report_informed_strains(fit, &low, &high);
    fprintf(f,
            "The drops inform the curve between strains of %.2f and %.2f; beyond, its form "
            "determines it.\n",
            low, high);
    fprintf(f, "Curve: %s.\n", fit->input->form.curve->formula);
    if (fclose(f) != 0)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the material's comments");
    const sf_material_text text = {.title = fit->input->title, .provenance = provenance};
    if (err->status == SF_OK && sf_drop_fit_card(fit->input, fit->result.u, &card, err) == SF_OK) {
        card.informed_strain = high;
        const sf_material material = sf_foam_material(&card);
        sf_material_write_checked(output->aside, fit->input->material_name, &material, &text, err);
        sf_foam_card_free(&card);
    }
    free(provenance);
    return err->status;
}
