/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pad must be one body: parts, overlaps, hinges and doubled cells are refused with their place. */
#include "model_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const fixture_block BLOCK = {.cells = {6, 4, 4}, .spacing = 0.01, .jitter = 0.1};

/* The error of the build of a block under a plate; the mesh is released. */
static sf_error build(sf_mesh *mesh) {
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    sf_model m;
    sf_surface plate;
    sf_build_report report;
    fixture_case(&c, NULL);
    c.symmetry_count = 0;
    fixture_plate(0.1, 0.03, 0.02, &plate);
    sf_model_build(&c, mesh, &plate, &m, &report, NULL, &err);
    sf_model_free(&m);
    sf_surface_free(&plate);
    sf_mesh_free(mesh);
    sf_case_free(&c);
    return err;
}

static void assert_refused(sf_mesh *mesh, const char *const *words) {
    sf_error err = build(mesh);
    assert_int_equal(err.status, SF_ERR_INPUT);
    for (; *words; words++)
        if (!strstr(err.text, *words))
            fail_msg("\"%s\" is missing in: %s", *words, err.text);
}

static void bodies_in_one_piece_are_built(void **state) {
    (void)state;
    sf_mesh mesh;
    fixture_block_mesh(&BLOCK, &mesh);
    assert_int_equal(build(&mesh).status, SF_OK);
    fixture_block_mesh(&BLOCK, &mesh);
    fixture_open_slit(&BLOCK, 4, 1, 0.004, &mesh);
    assert_int_equal(build(&mesh).status, SF_OK);
}

static void parts_are_refused(void **state) {
    (void)state;
    sf_mesh mesh;
    fixture_block even = BLOCK;
    even.jitter = 0;
    fixture_block_mesh(&even, &mesh);
    fixture_open_slit(&even, 4, -1, 0.0005, &mesh);
    assert_refused(&mesh, (const char *const[]){"2 parts that share no faces",
                                                "of 32 cells, lies between (40.5, 0, 0)",
                                                "and (60, 40, 40) mm", "fuse the volumes", NULL});
}

/* The right half reaches 4 mm into the left one above the tip. */
static void overlap_is_refused(void **state) {
    (void)state;
    sf_mesh mesh;
    fixture_block_mesh(&BLOCK, &mesh);
    fixture_open_slit(&BLOCK, 4, 1, -0.004, &mesh);
    assert_refused(&mesh,
                   (const char *const[]){"the pad overlaps itself", "lies inside the cell at", "mm", NULL});
}

/* Removes the cells that have their lowest corner at (i, j, k >= 2). */
static void remove_column(sf_mesh *mesh, int i, int j) {
    int64_t kept = 0;
    for (int64_t cell = 0; cell < mesh->cell_count; cell++) {
        int32_t node = mesh->cell_node[8 * cell];
        int column = node % (BLOCK.cells[0] + 1), layer = node / (BLOCK.cells[0] + 1) / (BLOCK.cells[1] + 1),
            row = node / (BLOCK.cells[0] + 1) % (BLOCK.cells[1] + 1);
        if (column == i && row == j && layer >= 2)
            continue;
        memmove(&mesh->cell_node[8 * kept++], &mesh->cell_node[8 * cell], 8 * sizeof *mesh->cell_node);
    }
    mesh->cell_count = kept;
}

static void hinges_are_refused(void **state) {
    (void)state;
    sf_mesh mesh;
    fixture_block_mesh(&BLOCK, &mesh);
    remove_column(&mesh, 1, 1);
    assert_int_equal(build(&mesh).status, SF_OK); /* a hole */
    fixture_block_mesh(&BLOCK, &mesh);
    remove_column(&mesh, 1, 1);
    remove_column(&mesh, 2, 2);
    assert_refused(&mesh, (const char *const[]){"hang together at an edge or a point only, at (2", NULL});
}

static void doubled_cells_are_refused(void **state) {
    (void)state;
    sf_mesh mesh;
    fixture_block_mesh(&BLOCK, &mesh);
    memcpy(&mesh.cell_node[8], mesh.cell_node, 8 * sizeof *mesh.cell_node);
    memcpy(&mesh.cell_node[16], mesh.cell_node, 8 * sizeof *mesh.cell_node);
    assert_refused(&mesh, (const char *const[]){"the pad's cells overlap: 3 of them share one face", NULL});
}

/* Two tetrahedra on one side of the triangle that they share. */
static void cells_on_one_side_of_their_face_are_refused(void **state) {
    (void)state;
    double position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.2, 0.2, 2};
    int32_t node[] = {0, 1, 2, 3, 0, 1, 2, 4};
    uint8_t type[] = {SF_CELL_TETRAHEDRON, SF_CELL_TETRAHEDRON};
    int64_t ptr[] = {0, 4, 8};
    const sf_mesh mesh = {.node_count = 5,
                          .position = position,
                          .cell_count = 2,
                          .cell_type = type,
                          .cell_ptr = ptr,
                          .cell_node = node};
    sf_dual dual;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_dual_build(&mesh, &dual, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "on the same side of it"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bodies_in_one_piece_are_built),
        cmocka_unit_test(parts_are_refused),
        cmocka_unit_test(overlap_is_refused),
        cmocka_unit_test(hinges_are_refused),
        cmocka_unit_test(doubled_cells_are_refused),
        cmocka_unit_test(cells_on_one_side_of_their_face_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
