/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wrong command lines, wrong cases, damaged files: each is refused with one sentence that says what is wrong
 * and a code that is not 0, and files from before stay as they were, byte by byte. */
#include "check.h"
#include "io/h5_data.h"
#include "model/model_io.h"
#include "model_fixture.h"
#include "program_fixture.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Not 0, no signal; one line on stderr (argp adds a second one that points to --help), with `part` in it. */
static void assert_refused(const program_result *r, const char *part) {
    int lines = 0;
    for (const char *c = r->err; *c; c++)
        lines += *c == '\n';
    if (r->code <= 0 || r->code >= 128)
        fail_msg("exit code %d where \"%s\" was expected: %s", r->code, part, r->err);
    if (!strstr(r->err, part))
        fail_msg("\"%s\" is missing in: %s", part, r->err);
    if (lines != 1 && !(lines == 2 && strstr(r->err, "--help")))
        fail_msg("%d lines: %s", lines, r->err);
    if (strncmp(r->err, "softfall-", 9) != 0 && !strstr(r->err, "/softfall-"))
        fail_msg("the program's name is missing: %s", r->err);
}

static void command_lines_that_cannot_be_meant_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *program, *words, *part;
    } lines[] = {
        {"pre", "", "-o model.h5"},
        {"pre", "good.cfg", "-o model.h5"},
        {"pre", "good.cfg good.cfg -o new.h5", "unexpected \"good.cfg\""},
        {"pre", "good.cfg -o new.h5 --speed 3", "unrecognized option"},
        {"pre", "good.cfg -o new.h5 --set velocity=3", "group.key=value"},
        {"pre", "good.cfg -o new.h5 --set missile.velocity", "group.key=value"},
        {"pre", "good.cfg -o new.h5 --set missile.speed='3 m/s'", "velocity"}, /* what exists */
        {"pre", "good.cfg -o new.h5 --set rocket.speed='3 m/s'", "missile"},
        {"pre", "good.cfg -o new.h5 --set missile.velocity='3 kg'", "3 kg"},
        {"pre", "good.cfg -o new.h5 --set missile.velocity=3", "missile.velocity"},
        {"pre", "good.cfg -o new.h5 --set missile.mass='-1 kg'", "missile.mass"},
        {"pre", "good.cfg -o", "requires an argument"},
        {"solve", "", "-o results.h5"},
        {"solve", "model.h5", "-o results.h5"},
        {"solve", "model.h5 model.h5 -o new.h5", "one too many"},
        {"solve", "model.h5 -o new.h5 --threads 0", "1 to 1024"},
        {"solve", "model.h5 -o new.h5 --threads two", "two"},
        {"solve", "model.h5 -o new.h5 --gpu", "unrecognized option"},
        {"post", "", "results"},
        {"post", "results.h5", "-o"},
        {"post", "results.h5 results.h5 -o new", "results.h5"},
        {"post", "results.h5 -o new --filter 77", "1000"},
        {"post", "results.h5 -o new --window 3,4", "--reference"},
        {"post", "results.h5 -o new --reference none.csv", "none.csv"},
    };
    for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
        program_result result = program_run(p, lines[k].program, "%s", lines[k].words);
        assert_refused(&result, lines[k].part);
    }
    assert_int_equal(program_shell(p, "ls new new.h5 2>/dev/null | grep -c .").code, 1); /* none was begun */
}

