/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The axisymmetric method on jittered sections: kinematics, forces, energy, ties, the bound of the step, and
 * a thick-walled cylinder in closed form; what is refused. */
#include "extreme.h"
#include "layer_fixture.h"
#include "post_check.h"

#include "model/stability.h"
#include "post/results/revolution.h"
#include "pre/mesh/refine.h"
#include "pre/mesh/section.h"
#include "solver/step.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* A section over [inner, inner + cells spacing] in R and [0, ...] in Z; nodes shift along the sides and on
 * the axis, and inside; every third cell is two triangles. */
typedef struct section {
    int cells[2];
    double spacing, inner, jitter;
    int lower; /* rows of cells of the layer "A"; the others are "B"; 0: one material */
} section;

static const section JITTERED = {.cells = {7, 6}, .spacing = 0.01, .jitter = 0.2};

static void add_side(const section *s, sf_mesh *mesh, const char *name, int axis, int place) {
    sf_node_set *set = &mesh->set[mesh->set_count++];
    set->name = strdup(name);
    set->node = malloc((size_t)mesh->node_count * sizeof *set->node);
    for (int k = 0; k <= s->cells[1]; k++)
        for (int i = 0; i <= s->cells[0]; i++)
            if ((axis == 0 ? i : k) == place)
                set->node[set->count++] = i + k * (s->cells[0] + 1);
}

static void add_cell(sf_mesh *mesh, int layer, int vertices, const int32_t *node) {
    int64_t c = mesh->cell_count++;
    mesh->cell_type[c] = vertices == 3 ? SF_CELL_TRIANGLE : SF_CELL_QUADRANGLE;
    memcpy(&mesh->cell_node[mesh->cell_ptr[c]], node, (size_t)vertices * sizeof *node);
    mesh->cell_ptr[c + 1] = mesh->cell_ptr[c] + vertices;
    mesh->cell_layer[c] = (uint8_t)layer;
}

static void make_mesh(const section *s, sf_mesh *mesh) {
    int across = s->cells[0] + 1;
    size_t nodes = (size_t)(across * (s->cells[1] + 1)), cells = (size_t)(2 * s->cells[0] * s->cells[1]);
    uint64_t seed = 7;
    *mesh = (sf_mesh){.node_count = (int64_t)nodes,
                      .position = calloc(3 * nodes, sizeof(double)),
                      .cell_type = calloc(cells, 1),
                      .cell_layer = calloc(cells, 1),
                      .cell_ptr = calloc(cells + 1, sizeof(int64_t)),
                      .cell_node = calloc(4 * cells, sizeof(int32_t)),
                      .set = calloc(4, sizeof(sf_node_set))};
    for (int k = 0; k <= s->cells[1]; k++)
        for (int i = 0; i < across; i++) {
            double *x = &mesh->position[3 * (i + k * across)];
            bool r = i > 0 && i<s->cells[0], z = k> 0 && k < s->cells[1] && (s->lower == 0 || k != s->lower);
            x[0] = s->inner + s->spacing * (i + (r ? s->jitter * fixture_random(&seed) : 0));
            x[2] = s->spacing * (k + (z ? s->jitter * fixture_random(&seed) : 0));
        }
    for (int k = 0; k < s->cells[1]; k++)
        for (int i = 0; i < s->cells[0]; i++) {
            int32_t a = i + k * across;
            const int32_t v[4] = {a, a + 1, a + 1 + across, a + across};
            int layer = s->lower > 0 && k >= s->lower;
            if ((i + 2 * k) % 3 > 0)
                add_cell(mesh, layer, 4, v);
            else {
                add_cell(mesh, layer, 3, (const int32_t[3]){v[0], v[1], v[2]});
                add_cell(mesh, layer, 3, (const int32_t[3]){v[0], v[2], v[3]});
            }
        }
    add_side(s, mesh, "base", 1, 0);
    add_side(s, mesh, "top", 1, s->cells[1]);
    add_side(s, mesh, "outer", 0, s->cells[0]);
    add_side(s, mesh, "inner", 0, 0);
}

