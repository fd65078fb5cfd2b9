/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape functions of inner nodes, which a model drops and frames take from its file again: what stays is
 * what was there, frames are the same bits, and a file that is not that of the model is refused. */
#include "model_fixture.h"
#include "program_fixture.h"

#include "io/model_io.h"
#include "solver/run/frame.h"
#include <hdf5.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* 21 x 21 x 13 nodes, more than 5 slabs, the last of which is cut; its surface is held. */
static const fixture_block block = {.cells = {20, 20, 12}, .spacing = 0.005, .jitter = 0.1};

typedef struct shapes_case {
    const program_place *place; /* with model.h5 */
    fixture f;                  /* displaced and moving at random */
} shapes_case;

static int set_up(void **state) {
    static shapes_case c;
    sf_error err = SF_ERROR_INIT;
    uint64_t seed = 5;
    memset(&c, 0, sizeof c);
    c.place = program_group_set_up(state);
    fixture_held_block(&block, &c.f);
    fixture_start(&c.f);
    for (int64_t k = 0; k < 3 * c.f.model.node_count; k++) {
        c.f.state.d[k] = 1e-4 * fixture_random(&seed);
        c.f.state.v[k] = fixture_random(&seed);
    }
    fixture_forces(&c.f);
    const sf_provenance provenance = {.program = "test_shapes"};
    assert_int_equal(sf_model_write(program_path(c.place, "model.h5"), &c.f.model, &provenance, &err), SF_OK);
    assert_true(c.f.model.node_count > 2 * SF_SLAB && c.f.model.node_count % SF_SLAB != 0);
    *state = &c;
    return 0;
}

static int tear_down(void **state) {
    shapes_case *c = *state;
    void *place = (void *)c->place;
    fixture_free(&c->f);
    return program_group_tear_down(&place);
}

