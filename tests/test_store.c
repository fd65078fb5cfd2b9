/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mesh and the domains of a geometry are made once for all drops with it: the model is the same, bit by
 * bit, and nothing is shared where something differs. */
#include "io/h5_data.h"
#include "model/model_io.h"
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* A cube that merges a file, and softfall-mesh behind a script that counts its calls and leaves no
 * spare for the next one. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    const char *source = getenv("SF_SOURCE_DIR"), *bin = getenv("SF_BIN_DIR");
    int code =
        program_shell(p,
                      "cp -r '%s/examples' '%s/geo' . && echo 'Merge \"size.geo\";' >> geo/cube.geo && "
                      "echo '// nothing' > geo/size.geo && mkdir bin && touch calls && "
                      "ln -s '%s'/softfall-* bin && rm bin/softfall-mesh && "
                      "printf '#!/bin/sh\\necho mesh >> \"%s/calls\"\\nexec \"%s/softfall-mesh\" 6>&-\\n' "
                      "> bin/softfall-mesh && chmod +x bin/softfall-mesh",
                      source, source, bin, p->folder, bin)
            .code;
    setenv("SF_BIN_DIR", program_path(p, "bin"), 1);
    unsetenv("SOFTFALL_SHARE");
    return code;
}

/* Runs softfall-pre; how often was a geometry meshed? */
static int count_meshes(const program_place *p, const char *model, const char *share, const char *more) {
    program_shell(p, "rm -f calls; touch calls");
    program_result made =
        program_run(p, "pre",
                    "examples/compression/case.cfg -o %s -f %s --set geometry.parameters.spacing=25 "
                    "--set solver.end_time='20 ms' %s",
                    model, share, more);
    assert_int_equal(made.code, 0);
    return atoi(program_shell(p, "wc -l < calls").out);
}

/* The arrays and numbers of both models. */
static void assert_same_model(const program_place *p, const char *one, const char *other) {
    sf_error err = SF_ERROR_INIT;
    sf_model a, b;
    if (sf_model_read(program_path(p, one), &a, NULL, &err) != SF_OK ||
        sf_model_read(program_path(p, other), &b, NULL, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(a.node_count, b.node_count);
    size_t n = (size_t)a.node_count;
    assert_memory_equal(a.position, b.position, 3 * n * sizeof *a.position);
    assert_memory_equal(a.support, b.support, n * sizeof *a.support);
    assert_memory_equal(a.volume, b.volume, n * sizeof *a.volume);
    assert_memory_equal(a.mass, b.mass, n * sizeof *a.mass);
    assert_int_equal(a.domain_nnz, b.domain_nnz);
    assert_memory_equal(a.domain_node, b.domain_node, (size_t)a.domain_nnz * sizeof *a.domain_node);
    assert_memory_equal(a.domain_b, b.domain_b, 3 * (size_t)a.domain_nnz * sizeof *a.domain_b);
    assert_int_equal(a.phi_nnz, b.phi_nnz);
    assert_memory_equal(a.phi_value, b.phi_value, (size_t)a.phi_nnz * sizeof *a.phi_value);
    sf_model_free(&a);
    sf_model_free(&b);
}

/* The list of the files that the geometries of a model were read from. Owned: free. */
static char *files_read_for(const program_place *p, const char *model) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = program_open_h5(p, model);
    char *text = NULL;
    if (sf_h5_read_text(file, "/provenance/geometry_files", &text, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_h5_drop(&file);
    return text;
}

static void another_foam_or_speed_does_not_mesh_again(void **state) {
    const program_place *p = *state;
    const char *foam = "--set material.density='50 kg/m3' --set missile.friction=0.4";
    assert_int_equal(count_meshes(p, "alone.h5", "", foam), 2); /* pad and platen */
    assert_int_equal(count_meshes(p, "first.h5", "--share shared", ""), 2);
    assert_int_equal(count_meshes(p, "second.h5", "--share shared", foam), 0);
    assert_same_model(p, "alone.h5", "second.h5");
    assert_string_equal(program_shell(p, "ls shared | grep -c domains").out,
                        "1\n"); /* and none of a section: no drop is like a prescribed motion */
    /* The lists of what was read are those of a meshing too. */
    char *alone = files_read_for(p, "alone.h5"), *second = files_read_for(p, "second.h5");
    assert_true(*alone);
    assert_string_equal(alone, second);
    free(alone);
    free(second);
}

static void what_differs_is_made_anew(void **state) {
    const program_place *p = *state;
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 0);
    program_shell(p, "echo 'Mesh.RandomFactor = 1e-8;' > geo/size.geo"); /* merged */
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 1);
    assert_int_equal(count_meshes(p, "alone.h5", "", ""), 2);
    assert_same_model(p, "alone.h5", "m.h5");
    program_shell(p, "touch geo/size.geo.opt");
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 1);
    program_shell(p, "rm geo/size.geo.opt");
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 1);
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", "--set geometry.parameters.side=51"), 1);
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", "--set geometry.parameters.side=50"),
                     0); /* which now comes last */
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", "--set kernel.support_ratio=1.9"), 0);
    assert_int_equal(count_meshes(p, "alone.h5", "", "--set kernel.support_ratio=1.9"), 2);
    assert_same_model(p, "alone.h5", "m.h5");
}

