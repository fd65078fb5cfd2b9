/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case in a folder of its own: it holds all that the case needs, and its drop has the same bits. */
#include "program_fixture.h"

#include "study/case_folder.h"
#include "model_fixture.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

/* Of the case at `path` with the --set texts up to NULL. */
static sf_status make(const program_place *p, const char *path, const char *folder,
                      const char *const *overrides, sf_error *err) {
    char target[700];
    snprintf(target, sizeof target, "%s/%s", p->folder, folder);
    sf_case_folder_request request = {.case_path = path, .overrides = overrides, .folder = target};
    while (overrides && overrides[request.override_count])
        request.override_count++;
    *err = (sf_error)SF_ERROR_INIT;
    return sf_case_folder_make(&request, NULL, err);
}

static void succeed(const program_place *p, const char *path, const char *folder,
                    const char *const *overrides) {
    sf_error err;
    if (make(p, path, folder, overrides, &err) != SF_OK)
        fail_msg("%s: %s", path, err.text);
}

/* What the folder holds, sorted. */
static const char *files_of(const program_place *p, const char *folder) {
    static program_result result;
    result =
        program_shell(p, "cd '%s' && find . -type f | sed 's|^./||' | LC_ALL=C sort | tr '\\n' ' '", folder);
    return result.out;
}

static const char *text_of(const program_place *p, const char *name) {
    static char text[65536];
    program_bytes bytes = program_read_file(program_path(p, name));
    snprintf(text, sizeof text, "%s", bytes.data);
    free(bytes.data);
    return text;
}

static void assert_holds(const program_place *p, const char *name, const char *part) {
    if (!strstr(text_of(p, name), part))
        fail_msg("\"%s\" is missing in %s:\n%s", part, name, text_of(p, name));
}

/* The drop of `path` with the --set texts, and that of the folder, moved to another place. */
static void assert_same_drop(const program_place *p, const char *path, const char *folder,
                             const char *const *overrides) {
    char words[1024] = "";
    for (size_t k = 0; overrides && overrides[k]; k++)
        snprintf(words + strlen(words), sizeof words - strlen(words), " --set '%s'", overrides[k]);
    program_shell(p, "rm -rf moved one two *.h5* && mv '%s' moved", folder);
    program_succeed(p, "pre", "'%s' -o one.h5 %s", path, words);
    program_succeed(p, "pre", "moved/case.cfg -o two.h5");
    for (int k = 0; k < 2; k++) {
        program_succeed(p, "solve", "%s.h5 -o %s-r.h5 --threads 1", k ? "two" : "one", k ? "two" : "one");
        program_succeed(p, "post", "%s-r.h5 -o %s", k ? "two" : "one", k ? "two" : "one");
    }
    program_result same = program_shell(p, "test -s one/history.csv && cmp one/history.csv two/history.csv");
    if (same.code != 0)
        fail_msg("%s: %s%s", path, same.out, same.err);
}

/* An included file beside the case, one of another folder, a geometry outside; coarse by --set texts, of
 * which one changes a key of an included file, one adds a key and one a group. */
static void a_case_of_layers_runs_to_the_same_bits(void **state) {
    const program_place *p = *state;
    static const char *const set[] = {"geometry.parameters.fine_spacing=20.0",
                                      "geometry.parameters.outer_spacing=30.0",
                                      "geometry.missile_parameters.element_size=20.0",
                                      "pad.mesh_error_limit=1",
                                      "materials.upper.DAMP=0.2",
                                      "missile.velocity=5.2 m/s",
                                      "solver.end_time=2 ms",
                                      NULL};
    char path[700];
    snprintf(path, sizeof path, "%s", fixture_source("examples/layers/case.cfg"));
    succeed(p, path, "layers", set);
    assert_string_equal(
        files_of(p, "layers"),
        "README.md case.cfg cover_sheet.cfg cover_sheet.csv geo/hemisphere.geo geo/layers.geo "
        "hard_foam.cfg hard_foam.csv materials/eva35.cfg materials/eva35.csv ");
    assert_holds(p, "layers/case.cfg", "velocity = \"5.2 m/s\";    # at first contact");
    assert_holds(p, "layers/case.cfg", "file = \"geo/layers.geo\";");
    assert_holds(p, "layers/case.cfg", "@include \"materials/eva35.cfg\"");
    assert_holds(p, "layers/case.cfg", "\npad = { mesh_error_limit = 1; };\n");
    assert_holds(p, "layers/README.md", "softfall-pre case.cfg -o model.h5");
    assert_holds(p, "layers/README.md", "--set 'missile.velocity=5.2 m/s' --set 'solver.end_time=2 ms'.\n");
    assert_same_drop(p, path, "layers", set);
}

