/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every option and key of every program that names a file to be read, given what is no plain file: each ends
 * soon, in one sentence, with a code that is not 0, and has written nothing. That there is no other reader:
 * tools/gate.py. */
#include "check.h"
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

/* Nothing takes 2 s on an idle machine; one with other work may let a program wait for its turn. */
enum { PROCESSOR_SECONDS = 2, SECONDS = 30 };

/* Sound but for the file `hostile`. */
static const struct {
    const char *name, *text;
} files[] = {
    {"include.cfg", "@include \"hostile\"\n"},
    {"nested.cfg", "@include \"include.cfg\"\n"},
    {"material-include.cfg", "@include \"hostile\"\n"},
    {"test.cfg", "density = \"35 kg/m3\"; specimen = { side = \"50 mm\"; thickness = \"50 mm\"; };\n"
                 "tests = ( { file = \"hostile\"; rate = \"2 1/min\"; } );\n"},
};

static const struct {
    const char *program, *words;
} readers[] = {
    {"pre", "hostile -o new"},
    {"pre", "include.cfg -o new"},
    {"pre", "nested.cfg -o new"},
    {"pre", "good.cfg -o new --set material=@hostile"},
    {"pre", "good.cfg -o new --set material=@material-include.cfg"},
    {"pre", "good.cfg -o new --set material.curve=hostile"},
    {"pre", "rates.cfg -o new"},
    {"pre", "driven.cfg -o new"},
    {"pre", "good.cfg -o new --set geometry.file=hostile.geo"},
    {"pre", "good.cfg -o new --set geometry.file=hostile.msh"},
    {"pre", "good.cfg -o new --set geometry.file=hostile.step"},
    {"pre", "good.cfg -o new --set geometry.missile_file=hostile.geo"},
    {"solve", "hostile -o new"},
    {"solve", "--restart checkpoint.h5"},
    {"solve", "--restart going.h5 hostile"},
    {"post", "hostile -o new"},
    {"post", "results.h5 -o new --reference hostile"},
    {"post", "compare results.h5 hostile -o new"},
    {"fit", "compression hostile -o new"},
    {"fit", "compression include.cfg -o new"},
    {"fit", "compression test.cfg -o new"},
};

static int set_up(void **state) {
    program_group_example(state);
    const program_place *p = *state;
    for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
        program_write_text(p, files[k].name, files[k].text);
    /* Copies of the sound files with a hostile one in place of a curve, a motion, a model, a checkpoint and
     * the files of a run in progress. */
    program_result made = program_shell(
        p,
        "R=\"$SF_SOURCE_DIR/examples\" && "
        "sed 's|@include.*eva35.cfg\"|law = \"low_density_foam\"; density = \"35 kg/m3\"; E = \"0.4 MPa\"; "
        "curves = ( { rate = \"1 1/s\"; file = \"hostile\"; }, { rate = \"9 1/s\"; file = \"hostile\"; } );|' good.cfg > rates.cfg && "
        "sed 's|\\.\\./\\.\\./geo|geo|; s|\\.\\./materials|materials|; s|motion.csv|hostile|' \"$R\"/compression/case.cfg > driven.cfg && "
        "for e in geo msh step; do ln -s hostile hostile.$e; done && ln -s hostile checkpoint.h5.restart && "
        "mkdir empty && mkfifo pipe && truncate -s 1T sparse && echo secret > closed && chmod 0 closed && "
        "python3 -c 'import socket; socket.socket(socket.AF_UNIX).bind(\"socket\")'");
    if (made.code != 0)
        fail_msg("%s", made.err);
    program_succeed(p, "solve", "model.h5 -o going.h5 --threads 1");
    return 0;
}

/* Who may read everything sees `closed` with other eyes: those of nobody. */
static void use(const program_place *p, const char *target, const char *words, const char *program,
                char *failure, size_t size) {
    const char *as =
        geteuid() == 0 && strcmp(target, "closed") == 0 ? "setpriv --reuid=65534 --clear-groups " : "";
    program_result r =
        program_shell(p, "ulimit -v %s; ulimit -t %d; %stimeout -s KILL %d '%s/softfall-%s' %s",
                      SANITIZED ? "unlimited" : "8000000", PROCESSOR_SECONDS, as, SECONDS,
                      getenv("SF_BIN_DIR"), program, words);
    const char *end = strchr(r.err, '\n');
    if (r.code == 0 || r.code >= 126 || strncmp(r.err, "softfall-", 9) != 0 || !end || end[1] != '\0')
        snprintf(failure, size, "softfall-%s %s, hostile is %s: exit code %d: %.600s", program, words, target,
                 r.code, r.err);
}

static void no_reader_takes(void **state, const char *target) {
    const program_place *p = *state;
    char failure[1024] = "";
    int failures = 0;
    program_shell(p, "ln -sfn '%s' hostile; chmod -R a+rX .; chmod a+w .; chmod 0 closed", target);
    for (size_t k = 0; k < sizeof readers / sizeof readers[0]; k++) {
        *failure = '\0';
        use(p, target, readers[k].words, readers[k].program, failure, sizeof failure);
        if (*failure) {
            print_message("%s\n", failure);
            failures++;
        }
    }
    assert_int_equal(failures, 0);
    program_result left = program_shell(p, "find new* .softfall* 2>/dev/null");
    if (*left.out)
        fail_msg("left: %s", left.out);
}

static void no_reader_takes_an_endless_device(void **state) {
    no_reader_takes(state, "/dev/zero");
}

static void no_reader_waits_for_a_pipe(void **state) {
    no_reader_takes(state, "pipe");
}

static void no_reader_waits_for_the_kernel(void **state) {
    no_reader_takes(state, geteuid() == 0 ? "/proc/kmsg" : "/proc/self/status");
}

static void no_reader_takes_a_folder(void **state) {
    no_reader_takes(state, "empty");
}

static void no_reader_takes_a_socket(void **state) {
    no_reader_takes(state, "socket");
}

static void no_reader_takes_what_is_missing(void **state) {
    no_reader_takes(state, "nowhere");
}

static void no_reader_takes_what_it_may_not_read(void **state) {
    if (geteuid() == 0 &&
        program_shell(*state, "setpriv --reuid=65534 --clear-groups '%s/softfall-pre' --version",
                      getenv("SF_BIN_DIR"))
                .code != 0)
        check_skip_refused("the user nobody may not enter the folder of the programs");
    no_reader_takes(state, "closed");
}

static void no_reader_takes_a_file_larger_than_the_memory(void **state) {
    no_reader_takes(state, "sparse");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_reader_takes_an_endless_device),
        cmocka_unit_test(no_reader_waits_for_a_pipe),
        cmocka_unit_test(no_reader_waits_for_the_kernel),
        cmocka_unit_test(no_reader_takes_a_folder),
        cmocka_unit_test(no_reader_takes_a_socket),
        cmocka_unit_test(no_reader_takes_what_is_missing),
        cmocka_unit_test(no_reader_takes_what_it_may_not_read),
        cmocka_unit_test(no_reader_takes_a_file_larger_than_the_memory),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
