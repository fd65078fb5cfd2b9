/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inputs that cannot be meant, over all programs: each is refused with a code that is not 0 and one sentence
 * that names the thing, its value and what it may be, and every file of an earlier run stays as it was. */
#include "program_fixture.h"

#include "io/h5_data.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { PARTS = 3 };

typedef struct nonsense {
    const char *words;       /* of the command line */
    const char *part[PARTS]; /* of the sentence */
} nonsense;

/* The example, and files/ with what is wrong in each. */
static int set_up(void **state) {
    program_group_example(state);
    program_result made = program_shell(
        *state, "mkdir files && cd files && "
                "printf 'strain,stress_kPa\\n0,0\\n0.1,20\\n0.5,10\\n0.8,900\\n' > falls.csv && "
                "printf 'strain,stress_kPa\\n0,0\\n0.02,5\\n0.05,9\\n0.08,12\\n' > stops.csv && "
                "printf 'strain,stress_kPa\\n0,0\\n0.8,900\\n' > two.csv && "
                "printf 'strain,stress_kPa\\n0,0\\n0.1,nan\\n0.5,100\\n0.8,900\\n' > nan.csv && "
                "printf 'strain,stress_kPa\\n0,0\\n0.1,1e999\\n0.5,100\\n0.8,900\\n' > inf.csv && "
                "printf 'strain,stress_kPa\\n0,0\\n0.1,20\\n0.5,100\\n1.2,900\\n' > through.csv && "
                "printf 'strain,stress_kPa\\n0,7\\n0.1,20\\n0.5,100\\n0.8,900\\n' > preload.csv && "
                "printf 'strain,stress_kPa\\n0,0\\n0.1,0\\n0.5,0\\n0.8,0\\n' > zero.csv && "
                "printf 'strain,stress_kPa\\n0,0\\n0.1,20\\n0.5,100\\n0.6,100\\n' > flat.csv && "
                "printf 'strain,stress_MPa\\n0,0\\n0.1,0.02\\n0.5,0.1\\n0.6,1e300\\n' > huge.csv && "
                "printf 'strain,force_N\\n0,0\\n0.1,20\\n' > force.csv && "
                "printf 'time_ms,displacement_mm\\n0,0\\n1,900\\n' > fast.csv && "
                "printf 'time_ms,displacement_mm\\n0,0\\n5,1\\n4,2\\n' > back.csv && "
                "printf 'time_ms,displacement_mm\\n0,3\\n50,10\\n' > late.csv && "
                "printf 'time_ms,acceleration_g\\n0,0\\n1,5\\n' > short.csv && "
                "printf 'time_ms,acceleration_g\\n0,0\\n1,nan\\n2,0\\n' > hole.csv && "
                "printf 'time_ms,acceleration_g\\n0,0\\n2,5\\n1,0\\n' > order.csv && "
                "printf 'SystemCall \"touch written\";\\n' > run.geo && printf 'Save "
                "\"written.msh\";\\n' > save.geo && "
                "printf 'Printf(\"x\") > \"written\";\\n' > print.geo && printf 'SystemCall \"touch "
                "written\";\\n' > run.msh && "
                "printf 'Include StrCat(\"a\", \"b\");\\n' > include.geo && cp run.geo pad.txt && "
                "printf '$MeshFormat\\n4.1 0 8\\n$EndMeshFormat\\n$Nodes\\n1 999999999999 1 "
                "999999999999\\n' > bomb.msh && "
                "printf 'density = \"35 kg/m3\"; E = \"0.4 MPa\";\\ncurve = \"flat.csv\";\\n' > flat.cfg && "
                ": > empty.geo && printf '*HEADING\\n*NODE\\n1, 0, 0, 0\\n' > deck.inp");
    if (made.code != 0)
        fail_msg("the files cannot be made: %s", made.err);
    return 0;
}