static void build_case(const section *s, sf_case *c, fixture *f) {
    sf_mesh mesh;
    sf_surface surface;
    make_mesh(s, &mesh);
    fixture_dome(0.08, 6, 0, 0, &surface);
    fixture_build(c, &mesh, &surface, f);
    fixture_start(f);
}

/* A linear elastic section, or its layers, held by the sets `held`, up to NULL. */
static void build(const section *s, const char *const *held, fixture *f) {
    sf_case c;
    if (s->lower > 0) {
        layers_case(&c, NULL, held, 2);
        layers_make_linear(&c.layer[0], 4e5, 35);
        layers_make_linear(&c.layer[1], 8e5, 50);
    } else {
        fixture_case(&c, NULL);
        fixture_hold(&c, held);
        fixture_make_linear(&c);
    }
    build_case(s, &c, f);
}

static const char *const BASE[] = {"base", NULL}, *const ALL_SIDES[] = {"base", "top", "outer", NULL};

/* ---- kinematics ---- */

static void rings_fill_the_volume_and_rows_are_complete(void **state) {
    fixture f;
    (void)state;
    build(&JITTERED, BASE, &f);
    const sf_model *m = &f.model;
    double sum = 0, radius = 0.07, height = 0.06;
    for (int64_t i = 0; i < m->node_count; i++)
        sum += m->volume[i];
    assert_relative(sum, acos(-1) * radius * radius * height, 1e-13);
    const sf_invariants *v = &f.report.invariants;
    assert_close(v->unity, 0, 1e-12);
    assert_close(v->linear, 0, 1e-12);
    assert_close(v->shape, 0, 1e-12);
    assert_close(v->telescope, 0, 1e-11);
    fixture_free(&f);
}

static void uniform_stretches_are_exact(void **state) {
    (void)state;
    const section layered = {.cells = {7, 6}, .spacing = 0.01, .jitter = 0.2, .lower = 2};
    for (int k = 0; k < 2; k++) {
        fixture f;
        build(k ? &layered : &JITTERED, BASE, &f);
        fixture_set_affine(&f, (const double[9]){0.2, 0, 0, 0, 0, 0, 0, 0, -0.3},
                           (const double[3]){0, 0, 0.5});
        fixture_forces(&f);
        static const double expected[9] = {1.2, 0, 0, 0, 1.2, 0, 0, 0, 0.7};
        for (int64_t q = 0; q < 9 * f.model.node_count; q++)
            assert_close(f.state.f[q], expected[q % 9], 1e-12);
        fixture_free(&f);
    }
}

static void axial_motion_makes_no_force(void **state) {
    fixture f;
    (void)state;
    build(&JITTERED, BASE, &f);
    fixture_set_affine(&f, (const double[9]){0}, (const double[3]){0, 0, 0.02});
    fixture_forces(&f);
    for (int64_t q = 0; q < 3 * f.model.node_count; q++)
        assert_close(f.state.force[q], 0, 1e-9); /* N, of some 1e3 N */
    fixture_free(&f);
}

/* ---- forces ---- */

static void uniform_stress_leaves_the_inside_at_rest(void **state) {
    (void)state;
    const section layered = {.cells = {7, 6}, .spacing = 0.01, .jitter = 0.2, .lower = 2};
    for (int k = 0; k < 2; k++) {
        fixture f;
        build(k ? &layered : &JITTERED, ALL_SIDES, &f);
        const sf_model *m = &f.model;
        for (int64_t i = 0; i < m->node_count; i++) { /* the layer above is twice as stiff */
            double *d = &f.state.d[3 * i], z = m->position[3 * i + 2], knee = 0.02;
            d[0] = k ? 0 : 0.05 * m->position[3 * i];
            d[2] = k && m->node_material[i] > 0 ? -0.05 * knee - 0.025 * (z - knee) : -0.05 * z;
        }
        fixture_forces(&f);
        assert_close(fixture_held_acceleration(&f, &f.operators.constraint), 0, 1e-12);
        fixture_free(&f);
    }
}

