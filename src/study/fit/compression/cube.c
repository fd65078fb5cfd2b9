/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/cube.h"

#include "study/material_file.h"
#include "study/runner.h"
#include "material/point.h"
#include "io/replace.h"
#include "post/results/results.h"
#include "material/low_density_foam.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SIMULATED_RATE =
    2; /* s-1: inertia below a thousandth of the largest stress, seconds of CPU */
static const double SIMULATED_DAMP = 0.35; /* stills the vibrations of the start; adds less than inertia */
static const double POINT_STEP = 5e-4;     /* strain */

enum { TEXT = PATH_MAX + 64, CELLS = 6 }; /* cells along an edge: the law has no Poisson effect */

/* ---- inputs of a simulated test ---- */

/* The same foam in a time that runs k times faster. The filter of the rate, which a test of seconds or
 * minutes does not notice, stays: without it every vibration of the cube would choose among the curves. */
static sf_foam_card quicken(const sf_foam_card *card, double k, double *rates) {
    sf_foam_card fast = *card;
    for (int64_t r = 0; r < card->curve_count; r++)
        rates[r] = k * card->curve_rate[r];
    fast.curve_rate = rates;
    fast.maxwell_rate = k * card->maxwell_rate;
    fast.kelvin_viscosity = card->kelvin_viscosity / k;
    fast.damp = fmax(card->damp, SIMULATED_DAMP);
    fast.informed_strain = 0;
    return fast;
}

static sf_status write_motion(const char *path, double displacement, double turn_time, sf_error *err) {
    sf_replacement out;
    FILE *file = sf_replace_open(path, &out, err);
    if (!file)
        return err->status;
    fprintf(file, "time_s,displacement_m\n0,0\n%.12g,%.12g\n%.12g,0\n", turn_time, displacement,
            2 * turn_time);
    return sf_replace_close(&out, err);
}

static sf_status check_specimen(const sf_compression_config *c, sf_error *err) {
    bool square =
        !(c->specimen.width > 0) || fabs(c->specimen.width - c->specimen.side) <= 1e-9 * c->specimen.side;
    if (!(square && c->specimen.side > 0 &&
          fabs(c->specimen.side - c->specimen.thickness) <= 1e-9 * c->specimen.side))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "the simulated specimen is a cube: give specimen = { side = \"50 mm\"; thickness = "
                       "\"50 mm\"; } with equal lengths (they are %g mm and %g mm)",
                       1e3 * c->specimen.side, 1e3 * c->specimen.thickness);
    return SF_OK;
}

/* ---- results ---- */

/* Means of strain and stress over blocks of equal time; blocks do not cross the turn. */
static void average(const sf_results *r, double area, double turn_time, sf_cube_test *test) {
    const double *time = r->history.time;
    int64_t row = 1;
    test->count = 0;
    for (int b = 0; b < 2 * SF_CUBE_BLOCKS; b++) {
        double end = turn_time * (b + 1) / SF_CUBE_BLOCKS, strain = 0, stress = 0, weight = 0;
        for (; row < r->history.rows && time[row] <= end * (1 + 1e-9); row++) {
            double span = time[row] - time[row - 1];
            strain += span * r->history.indentation[row] / r->thickness;
            stress += span * r->history.contact_force[row] / area;
            weight += span;
        }
        if (!(weight > 0))
            continue;
        test->strain[test->count] = strain / weight;
        test->cube[test->count++] = stress / weight;
    }
}

/* The material point goes through the same strains, and through the turn between them. */
static sf_status compare(const sf_foam_card *card, double rate, double turn, sf_cube_test *test,
                         sf_error *err) {
    double strain[2 * SF_CUBE_BLOCKS + 1], stress[2 * SF_CUBE_BLOCKS + 1], largest = 0;
    int loading = test->count < SF_CUBE_BLOCKS ? test->count : SF_CUBE_BLOCKS;
    sf_foam_card point = *card;
    const sf_material material = sf_foam_material(&point);
    sf_material_law law;
    point.damp = 0;
    if (sf_material_law_build(&material, &law, err) != SF_OK)
        return err->status;
    memcpy(strain, test->strain, (size_t)loading * sizeof *strain);
    strain[loading] = turn;
    memcpy(&strain[loading + 1], &test->strain[loading], (size_t)(test->count - loading) * sizeof *strain);
    sf_material_point_drive(&law, rate, POINT_STEP, test->count + 1, strain, stress);
    sf_material_law_free(&law);
    for (int i = 0; i < test->count; i++) {
        test->point[i] = stress[i < loading ? i : i + 1];
        largest = fmax(largest, test->point[i]);
    }
    for (int i = 0; i < test->count; i++) {
        double *percent = &test->percent[i >= loading];
        *percent =
            fmax(*percent, 100 * fabs(test->cube[i] - test->point[i]) / fmax(test->point[i], 0.01 * largest));
    }
    return SF_OK;
}

