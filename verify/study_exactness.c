/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Identities that hold to rounding on any mesh: the invariants of the discretisation, affine fields, the
 * patch test with held u_h, objectivity; and the wrong way of holding a boundary, which must break the patch
 * test. */
#include "extreme.h"
#include "model_fixture.h"
#include "study.h"

#include "solver/constraint/constraint.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static const double GRADIENT[9] = {0.06, -0.11, 0.04, 0.09, -0.05, 0.13, -0.07, 0.08, -0.32};
static const double SHIFT[3] = {0.013, -0.004, 0.021};

enum { UNITY, LINEAR, VOLUME, TELESCOPE, SHAPE, AFFINE, HELD, RIGID, OBJECTIVE, TRANSLATION, RESIDUALS };

static const char *const residual_name[RESIDUALS] = {
    [UNITY] = "ΣB h",
    [LINEAR] = "ΣX⊗B − I",
    [VOLUME] = "ΣV",
    [TELESCOPE] = "ΣVB − ∮φN",
    [SHAPE] = "Σφ, ΣφX",
    [AFFINE] = "affine F",
    [HELD] = "patch test",
    [RIGID] = "rigid rotation",
    [OBJECTIVE] = "objectivity",
    [TRANSLATION] = "translation",
};

typedef struct mesh_result {
    const char *name;
    int64_t nodes, cells[10];
    double residual[RESIDUALS];
    double wrong_way;
} mesh_result;

static double *copy(const double *a, int64_t count) {
    double *out = malloc((size_t)count * sizeof *out);
    if (!out)
        abort();
    memcpy(out, a, (size_t)count * sizeof *out);
    return out;
}

/* 37 degrees about (1, 2, 3), by Rodrigues. */
static void rotation(double r[9]) {
    double angle = 37 * acos(-1) / 180, axis[3] = {1 / sqrt(14), 2 / sqrt(14), 3 / sqrt(14)};
    const double cross[9] = {0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r[3 * i + j] =
                (i == j) + sin(angle) * cross[3 * i + j] + (1 - cos(angle)) * (axis[i] * axis[j] - (i == j));
}

/* The invariants again, from the finished model's arrays; ΣV against the closed form of the box. */
static void measure_invariants(const fixture *f, double volume, double out[RESIDUALS]) {
    const sf_model *m = &f->model;
    double total = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        double unity[3] = {0}, linear[9] = {0}, sum = -1, moment[3] = {0}, h = m->spacing[i];
        const double *x = &m->position[3 * i];
        total += m->volume[i];
        for (int64_t k = m->domain_ptr[i]; k < m->domain_ptr[i + 1]; k++)
            for (int c = 0; c < 9; c++) {
                unity[c % 3] += c < 3 ? m->domain_b[3 * k + c] : 0;
                linear[c] += (m->position[3 * (int64_t)m->domain_node[k] + c / 3] - x[c / 3]) *
                             m->domain_b[3 * k + c % 3];
            }
        for (int64_t k = m->phi_ptr[i]; k < m->phi_ptr[i + 1]; k++) {
            sum += m->phi_value[k];
            for (int c = 0; c < 3; c++)
                moment[c] += m->phi_value[k] * (m->position[3 * (int64_t)m->phi_node[k] + c] - x[c]);
        }
        for (int c = 0; c < 3; c++)
            linear[4 * c] -= 1;
        out[UNITY] = larger(out[UNITY], largest_of(unity, 3) * h);
        out[LINEAR] = larger(out[LINEAR], largest_of(linear, 9));
        out[SHAPE] = larger(out[SHAPE], larger(fabs(sum), largest_of(moment, 3) / h));
    }
    out[VOLUME] = fabs(total / volume - 1);
    out[TELESCOPE] = f->report.invariants.telescope; /* needs the mesh, which the model has swallowed */
}

static double measure_affine(fixture *f) {
    double worst = 0;
    fixture_start(f);
    fixture_set_affine(f, GRADIENT, SHIFT);
    fixture_forces(f);
    for (int64_t k = 0; k < 9 * f->model.node_count; k++)
        worst = larger(worst, fabs(f->state.f[k] - GRADIENT[k % 9] - (k % 9 % 4 == 0)));
    return worst;
}

/* Largest acceleration that the constraints leave of the present forces, of the largest without them. */
static double held_acceleration(fixture *f, const sf_constraint *constraint) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    sf_constraint_step step = {.force = s->force, .v = s->v, .dt = 1e-5, .reaction = s->reaction};
    double free_motion = 0, held_motion = 0;
    memset(s->reaction, 0, 3 * (size_t)m->node_count * sizeof *s->reaction); /* of constraints tried before */
    sf_constraint_project(constraint, &step);
    for (int64_t k = 0; k < 3 * m->node_count; k++) {
        free_motion = larger(free_motion, fabs(s->force[k]) / m->mass[k / 3]);
        held_motion = larger(held_motion, fabs(s->force[k] - s->reaction[k]) / m->mass[k / 3]);
    }
    return held_motion / free_motion;
}