static void assert_refused(const program_result *r, const char *program, const nonsense *row) {
    char begin[64];
    const char *said = r->err, *end;
    while (
        (strstr(said, ": gmsh has worked for ") || strstr(said, " is replaced by the later --set ")) &&
        strchr(
            said,
            '\n')) /* on a slow machine, notes of it come first, and a row may replace a value of `before` */
        said = strchr(said, '\n') + 1;
    end = strchr(said, '\n');
    snprintf(begin, sizeof begin, "softfall-%s: ", program);
    if (r->code <= 0 || r->code >= 128)
        fail_msg("%s %s: exit code %d: %s", program, row->words, r->code, r->err);
    if (!end || end[1] != '\0' || strncmp(said, begin, strlen(begin)) != 0)
        fail_msg("%s %s: not one sentence of %s: %s", program, row->words, begin, r->err);
    for (int k = 0; k < PARTS && row->part[k]; k++)
        if (!strstr(r->err, row->part[k]))
            fail_msg("%s %s: \"%s\" is missing in: %s", program, row->words, row->part[k], r->err);
}

/* Every row after `before`, which names the input and the output that exists already. */
static void refuse_all(const program_place *p, const char *program, const char *before, const nonsense *rows,
                       size_t count) {
    char *earlier = program_list_files(p);
    for (size_t k = 0; k < count; k++) {
        program_result result = program_run(p, program, "%s %s", before, rows[k].words);
        assert_refused(&result, program, &rows[k]);
    }
    char *later = program_list_files(p);
    assert_string_equal(earlier, later); /* nothing changed, nothing new */
    free(earlier);
    free(later);
}

#define REFUSE_ALL(p, program, before, rows)                                                                 \
    refuse_all(p, program, before, rows, sizeof(rows) / sizeof(rows)[0])