static sf_status read_test(const char *path, const sf_foam_card *card, const sf_compression_test *lab,
                           double turn_time, sf_cube_test *test, sf_error *err) {
    sf_results r;
    if (sf_results_open(path, &r, err) != SF_OK)
        return err->status;
    average(&r, sf_results_cross_section(&r), turn_time, test);
    sf_results_close(&r);
    return compare(card, lab->rate, lab->largest_strain, test, err);
}

/* ---- runs ---- */

static sf_status simulate(const sf_compression_fit *fit, const sf_foam_card *card,
                          const sf_cube_options *options, const char *folder, int index, sf_cube_test *test,
                          sf_error *err) {
    static const sf_material_text text = {
        .title = "The fitted foam in a time that runs faster: for the simulated test only", .provenance = ""};
    const sf_compression_config *c = fit->data.config;
    const sf_compression_test *lab = &c->test[index];
    double rates[SF_COMPRESSION_TESTS], turn_time = lab->largest_strain / SIMULATED_RATE;
    char real[PATH_MAX], name[32], motion[TEXT], material[TEXT], side[64], spacing[64], end[64], friction[64],
        moved[TEXT + 32];
    *test = (sf_cube_test){.speed_up = SIMULATED_RATE / lab->rate};
    const sf_foam_card fast = quicken(card, test->speed_up, rates);
    const sf_material quick = sf_foam_material(&fast);
    if (!realpath(folder, real))
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be found: %s", folder, strerror(errno));
    snprintf(name, sizeof name, "test-%d", index + 1);
    snprintf(motion, sizeof motion, "%s/%s-motion.csv", real, name);
    snprintf(material, sizeof material, "%s/%s.cfg", real, name);
    snprintf(moved, sizeof moved, "missile.motion=%s", motion);
    snprintf(side, sizeof side, "geometry.parameters.side=%.12g", 1e3 * c->specimen.side);
    snprintf(spacing, sizeof spacing, "geometry.parameters.spacing=%.12g", 1e3 * c->specimen.side / CELLS);
    snprintf(end, sizeof end, "solver.end_time=%.12g s", 2 * turn_time);
    sf_runner runner = {.folder = real, .threads = 1};
    sf_runner_drop drop = {.label = name,
                           .case_path = options->case_path,
                           .material = material,
                           .override_count = 4,
                           .overrides = {moved, side, spacing, end}};
    if (options->friction) {
        snprintf(friction, sizeof friction, "missile.friction=%s", options->friction);
        drop.overrides[drop.override_count++] = friction;
    }
    sf_runner_result result;
    if (write_motion(motion, lab->largest_strain * c->specimen.side, turn_time, err) != SF_OK ||
        sf_material_write(real, name, &quick, &text, err) != SF_OK ||
        sf_runner_run(&runner, &drop, &result, err) != SF_OK)
        return err->status;
    test->energy_error = result.energy_error;
    read_test(result.path, card, lab, turn_time, test, err);
    sf_runner_result_free(&result);
    return err->status;
}

sf_status sf_compression_simulate(const sf_compression_fit *fit, const sf_foam_card *card,
                                  const sf_cube_options *options, const char *folder, sf_cube_test *tests,
                                  sf_error *err) {
    const sf_compression_config *c = fit->data.config;
    if (check_specimen(c, err) != SF_OK)
        return err->status;
    for (int k = 0; k < c->test_count; k++) {
        if (simulate(fit, card, options, folder, k, &tests[k], err) != SF_OK)
            return err->status;
        fprintf(
            options->log,
            "simulated cube against material point, %.4g 1/s: largest difference %.2g %% loading, %.2g %% "
            "unloading\n",
            c->test[k].rate, tests[k].percent[0], tests[k].percent[1]);
        fflush(options->log);
    }
    return SF_OK;
}