/* Patch test with the coefficients of the boundary nodes held instead of u_h there: phi replaced by the
 * identity. */
static double measure_wrong_way(fixture *f, sf_study *study) {
    sf_error err = SF_ERROR_INIT;
    sf_constraint constraint;
    fixture wrong = *f;
    sf_model *m = &wrong.model;
    size_t n = (size_t)m->node_count;
    double value = NAN;
    m->phi_ptr = malloc((n + 1) * sizeof *m->phi_ptr);
    m->phi_node = malloc(n * sizeof *m->phi_node);
    m->phi_value = malloc(n * sizeof *m->phi_value);
    if (!m->phi_ptr || !m->phi_node || !m->phi_value)
        abort();
    for (size_t i = 0; i <= n; i++)
        m->phi_ptr[i] = (int64_t)i;
    for (size_t i = 0; i < n; i++) {
        m->phi_node[i] = (int32_t)i;
        m->phi_value[i] = 1;
    }
    if (sf_constraint_build(m, &constraint, &err) == SF_OK) {
        value = held_acceleration(&wrong, &constraint);
        sf_constraint_free(&constraint);
    } else {
        sf_study_fail(study, &err);
    }
    free(m->phi_ptr);
    free(m->phi_node);
    free(m->phi_value);
    return value;
}

/* Stress and force after a rigid rotation and translation from rest, in units of E and E h^2. */
static double measure_rigid(fixture *f) {
    const sf_model *m = &f->model;
    double r[9], worst = 0;
    rotation(r);
    for (int k = 0; k < 9; k += 4)
        r[k] -= 1;
    fixture_start(f);
    fixture_set_affine(f, r, SHIFT);
    fixture_forces(f);
    for (int64_t i = 0; i < m->node_count; i++) {
        double unit = sf_foam_card_of(&m->material[0])->modulus * m->spacing[i] * m->spacing[i];
        worst = larger(worst, largest_of(&f->state.stress[9 * i], 9) /
                                  (m->volume[i] * sf_foam_card_of(&m->material[0])->modulus));
        worst = larger(worst, largest_of(&f->state.force[3 * i], 3) / unit);
    }
    return worst;
}

/* A strong motion in two steps, with every term of the law: curve, hysteresis, Maxwell, DAMP, stabilisation;
 * seen from a frame turned by `r` and moved by `shift`. */
static void two_steps(fixture *f, const double r[9], const double shift[3]) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    uint64_t seed = 5;
    fixture_start(f);
    for (int step = 0; step < 3; step++) {
        double scale = step == 2 ? 0.7 : 0.5 * (step + 1); /* loading, then unloading */
        for (int64_t i = 0; i < m->node_count; i++) {
            const double *x = &m->position[3 * i];
            double y[3];
            for (int c = 0; c < 3; c++) {
                double moved = 0;
                for (int k = 0; k < 3; k++)
                    moved += GRADIENT[3 * c + k] * x[k];
                y[c] = x[c] + scale * (moved + 0.05 * m->spacing[i] * fixture_random(&seed));
            }
            for (int c = 0; c < 3; c++)
                s->d[3 * i + c] =
                    r[3 * c] * y[0] + r[3 * c + 1] * y[1] + r[3 * c + 2] * y[2] + shift[c] - x[c];
        }
        s->dt_old = step * 1e-4;
        fixture_forces(f);
    }
}

/* Forces of the same motion seen from a turned and from a moved frame, of the largest force. */
static void measure_objectivity(fixture *f, double out[RESIDUALS]) {
    static const double same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, still[3] = {0};
    int64_t n = 3 * f->model.node_count;
    double r[9];
    rotation(r);
    two_steps(f, same, still);
    double *plain = copy(f->state.force, n), scale = largest_of(plain, n);
    two_steps(f, r, still);
    for (int64_t i = 0; i < n; i++) {
        const double *row = &r[3 * (i % 3)], *force = &plain[3 * (i / 3)];
        double turned = row[0] * force[0] + row[1] * force[1] + row[2] * force[2];
        out[OBJECTIVE] = larger(out[OBJECTIVE], fabs(f->state.force[i] - turned) / scale);
    }
    two_steps(f, same, SHIFT);
    for (int64_t i = 0; i < n; i++)
        out[TRANSLATION] = larger(out[TRANSLATION], fabs(f->state.force[i] - plain[i]) / scale);
    free(plain);
}

/* Measures one mesh, all of its surface held; releases the fixture. */
static void measure(sf_study *study, const char *name, double volume, fixture *f, mesh_result *out) {
    *out = (mesh_result){.name = name, .nodes = f->model.node_count};
    memcpy(out->cells, f->report.cells, sizeof out->cells);
    measure_invariants(f, volume, out->residual);
    out->residual[AFFINE] = measure_affine(f);
    out->residual[HELD] = held_acceleration(f, &f->operators.constraint);
    out->wrong_way = measure_wrong_way(f, study);
    out->residual[RIGID] = measure_rigid(f);
    measure_objectivity(f, out->residual);
    fixture_free(f);
}

