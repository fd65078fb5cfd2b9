/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model_fixture.h"

#include "case/read.h"
#include "extreme.h"

#include "pre/mesh/gmsh_session.h"
#include "solver/field/domain_stress.h"
#include "solver/field/stabilisation.h"
#include "solver/step.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const double PI = 3.14159265358979323846;
static const double HEIGHT = 0.2; /* m, of missiles made here before they are moved to the pad */

static void require(sf_status status, const sf_error *err) {
    if (status != SF_OK)
        fail_msg("%s:%d: %s", err->where, err->line, err->text);
}

static void *allocate(size_t count, size_t size) {
    sf_error err = SF_ERROR_INIT;
    void *block = sf_alloc(&err, count, size, "fixture");
    require(err.status, &err);
    return block;
}

double fixture_random(uint64_t *seed) {
    /* splitmix64 (Steele, Lea, Flood 2014) */
    uint64_t z = (*seed += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
    return (double)(z >> 11) / (double)(1ULL << 52) - 1;
}

const char *fixture_source(const char *name) {
    static char path[4][1024];
    static int turn;
    const char *root = getenv("SF_SOURCE_DIR");
    if (!root)
        fail_msg("SF_SOURCE_DIR is not set: it names the root of the source");
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", root, name);
    return path[turn];
}

void fixture_case(sf_case *c, const char *const *overrides) {
    enum { MOST = 32 };
    sf_error err = SF_ERROR_INIT;
    char material[4200];
    const char *all[MOST] = {material};
    int count = 1;
    snprintf(material, sizeof material, "material=@%s", fixture_source("tests/materials/eva35_first.cfg"));
    for (; overrides && overrides[count - 1]; count++) {
        if (count == MOST)
            fail_msg("more than %d overrides", MOST - 1);
        all[count] = overrides[count - 1];
    }
    require(sf_case_read(fixture_source("examples/eva50-v4.5/case.cfg"), count, all, NULL, c, &err), &err);
    c->mesh_error_limit = 1e6; /* tests run on coarse meshes */
}

void fixture_make_elastic(sf_case *c) {
    sf_foam_card *card = sf_foam_card_of(&c->material);
    card->shared.hysteresis_hu = 1;
    card->shared.damp = 0;
    card->shared.maxwell_modulus = 0;
    card->shared.kelvin_viscosity = 0;
}

void fixture_make_linear(sf_case *c) {
    enum { POINTS = 5 };
    sf_foam_card *card = sf_foam_card_of(&c->material);
    fixture_make_elastic(c);
    free(card->curves.curve_strain);
    free(card->curves.curve_stress);
    card->curves.curve_strain = allocate(POINTS, sizeof(double));
    card->curves.curve_stress = allocate(POINTS, sizeof(double));
    for (int k = 0; k < POINTS; k++) {
        card->curves.curve_strain[k] = 0.2 * k;
        card->curves.curve_stress[k] = 0.2 * k * card->modulus;
    }
    card->curves.curve_points = card->curves.curve_ptr[1] = POINTS;
    card->densification_start = card->densification_exponent = 0;
    card->densification_limit = 1;
}

double fixture_peak(const fixture *f, int64_t node) {
    int64_t row = node / SF_LANES * f->state.history_rows + SF_FOAM_PEAK;
    return f->state.history[row * SF_LANES + node % SF_LANES];
}

void fixture_hold(sf_case *c, const char *const *names) {
    c->symmetry_count = 0;
    c->fixed_count = 0;
    for (; names[c->fixed_count]; c->fixed_count++)
        snprintf(c->fixed_group[c->fixed_count], SF_CASE_NAME_SIZE, "%s", names[c->fixed_count]);
}

void fixture_mirror(sf_case *c, int count) {
    for (c->symmetry_count = 0; c->symmetry_count < count; c->symmetry_count++)
        snprintf(c->symmetry_group[c->symmetry_count], SF_CASE_NAME_SIZE, "plane_%c",
                 'x' + c->symmetry_count);
}

void fixture_slant(sf_case *c, double slant) {
    double *direction = c->missile_card.direction;
    direction[0] = sin(slant);
    direction[1] = 0;
    direction[2] = -cos(slant);
}

void fixture_geometry(const sf_case *c, sf_mesh *mesh, sf_surface *surface) {
    sf_error err = SF_ERROR_INIT;
    sf_gmsh *session = NULL;
    if (sf_gmsh_begin(&session, &err) == SF_OK)
        session->store = c->store;
    if (session && sf_gmsh_load(session, &c->pad, &err) == SF_OK &&
        sf_gmsh_read_mesh(session, c->pad_group, c->length_unit, mesh, &err) == SF_OK &&
        sf_gmsh_load(session, &c->missile, &err) == SF_OK)
        sf_gmsh_read_surface(session, c->surface_group, c->length_unit, surface, &err);
    sf_gmsh_end(&session);
    require(err.status, &err);
}

static int32_t lattice(const fixture_block *b, int i, int j, int k) {
    return (int32_t)(i + (b->cells[0] + 1) * (j + (b->cells[1] + 1) * k));
}

static void block_position(const fixture_block *b, const int place[3], uint64_t *seed, double x[3]) {
    bool surface = false;
    for (int c = 0; c < 3; c++)
        surface = surface || place[c] == 0 || place[c] == b->cells[c];
    for (int c = 0; c < 3; c++) {
        bool bound = place[c] == 0 || place[c] == b->cells[c];
        double shift = fixture_random(seed) * (surface ? b->surface_jitter : b->jitter);
        x[c] = b->spacing * (place[c] + (bound ? 0 : shift));
    }
    x[2] *= b->flatness > 0 ? b->flatness : 1;
}

static void add_set(sf_mesh *mesh, int index, const char *name, int axes, bool high, bool low,
                    const fixture_block *b) {
    sf_node_set *set = &mesh->set[index];
    set->name = strdup(name);
    set->node = allocate((size_t)mesh->node_count, sizeof *set->node);
    for (int k = 0; k <= b->cells[2]; k++)
        for (int j = 0; j <= b->cells[1]; j++)
            for (int i = 0; i <= b->cells[0]; i++) {
                const int place[3] = {i, j, k};
                bool in = false;
                for (int c = 0; c < 3; c++)
                    if (axes & (1 << c))
                        in = in || (low && place[c] == 0) || (high && place[c] == b->cells[c]);
                if (in)
                    set->node[set->count++] = lattice(b, i, j, k);
            }
}

void fixture_block_mesh(const fixture_block *b, sf_mesh *mesh) {
    uint64_t seed = 1;
    memset(mesh, 0, sizeof *mesh);
    mesh->node_count = (int64_t)(b->cells[0] + 1) * (b->cells[1] + 1) * (b->cells[2] + 1);
    mesh->cell_count = (int64_t)b->cells[0] * b->cells[1] * b->cells[2];
    mesh->position = allocate(3 * (size_t)mesh->node_count, sizeof *mesh->position);
    mesh->cell_type = allocate((size_t)mesh->cell_count, 1);
    mesh->cell_ptr = allocate((size_t)mesh->cell_count + 1, sizeof *mesh->cell_ptr);
    mesh->cell_node = allocate(8 * (size_t)mesh->cell_count, sizeof *mesh->cell_node);
    int64_t cell = 0;
    for (int k = 0; k <= b->cells[2]; k++)
        for (int j = 0; j <= b->cells[1]; j++)
            for (int i = 0; i <= b->cells[0]; i++) {
                block_position(b, (const int[3]){i, j, k}, &seed, &mesh->position[3 * lattice(b, i, j, k)]);
                if (i == b->cells[0] || j == b->cells[1] || k == b->cells[2])
                    continue;
                for (int v = 0; v < 8; v++)
                    mesh->cell_node[8 * cell + v] =
                        lattice(b, i + (v % 4 == 1 || v % 4 == 2), j + (v % 4 >= 2), k + (v >= 4));
                mesh->cell_type[cell++] = SF_CELL_HEXAHEDRON;
                mesh->cell_ptr[cell] = 8 * cell;
            }
    mesh->set = calloc(5, sizeof *mesh->set); /* sf_mesh_free releases sets with free */
    mesh->set_count = 5;
    add_set(mesh, 0, "base", 4, false, true, b);
    add_set(mesh, 1, "top", 4, true, false, b);
    add_set(mesh, 2, "sides", 1 | 2, true, true, b);
    add_set(mesh, 3, "plane_x", 1, false, true, b);
    add_set(mesh, 4, "plane_y", 2, false, true, b);
}

static void join_set(sf_node_set *set, int32_t node) {
    for (int64_t k = 0; k < set->count; k++)
        if (set->node[k] == node)
            return;
    set->node[set->count++] = node;
}

/* Appends a copy of `node`, `width` further, to the mesh and to the sets that hold the node. */
static int32_t double_node(sf_mesh *mesh, int32_t node, double width) {
    int32_t copy = (int32_t)mesh->node_count++;
    memcpy(&mesh->position[3 * (int64_t)copy], &mesh->position[3 * (int64_t)node], 3 * sizeof(double));
    mesh->position[3 * (int64_t)copy] += width;
    for (int g = 0; g < mesh->set_count; g++)
        for (int64_t k = mesh->set[g].count - 1; k >= 0; k--)
            if (mesh->set[g].node[k] == node)
                join_set(&mesh->set[g], copy);
    return copy;
}

void fixture_open_slit(const fixture_block *b, int column, int tip, double width, sf_mesh *mesh) {
    int64_t first = mesh->node_count, most = 2 * first;
    int32_t *twin = allocate((size_t)first, sizeof *twin);
    double *position = allocate(3 * (size_t)most, sizeof *position);
    memcpy(position, mesh->position, 3 * (size_t)first * sizeof *position);
    free(mesh->position);
    mesh->position = position;
    for (int g = 0; g < mesh->set_count; g++) {
        int32_t *node = allocate((size_t)most, sizeof *node);
        memcpy(node, mesh->set[g].node, (size_t)mesh->set[g].count * sizeof *node);
        free(mesh->set[g].node);
        mesh->set[g].node = node;
    }
    sf_node_set *sides = &mesh->set[2];
    for (int k = tip < 0 ? 0 : tip; k <= b->cells[2]; k++)
        for (int j = 0; j <= b->cells[1]; j++) {
            int32_t node = lattice(b, column, j, k);
            join_set(sides, node);
            twin[node] = k > tip ? double_node(mesh, node, width) : 0;
        }
    for (int64_t cell = 0; cell < mesh->cell_count; cell++)
        for (int v = 0; cell % b->cells[0] >= column && v < 8; v++) {
            int32_t *node = &mesh->cell_node[8 * cell + v];
            *node = twin[*node] ? twin[*node] : *node;
        }
    free(twin);
}

void fixture_plate(double side, double x, double y, sf_surface *s) {
    static const int32_t triangle[6] = {0, 2, 1, 0, 3, 2};
    *s = (sf_surface){.node_count = 4, .triangle_count = 2};
    s->position = allocate(12, sizeof *s->position);
    s->triangle = allocate(6, sizeof *s->triangle);
    memcpy(s->triangle, triangle, sizeof triangle);
    for (int v = 0; v < 4; v++) {
        s->position[3 * v] = x + (v == 1 || v == 2 ? 0.5 : -0.5) * side;
        s->position[3 * v + 1] = y + (v >= 2 ? 0.5 : -0.5) * side;
        s->position[3 * v + 2] = HEIGHT;
    }
}

void fixture_dome(double radius, int rings, double x, double y, sf_surface *s) {
    int around = 4 * rings;
    *s = (sf_surface){.node_count = 1 + (int64_t)rings * around,
                      .triangle_count = (int64_t)around * (2 * rings - 1)};
    s->position = allocate(3 * (size_t)s->node_count, sizeof *s->position);
    s->triangle = allocate(3 * (size_t)s->triangle_count, sizeof *s->triangle);
    int32_t *t = s->triangle;
    for (int64_t v = 0; v < s->node_count; v++) {
        int64_t ring = v == 0 ? 0 : 1 + (v - 1) / around, step = v == 0 ? 0 : (v - 1) % around;
        double polar = 0.5 * PI * (double)ring / rings, turn = 2 * PI * (double)step / around;
        s->position[3 * v] = x + radius * sin(polar) * cos(turn);
        s->position[3 * v + 1] = y + radius * sin(polar) * sin(turn);
        s->position[3 * v + 2] = HEIGHT + radius * (1 - cos(polar));
    }
    for (int ring = 0; ring < rings; ring++)
        for (int k = 0; k < around; k++) {
            int next = (k + 1) % around, inner = 1 + (ring - 1) * around, outer = 1 + ring * around;
            const int32_t fan[3] = {ring == 0 ? 0 : (int32_t)(inner + k), (int32_t)(outer + next),
                                    (int32_t)(outer + k)};
            memcpy(t, fan, sizeof fan);
            t += 3;
            if (ring == 0)
                continue;
            const int32_t rest[3] = {(int32_t)(inner + k), (int32_t)(inner + next), (int32_t)(outer + next)};
            memcpy(t, rest, sizeof rest);
            t += 3;
        }
}

void fixture_build(sf_case *c, sf_mesh *mesh, sf_surface *surface, fixture *out) {
    sf_error err = SF_ERROR_INIT;
    memset(out, 0, sizeof *out);
    sf_status status = sf_model_build(c, mesh, surface, &out->model, &out->report, NULL, &err);
    sf_surface_free(surface);
    sf_mesh_free(mesh);
    sf_case_free(c);
    require(status, &err);
}

void fixture_pad(const char *const *overrides, fixture *out) {
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture_case(&c, overrides);
    fixture_geometry(&c, &mesh, &surface);
    fixture_build(&c, &mesh, &surface, out);
}

void fixture_under_plate(sf_case *c, const fixture_block *block, double side, double x, double y,
                         fixture *out) {
    sf_mesh mesh;
    sf_surface surface;
    fixture_block_mesh(block, &mesh);
    fixture_plate(side, x, y, &surface);
    fixture_build(c, &mesh, &surface, out);
}

void fixture_under_dome(sf_case *c, const fixture_block *block, double radius, int rings, double x, double y,
                        fixture *out) {
    sf_mesh mesh;
    sf_surface surface;
    fixture_block_mesh(block, &mesh);
    fixture_dome(radius, rings, x, y, &surface);
    fixture_build(c, &mesh, &surface, out);
}

void fixture_hold_mesh(sf_mesh *mesh, fixture *out) {
    sf_case c;
    sf_surface surface;
    fixture_case(&c, NULL);
    fixture_hold(&c, (const char *const[]){"base", "top", "sides", NULL});
    fixture_plate(1, 0, 0, &surface);
    fixture_build(&c, mesh, &surface, out);
}

void fixture_held_block(const fixture_block *block, fixture *out) {
    sf_mesh mesh;
    fixture_block_mesh(block, &mesh);
    fixture_hold_mesh(&mesh, out);
}

void fixture_start(fixture *f) {
    sf_error err = SF_ERROR_INIT;
    sf_operators_free(&f->operators);
    sf_state_free(&f->state);
    require(sf_operators_build(&f->model, &f->operators, &err), &err);
    require(sf_state_create(&f->model, &f->state, &err), &err);
}

void fixture_free(fixture *f) {
    sf_state_free(&f->state);
    sf_operators_free(&f->operators);
    sf_model_free(&f->model);
}

void fixture_forces(fixture *f) {
#pragma omp parallel default(none) shared(f)
    {
        sf_domain_stress(&f->model, &f->operators, &f->state);
        sf_stabilisation(&f->model, &f->operators, &f->state);
        sf_internal_force(&f->model, &f->operators, &f->state);
    }
}

double fixture_pair_weight(const sf_model *m, int64_t i, int64_t j) {
    double square = 0, share = m->volume[i] / (double)(m->edge_ptr[i + 1] - m->edge_ptr[i]) +
                               m->volume[j] / (double)(m->edge_ptr[j + 1] - m->edge_ptr[j]);
    for (int c = 0; c < 3; c++)
        square += pow(m->position[3 * j + c] - m->position[3 * i + c], 2);
    return m->run.stabilisation * share / (2 * square);
}

double fixture_pairs(const fixture *f, const double *stiffness, int64_t i, double force[3],
                     double couple[9]) {
    sf_pair_sums sums;
    int64_t place = i % SF_GROUP;
    const sf_pair_field field = {f->state.d, f->state.f,           stiffness,
                                 stiffness,  f->state.pair_offset, f->state.group_has_offsets};
    sf_stabilisation_group(&f->model, &f->operators.pairs, &field, i / SF_GROUP, &sums);
    for (int r = 0; r < 3; r++) {
        force[r] = sums.force[place][r];
        for (int c = 0; c < 3; c++)
            couple[3 * r + c] = sums.couple[place][c][r];
    }
    return sums.after[place][0] + sums.after[place][1] + sums.after[place][2];
}

void fixture_set_affine(fixture *f, const double gradient[9], const double shift[3]) {
    for (int64_t i = 0; i < f->model.node_count; i++)
        for (int r = 0; r < 3; r++) {
            const double *x = &f->model.position[3 * i];
            f->state.d[3 * i + r] =
                gradient[3 * r] * x[0] + gradient[3 * r + 1] * x[1] + gradient[3 * r + 2] * x[2] + shift[r];
        }
}

void fixture_step(fixture *f) {
    sf_error err = SF_ERROR_INIT;
    require(sf_step_evaluate(&f->model, &f->operators, &f->state, &err), &err);
    const sf_ledger *l = &f->state.ledger;
    if (!(l->largest_error >= fabs(l->error)))
        fail_msg("the energy error is %g, and the largest one %g", l->error, l->largest_error);
}

void fixture_advance(fixture *f) {
    fixture_step(f);
    sf_step_advance(&f->model, &f->state);
}

double fixture_held_acceleration(fixture *f, const sf_constraint *constraint) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    sf_constraint_step step = {.force = s->force, .v = s->v, .dt = 1e-5, .reaction = s->reaction};
    double free_motion = 0, held_motion = 0;
    sf_constraint_project(constraint, &step);
    for (int64_t k = 0; k < 3 * m->node_count; k++) {
        free_motion = larger(free_motion, fabs(s->force[k]) / m->mass[k / 3]);
        held_motion = larger(held_motion, fabs(s->force[k] - s->reaction[k]) / m->mass[k / 3]);
    }
    if (!(free_motion > 0))
        fail_msg("no forces act");
    return held_motion / free_motion;
}