static void vary(fixture *f, double amplitude) {
    uint64_t seed = 3;
    for (int64_t i = 0; i < f->model.node_count; i++) {
        f->state.d[3 * i] = amplitude * fixture_random(&seed);
        f->state.d[3 * i + 2] = amplitude * fixture_random(&seed);
    }
}

/* Stored energy of the law and the stabilisation, J. */
static double energy_of(fixture *f) {
    double sum = 0;
    fixture_forces(f);
    for (int64_t k = 0; k < f->state.chunk_count; k++)
        sum += f->state.partial[k].stored;
    for (int64_t i = 0; i < f->model.node_count; i++)
        sum += f->state.pair_energy[i];
    return sum;
}

/* Hoop, in-plane and pair forces alike; a linear law has a stabilisation that does not stiffen. */
static void forces_are_the_negative_gradient_of_the_energy(void **state) {
    fixture f;
    double scale = 0, step = 1e-6;
    (void)state;
    build(&JITTERED, BASE, &f);
    sf_state *s = &f.state;
    size_t n = 3 * (size_t)f.model.node_count;
    double *force = malloc(n * sizeof *force);
    vary(&f, 5e-4);
    fixture_forces(&f);
    memcpy(force, s->force, n * sizeof *force);
    for (size_t q = 0; q < n; q++)
        scale = larger(scale, fabs(force[q]));
    for (size_t q = 0; q < n; q++) {
        double start = s->d[q], energy[2];
        for (int k = 0; k < 2; k++) {
            s->d[q] = start + (k ? step : -step);
            energy[k] = q % 3 == 1 ? 0 : energy_of(&f);
        }
        s->d[q] = start;
        assert_close((energy[1] - energy[0]) / (2 * step * scale), -force[q] / scale, 1e-6);
    }
    free(force);
    fixture_free(&f);
}

/* Through a cycle far into the densification and back nothing comes out of the stabilisation. */
static void stabilisation_is_passive(void **state) {
    enum { STEPS = 200 };
    sf_case c;
    fixture f;
    double sum = 0, largest = 0;
    (void)state;
    fixture_case(&c, NULL);
    fixture_make_elastic(&c);
    build_case(&JITTERED, &c, &f);
    for (int k = 0; k <= STEPS; k++) {
        double part = sin(acos(-1) * k / STEPS);
        vary(&f, 1.5e-3 * part);
        for (int64_t i = 0; i < f.model.node_count; i++)
            f.state.d[3 * i + 2] -= 0.7 * part * f.model.position[3 * i + 2];
        fixture_forces(&f);
        for (int64_t p = 0; p < f.state.chunk_count; p++)
            sum += f.state.partial[p].stabilisation;
        largest = larger(largest, sum);
        assert_true(sum >= -1e-9 * largest);
    }
    assert_true(largest > 0 && sum >= 0);
    fixture_free(&f);
}

/* ---- the bound of the step ---- */

/* out = M^-1 K v of a linear pad, projected to its constraints; both fields are far below one spacing. */
static void apply_stiffness(fixture *f, const double *v, double *out) {
    sf_state *s = &f->state;
    const sf_model *m = &f->model;
    double small = 1e-9;
    for (int64_t q = 0; q < 3 * m->node_count; q++)
        s->d[q] = small * v[q];
    fixture_forces(f);
    memset(s->v, 0, 3 * (size_t)m->node_count * sizeof *s->v);
    sf_constraint_step step = {.force = s->force, .v = s->v, .dt = 1, .reaction = s->reaction};
    sf_constraint_project(&f->operators.constraint, &step);
    for (int64_t q = 0; q < 3 * m->node_count; q++)
        out[q] = (s->reaction[q] - s->force[q]) / (small * m->mass[q / 3]);
}

