/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/report_parts.h"

#include "report/gnuplot.h"
#include <math.h>

static double peak_time_ms(const sf_series *curve) {
    int64_t at = 0;
    for (int64_t k = 1; k < curve->count; k++)
        if (curve->value[k] > curve->value[at])
            at = k;
    return 1e3 * curve->time[at];
}

static void put_strain_panels(FILE *f) {
    fputs(
        "set size 0.5,0.5\nset origin 0,0.46\nset xtics 0.2\n"
        "set key left top Left reverse samplen 2\nset xlabel 'engineering strain'\nset xrange [0:0.95]\n"
        "set ylabel 'nominal stress (kPa)'\nset logscale y\n"
        "plot 'fit-curve.csv' skip 1 u 1:3:4 w filledcurves fc rgb '#c6dbef' t '95 %', '' skip 1 u 1:2 w l "
        "lw 3 lc rgb '#08519c' t 'loading curve'\n"
        "unset logscale y\nset origin 0.5,0.46\nunset key\nset ylabel 'information of the drops (share)'\nset yrange [0:*]\n"
        "set boxwidth 0.045\nset style fill solid 0.6\n"
        "plot 'fit-curve.csv' skip 1 u 1:5 w boxes lc rgb '#fd8d3c' t 'information by strain'\n",
        f);
}

/* Simulated curves; a circle at each measured peak. */
static void put_drop_panel(FILE *f, const sf_drop_fit *fit) {
    fputs(
        "set size 1,0.46\nset origin 0,0\nset autoscale\nset xtics auto\nset xrange [0:*]\nset yrange [0:*]\nset xlabel 'time after contact (ms)'\n"
        "set ylabel 'acceleration (g)'\nset key on\n",
        f);
    sf_gnuplot_key(f, fit->input->drop_count + 1, 3);
    for (int d = 0; d < fit->measured_drops; d++)
        if (!isnan(fit->input->drop[d].value[SF_FIT_A_MAX]))
            fprintf(f, "set label '' at %.6g,%.6g point pt 6 ps 2*dot lw 2 lc %d\n",
                    peak_time_ms(&fit->simulated[d].curve), fit->input->drop[d].value[SF_FIT_A_MAX], d + 1);
    fputs("plot ", f);
    for (int d = 0; d < fit->input->drop_count; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        fprintf(f, "'fit-drops.csv' index %d u 1:2 w l lw 3 dt %d lc %d t '%s%s', ", d,
                drop->predicted ? 2 : 1, d + 1, drop->name, drop->predicted ? " (predicted)" : "");
    }
    fputs("NaN w p pt 6 ps 2*dot lw 2 lc rgb '#404040' t 'measured peak'\n", f);
}

sf_status sf_report_picture(const sf_drop_fit *fit, const sf_staging *output, sf_error *err) {
    FILE *f = sf_gnuplot_begin(output, "fit", 1700, 1350, err);
    if (!f)
        return err->status;
    fprintf(f, "set multiplot title 'Identification from drops: %s'\n", fit->input->material_name);
    put_strain_panels(f);
    if (fit->input->drop_count > 0)
        put_drop_panel(f, fit);
    fputs("unset multiplot\n", f);
    return sf_staging_close(f, "fit.gp", err);
}
