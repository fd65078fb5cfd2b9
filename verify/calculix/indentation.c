/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "calculix/indentation.h"

#include "calculix/ccx.h"
#include "case/read.h"
#include "drop.h"
#include "post/results/results.h"
#include "pre/mesh/gmsh_session.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double RADIUS = 0.08;    /* m, of the missile */
static const double WINDOW = 0.25e-3; /* m, half width of the mean over softfall's force */
static const double SYMMETRY = 4;     /* quarters */

/* The missile is so heavy that it keeps its speed. */
static const char case_text[] =
    "geometry: {\n"
    "    file = \"%s/verify/geo/pad_hex_ccx.geo\";\n"
    "    missile_file = \"%s/geo/hemisphere.geo\";\n"
    "    length_unit = \"mm\";\n"
    "    parameters = { side = 200.0; thickness = 50.0; layers = 5; half_cells = 10; };\n"
    "    missile_parameters = { diameter = 160.0; element_size = 3.0; quarter = 1; };\n"
    "};\n"
    "material: { %s DAMP = 0.05; };\n"
    "missile: { mass = \"1e5 kg\"; velocity = \"1 m/s\"; friction = 0.0; "
    "gravity = \"0 m/s2\"; };\n"
    "solver: { end_time = \"1 ms\"; };\n";

/* The group `material` but for DAMP. */
static void write_material(const sf_indentation *in, char *text, size_t size) {
    const sf_ogden *law = &in->law;
    if (!in->hyperfoam) {
        snprintf(text, size, "density = \"35 kg/m3\"; E = \"1 Pa\"; curve = \"curve.csv\"; HU = 1.0;");
        return;
    }
    int used = snprintf(text, size, "law = \"hyperfoam\"; density = \"35 kg/m3\"; HU = 1.0;");
    for (int k = 0; k < SF_OGDEN_TERMS; k++)
        used += snprintf(text + used, size - (size_t)used,
                         " term_%d = { mu = \"%.12g Pa\"; alpha = %.12g; nu = %.12g; };", k + 1, law->mu[k],
                         law->alpha[k] + 0., law->nu[k]);
}

static sf_status begin(sf_indentation *in, sf_error *err) {
    const char *source = getenv("SF_SOURCE_DIR"), *temporary = getenv("TMPDIR");
    char path[1024], material[512];
    write_material(in, material, sizeof material);
    snprintf(in->folder, sizeof in->folder, "%s/softfall-ccx-XXXXXX",
             temporary && *temporary ? temporary : "/tmp");
    if (!source)
        return SF_FAIL(err, SF_ERR_INPUT, "SF_SOURCE_DIR must be set");
    if (!mkdtemp(in->folder))
        return SF_FAIL(err, SF_ERR_IO, "no temporary folder %s", in->folder);
    snprintf(path, sizeof path, "%s/curve.csv", in->folder);
    FILE *curve = fopen(path, "w");
    snprintf(path, sizeof path, "%s/case.cfg", in->folder);
    FILE *file = fopen(path, "w");
    if (curve)
        sf_ogden_table(&in->law, curve);
    if (file)
        fprintf(file, case_text, source, source, material);
    if (!curve || fclose(curve) != 0 || !file || fclose(file) != 0)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be written", path);
    return SF_OK;
}

sf_status sf_indentation_begin(sf_indentation *in, sf_error *err) {
    *in = (sf_indentation){.law = sf_ogden_foam()};
    return begin(in, err);
}

sf_status sf_indentation_begin_hyperfoam(sf_indentation *in, double nu, sf_error *err) {
    *in = (sf_indentation){.law = sf_ogden_foam(), .hyperfoam = true};
    for (int k = 0; k < SF_OGDEN_TERMS; k++)
        in->law.nu[k] = nu;
    return begin(in, err);
}

void sf_indentation_end(sf_indentation *in) {
    char command[1024];
    snprintf(command, sizeof command, "rm -rf '%s'", in->folder);
    if (system(command) != 0)
        fprintf(stderr, "%s remains\n", in->folder);
}