static void step_is_below_that_of_the_highest_frequency(void **state) {
    enum { ROUNDS = 400 };
    fixture f;
    uint64_t seed = 5;
    double highest = 0;
    (void)state;
    build(&JITTERED, BASE, &f);
    fixture_step(&f);
    double first = f.state.bound_step, bound = f.report.first_step;
    size_t n = 3 * (size_t)f.model.node_count;
    double *v = malloc(n * sizeof *v), *out = malloc(n * sizeof *out);
    for (size_t q = 0; q < n; q++)
        v[q] = q % 3 == 1 ? 0 : fixture_random(&seed);
    for (int k = 0; k < ROUNDS; k++) {
        double square = 0;
        apply_stiffness(&f, v, out);
        for (size_t q = 0; q < n; q++)
            square += out[q] * out[q];
        highest = sqrt(square);
        for (size_t q = 0; q < n; q++)
            v[q] = out[q] / highest;
    }
    double stable = 2 / sqrt(highest);
    assert_true(bound <= first * (1 + 1e-12));
    if (!(first <= stable * 1.001 && first > 0.8 * stable))
        fail_msg("step %.4g us, stable %.4g us", 1e6 * first, 1e6 * stable);
    free(v);
    free(out);
    fixture_free(&f);
}

/* ---- a thick-walled cylinder ---- */

/* The stiffness of u_R of all nodes, by columns, in N/m. */
static void build_stiffness(fixture *f, gsl_matrix *k) {
    sf_state *s = &f->state;
    const double small = 1e-9;
    for (size_t j = 0; j < k->size2; j++) {
        memset(s->d, 0, 3 * (size_t)f->model.node_count * sizeof *s->d);
        s->d[3 * j] = small;
        fixture_forces(f);
        for (size_t i = 0; i < k->size1; i++)
            gsl_matrix_set(k, i, j, -s->force[3 * i] / small);
    }
}

/* Adds the force of a pressure (Pa) on the inner side to nodes: its integral over phi, phi being interpolated
 * between the nodes of the side. */
static void press_inside(const section *s, const sf_model *m, double pressure, gsl_vector *force) {
    for (int64_t i = 0; i < m->node_count; i++) {
        if (fabs(m->position[3 * i] - s->inner) > 1e-9)
            continue;
        bool end = m->position[3 * i + 2] < 1e-9 || m->position[3 * i + 2] > s->cells[1] * s->spacing - 1e-9;
        double share = 2 * acos(-1) * s->inner * s->spacing * (end ? 0.5 : 1) * pressure;
        for (int64_t k = m->phi_ptr[i]; k < m->phi_ptr[i + 1]; k++)
            *gsl_vector_ptr(force, (size_t)m->phi_node[k]) += share * m->phi_value[k];
    }
}

/* Largest error of u_h on the nodes over the largest displacement, in plane strain. With stress = E strain in
 * each principal direction u = A r + B / r, and sigma_r = E (A - B / r^2). */
static double cylinder_error(int cells) {
    const double a = 0.04, b = 0.12, pressure = 100;
    const section s = {.cells = {cells, 4}, .spacing = (b - a) / cells, .inner = a};
    fixture f;
    double worst = 0;
    build(&s, BASE, &f);
    sf_model *m = &f.model;
    m->run.stabilisation = 1e-3;
    fixture_start(&f);
    size_t n = (size_t)m->node_count;
    gsl_matrix *k = gsl_matrix_alloc(n, n);
    gsl_vector *force = gsl_vector_calloc(n), *u = gsl_vector_alloc(n);
    gsl_permutation *p = gsl_permutation_alloc(n);
    int sign;
    build_stiffness(&f, k);
    press_inside(&s, m, pressure, force);
    gsl_linalg_LU_decomp(k, p, &sign);
    gsl_linalg_LU_solve(k, p, force, u);
    double modulus = sf_foam_card_of(&m->material[0])->modulus,
           slope = pressure / modulus / (b * b / (a * a) - 1);
    for (int64_t i = 0; i < m->node_count; i++) {
        double value = 0, r = m->position[3 * i], exact = slope * (r + b * b / r);
        for (int64_t e = m->phi_ptr[i]; e < m->phi_ptr[i + 1]; e++)
            value += m->phi_value[e] * gsl_vector_get(u, (size_t)m->phi_node[e]);
        worst = larger(worst, fabs(value / (slope * (a + b * b / a)) - exact / (slope * (a + b * b / a))));
    }
    gsl_matrix_free(k);
    gsl_vector_free(force);
    gsl_vector_free(u);
    gsl_permutation_free(p);
    fixture_free(&f);
    return worst;
}