static void values_of_a_case(void **state) {
    static const nonsense rows[] = {
        {"--set missile.velocity='1000 m/s'", {"missile.velocity", "1000 m s-1", "at most 200 m s-1"}},
        {"--set missile.velocity='0 m/s'", {"missile.velocity", "0 m s-1", "at least 1e-09"}},
        {"--set missile.velocity='-3 m/s'", {"missile.velocity", "-3 m s-1", "at least 1e-09"}},
        {"--set missile.velocity='nan m/s'", {"missile.velocity", "nan m/s", "not finite"}},
        {"--set missile.velocity='inf m/s'", {"missile.velocity", "inf m/s", "not finite"}},
        {"--set missile.velocity='4.5 kg'", {"missile.velocity", "4.5 kg", "expected a speed"}},
        {"--set missile.velocity='\"4.5\"'", {"missile.velocity", "no unit", "4.5 m/s"}},
        {"--set missile.velocity=4.5", {"missile.velocity", "a plain number", "4.5 m/s"}},
        {"--set missile.velocity='1 mm/s'", {"missile.velocity", "0.001 m/s is too slow", "24.5 %"}},
        {"--set missile.mass='0 kg'", {"missile.mass", "0 kg", "at least 1e-09 kg"}},
        {"--set missile.mass='-1 kg'", {"missile.mass", "-1 kg", "at least 1e-09 kg"}},
        {"--set missile.mass='1e12 kg'", {"missile.mass", "1e+12 kg", "at most 1e+09 kg"}},
        {"--set missile.mass='4.6 m'", {"missile.mass", "is a length", "expected a mass"}},
        {"--set material.density='0 kg/m3'", {"material.density", "0 kg m-3", "at least 0.3"}},
        {"--set material.density='-35 kg/m3'", {"material.density", "-35 kg m-3", "at least 0.3"}},
        {"--set material.density='35 kg'", {"material.density", "is a mass", "expected a density"}},
        {"--set material.density='1e9 kg/m3'", {"material.density", "1e+09", "at most 3000"}},
        {"--set material.density='35 g/cm3'",
         {"material.density", "35000 kg m-3 is out of bounds", "is the unit of \"35 g/cm3\" right?"}},
        {"--set material.density='0.035 kg/m3'",
         {"material.density", "0.035 kg m-3 is out of bounds", "at least 0.3 kg m-3"}},
        {"--set material.E='0 MPa'", {"material.E", "0 Pa", "at least 1 Pa"}},
        {"--set material.E='-1 MPa'", {"material.E", "-1e+06 Pa", "at least 1 Pa"}},
        {"--set material.E='0.4 N'", {"material.E", "0.4 N", "expected a pressure"}},
        {"--set material.HU=0", {"material.HU", "0 is out of bounds", "at least 1e-06"}},
        {"--set material.HU=1.5", {"material.HU", "1.5", "at most 1"}},
        {"--set material.SHAPE=-1", {"material.SHAPE", "-1", "at least 0.001"}},
        {"--set material.DAMP=-0.1", {"material.DAMP", "-0.1", "at least 0"}},
        {"--set material.ED='-1 MPa'", {"material.ED", "-1e+06 Pa", "at least 0 Pa"}},
        {"--set material.BETA1='0 1/s'", {"material.BETA1", "0 s-1", "at least 1e-06"}},
        {"--set material.BETA1='5 ms'", {"material.BETA1", "is a time", "expected a rate"}},
        {"--set material.eta='-1 Pa s'", {"material.eta", "-1 Pa s", "at least 0 Pa s"}},
        {"--set material.tension_cutoff='0 Pa'", {"material.tension_cutoff", "0 Pa", "above 0 Pa"}},
        {"--set material.densification.start=2.0", {"material.densification.start", "2 is", "at most 0.999"}},
        {"--set material.densification.start=0.99", {"material.densification.start", "0.99", "the end of"}},
        {"--set missile.direction='[0.0, 0.0, 1.0]'",
         {"missile.direction", "[0, 0, 1]", "does not point to the pad"}},
        {"--set missile.direction='[1.0, 0.0, -0.001]'", {"missile.direction", "89.9 degrees", "grazes it"}},
        {"--set missile.direction='[0.0, 0.0, 0.0]'",
         {"missile.direction", "[0, 0, 0]", "does not point to the pad"}},
        {"--set missile.direction='[0.0, -1.0]'", {"missile.direction", "three plain numbers"}},
        {"--set missile.friction=-1", {"missile.friction", "-1", "at least 0"}},
        {"--set missile.gravity='9.81 g'", {"missile.gravity", "9.81 g", "gram"}},
        {"--set missile.gap='-1 mm'", {"missile.gap", "-0.001 m", "at least 0 m"}},
        {"--set missile.gap='1 m'", {"missile.gap", "1 m away", "never reaches"}},
        {"--set kernel.support_ratio=1.0", {"kernel.support_ratio", "1 is", "above 1"}},
        {"--set kernel.support_ratio=9.0", {"kernel.support_ratio", "9 is", "at most 4"}},
        {"--set kernel.condition_limit=1.0", {"kernel.condition_limit", "1 is", "at least 10"}},
        {"--set kernel.stabilisation=-1.0", {"kernel.stabilisation", "-1", "at least 0"}},
        {"--set solver.end_time='0 ms'", {"solver.end_time", "0 s", "at least 1e-09 s"}},
        {"--set solver.end_time='10 us'", {"solver.end_time", "1e-05 s", "3 times solver.step_limit"}},
        {"--set solver.end_time='5 mm'", {"solver.end_time", "is a length", "expected a time"}},
        {"--set solver.step_safety=1.5", {"solver.step_safety", "1.5", "at most 1"}},
        {"--set solver.step_limit='1 ms'", {"solver.step_limit", "0.001 s", "at most 5e-05 s"}},
        {"--set solver.step_limit='1e-12 s'", {"solver.step_limit", "1e-12 s", "1e-09 of solver.end_time"}},
        {"--set solver.energy_limit=2.0", {"solver.energy_limit", "2 is", "at most 1"}},
        {"--set output.frame_interval='0 ms'", {"output.frame_interval", "0 s", "at least 1e-09 s"}},
        {"--set output.frame_interval='1 ns'", {"output.frame_interval", "4e+07 frames", "at most 100000"}},
        {"--set output.times='[\"-1 ms\"]'", {"output.times", "-0.001 s", "at least 0 s"}},
        {"--set output.times='[\"5 kg\"]'", {"output.times", "is a mass", "expected a time"}},
        {"--set pad.fixed='[]'", {"pad.fixed", "at least one surface must hold the pad"}},
        {"--set geometry.length_unit=kg", {"geometry.length_unit", "kg", "unit of length"}},
    };
    REFUSE_ALL(*state, "pre", "good.cfg -o model.h5 --force", rows);
}