enum { OVERRIDES = 8, OVERRIDE_SIZE = 96 };

/* The case's keys that vary, for --set; `list` ends with NULL. */
static void make_overrides(const sf_indentation *in, const sf_indentation_case *c,
                           char text[OVERRIDES][OVERRIDE_SIZE], const char *list[OVERRIDES + 1]) {
    int n = 0;
    snprintf(text[n++], OVERRIDE_SIZE, "geometry.parameters.layers=%d", c->layers);
    snprintf(text[n++], OVERRIDE_SIZE, "geometry.parameters.half_cells=%d", 2 * c->layers);
    snprintf(text[n++], OVERRIDE_SIZE, "geometry.missile_parameters.element_size=%g", c->facet);
    if (!in->hyperfoam)
        snprintf(text[n++], OVERRIDE_SIZE, "material.E=\"%.12g Pa\"",
                 c->modulus * sf_ogden_modulus(&in->law));
    snprintf(text[n++], OVERRIDE_SIZE, "missile.velocity=\"%g m/s\"", c->speed);
    snprintf(text[n++], OVERRIDE_SIZE, "solver.end_time=\"%.9g s\"", (c->depth + 2 * WINDOW) / c->speed);
    snprintf(text[n++], OVERRIDE_SIZE, "output.frame_interval=\"%.9g s\"", c->interval / c->speed);
    for (int k = 0; k < n; k++)
        list[k] = text[k];
    list[n] = NULL;
}

/* Mean of the contact force over the depths within WINDOW of `depth`: integral over the polygon of the
 * history's rows. */
static double mean_force(const sf_results *r, double depth) {
    const double *x = r->history.displacement, *f = r->history.contact_force;
    double low = depth - WINDOW, high = depth + WINDOW, sum = 0;
    for (int64_t k = 0; k + 1 < r->history.rows; k++) {
        double a = fmax(x[k], low), b = fmin(x[k + 1], high);
        if (!(a < b))
            continue;
        double slope = (f[k + 1] - f[k]) / (x[k + 1] - x[k]);
        sum += (b - a) * (f[k] + slope * (0.5 * (a + b) - x[k]));
    }
    return sum / (high - low);
}

static sf_status read_stretches(const sf_results *r, sf_indentation_curve *out, sf_error *err) {
    for (int64_t k = 1; k < r->frame_count && out->frames < SF_INDENTATION_FRAMES; k++) {
        sf_frame frame;
        double volume = 0, beyond = 0, largest = 0;
        if (sf_frame_read(r, &r->frames[k], SF_FIELD_ALL, &frame, err) != SF_OK)
            return err->status;
        const double *stretch = frame.field[SF_FRAME_PRINCIPAL_STRETCHES];
        for (int64_t i = 0; stretch && i < r->node_count; i++) {
            double most = fmax(stretch[3 * i], fmax(stretch[3 * i + 1], stretch[3 * i + 2]));
            largest = larger(largest, most);
            volume += r->volume[i];
            beyond += most > 1.3 ? r->volume[i] : 0;
        }
        sf_frame_free(&frame);
        out->stretch[out->frames] = largest;
        out->beyond[out->frames++] = beyond / volume;
    }
    return SF_OK;
}

sf_status sf_indentation_softfall(const sf_indentation *in, const sf_indentation_case *c,
                                  sf_indentation_curve *out, sf_error *err) {
    char text[OVERRIDES][OVERRIDE_SIZE], file[1024], keep[1024];
    const char *list[OVERRIDES + 1];
    sf_drop drop;
    sf_results r;
    *out = (sf_indentation_curve){0};
    make_overrides(in, c, text, list);
    snprintf(file, sizeof file, "%s/case.cfg", in->folder);
    snprintf(keep, sizeof keep, "%s/results.h5", in->folder);
    double start = sf_children_cpu();
    if (sf_drop_run(file, list, 1, keep, &drop, err) != SF_OK)
        return err->status;
    out->cpu = sf_children_cpu() - start;
    if (sf_results_open(keep, &r, err) != SF_OK)
        return err->status;
    out->depth_reached = r.history.displacement[r.history.rows - 1];
    while (out->count < SF_INDENTATION_POINTS && (out->count + 1) * c->interval <= c->depth + 1e-9) {
        out->force[out->count] = mean_force(&r, (out->count + 1) * c->interval);
        out->count++;
    }
    read_stretches(&r, out, err);
    sf_results_close(&r);
    return err->status;
}