/* A geometry of several folders: it includes a file above it and merges STEP files, one of another
 * folder; measured curves; a motion; a blank in a name. */
static void geometries_keep_what_they_read(void **state) {
    const program_place *p = *state;
    char text[2048], path[700];
    program_shell(p, "mkdir -p lab/cad/pad lab/far lab/cases 'lab/foam data'");
    program_write_text(p, "lab/far/box.geo",
                       "SetFactory(\"OpenCASCADE\");\nBox(1) = {-50, -50, 0, 100, 100, 40};\n");
    program_shell(p, "cd lab/far && gmsh -0 box.geo -format step -o box.step && mv box.step ../cad/ && "
                     "sed 's/-50, -50, 0, 100, 100, 40/-80, -80, 40, 160, 160, 10/' box.geo > plate.geo && "
                     "gmsh -0 plate.geo -format step -o plate.step && rm *.geo");
    program_write_text(p, "lab/cad/size.geo", "size = 20;\n");
    snprintf(text, sizeof text,
             "SetFactory(\"OpenCASCADE\");\nInclude \"../size.geo\";\nMerge \"../box.step\";\n"
             "Merge \"../../far/plate.step\"; // beside\n"
             "Physical Volume(\"pad\") = {1};\n"
             "Physical Surface(\"base\") = Surface In BoundingBox{-51, -51, -1, 51, 51, 1};\n"
             "top() = Surface In BoundingBox{-51, -51, 39, 51, 51, 41};\nPhysical Surface(\"top\") = top();\n"
             "down() = Surface In BoundingBox{-81, -81, 39, 81, 81, 41};\ndown() -= top();\n"
             "Physical Surface(\"missile_surface\") = down();\n"
             "Mesh.MeshSizeMin = size; Mesh.MeshSizeMax = size;\n");
    program_write_text(p, "lab/cad/pad/pad.geo", text);
    program_write_text(p, "lab/foam data/slow.csv", "strain,stress_kPa\n0,0\n0.1,10\n0.5,40\n0.8,200\n");
    program_write_text(p, "lab/foam data/fast.csv", "strain,stress_kPa\n0,0\n0.1,14\n0.5,55\n0.8,260\n");
    program_write_text(p, "lab/foam data/foam.cfg",
                       "density = \"50 kg/m3\"; E = \"200 kPa\"; /* \"curve\" */\n"
                       "curves = ( { rate = \"0.01 1/s\"; file = \"slow.csv\"; },\n"
                       "           { rate = \"1 1/s\"; file = \"fast\" \".csv\"; } );\n");
    program_write_text(p, "lab/cases/motion.csv", "time_s,displacement_mm\n0,0\n0.01,2\n");
    program_write_text(p, "lab/cases/press.cfg",
                       "# Pressed\ngeometry: { file = \"../cad/pad/pad.geo\"; length_unit = \"mm\"; }\n"
                       "pad = { mesh_error_limit = 1.0; }\n"
                       "material:\n{\n  @include \"../foam data/foam.cfg\" # measured\n}\n"
                       "missile = { motion = \"motion.csv\"; shape = \"surface\" }\n"
                       "solver = { end_time = \"0.5 ms\" };");
    snprintf(path, sizeof path, "%s/lab/cases/press.cfg", p->folder);
    succeed(p, path, "press", NULL);
    assert_string_equal(
        files_of(p, "press"),
        "README.md case.cfg geo/cad/box.step geo/cad/pad/pad.geo geo/cad/size.geo geo/far/plate.step "
        "materials/fast.csv materials/foam.cfg materials/slow.csv motion.csv ");
    assert_holds(p, "press/geo/cad/pad/pad.geo", "Merge \"../../far/plate.step\"; // beside");
    assert_holds(p, "press/README.md", "Pressed\n");
    static const char *const set[] = {NULL};
    assert_same_drop(p, path, "press", set);
}