static void curves_and_motions(void **state) {
    static const nonsense rows[] = {
        {"--set material.curve=files/falls.csv", {"falls.csv:4", "stress 10", "the one before it (20)"}},
        {"--set material.curve=files/stops.csv", {"stops.csv", "0.08", "at least 0.2"}},
        {"--set material.curve=files/two.csv", {"two.csv", "2 points", "at least 4"}},
        {"--set material.curve=files/nan.csv", {"nan.csv:3", "\"nan\"", "not a finite number"}},
        {"--set material.curve=files/inf.csv", {"inf.csv:3", "\"1e999\"", "not a finite number"}},
        {"--set material.curve=files/through.csv", {"through.csv:5", "strain 1.2", "below 1"}},
        {"--set material.curve=files/preload.csv", {"preload.csv:2", "stress 7", "(0, 0)"}},
        {"--set material.curve=files/zero.csv", {"zero.csv", "zero everywhere"}},
        {"--set material.curve=files/force.csv", {"force.csv:1", "stress_kPa"}},
        {"--set material.curve=files", {"files", "not a plain file"}},
        {"--set material.curve=files/flat.csv", {"material.curve: files/flat.csv", "curve is flat", "0.6"}},
        {"--set material=@files/flat.cfg", {"files/flat.cfg:2", "files/flat.cfg:2", "curve is flat"}},
        {"--set material.curve=files/huge.csv", {"huge.csv", "from the strain 0.5 to 0.6", "1e+306 Pa"}},
        {"--set missile.motion=files/fast.csv", {"fast.csv:3", "900 m/s", "at most 200 m/s"}},
        {"--set missile.motion=files/back.csv", {"back.csv:4", "time 4", "the one before it (5)"}},
        {"--set missile.motion=files/late.csv", {"late.csv:2", "displacement 3", "(0, 0)"}},
    };
    REFUSE_ALL(*state, "pre", "good.cfg -o model.h5 --force", rows);
}

