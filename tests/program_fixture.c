/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "program_fixture.h"

#include "io/plain_file.h"

#include <fts.h>
#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

enum { COMMAND_SIZE = 4096 };

void program_set_up(program_place *place) {
    const char *root = getenv("TMPDIR");
    snprintf(place->folder, sizeof place->folder, "%s/softfall-test-XXXXXX", root && *root ? root : "/tmp");
    if (!mkdtemp(place->folder))
        fail_msg("cannot make %s", place->folder);
}

void program_tear_down(const program_place *place) {
    char command[600];
    snprintf(command, sizeof command, "rm -rf '%s'", place->folder);
    if (system(command) != 0)
        fail_msg("cannot remove %s", place->folder);
}

program_place *program_group_set_up(void **state) {
    program_place *place = calloc(1, sizeof *place);
    assert_non_null(place);
    *state = place;
    program_set_up(place);
    return place;
}

int program_group_folder(void **state) {
    program_group_set_up(state);
    return 0;
}

int program_group_case(void **state) {
    const program_place *place = program_group_set_up(state);
    program_result made =
        program_shell(place, "R=\"$SF_SOURCE_DIR\" && cp -r \"$R/geo\" \"$R/examples/materials\" . && "
                             "sed 's|\\.\\./\\.\\./geo|geo|; s|\\.\\./materials|materials|' "
                             "\"$R/examples/eva50-v4.5/case.cfg\" > good.cfg");
    if (made.code != 0)
        fail_msg("the example cannot be copied: %s", made.err);
    return 0;
}

int program_group_example(void **state) {
    program_group_case(state);
    const program_place *place = *state;
    program_succeed(place, "pre", "good.cfg -o model.h5 %s --set solver.end_time='1 ms'", program_coarse(25));
    program_succeed(place, "solve", "model.h5 -o results.h5 --threads 1");
    program_succeed(place, "post", "results.h5 -o out");
    return 0;
}

int program_group_tear_down(void **state) {
    program_tear_down(*state);
    free(*state);
    return 0;
}

const char *program_path(const program_place *place, const char *name) {
    static char path[8][1024];
    static int turn;
    turn = (turn + 1) % 8;
    snprintf(path[turn], sizeof path[turn], "%s/%s", place->folder, name);
    return path[turn];
}

static void read_text(const char *path, char *text, size_t size) {
    FILE *file = fopen(path, "r");
    size_t length = file ? fread(text, 1, size - 1, file) : 0;
    text[length] = '\0';
    if (file)
        fclose(file);
}

static program_result run_command(const program_place *place, const char *command) {
    program_result result = {.code = -1};
    char line[COMMAND_SIZE + 1200];
    snprintf(line, sizeof line, "cd '%s' || exit\nexec > .stdout 2> .stderr\n%s", place->folder, command);
    int status = system(line);
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    read_text(program_path(place, ".stdout"), result.out, sizeof result.out);
    read_text(program_path(place, ".stderr"), result.err, sizeof result.err);
    if (strstr(result.err, "AddressSanitizer") || strstr(result.err, "ThreadSanitizer") ||
        strstr(result.err, "runtime error:"))
        fail_msg("%s: %s", command, result.err);
    return result;
}

program_result program_shell(const program_place *place, const char *format, ...) {
    char command[COMMAND_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(command, sizeof command, format, args);
    va_end(args);
    return run_command(place, command);
}

/* `before`: words of the shell before the program. */
static void program_command(char command[COMMAND_SIZE], const char *before, const char *name,
                            const char *format, va_list args) {
    const char *programs = getenv("SF_BIN_DIR");
    if (!programs)
        fail_msg("SF_BIN_DIR is not set: it names the folder of the programs");
    size_t used = (size_t)snprintf(command, COMMAND_SIZE, "%s'%s'/softfall-%s ", before, programs, name);
    if (used < COMMAND_SIZE)
        vsnprintf(command + used, COMMAND_SIZE - used, format, args);
}

program_result program_run(const program_place *place, const char *name, const char *format, ...) {
    char command[COMMAND_SIZE];
    va_list args;
    va_start(args, format);
    program_command(command, "", name, format, args);
    va_end(args);
    return run_command(place, command);
}

static program_result succeed(const program_place *place, const char *command) {
    program_result result = run_command(place, command);
    if (result.code != 0)
        fail_msg("exit code %d from %s: %s", result.code, command, result.err);
    return result;
}

program_result program_succeed(const program_place *place, const char *name, const char *format, ...) {
    char command[COMMAND_SIZE];
    va_list args;
    va_start(args, format);
    program_command(command, "", name, format, args);
    va_end(args);
    return succeed(place, command);
}

program_result program_figures(const program_place *place, const char *format, ...) {
    char command[COMMAND_SIZE];
    va_list args;
    va_start(args, format);
    program_command(command, "", "post --view 0", format, args);
    va_end(args);
    return succeed(place, command);
}

const char *program_coarse(double spacing) {
    static char options[256];
    snprintf(options, sizeof options,
             "--set geometry.parameters.fine_spacing=%.1f --set geometry.parameters.outer_spacing=%.1f "
             "--set geometry.missile_parameters.element_size=20.0 --set pad.mesh_error_limit=1",
             spacing, spacing < 25 ? 20.0 : 40.0);
    return options;
}

program_bytes program_read_file(const char *path) {
    program_bytes bytes = {0};
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END) != 0)
        fail_msg("cannot read %s", path);
    bytes.size = (size_t)ftell(file);
    bytes.data = malloc(bytes.size + 1);
    rewind(file);
    if (!bytes.data || fread(bytes.data, 1, bytes.size, file) != bytes.size)
        fail_msg("cannot read %s", path);
    bytes.data[bytes.size] = '\0';
    fclose(file);
    return bytes;
}