/* The model of the file, whole, with the file open. */
static void read_model(const shapes_case *c, const char *name, sf_model *m, sf_h5 **file) {
    sf_error err = SF_ERROR_INIT;
    if (sf_model_read(program_path(c->place, name), m, file, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static void rows_of_held_nodes_and_contact_points_stay(void **state) {
    const shapes_case *c = *state;
    const sf_model *whole = &c->f.model;
    sf_model m;
    int64_t rows = 0, contacts = 0, entries = 0;
    read_model(c, "model.h5", &m, NULL);
    m.fixed_count /= 2; /* then some contact points are not held */
    bool *kept = calloc((size_t)m.node_count, 1);
    assert_non_null(kept);
    for (int64_t k = 0; k < m.fixed_count; k++)
        kept[m.fixed_node[k]] = true;
    for (int64_t k = 0; k < m.contact_count; k++) {
        contacts += !kept[m.contact_node[k]];
        kept[m.contact_node[k]] = true;
    }
    sf_model_drop_inner_shapes(&m);
    assert_int_equal(m.phi_ptr[0], 0);
    for (int64_t i = 0; i < m.node_count; i++) {
        int64_t begin = m.phi_ptr[i], length = m.phi_ptr[i + 1] - begin, before = whole->phi_ptr[i];
        assert_int_equal(length, kept[i] ? whole->phi_ptr[i + 1] - before : 0);
        assert_memory_equal(&m.phi_node[begin], &whole->phi_node[before],
                            (size_t)length * sizeof *m.phi_node);
        assert_memory_equal(&m.phi_value[begin], &whole->phi_value[before],
                            (size_t)length * sizeof *m.phi_value);
        rows += kept[i];
        entries += length;
    }
    assert_int_equal(m.phi_nnz, entries);
    assert_true(contacts > 0 && rows > contacts && rows < m.node_count / 2);
    free(kept);
    sf_model_free(&m);
}

static void write_frame(const shapes_case *c, const sf_model *m, const sf_shapes *shapes, const char *name) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = NULL;
    sf_h5_create(program_path(c->place, name), &file, &err);
    sf_frame_write(m, &c->f.operators, &c->f.state, shapes, SF_FIELD_ALL, "/frame", file, &err);
    if (sf_h5_close(&file, &err) != SF_OK || err.status != SF_OK)
        fail_msg("%s", err.text);
}

static void assert_same_field(const shapes_case *c, sf_h5 *const *file, const char *name, int columns) {
    sf_error err = SF_ERROR_INIT;
    int64_t n = c->f.model.node_count, dims[2] = {n, columns};
    double *data[2] = {NULL, NULL};
    for (int k = 0; k < 2; k++)
        if (sf_h5_read(file[k], name, SF_H5_F64, columns > 1 ? 2 : 1, dims, (void **)&data[k], &err) != SF_OK)
            fail_msg("%s", err.text);
    assert_memory_equal(data[0], data[1], (size_t)(n * columns) * sizeof *data[0]);
    free(data[0]);
    free(data[1]);
}

/* The model in memory, and one that has dropped its inner rows, with the file under another name meanwhile.
 */
static void frames_are_the_same_bits(void **state) {
    const shapes_case *c = *state;
    sf_error err = SF_ERROR_INIT;
    sf_model m;
    sf_h5 *model_file = NULL, *file[2];
    sf_shapes shapes;
    program_shell(c->place, "cp model.h5 same.h5");
    read_model(c, "same.h5", &m, &model_file);
    assert_int_equal(sf_shapes_open(&m, model_file, &shapes, &err), SF_OK);
    sf_model_drop_inner_shapes(&m);
    program_shell(c->place, "mv same.h5 elsewhere.h5; echo other > same.h5");
    write_frame(c, &c->f.model, NULL, "whole_frame.h5");
    write_frame(c, &m, &shapes, "frame.h5");
    file[0] = program_open_h5(c->place, "whole_frame.h5");
    file[1] = program_open_h5(c->place, "frame.h5");
    assert_same_field(c, file, "/frame/displacement", 3);
    assert_same_field(c, file, "/frame/velocity", 3);
    assert_same_field(c, file, "/frame/cauchy_stress", 9);
    assert_same_field(c, file, "/frame/von_mises", 1);
    assert_same_field(c, file, "/frame/principal_stretches", 3);
    assert_same_field(c, file, "/frame/energy_density", 1);
    sf_h5_close(&file[0], &err);
    sf_h5_close(&file[1], &err);
    sf_shapes_close(&shapes);
    sf_h5_close(&model_file, &err);
    sf_model_free(&m);
}

/* Writes `size` bytes at an item of a dataset of the file, past the library. */
static void damage(const program_place *p, const char *name, const char *dataset, long item, const void *data,
                   size_t size) {
    hid_t file = H5Fopen(program_path(p, name), H5F_ACC_RDONLY, H5P_DEFAULT);
    hid_t set = H5Dopen2(file, dataset, H5P_DEFAULT);
    long place = (long)H5Dget_offset(set) + item * (long)size;
    H5Dclose(set);
    H5Fclose(file);
    FILE *bytes = fopen(program_path(p, name), "r+b");
    assert_true(bytes && fseek(bytes, place, SEEK_SET) == 0 && fwrite(data, size, 1, bytes) == 1);
    assert_int_equal(fclose(bytes), 0);
}

/* Anything in the last slab that differs from what was read with the model: pointers that would lead astray,
 * nodes that do not exist, other nodes and values, and a file that has lost its end, for which HDF5 gives
 * zeros. */
static void changed_file_is_refused(void **state) {
    static const int64_t before = -8, beyond = INT64_C(1) << 60;
    static const int32_t no_node = -1, far = 1 << 30, other = 0;
    static const double value = 0.25;
    const shapes_case *c = *state;
    const sf_model *whole = &c->f.model;
    const struct {
        const char *dataset;
        long item;
        const void *data;
        size_t size;
    } row[] = {
        {"/shape/ptr", whole->node_count, &before, 8},     {"/shape/ptr", whole->node_count, &beyond, 8},
        {"/shape/ptr", whole->node_count - 2, &beyond, 8}, {"/shape/node", whole->phi_nnz - 1, &no_node, 4},
        {"/shape/node", whole->phi_nnz - 1, &far, 4},      {"/shape/node", whole->phi_nnz - 1, &other, 4},
        {"/shape/value", whole->phi_nnz - 1, &value, 8},   {NULL, 0, NULL, 0}};
    for (size_t k = 0; k < sizeof row / sizeof row[0]; k++) {
        sf_error err = SF_ERROR_INIT, none = SF_ERROR_INIT;
        sf_model m;
        sf_h5 *model_file = NULL, *frame = NULL;
        sf_shapes shapes;
        program_shell(c->place, "cp model.h5 damaged.h5");
        read_model(c, "damaged.h5", &m, &model_file);
        assert_int_equal(sf_shapes_open(&m, model_file, &shapes, &none), SF_OK);
        sf_model_drop_inner_shapes(&m);
        if (row[k].dataset)
            damage(c->place, "damaged.h5", row[k].dataset, row[k].item, row[k].data, row[k].size);
        else
            program_shell(c->place, "truncate -s 100000 damaged.h5");
        sf_h5_create(program_path(c->place, "after.h5"), &frame, &none);
        sf_frame_write(&m, &c->f.operators, &c->f.state, &shapes, SF_FIELD_DISPLACEMENT, "/frame", frame,
                       &err);
        if (err.status != SF_ERR_IO || !strstr(err.text, "damaged.h5 has changed since the run began"))
            fail_msg("case %zu: %s", k, err.status == SF_OK ? "no failure" : err.text);
        sf_h5_close(&frame, &none);
        sf_shapes_close(&shapes);
        sf_h5_close(&model_file, &none);
        sf_model_free(&m);
    }
}

static void file_of_another_model_is_refused(void **state) {
    const shapes_case *c = *state;
    sf_error err = SF_ERROR_INIT, none = SF_ERROR_INIT;
    sf_model m;
    sf_h5 *file = NULL;
    sf_shapes shapes;
    read_model(c, "model.h5", &m, &file);
    m.node_count--;
    assert_int_equal(sf_shapes_open(&m, file, &shapes, &err), SF_ERR_IO);
    assert_non_null(strstr(err.text, "/shape/ptr has extent"));
    m.node_count++;
    sf_shapes_close(&shapes);
    sf_h5_close(&file, &none);
    sf_model_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_of_held_nodes_and_contact_points_stay),
        cmocka_unit_test(frames_are_the_same_bits),
        cmocka_unit_test(changed_file_is_refused),
        cmocka_unit_test(file_of_another_model_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