static void measure_block(sf_study *study, const char *name, double jitter, mesh_result *out) {
    const fixture_block block = {
        .cells = {7, 6, 5}, .spacing = 0.01, .jitter = jitter, .surface_jitter = 0.8 * jitter};
    fixture f;
    fixture_held_block(&block, &f);
    measure(study, name, 7 * 6 * 5 * 1e-6, &f, out);
}

/* A quarter of a 200 x 200 x 50 mm pad, 10 mm in the impact zone, 16 mm at the edges. */
static void measure_pad(sf_study *study, const char *name, const char *geometry, mesh_result *out) {
    char file[1100];
    const char *const overrides[] = {file,
                                     "geometry.parameters.side=200.0",
                                     "geometry.parameters.zone_side=100.0",
                                     "geometry.parameters.fine_spacing=10.0",
                                     "geometry.parameters.outer_spacing=16.0",
                                     "geometry.missile_parameters.quarter=0",
                                     NULL};
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture f;
    snprintf(file, sizeof file, "geometry.file=\"%s\"", fixture_source(geometry));
    fixture_case(&c, overrides);
    fixture_hold(&c, (const char *const[]){"base", "top", "sides", "symmetry_x", "symmetry_y", NULL});
    fixture_geometry(&c, &mesh, &surface);
    fixture_build(&c, &mesh, &surface, &f);
    measure(study, name, 0.1 * 0.1 * 0.05, &f, out);
}

static void print_table(sf_study *study, int count, const mesh_result *r) {
    sf_study_text(study, "| mesh | nodes | hexahedra | pyramids | tetrahedra |");
    for (int k = 0; k < RESIDUALS; k++)
        sf_study_text(study, " %s |", residual_name[k]);
    sf_study_text(study, " wrong way |\n|---|---|---|---|---|");
    for (int k = 0; k <= RESIDUALS; k++)
        sf_study_text(study, "---|");
    for (int i = 0; i < count; i++) {
        sf_study_text(study, "\n| %s | %lld | %lld | %lld | %lld |", r[i].name, (long long)r[i].nodes,
                      (long long)r[i].cells[SF_CELL_HEXAHEDRON], (long long)r[i].cells[SF_CELL_PYRAMID],
                      (long long)r[i].cells[SF_CELL_TETRAHEDRON]);
        for (int k = 0; k < RESIDUALS; k++)
            sf_study_text(study, " %.1e |", r[i].residual[k]);
        sf_study_text(study, " %.1e |", r[i].wrong_way);
    }
    sf_study_text(study, "\n\n");
}

int main(int argc, char **argv) {
    enum { MESHES = 5 };
    sf_study study;
    mesh_result r[MESHES];
    omp_set_num_threads(1); /* small models: threads would mostly wait for each other */
    sf_study_begin(&study, "exactness", "Exactness", argc, argv);
    measure_block(&study, "regular lattice", 0, &r[0]);
    measure_block(&study, "jittered lattice", 0.25, &r[1]);
    measure_pad(&study, "hexahedra, pyramids, tetrahedra", "geo/pad.geo", &r[2]);
    measure_pad(&study, "tetrahedra", "verify/geo/pad_tet.geo", &r[3]);
    measure_pad(&study, "graded hexahedra", "verify/geo/pad_hex.geo", &r[4]);
    sf_study_text(
        &study,
        "Identities that hold to rounding, whatever the mesh. The sums are the invariants of theory, section 2, on "
        "the finished model (ΣV relative to the closed form). *Affine F* and *patch test* (u_h held on the whole "
        "surface): a field with 32 %% compression and shear. *Rigid rotation*: stress / E and force / (E h²) after "
        "37° about (1, 2, 3) and a translation. *Objectivity*, *translation*: forces of an irregular motion in a "
        "rotated and in a translated frame, with hysteresis, Maxwell branch, DAMP and stabilisation. *Wrong way*: "
        "the patch test with the coefficients d held instead of u_h; it must fail (on the regular lattice it cannot: "
        "there the shape functions of the layer below the surface add up to zero on flat faces).\n\n");
    print_table(&study, MESHES, r);
    for (int k = 0; k < RESIDUALS; k++) {
        double worst = 0;
        for (int i = 0; i < MESHES; i++)
            worst = larger(worst, r[i].residual[k]);
        sf_study_check(&study, worst, 0, 1e-12, "largest over the meshes: %s", residual_name[k]);
    }
    double least = INFINITY;
    for (int i = 1; i < MESHES; i++)
        least = smaller(least, r[i].wrong_way);
    sf_study_check(&study, least, 1e-3, INFINITY,
                   "wrong way (must break the patch test), smallest over all but the regular lattice");
    return sf_study_end(&study);
}