static void geometries(void **state) {
    static const nonsense rows[] = {
        {"--set geometry.parameters.quarter=2", {"pad.geo", "quarter = 2 is none of its choices: 0, 1"}},
        {"--set geometry.missile_parameters.quarter=-1", {"hemisphere.geo", "quarter = -1 is none of"}},
        {"--set geometry.file=files/empty.geo --set geometry.parameters='{}'", {"empty.geo is empty"}},
        {"--set geometry.file=files/deck.inp --set geometry.parameters='{}'",
         {"deck.inp is a deck of Abaqus", ".msh"}},
        {"--set geometry.parameters.thickness=0.0", {"pad.geo", "thickness", "must be above 0"}},
        {"--set geometry.parameters.thickness=-50.0", {"pad.geo", "thickness", "must be above 0"}},
        {"--set geometry.parameters.fine_spacing=0.0", {"pad.geo", "fine_spacing", "must be above 0"}},
        {"--set geometry.length_unit=nm",
         {"pad is 5e-05 mm thick", "0.5 to 5000 mm", "geometry.length_unit is 1e-09 m"}},
        {"--set geometry.length_unit=m", {"pad is 50000 mm thick", "5000 mm", "geometry.length_unit is 1 m"}},
        {"--set geometry.missile_length_unit=m",
         {"1.6e+05 x 1.6e+05 x 8e+04 mm", "geometry.missile_length_unit is 1 m", "sizes cannot belong"}},
        {"--set geometry.missile_length_unit=um", {"0.16 x 0.16 x 0.08 mm", "sizes cannot belong"}},
        {"--set geometry.missile_file= --set geometry.missile_parameters= --set geometry.missile_length_unit=m",
         {"geometry.missile_file"}},
        {"--set missile.mass='1 mg'", {"missile.mass", "1e-06 kg", "the heaviest node"}},
        {"--set material.eta='1e9 Pa s'", {"first stable time step", "1e-09 of solver.end_time", "eta"}},
        {"--set geometry.parameters.quarter=0 --set missile.shape=surface",
         {"cut open", "x = 0 mm", "whole pad"}},
        {"--set geometry.parameters.quarter=0", {"missile is cut open", "x = 0 mm", "whole pad"}},
        {"--set pad.symmetry='[\"symmetry_x\"]'", {"missile is cut open", "y = 0 mm", "pad.symmetry"}},
        {"--set pad.symmetry='[\"symmetry_y\"]' --set geometry.missile_parameters.quarter=0",
         {"pad is cut open", "x = 0 mm", "pad.symmetry"}},
        {"--set pad.fixed='[\"floor\"]'", {"pad.fixed", "\"floor\"", "\"base\""}},
        {"--set pad.fixed='[\"top\", \"base\"]'", {"pad.contact", "every node", "\"top\""}},
        {"--set pad.sliding='[\"top\"]'", {"pad.contact", "held along z", "pad.sliding"}},
        {"--set geometry.file=files/pad.txt --set geometry.parameters='{}'", {"pad.txt", "start a program"}},
        {"--set geometry.file=files/run.geo --set geometry.parameters='{}'", {"run.geo", "start a program"}},
        {"--set geometry.file=files/save.geo --set geometry.parameters='{}'", {"save.geo", "tried to write"}},
        {"--set geometry.file=files/print.geo --set geometry.parameters='{}'",
         {"print.geo", "tried to write"}},
        {"--set geometry.file=files/include.geo --set geometry.parameters='{}'",
         {"include.geo", "files/ab'"}},
        {"--set geometry.file=files/run.msh --set geometry.parameters='{}'", {"run.msh", "start a program"}},
        {"--set geometry.time_limit='0 s'", {"geometry.time_limit", "at least 1 s"}},
        {"--set geometry.file=files/bomb.msh --set geometry.parameters='{}'", {"bomb.msh"}},
    };
    static const nonsense large[] = {
        {"--set geometry.parameters.fine_spacing=0.1", {"pad.geo", "GB", "SOFTFALL_MEMORY_MB"}},
    };
    char before[512];
    snprintf(before, sizeof before, "good.cfg -o model.h5 --force %s", program_coarse(25));
    setenv("SOFTFALL_MEMORY_MB", "300", 1); /* the same answers on a machine with any memory */
    REFUSE_ALL(*state, "pre", before, rows);
    if (!SANITIZED)
        REFUSE_ALL(*state, "pre", before, large);
    unsetenv("SOFTFALL_MEMORY_MB");
}

/* A place at the edge may be meant; it is told, with the key that moves it. */
static void impacts_on_an_edge_are_told(void **state) {
    char plate[1200];
    snprintf(plate, sizeof plate,
             "--set geometry.missile_file='\"%s/geo/platen.geo\"' --set "
             "geometry.missile_parameters='{side=600.0; thickness=20.0;}'",
             getenv("SF_SOURCE_DIR"));
    const struct {
        const char *words, *said;
    } rows[] = {
        {"", "(0, 0) mm, lies 0 mm inside"},
        {"--set missile.position='[\"100 mm\", \"10 mm\"]'", "(100, 10) mm, lies 10 mm inside"},
        {"--set missile.position='[\"100 mm\", \"100 mm\"]'", NULL},
        {plate, NULL}, /* it covers the whole top */
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        program_result r = program_run(
            *state, "pre",
            "good.cfg -o edge.h5 --force %s --set pad.symmetry='[]' --set geometry.missile_parameters.quarter=0 %s",
            program_coarse(25), rows[k].words);
        const char *told = strstr(r.err, "the missile falls on the edge of the pad");
        assert_int_equal(r.code, 0);
        if (!rows[k].said)
            assert_null(told);
        else if (!told || !strstr(told, rows[k].said) ||
                 !strstr(told, "missile.position = [\"100 mm\", \"100 mm\"]"))
            fail_msg("%s: said: %s", rows[k].words, r.err);
    }
}