/* The mesh and the missile's surface exactly as softfall-pre reads them. */
static sf_status read_geometry(const sf_indentation *in, const sf_indentation_case *c, sf_mesh *mesh,
                               sf_surface *surface, sf_error *err) {
    char text[OVERRIDES][OVERRIDE_SIZE], file[1024];
    const char *list[OVERRIDES + 1];
    sf_gmsh *session = NULL;
    sf_case k = {0};
    int count = 0;
    make_overrides(in, c, text, list);
    while (list[count])
        count++;
    snprintf(file, sizeof file, "%s/case.cfg", in->folder);
    if (sf_case_read(file, count, list, NULL, &k, err) == SF_OK && sf_gmsh_begin(&session, err) == SF_OK &&
        sf_gmsh_load(session, &k.pad, err) == SF_OK &&
        sf_gmsh_read_mesh(session, k.pad_group, k.length_unit, mesh, err) == SF_OK &&
        sf_gmsh_load(session, &k.missile, err) == SF_OK)
        sf_gmsh_read_surface(session, k.surface_group, k.length_unit, surface, err);
    sf_gmsh_end(&session);
    sf_case_free(&k);
    return err->status;
}

static sf_status write_deck(const sf_indentation *in, const sf_indentation_case *c, const char *path,
                            sf_error *err) {
    const sf_deck deck = {.element = "C3D8",
                          .nodes = c->nodes,
                          .penalty = c->penalty,
                          .radius = RADIUS,
                          .depth = c->depth,
                          .interval = c->interval};
    sf_mesh mesh = {0};
    sf_surface surface = {0};
    FILE *file = NULL;
    if (read_geometry(in, c, &mesh, &surface, err) != SF_OK)
        goto done;
    file = fopen(path, "w");
    if (!file) {
        SF_FAIL(err, SF_ERR_IO, "%s cannot be written", path);
        goto done;
    }
    sf_deck_indentation(&in->law, &deck, &mesh, &surface, file, err);
    if (fclose(file) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be written", path);
done:
    sf_mesh_free(&mesh);
    sf_surface_free(&surface);
    return err->status;
}

sf_status sf_indentation_calculix(const sf_indentation *in, const sf_indentation_case *c,
                                  sf_indentation_curve *out, sf_error *err) {
    char path[1024];
    sf_ccx_run run;
    sf_ccx_forces forces;
    *out = (sf_indentation_curve){0};
    snprintf(path, sizeof path, "%s/pad.inp", in->folder);
    if (write_deck(in, c, path, err) != SF_OK || sf_ccx_solve(in->folder, "pad", &run, err) != SF_OK)
        return err->status;
    out->cpu = run.cpu;
    out->depth_reached = run.reached * c->depth;
    memcpy(out->ending, run.ending, sizeof out->ending);
    sf_error none = SF_ERROR_INIT; /* a run that stopped before the first point has no forces */
    if (sf_ccx_forces_read(in->folder, "pad", "NBASE", &forces, &none) != SF_OK)
        return SF_OK;
    for (int k = 0; k < forces.count && k < SF_INDENTATION_POINTS; k++)
        if ((k + 1) * c->interval <= c->depth + 1e-9)
            out->force[out->count++] = SYMMETRY * forces.force[3 * k + 2];
    sf_ccx_forces_free(&forces);
    return SF_OK;
}