static void files_that_are_missing_or_of_another_kind_are_refused(void **state) {
    const program_place *p = *state;
    program_shell(p, "echo 'This is a text.' > text.h5; : > empty.h5; mkdir -p folder.h5; "
                     "echo 'geometry = {' > broken.cfg; echo 'strain' > curve.csv");
    static const struct {
        const char *program, *words, *part;
    } inputs[] = {
        {"pre", "none.cfg", "none.cfg"},        {"pre", "folder.h5", "folder.h5"},
        {"pre", "broken.cfg", "broken.cfg"},    {"pre", "empty.h5", "empty.h5"},
        {"pre", "model.h5", "not a text file"}, {"solve", "none.h5", "none.h5"},
        {"solve", "text.h5", "text.h5"},        {"solve", "empty.h5", "empty.h5"},
        {"solve", "folder.h5", "folder.h5"},    {"solve", "results.h5", "softfall-model"},
        {"solve", "out/pad-*.h5", "out/pad-"},  {"post", "none.h5", "none.h5"},
        {"post", "text.h5", "text.h5"},         {"post", "empty.h5", "empty.h5"},
        {"post", "folder.h5", "folder.h5"},     {"post", "model.h5", "softfall-results"},
        {"post", "out/pad-*.h5", "out/pad-"},
    };
    for (size_t k = 0; k < sizeof inputs / sizeof inputs[0]; k++) {
        program_result result = program_run(p, inputs[k].program, "%s -o new.h5", inputs[k].words);
        assert_refused(&result, inputs[k].part);
        assert_int_equal(program_shell(p, "ls new.h5*").code, 2);
    }
}

static void places_that_cannot_be_written_are_refused(void **state) {
    const program_place *p = *state;
    char pre[512];
    snprintf(pre, sizeof pre, "good.cfg --set geometry.parameters.thickness=70 %s", program_coarse(10));
    const struct {
        const char *program, *words;
    } inputs[] = {{"pre", pre}, {"solve", "model.h5"}, {"post", "results.h5"}};
    static const char *const places[] = {"none/below/new", "good.cfg/new", "/proc/softfall-new"};
    for (size_t k = 0; k < 3; k++)
        for (size_t q = 0; q < 3; q++) {
            program_result result =
                program_run(p, inputs[k].program, "%s -o '%s' --force", inputs[k].words, places[q]);
            assert_refused(&result, places[q]);
        }
    program_bytes before = program_read_file(program_path(p, "good.cfg"));
    program_result over = program_run(p, "post", "results.h5 -o good.cfg --force"); /* a file, not a folder */
    assert_refused(&over, "good.cfg");
    program_assert_unchanged(program_path(p, "good.cfg"), &before);
}

static void cases_that_contradict_their_geometry_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *set, *part;
    } cases[] = {
        {"pad.fixed='[\"floor\"]'", "\"base\""}, /* what exists */
        {"pad.contact=lid", "\"top\""},
        {"pad.group=mattress", "pad"},
        {"pad.symmetry='[\"top\"]'", "not a plane normal to x or y"},
        {"missile.group=nose", "missile_surface"},
        {"geometry.parameters.colour=3.0", "colour"},
        {"geometry.parameters.zone_side=900.0", "zone_side"},
        {"geometry.file=none.geo", "none.geo"},
        {"geometry.length_unit=kg", "kg"},
        {"material.curve=none.csv", "none.csv"},
        {"material.curve=curve.csv", "curve.csv"},
        {"material.HU=2.0", "HU"},
        {"missile.direction='[0.0, 0.0, 1.0]'", "direction"},
        {"missile.direction='[0.6, 0.0, -0.8]'", "needs a model without that plane"},
        {"missile=@deep.cfg", "60 mm deep into a pad that is 50 mm thick"},
        {"kernel.support_ratio=0.5", "support_ratio"},
        {"solver.end_time='0 s'", "end_time"},
        {"output.fields='[\"colour\"]'", "colour"},
    };
    program_bytes before = program_read_file(program_path(p, "model.h5"));
    program_shell(p, "echo 'strain' > curve.csv; echo 'motion = \"deep.csv\";' > deep.cfg; printf "
                     "'time_ms,displacement_mm\\n0,0\\n100,60\\n' > deep.csv");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        program_result result = program_run(p, "pre", "good.cfg -o model.h5 --force %s --set %s",
                                            program_coarse(25), cases[k].set);
        assert_refused(&result, cases[k].part);
    }
    program_assert_unchanged(program_path(p, "model.h5"), &before);
}