static int by_name(const FTSENT **a, const FTSENT **b) {
    return strcmp((*a)->fts_name, (*b)->fts_name);
}

char *program_list_files(const program_place *place) {
    char *text = NULL, *const root[] = {(char *)place->folder, NULL};
    size_t size;
    FILE *out = open_memstream(&text, &size);
    FTS *tree = fts_open(root, FTS_PHYSICAL | FTS_NOCHDIR, by_name);
    for (FTSENT *e; (e = fts_read(tree)) != NULL;) {
        if (e->fts_info == FTS_DP || strncmp(e->fts_name, ".std", 4) == 0)
            continue;
        char target[PATH_MAX] = "";
        uint64_t hash = 0;
        sf_error err = SF_ERROR_INIT;
        if (e->fts_info == FTS_SL && readlink(e->fts_path, target, sizeof target - 1) < 0)
            fail_msg("cannot read the link %s", e->fts_path);
        if (e->fts_info == FTS_F && sf_plain_hash(e->fts_path, NULL, SF_PLAIN_ANY, &hash, &err) != SF_OK)
            fail_msg("%s", err.text);
        fprintf(out, "%s %o %s %016" PRIx64 "\n", e->fts_path, e->fts_statp->st_mode, target, hash);
    }
    fts_close(tree);
    sf_plain_clear();
    fclose(out);
    return text;
}

double program_json_number(const char *json, const char *after, const char *key) {
    char quoted[96], *end;
    const char *at = after && json ? strstr(json, after) : json;
    snprintf(quoted, sizeof quoted, "\"%s\":", key);
    at = at ? strstr(at, quoted) : NULL;
    if (!at)
        fail_msg("no %s after %s in: %s", key, after ? after : "the beginning", json);
    double value = strtod(at + strlen(quoted), &end);
    return end == at + strlen(quoted) ? NAN : value;
}

double program_file_number(const program_place *place, const char *name, const char *key) {
    program_bytes text = program_read_file(program_path(place, name));
    double value = program_json_number(text.data, NULL, key);
    free(text.data);
    return value;
}

sf_h5 *program_open_h5(const program_place *place, const char *name) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = NULL;
    if (sf_h5_open(program_path(place, name), &file, &err) != SF_OK)
        fail_msg("%s", err.text);
    return file;
}

void program_write_file(const char *path, const void *data, size_t size) {
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        fail_msg("cannot write %s", path);
}

const char *program_write_text(const program_place *place, const char *name, const char *text) {
    const char *path = program_path(place, name);
    program_write_file(path, text, strlen(text));
    return path;
}

void program_assert_unchanged(const char *path, program_bytes *before) {
    program_bytes after = program_read_file(path);
    if (after.size != before->size || memcmp(after.data, before->data, after.size) != 0)
        fail_msg("%s has changed", path);
    free(after.data);
    free(before->data);
    *before = (program_bytes){0};
}

double program_history_largest(const program_place *p, const char *column) {
    program_result r = program_shell(
        p,
        "awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == \"%s\") c = k; next } { v = $c < 0 ? -$c : $c; "
        "if (v > m) m = v } END { print m + 0 }' out/history.csv",
        column);
    assert_int_equal(r.code, 0);
    return strtod(r.out, NULL);
}