/* Each --set text finds its place, whatever stands there. */
static void set_texts_find_their_places(void **state) {
    const program_place *p = *state;
    program_shell(p, "cp -r '%s' mat && cp '%s' flat.csv", fixture_source("examples/materials"),
                  fixture_source("examples/layers/hard_foam.csv"));
    char path[700], foam[800], curve[800];
    snprintf(path, sizeof path, "%s", fixture_source("examples/compression/case.cfg"));
    snprintf(foam, sizeof foam, "material=@%s/mat/eva35.cfg", p->folder);
    snprintf(curve, sizeof curve, "material.curve=%s/flat.csv", p->folder);
    const char *const set[] = {foam,
                               "material.E=0.5 MPa",
                               curve,
                               " missile.friction = 0.25",
                               "geometry.parameters.spacing=10",
                               "output.fields=[\"von_mises\"]",
                               "output.times=[\"12 ms\", \"20 ms\"]",
                               "kernel.support_ratio=1.5",
                               "missile.group=missile_surface",
                               NULL};
    succeed(p, path, "set", set);
    assert_holds(p, "set/case.cfg", "@include \"materials/eva35.cfg\"\n}");
    assert_holds(p, "set/case.cfg", "friction = 0.25;          # of the upper platen");
    assert_holds(p, "set/case.cfg", "    fields = [\"von_mises\"];\n");
    assert_holds(p, "set/case.cfg", "\nkernel = { support_ratio = 1.5; };\n");
    assert_holds(p, "set/materials/eva35.cfg", "E = \"0.5 MPa\"");
    assert_holds(p, "set/materials/eva35.cfg", "curve = \"../data/flat.csv\"");
    assert_string_equal(files_of(p, "set"), "README.md case.cfg data/flat.csv geo/cube.geo geo/platen.geo "
                                            "materials/eva35.cfg motion.csv ");
}

/* A file that two layers include is two files where a --set text changes it for one of them. */
static void a_change_of_one_layer_leaves_the_other(void **state) {
    const program_place *p = *state;
    char path[700];
    const char *const set[] = {"materials.lower.density=60 kg/m3", NULL};
    program_shell(p, "mkdir -p two && cp -r '%s' '%s' two", fixture_source("geo"),
                  fixture_source("examples/materials"));
    program_shell(p,
                  "sed -e 's|\\.\\./\\.\\./geo|geo|; s|\\.\\./materials|materials|; "
                  "s|hard_foam|materials/eva35|; s|\"cover_sheet|\"materials/eva35|' '%s' > two/case.cfg",
                  fixture_source("examples/layers/case.cfg"));
    snprintf(path, sizeof path, "%s/two/case.cfg", p->folder);
    succeed(p, path, "one-changed", set);
    assert_string_equal(files_of(p, "one-changed"),
                        "README.md case.cfg geo/hemisphere.geo geo/layers.geo materials/eva35-2.cfg "
                        "materials/eva35.cfg materials/eva35.csv ");
    assert_holds(p, "one-changed/materials/eva35.cfg", "density = \"60 kg/m3\"");
    assert_null(strstr(text_of(p, "one-changed/materials/eva35-2.cfg"), "60 kg/m3"));
}