static void cylinder_under_pressure_converges_to_its_closed_form(void **state) {
    (void)state;
    double coarse = cylinder_error(8), fine = cylinder_error(16), order = log2(coarse / fine);
    if (!(fine < 8e-3 && order > 1.5))
        fail_msg("errors %.3g and %.3g, order %.2f", coarse, fine, order);
}

/* ---- the body of revolution ---- */

static void cells_of_the_quarter_fill_its_sectors(void **state) {
    sf_mesh mesh;
    sf_revolution v;
    sf_error err = SF_ERROR_INIT;
    double sum = 0, shares = 0, angle = acos(-1) / 24, radius = 0.07, height = 0.06; /* 12 sectors */
    int64_t types[10] = {0};
    (void)state;
    make_mesh(&JITTERED, &mesh);
    assert_int_equal(sf_revolution_build(mesh.node_count, mesh.position, &v, &err), SF_OK);
    sf_cell_lists cells = {mesh.cell_count, mesh.cell_ptr[mesh.cell_count], mesh.cell_type, mesh.cell_ptr,
                           mesh.cell_node};
    assert_int_equal(sf_revolution_cells(&v, &cells, &err), SF_OK);
    assert_int_equal(sf_revolution_field(&v, 3, true, &mesh.position, &err), SF_OK);
    mesh.node_count = v.nodes;
    mesh.cell_count = cells.count;
    mesh.cell_type = cells.type;
    mesh.cell_ptr = cells.ptr;
    mesh.cell_node = cells.node;
    for (int64_t c = 0; c < mesh.cell_count; c++) {
        double volume = sf_mesh_cell_volume(&mesh, c);
        types[mesh.cell_type[c]]++;
        assert_true(volume > 0);
        sum += volume;
    }
    for (int64_t i = 0; i < v.nodes; i++)
        shares += sf_revolution_share(&v, i);
    assert_close(shares, (double)v.section_nodes / 4, 1e-12);
    assert_relative(sum, 12 * 0.5 * radius * radius * sin(angle) * height, 1e-12);
    assert_true(types[SF_CELL_TETRAHEDRON] > 0 && types[SF_CELL_PYRAMID] > 0 && types[SF_CELL_PRISM] > 0 &&
                types[SF_CELL_HEXAHEDRON] > 0);
    sf_revolution_free(&v);
    sf_mesh_free(&mesh);
}

/* ---- what is refused ---- */

static void refuse_pad(sf_mesh *mesh, const char *text) {
    sf_case c;
    sf_error err = SF_ERROR_INIT;
    fixture_case(&c, NULL);
    for (int64_t i = 0; i < mesh->node_count; i++) { /* as it is drawn */
        mesh->position[3 * i + 1] = mesh->position[3 * i + 2];
        mesh->position[3 * i + 2] = 0;
    }
    assert_int_not_equal(sf_section_take_pad(&c, mesh, &err), SF_OK);
    if (!strstr(err.text, text))
        fail_msg("\"%s\" is not in \"%s\"", text, err.text);
    sf_mesh_free(mesh);
    sf_case_free(&c);
}

static void sections_that_are_no_plate_are_refused(void **state) {
    sf_mesh mesh;
    section s = JITTERED;
    (void)state;
    s.inner = 0.01;
    make_mesh(&s, &mesh);
    refuse_pad(&mesh, "does not reach the axis: it begins at x = 10 mm");
    s.inner = -0.02;
    make_mesh(&s, &mesh);
    refuse_pad(&mesh, "crosses the axis: it reaches x = -20 mm");
    make_mesh(&JITTERED, &mesh);
    mesh.position[3 * (mesh.node_count - 1) + 2] *= 0.98;
    refuse_pad(&mesh, "the section is no rectangle");
    make_mesh(&JITTERED, &mesh);
    memcpy(&mesh.position[3 * 9], &mesh.position[3 * 10], 3 * sizeof(double));
    refuse_pad(&mesh, "is inverted or flat");
}