static void a_damaged_store_counts_as_none(void **state) {
    const program_place *p = *state;
    assert_int_equal(count_meshes(p, "alone.h5", "", ""), 2);
    program_shell(p,
                  "for f in shared/*.bin; do printf 'x' | dd of=$f bs=1 seek=200 conv=notrunc 2>/dev/null; "
                  "done");
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 2);
    assert_same_model(p, "alone.h5", "m.h5");
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 0);
    program_shell(p, "for f in shared/*.bin; do truncate -s 20 $f; done");
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 2);
    program_shell(p, "mkdir taken && echo mine > taken/file");
    assert_int_equal(count_meshes(p, "m.h5", "--share taken", ""), 2); /* not a folder of softfall */
    assert_string_equal(program_shell(p, "ls -A taken").out, "file\n");
}

/* Also for a model with shorter steps, which tell no more of a mesh. */
static void drops_of_the_section_are_run_once(void **state) {
    static const char *const share[] = {"", "--share sections",
                                        "--share sections --set solver.step_safety=0.1"};
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_model m[3];
    for (int k = 0; k < 3; k++) {
        program_succeed(p, "pre", "examples/eva50-v4.5/case.cfg -o m.h5 -f %s %s", program_coarse(25),
                        share[k]);
        assert_string_equal(program_shell(p, "ls sections 2>/dev/null | grep -c section-").out,
                            k == 0 ? "0\n" : "4\n");
        if (sf_model_read(program_path(p, "m.h5"), &m[k], NULL, &err) != SF_OK)
            fail_msg("%s", err.text);
        if (k == 1)
            program_shell(p, "touch -d @0 sections/section-*");
    }
    assert_string_equal(program_shell(p, "find sections -name 'section-*' -newermt 2000-01-01").out,
                        ""); /* none is written again */
    assert_true(m[0].section.a_max_g > 0);
    for (int k = 2; k >= 0; k--) {
        assert_memory_equal(&m[k].section, &m[0].section, sizeof m[k].section);
        assert_true(m[k].expected_mesh_error == m[0].expected_mesh_error);
        sf_model_free(&m[k]);
    }
}

static void a_folder_for_all_programs_stands_before_their_own(void **state) {
    const program_place *p = *state;
    setenv("SOFTFALL_SHARE", program_path(p, "all"), 1);
    assert_int_equal(count_meshes(p, "m.h5", "", ""), 2);
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", ""), 0);
    assert_int_equal(count_meshes(p, "m.h5", "", ""), 0);
    unsetenv("SOFTFALL_SHARE");
}

static void a_full_store_is_emptied(void **state) {
    const program_place *p = *state;
    program_shell(p, "truncate -s 1G shared/mesh-0123456789abcdef.bin");
    assert_int_equal(count_meshes(p, "m.h5", "--share shared", "--set geometry.parameters.side=52"), 2);
    assert_string_equal(program_shell(p, "ls shared | grep -c -e mesh -e domains").out, "3\n");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_foam_or_speed_does_not_mesh_again),
        cmocka_unit_test(what_differs_is_made_anew),
        cmocka_unit_test(a_damaged_store_counts_as_none),
        cmocka_unit_test(drops_of_the_section_are_run_once),
        cmocka_unit_test(a_folder_for_all_programs_stands_before_their_own),
        cmocka_unit_test(a_full_store_is_emptied),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