/* Shapes the case cannot be meant to have: no file at all is left behind by a refused model. */
static void truncated_files_are_refused(void **state) {
    const program_place *p = *state;
    static const double shares[] = {0.001, 0.1, 0.5, 0.9, 0.999};
    for (int k = 0; k < 2; k++) {
        program_bytes whole = program_read_file(program_path(p, k ? "results.h5" : "model.h5"));
        for (size_t q = 0; q < sizeof shares / sizeof shares[0]; q++) {
            program_write_file(program_path(p, "cut.h5"), whole.data,
                               (size_t)(shares[q] * (double)whole.size));
            program_result result =
                k ? program_run(p, "post", "cut.h5 -o new") : program_run(p, "solve", "cut.h5 -o new.h5");
            assert_refused(&result, "cut.h5");
        }
        free(whole.data);
    }
    assert_int_equal(program_shell(p, "ls new new.h5").code, 2);
}

typedef void (*damage)(sf_model *m);

static void nan_in_position(sf_model *m) {
    m->position[7] = NAN;
}
static void infinite_gradient(sf_model *m) {
    m->domain_b[m->domain_nnz] = INFINITY;
}
static void domain_beyond_nodes(sf_model *m) {
    m->domain_node[m->domain_ptr[3]] = (int32_t)m->node_count;
}
static void negative_domain_index(sf_model *m) {
    m->domain_node[0] = -1;
}
static void rows_out_of_order(sf_model *m) {
    m->domain_ptr[5] = m->domain_ptr[7] + 1;
}
static void rows_beyond_the_end(sf_model *m) {
    m->phi_ptr[m->node_count] += 1;
}
static void shape_of_no_node(sf_model *m) {
    m->phi_node[m->phi_nnz - 1] = 1 << 30;
}
static void edge_out_of_range(sf_model *m) {
    m->edge_node[0] = -5;
}
static void edge_to_itself(sf_model *m) {
    m->edge_node[0] = 0;
}
static void edge_with_one_end(sf_model *m) {
    m->edge_node[m->edge_ptr[1] - 1] = (int32_t)m->node_count - 1;
}
static void negative_volume(sf_model *m) {
    m->volume[11] = -m->volume[11];
}
static void no_mass(sf_model *m) {
    m->mass[0] = 0;
}
static void falling_curve(sf_model *m) {
    sf_foam_card_of(&m->material[0])
        ->curves.curve_stress[sf_foam_card_of(&m->material[0])->curves.curve_points - 1] = 0;
}
static void no_curve(sf_model *m) {
    sf_foam_card_of(&m->material[0])
        ->curves.curve_ptr[sf_foam_card_of(&m->material[0])->curves.curve_count] -= 1;
}
static void curve_from_nowhere(sf_model *m) {
    sf_foam_card_of(&m->material[0])->curves.curve_stress[0] = 1;
}
static void curve_of_three_points(sf_model *m) {
    sf_foam_card_of(&m->material[0])->curves.curve_points =
        sf_foam_card_of(&m->material[0])->curves.curve_ptr[1] = 3;
}
static void material_out_of_range(sf_model *m) {
    m->node_material[m->node_count - 1] = 1;
}
static void unknown_law(sf_model *m) {
    static const sf_law law = {.name = "no_such_law", .curves = SIZE_MAX};
    sf_error err = SF_ERROR_INIT;
    sf_material *two = sf_alloc(&err, 2, sizeof *two, "materials");
    assert_int_equal(err.status, SF_OK);
    two[0] = m->material[0];
    two[1].law = &law;
    free(m->material);
    m->material = two;
    m->material_count = 2;
}
static void no_materials(sf_model *m) {
    sf_material_free(&m->material[0]);
    m->material_count = 0;
}
static void three_planes(sf_model *m) {
    m->symmetry_factor = 3;
}
static void held_in_no_direction(sf_model *m) {
    m->fixed_mask[0] = 0;
}
static void frame_before_the_beginning(sf_model *m) {
    sf_error err = SF_ERROR_INIT;
    free(m->frame_time);
    m->frame_time_count = 1;
    m->frame_time = sf_alloc(&err, 1, sizeof(double), "frame times");
    assert_int_equal(err.status, SF_OK);
    m->frame_time[0] = -0.001;
}
static void frames_without_end(sf_model *m) {
    m->run.frame_interval = 1e-9;
}
static void long_direction(sf_model *m) {
    m->missile.direction[2] = -2;
}
static void held_node_out_of_range(sf_model *m) {
    m->fixed_node[m->fixed_count - 1] = INT32_MAX;
}
static void contact_nodes_out_of_order(sf_model *m) {
    m->contact_node[1] = m->contact_node[0];
}
static void triangle_out_of_range(sf_model *m) {
    m->surface_triangle[0] = (int32_t)m->surface_node_count;
}
static void cell_of_no_type(sf_model *m) {
    m->cell_type[0] = 42;
}
static void cell_beyond_nodes(sf_model *m) {
    m->cell_node[m->cell_nnz - 1] = (int32_t)m->node_count;
}
static void no_hysteresis_unit(sf_model *m) {
    sf_foam_card_of(&m->material[0])->shared.hysteresis_hu = 0;
}
static void fast_missile(sf_model *m) {
    m->missile.speed = -4.5;
}
static void no_contact_points(sf_model *m) {
    m->contact_count = 0;
}