static void assert_refused(const program_place *p, const char *path, const char *folder, sf_status status,
                           const char *part) {
    sf_error err;
    program_result before = program_shell(p, "find . ! -name '.std*' | sort");
    make(p, path, folder, NULL, &err);
    if (err.status != status || !strstr(err.text, part))
        fail_msg("status %d, expected %d with \"%s\": %s", err.status, status, part, err.text);
    program_result after = program_shell(p, "find . ! -name '.std*' | sort");
    assert_string_equal(before.out, after.out);
}

static void what_cannot_be_made_leaves_nothing(void **state) {
    const program_place *p = *state;
    char path[700], bad[700];
    program_shell(p,
                  "rm -rf * && mkdir -p full empty far && echo mine > full/file && cp -r '%s' . && "
                  "cp geo/cube.geo far",
                  fixture_source("geo"));
    snprintf(path, sizeof path, "%s", fixture_source("examples/compression/case.cfg"));
    snprintf(bad, sizeof bad, "%s/bad.cfg", p->folder);
    assert_refused(p, path, "full", SF_ERR_INPUT, "exists and is not empty");
    assert_refused(p, path, "full/file", SF_ERR_INPUT, "exists and is not a folder");
    assert_refused(p, path, "no/such/folder", SF_ERR_IO, "No such file or directory");
    assert_refused(p, bad, "new", SF_ERR_INPUT, "bad.cfg");
    program_shell(p,
                  "sed 's|\"\\.\\./\\.\\./geo/cube.geo|\"bad.geo|; s|\\.\\./\\.\\./geo|geo|; "
                  "s|@include.*|law = \"hyperfoam\"; density = \"50 kg/m3\"; term_1 = { mu = \"50 kPa\"; "
                  "alpha = 8.0; nu = 0.1; };|; s|\"motion.csv\"|\"%s\"|' '%s' > bad.cfg",
                  fixture_source("examples/compression/motion.csv"), path);
    program_write_text(p, "bad.geo", "Point(1) = {0, 0, 0};\nnonsense;\n");
    assert_refused(p, bad, "new", SF_ERR_INPUT, "bad.geo");
    /* A path from / in the geometry. */
    char text[1500];
    snprintf(text, sizeof text, "side = 50; spacing = 10; quarter = 1;\nInclude \"%s/far/cube.geo\";\n",
             p->folder);
    program_write_text(p, "bad.geo", text);
    assert_refused(p, bad, "new", SF_ERR_INPUT, "/far/cube.geo by a path from /");
    /* A mesh that depends on where it stands. */
    program_write_text(p, "bad.geo",
                       "DefineConstant[ side = 50, spacing = 10, quarter = 1 ];\n"
                       "If (StrFind(CurrentDir, \"partial\")) spacing = 10; EndIf\n"
                       "Include \"geo/cube.geo\";\n");
    assert_refused(p, bad, "new", SF_ERR_INPUT, "another mesh");
    /* An empty folder is taken, and stays itself. */
    char target[700];
    snprintf(target, sizeof target, "%s/empty", p->folder);
    assert_int_equal(chdir(target), 0);
    sf_error err = SF_ERROR_INIT;
    const sf_case_folder_request here = {.case_path = path, .folder = "."};
    if (sf_case_folder_make(&here, NULL, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(access("case.cfg", F_OK) + access("geo/cube.geo", F_OK), 0);
    assert_int_equal(chdir("/"), 0);
    assert_string_equal(program_shell(p, "find empty -name '*partial*'").out, "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_case_of_layers_runs_to_the_same_bits),
        cmocka_unit_test(geometries_keep_what_they_read),
        cmocka_unit_test(set_texts_find_their_places),
        cmocka_unit_test(a_change_of_one_layer_leaves_the_other),
        cmocka_unit_test(what_cannot_be_made_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
