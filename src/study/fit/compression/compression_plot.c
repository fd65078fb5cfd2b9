/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fit.png: data against fit over the whole range and at the foot, deviations below. */
#include "study/fit/compression/compression_plot.h"

#include "report/gnuplot.h"
#include <math.h>

/* Light to dark with the rate: points, lines. */
static const char *const POINT[SF_COMPRESSION_TESTS] = {"#9ecae1", "#fdae6b", "#a1d99b", "#bcbddc",
                                                        "#fa9fb5", "#bdbdbd", "#d8b365", "#80cdc1"};
static const char *const LINE[SF_COMPRESSION_TESTS] = {"#08519c", "#a63603", "#006d2c", "#54278f",
                                                       "#7a0177", "#252525", "#8c510a", "#01665e"};

/* Points and lines of every test. */
static void put_tests(FILE *g, const sf_compression_fit *fit, bool titles) {
    int tests = fit->data.config->test_count;
    fputs("plot ", g);
    for (int k = 0; k < tests; k++)
        fprintf(
            g,
            "'fit.csv' skip 1 using ($1 == %d ? $3 : NaN):4 with points pt 7 ps 0.9*dot lc rgb '%s' notitle, "
            "\\\n     ",
            k + 1, POINT[k]);
    for (int k = 0; k < tests; k++) {
        fprintf(g, "'fit.csv' skip 1 using ($1 == %d ? $3 : NaN):5 with lines lw 1.8 lc rgb '%s' ", k + 1,
                LINE[k]);
        if (titles)
            fprintf(g, "title 'fit at %.3g 1/s'", fit->data.config->test[k].rate);
        else
            fputs("notitle", g);
        fputs(k + 1 < tests ? ", \\\n     " : "\n", g);
    }
}

/* Stress up to which the panel of the foot reaches: the loading curve at half the largest strain, kPa. */
static double foot_stress(const sf_compression_fit *fit) {
    int k = 0, last = fit->rate_count - 1;
    while (k + 1 < fit->table_count && fit->table_strain[k] < 0.5 * fit->data.end)
        k++;
    return 1.3e-3 * fit->table_stress[last][k];
}

static void put_deviations(FILE *g, const sf_compression_fit *fit) {
    int tests = fit->data.config->test_count;
    double largest = 3;
    for (int i = 0; i < fit->data.count; i++)
        largest = fmax(largest, fabs(fit->data.stress[i] - fit->stress[i]) / fit->data.sigma[i]);
    fprintf(g, "set yrange [%.4g:%.4g]\nset ylabel 'deviation / scatter'\n", -1.08 * largest, 1.08 * largest);
    fputs("set title 'Deviation of the data from the fit, over the standard deviation of the scatter (band: "
          "±2)'\n"
          "set key top center horizontal samplen 1\n"
          "set object 1 rectangle from graph 0, first -2 to graph 1, first 2 fc rgb '#f0f0f0' fs solid "
          "noborder behind\nplot ",
          g);
    for (int k = 0; k < tests; k++)
        for (int side = 0; side < 2; side++) {
            const char *branch = side ? "unloading" : "loading";
            fprintf(g,
                    "'fit.csv' skip 1 using ($1 == %d && strcol(2) eq '%s' ? $3 : NaN):7 with points pt %d "
                    "ps 0.7*dot lc rgb '%s' ",
                    k + 1, branch, side ? 6 : 7, side ? POINT[k] : LINE[k]);
            if (k == 0)
                fprintf(g, "title '%s', \\\n     ", branch);
            else
                fputs("notitle, \\\n     ", g);
        }
    fputs("0 with lines lw 1.5 lc rgb '#404040' notitle\n", g);
}

sf_status sf_compression_write_plot(const sf_staging *output, const sf_compression_fit *fit, char *warning,
                                    size_t size, sf_error *err) {
    FILE *g = sf_gnuplot_begin(output, "fit", 1700, 1350, err);
    if (!g)
        return err->status;
    double end = fit->data.end;
    fputs("set xlabel 'compressive strain'\nset xtics 0.1\n", g);
    fprintf(g, "set multiplot title '%s: compression tests (points) and fit (lines)'\n",
            fit->data.config->name);
    fprintf(g, "set xrange [0:%.6g]\nset yrange [0:*]\n", 1.02 * end);
    fputs("set size 0.5,0.56\nset origin 0,0.39\nset ylabel 'nominal stress (kPa)'\nset title 'whole range'\n"
          "set key top left Left reverse samplen 2\n",
          g);
    put_tests(g, fit, true);
    fprintf(g,
            "set origin 0.5,0.39\nset title 'foot and plateau'\nset xrange [0:%.6g]\nset yrange [0:%.6g]\n",
            0.6 * end, foot_stress(fit));
    put_tests(g, fit, false);
    fprintf(g, "set size 1,0.39\nset origin 0,0\nset xrange [0:%.6g]\n", 1.02 * end);
    put_deviations(g, fit);
    fputs("unset multiplot\n", g);
    if (sf_staging_close(g, "fit.gp", err) != SF_OK)
        return err->status;
    sf_gnuplot_draw(output, "fit", warning, size);
    return SF_OK;
}