static void set_motion(sf_model *m, double time, double displacement) {
    sf_error err = SF_ERROR_INIT;
    free(m->motion_time); /* a model without a motion may hold empty lists */
    free(m->motion_displacement);
    m->motion_count = 2;
    m->motion_time = sf_alloc(&err, 2, sizeof(double), "motion");
    m->motion_displacement = sf_alloc(&err, 2, sizeof(double), "motion");
    assert_int_equal(err.status, SF_OK);
    m->motion_time[1] = time;
    m->motion_displacement[1] = displacement;
    m->missile.mass = m->missile.speed = m->missile.gravity = 0;
}
static void motion_that_stands(sf_model *m) {
    set_motion(m, 1, 0);
}
static void motion_too_short(sf_model *m) {
    set_motion(m, 0.5 * m->run.end_time, 0.01);
}
static void motion_backwards_in_time(sf_model *m) {
    set_motion(m, -1, 0.01);
}
static void motion_not_from_zero(sf_model *m) {
    set_motion(m, 1, 0.01);
    m->motion_displacement[0] = 0.001;
}
static void motion_of_a_heavy_missile(sf_model *m) {
    set_motion(m, 1, 0.01);
    m->missile.mass = 4.6;
}

static void damaged_models_are_refused_with_what_is_wrong(void **state) {
    const program_place *p = *state;
    static const struct {
        damage spoil;
        const char *part;
    } cases[] = {
        {nan_in_position, "/cloud/position"},
        {infinite_gradient, "/domain/b"},
        {domain_beyond_nodes, "smoothing domains"},
        {negative_domain_index, "smoothing domains"},
        {rows_out_of_order, "smoothing domains"},
        {rows_beyond_the_end, "shape functions"},
        {shape_of_no_node, "shape functions"},
        {edge_out_of_range, "edges"},
        {edge_to_itself, "has no length"},
        {edge_with_one_end, "which has none back"},
        {negative_volume, "node 11 has volume"},
        {no_mass, "node 0 has volume"},
        {falling_curve, "does not rise"},
        {no_curve, "no usable compression curve"},
        {curve_from_nowhere, "does not start at (0, 0)"},
        {curve_of_three_points, "fewer than 4 points"},
        {material_out_of_range, "is 1, outside 0 to 0"},
        {unknown_law, "\"no_such_law\" is not a law that this program has"},
        {no_materials, "/material/count is 0, outside 1 to 256"},
        {three_planes, "symmetry factor is 3"},
        {held_in_no_direction, "has mask 0"},
        {frame_before_the_beginning, "frame time -0.001 s"},
        {frames_without_end, "number of frames"},
        {long_direction, "direction"},
        {held_node_out_of_range, "constrained nodes"},
        {contact_nodes_out_of_order, "contact nodes"},
        {triangle_out_of_range, "missile triangle 0"},
        {cell_of_no_type, "background cell 0"},
        {cell_beyond_nodes, "background cells"},
        {no_hysteresis_unit, "HU"},
        {fast_missile, "missile speed"},
        {no_contact_points, "no contact points"},
        {motion_that_stands, "speed of the missile's motion"},
        {motion_too_short, "lies beyond the missile's motion"},
        {motion_backwards_in_time, "the times do not ascend"},
        {motion_not_from_zero, "the first (0, 0)"},
        {motion_of_a_heavy_missile, "missile mass"},
    };
    program_bytes before = program_read_file(program_path(p, "results.h5"));
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_model m;
        sf_provenance provenance = {.program = "test"};
        assert_int_equal(sf_model_read(program_path(p, "model.h5"), &m, NULL, &err), SF_OK);
        cases[k].spoil(&m);
        if (sf_model_write(program_path(p, "bad.h5"), &m, &provenance, &err) != SF_OK)
            fail_msg("%s", err.text);
        sf_model_free(&m);
        program_result result = program_run(p, "solve", "bad.h5 -o results.h5 --force");
        assert_refused(&result, cases[k].part);
        assert_non_null(strstr(result.err, "bad.h5"));
    }
    program_assert_unchanged(program_path(p, "results.h5"), &before);
}