static void refuse_missile(sf_surface *surface) {
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_section_take_missile(surface, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "no body of revolution about the axis"));
    sf_surface_free(surface);
}

static void missiles_beside_the_axis_are_refused(void **state) {
    sf_surface surface;
    (void)state;
    fixture_dome(0.08, 10, 0.01, 0, &surface);
    refuse_missile(&surface);
    fixture_dome(0.08, 10, 0, 0, &surface);
    for (int64_t k = 0; k < surface.node_count; k++)
        surface.position[3 * k] *= 1.1; /* an ellipsoid with three axes */
    refuse_missile(&surface);
}

/* Facets of the turned profile touch it in the half plane. */
static void profile_is_exact_in_the_half_plane(void **state) {
    sf_surface surface;
    sf_error err = SF_ERROR_INIT;
    double worst = 0;
    (void)state;
    fixture_dome(0.08, 40, 0, 0, &surface);
    double centre = surface.position[2] + 0.08;
    assert_int_equal(sf_section_take_missile(&surface, &err), SF_OK);
    for (int64_t t = 0; t < surface.triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            const double *a = &surface.position[3 * (int64_t)surface.triangle[3 * t + c]],
                         *b = &surface.position[3 * (int64_t)surface.triangle[3 * t + (c + 1) % 3]];
            if (a[2] != b[2] || a[1] * b[1] >= 0 || a[0] <= 0) /* along a ring, across y = 0, R > 0 */
                continue;
            worst = larger(worst, fabs(hypot(0.5 * (a[0] + b[0]), a[2] - centre) / 0.08 - 1));
        }
    assert_close(worst, 0, 1e-12);
    sf_surface_free(&surface);
}

static double volume_of(const sf_mesh *mesh, int layer) {
    double sum = 0;
    for (int64_t c = 0; c < mesh->cell_count; c++)
        sum += mesh->cell_layer[c] == layer ? sf_mesh_cell_volume(mesh, c) : 0;
    return sum;
}

/* Sides between the nodes of a row. */
static void add_sides(sf_node_set *row, int sides) {
    row->face = calloc(4 * (size_t)sides, sizeof *row->face);
    for (row->face_count = 0; row->face_count < sides; row->face_count++)
        memcpy(&row->face[4 * row->face_count],
               (const int32_t[4]){-1, -1, row->node[row->face_count], row->node[row->face_count + 1]},
               4 * sizeof *row->face);
}

/* Four cells of each, the layers' volumes and the sides of a group kept, and the middles on these. */
static void halving_keeps_layers_and_sides(void **state) {
    (void)state;
    section s = JITTERED;
    sf_mesh mesh, fine = {0};
    sf_error err = SF_ERROR_INIT;
    s.lower = 2;
    make_mesh(&s, &mesh);
    sf_node_set *top = &mesh.set[1];
    add_sides(top, s.cells[0]);
    assert_int_equal(sf_section_refine(&mesh, NULL, &fine, &err), SF_OK);
    assert_int_equal(fine.cell_count, 4 * mesh.cell_count);
    for (int layer = 0; layer < 2; layer++)
        assert_relative(volume_of(&fine, layer), volume_of(&mesh, layer), 1e-12);
    const sf_node_set *halves = sf_mesh_find_set(&fine, "top");
    assert_int_equal(halves->face_count, 2 * s.cells[0]);
    assert_int_equal(halves->count, 2 * s.cells[0] + 1);
    for (int64_t k = 0; k < halves->count; k++)
        assert_close(fine.position[3 * (int64_t)halves->node[k] + 2], s.cells[1] * s.spacing, 1e-15);
    double volume;
    assert_int_equal(sf_mesh_check(&fine, &volume, &err), SF_OK);
    top->face[3] = 0; /* from the top to a node that is no neighbour */
    sf_mesh_free(&fine);
    assert_int_equal(sf_section_refine(&mesh, NULL, &fine, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the group \"top\" has a side that no cell of the section has"));
    sf_mesh_free(&mesh);
}