/* A drawing in centimetres beside one in millimetres: each file has its own unit. */
static void files_may_have_units_of_their_own(void **state) {
    char before[512];
    snprintf(before, sizeof before, "good.cfg --force %s", program_coarse(25));
    program_succeed(*state, "pre", "%s -o mm.h5", before);
    program_succeed(*state, "pre",
                    "%s -o cm.h5 --set geometry.missile_length_unit=cm --set "
                    "geometry.missile_parameters.diameter=16 --set "
                    "geometry.missile_parameters.element_size=2",
                    before);
    sf_error err = SF_ERROR_INIT;
    double radius[2] = {0};
    for (int k = 0; k < 2; k++) {
        sf_h5 *file = program_open_h5(*state, k ? "cm.h5" : "mm.h5");
        sf_h5_read_scalar(file, "/missile/sphere_radius", &radius[k], &err);
        sf_h5_close(&file, &err);
    }
    assert_int_equal(err.status, SF_OK);
    assert_true(radius[0] > 0.0799 && fabs(radius[1] / radius[0] - 1) < 1e-9);
}

static void command_lines_and_files(void **state) {
    static const nonsense pre[] = {
        {"cut.cfg -o new.h5", {"cut.cfg:", "the text ends within a group"}},
        {"good.cfg -o model.h5", {"model.h5 exists", "--force"}},
        {"none.cfg -o new.h5", {"none.cfg", "No such file"}},
        {"model.h5 -o new.h5", {"model.h5:", "zero byte"}},
    };
    static const nonsense solve[] = {
        {"model.h5 -o results.h5", {"results.h5 exists", "--force"}},
        {"none.h5 -o new.h5", {"none.h5", "No such file"}},
        {"out -o new.h5", {"out is not a plain file"}},
        {"good.cfg -o new.h5", {"good.cfg is not an HDF5 file"}},
        {"results.h5 -o new.h5", {"results.h5 is a softfall-results file", "expected a softfall-model"}},
        {"model.h5 -o none/below/new.h5", {"none/below/new.h5", "No such file"}},
    };
    static const nonsense post[] = {
        {"results.h5 -o out", {"out already holds", "--force"}},
        {"results.h5 -o new --filter 77", {"--filter 77", "60, 180, 600 and 1000"}},
        {"results.h5 -o new --filter nan", {"--filter nan", "60, 180, 600 and 1000"}},
        {"results.h5 -o new --reference files/short.csv", {"short.csv", "2 points", "at least 3"}},
        {"results.h5 -o new --reference files/hole.csv", {"hole.csv:3", "\"nan\"", "softfall read"}},
        {"results.h5 -o new --reference files/order.csv", {"order.csv:4", "1 ms", "does not follow 2 ms"}},
        {"results.h5 -o new --shift inf --reference files/hole.csv", {"--shift inf", "expected a time"}},
        {"model.h5 -o new", {"model.h5 is a softfall-model file", "expected a softfall-results"}},
        {"results.h5 -o good.cfg --force", {"good.cfg exists and is not a folder"}},
    };
    program_shell(*state, "head -c -3 good.cfg > cut.cfg");
    REFUSE_ALL(*state, "pre", "", pre);
    REFUSE_ALL(*state, "solve", "", solve);
    REFUSE_ALL(*state, "post", "", post);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_of_a_case),
        cmocka_unit_test(curves_and_motions),
        cmocka_unit_test(geometries),
        cmocka_unit_test(impacts_on_an_edge_are_told),
        cmocka_unit_test(files_may_have_units_of_their_own),
        cmocka_unit_test(command_lines_and_files),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