/* A file of a newer format, and one that has the right name on it and nothing else in it. */
static void files_of_newer_formats_or_without_content_are_refused(void **state) {
    const program_place *p = *state;
    for (int k = 0; k < 4; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_h5 *file = NULL;
        bool model = k < 2, newer = k % 2;
        remove(program_path(p, "odd.h5"));
        assert_int_equal(sf_h5_create(program_path(p, "odd.h5"), &file, &err), SF_OK);
        sf_h5_set_attribute(file, "format", model ? "softfall-model" : "softfall-results", &err);
        sf_h5_set_attribute_i64(file, "format_version", newer ? SF_FORMAT_VERSION + 1 : SF_FORMAT_VERSION,
                                &err);
        sf_h5_close(&file, &err);
        assert_int_equal(err.status, SF_OK);
        program_result result =
            model ? program_run(p, "solve", "odd.h5 -o new.h5") : program_run(p, "post", "odd.h5 -o new");
        assert_refused(&result, newer ? "version" : "/");
        assert_true(strstr(result.err, "odd.h5") || !newer);
    }
}

/* Single bytes changed anywhere in the file: whatever the programs make of it, they end by themselves. */
static void flipped_bytes_never_crash_a_program(void **state) {
    const program_place *p = *state;
    uint64_t seed = 12;
    int refused = 0;
    for (int k = 0; k < 2; k++) {
        program_bytes whole = program_read_file(program_path(p, k ? "results.h5" : "model.h5"));
        for (int trial = 0; trial < 40; trial++) {
            /* Half of them in the first 4 kB, where the structure of the file stands. */
            size_t range = trial % 2 ? whole.size : 4096;
            size_t at = (size_t)(0.5 * (fixture_random(&seed) + 1) * (double)range);
            char kept = whole.data[at];
            whole.data[at] = (char)(kept ^ (1 << (trial % 8)));
            program_write_file(program_path(p, "flip.h5"), whole.data, whole.size);
            whole.data[at] = kept;
            program_result result =
                program_shell(p,
                              k ? "timeout 300 '%s/softfall-post' flip.h5 -o flip --force"
                                : "timeout 300 '%s/softfall-solve' flip.h5 -o flip.h5.out --force",
                              getenv("SF_BIN_DIR"));
            if (result.code >= 124)
                fail_msg("byte %zu of %s: exit code %d, %s", at, k ? "results.h5" : "model.h5", result.code,
                         result.err);
            refused += result.code != 0;
        }
        free(whole.data);
    }
    assert_true(refused > 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(command_lines_that_cannot_be_meant_are_refused),
        cmocka_unit_test(files_that_are_missing_or_of_another_kind_are_refused),
        cmocka_unit_test(places_that_cannot_be_written_are_refused),
        cmocka_unit_test(cases_that_contradict_their_geometry_are_refused),
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(damaged_models_are_refused_with_what_is_wrong),
        cmocka_unit_test(files_of_newer_formats_or_without_content_are_refused),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(flipped_bytes_never_crash_a_program),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_example, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_example, program_group_tear_down);
}