/* A cone with a flat face of 52 mm below and a wide rim above; `rise` of the cone, m. */
static void make_cone(double rise, sf_surface *s) {
    const double profile[4][2] = {{0, 0}, {0.052, 0}, {0.12, rise}, {0.12, 0.2}};
    *s = (sf_surface){.node_count = 4, .position = calloc(12, sizeof *s->position)};
    for (int k = 0; k < 4; k++) {
        s->position[3 * k] = profile[k][0];
        s->position[3 * k + 2] = profile[k][1];
    }
}

/* Cells below an edge are split, their neighbours close up to them, and a smooth missile splits none. */
static void edges_of_flat_missiles_split_cells(void **state) {
    (void)state;
    section s = {{20, 6}, 0.005, 0, 0, 2};
    for (int steep = 0; steep < 2; steep++) {
        sf_mesh mesh;
        sf_surface missile;
        sf_case c;
        sf_error err = SF_ERROR_INIT;
        fixture_case(&c, NULL);
        make_mesh(&s, &mesh);
        snprintf(c.contact_group, sizeof c.contact_group, "top");
        make_cone(steep ? 0.1 : 0.005, &missile);
        add_sides(&mesh.set[1], s.cells[0]);
        int64_t before = mesh.cell_count;
        double volume[2] = {volume_of(&mesh, 0), volume_of(&mesh, 1)}, whole;
        assert_int_equal(sf_section_refine_edge(&c, &missile, &mesh, &err), SF_OK);
        if (!steep)
            assert_int_equal(mesh.cell_count, before);
        else
            assert_true(mesh.cell_count > before + 40);
        for (int layer = 0; layer < 2; layer++)
            assert_relative(volume_of(&mesh, layer), volume[layer], 1e-12);
        assert_int_equal(sf_mesh_check(&mesh, &whole, &err), SF_OK);
        double shortest = INFINITY, length = 0;
        const sf_node_set *top = sf_mesh_find_set(&mesh, "top");
        for (int64_t f = 0; f < top->face_count; f++) {
            double side = fabs(mesh.position[3 * (int64_t)top->face[4 * f + 2]] -
                               mesh.position[3 * (int64_t)top->face[4 * f + 3]]);
            shortest = smaller(shortest, side);
            length += side;
        }
        assert_close(length, 0.1, 1e-12);
        assert_relative(shortest, steep ? 0.00125 : 0.005, 1e-9); /* twice: 30 mm is 12 times 2.5 mm */
        assert_int_equal(top->count, top->face_count + 1);
        sf_surface_free(&missile);
        sf_mesh_free(&mesh);
        sf_case_free(&c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_of_flat_missiles_split_cells),
        cmocka_unit_test(halving_keeps_layers_and_sides),
        cmocka_unit_test(rings_fill_the_volume_and_rows_are_complete),
        cmocka_unit_test(uniform_stretches_are_exact),
        cmocka_unit_test(axial_motion_makes_no_force),
        cmocka_unit_test(uniform_stress_leaves_the_inside_at_rest),
        cmocka_unit_test(forces_are_the_negative_gradient_of_the_energy),
        cmocka_unit_test(stabilisation_is_passive),
        cmocka_unit_test(step_is_below_that_of_the_highest_frequency),
        cmocka_unit_test(cylinder_under_pressure_converges_to_its_closed_form),
        cmocka_unit_test(cells_of_the_quarter_fill_its_sectors),
        cmocka_unit_test(sections_that_are_no_plate_are_refused),
        cmocka_unit_test(missiles_beside_the_axis_are_refused),
        cmocka_unit_test(profile_is_exact_in_the_half_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
