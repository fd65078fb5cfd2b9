/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/record.h"

#include "build_info.h"
#include "base/hash.h"
#include "io/folder.h"
#include "io/plain_file.h"
#include "io/replace.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define HEAD "softfall-drop-figures 1 " SF_VERSION " " SF_GIT_REVISION
enum { END_SIZE = 21 }; /* "end 0123456789abcdef\n" */

/* ---- writing ---- */

static bool put_results(FILE *out, const char *results) {
    struct stat info;
    if (stat(results, &info) != 0)
        return false;
    fprintf(out, "results %" PRId64 " %" PRId64 " %ld\n", (int64_t)info.st_size, (int64_t)info.st_mtim.tv_sec,
            info.st_mtim.tv_nsec);
    return true;
}

static void put_figures(FILE *out, const sf_results *r, const sf_figures *f) {
    size_t count;
    const sf_figure *list = sf_figure_list(&count);
    for (size_t k = 0; k < count; k++)
        if (list[k].row.type != SF_ROW_TEXT)
            fprintf(out, "%s %a\n", list[k].row.key, sf_figure_number(&list[k], r, f));
}

/* Not synchronised with the disk: the end says whether it is whole. */
static void keep(const char *path, const char *text, size_t length) {
    sf_error none = SF_ERROR_INIT;
    sf_folder_remove_file(path);
    FILE *file = sf_replace_create(path, &none);
    if (!file)
        return;
    fwrite(text, 1, length, file);
    fprintf(file, "end %016" PRIx64 "\n", sf_hash_bytes(SF_HASH_START, text, length));
    fclose(file);
}

void sf_run_record_write(const char *path, const char *results, const sf_results *r, const sf_figures *f,
                         sf_grade grade, const char *verdict, const char *geometry) {
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    if (!out)
        return;
    fprintf(out, "%s\n", HEAD);
    bool there = put_results(out, results) && !strchr(verdict, '\n') && !strchr(r->status, '\n');
    fprintf(out, "grade %d\nverdict %s\nstatus %s\n", (int)grade, verdict, r->status);
    put_figures(out, r, f);
    fprintf(out, "geometry\n%s", geometry);
    if (fclose(out) == 0 && there)
        keep(path, text, length);
    free(text);
}

/* ---- reading ---- */

/* The rest of the next line if it begins with `name` and a blank; NULL if not. */
static char *take_line(char **rest, const char *name) {
    char *line = *rest ? strsep(rest, "\n") : NULL;
    size_t length = strlen(name);
    return line && strncmp(line, name, length) == 0 && line[length] == ' ' ? line + length + 1 : NULL;
}

/* Takes the last line away. */
static bool is_whole(char *text, size_t length) {
    uint64_t hash = 0;
    if (length < END_SIZE || sscanf(text + length - END_SIZE, "end %16" SCNx64, &hash) != 1)
        return false;
    length -= END_SIZE;
    text[length] = '\0';
    return hash == sf_hash_bytes(SF_HASH_START, text, length);
}

static bool is_of(const char *line, const char *results) {
    struct stat info;
    int64_t size = 0, second = 0;
    long nanosecond = 0;
    return line && stat(results, &info) == 0 &&
           sscanf(line, "%" SCNd64 " %" SCNd64 " %ld", &size, &second, &nanosecond) == 3 &&
           size == info.st_size && second == info.st_mtim.tv_sec && nanosecond == info.st_mtim.tv_nsec;
}

static bool take_figures(char **rest, sf_run_record *out) {
    size_t count;
    const sf_figure *list = sf_figure_list(&count);
    sf_error none = SF_ERROR_INIT;
    out->figure = sf_alloc(&none, count, sizeof *out->figure, "figures");
    for (size_t k = 0; out->figure && k < count; k++) {
        char *end = NULL;
        const char *value = list[k].row.type == SF_ROW_TEXT ? NULL : take_line(rest, list[k].row.key);
        if (list[k].row.type != SF_ROW_TEXT && !value)
            return false;
        out->figure[k] = value ? strtod(value, &end) : NAN;
        if (value && (end == value || *end))
            return false;
    }
    return out->figure != NULL;
}

static bool take(char *rest, const char *results, sf_run_record *out) {
    const char *head = strsep(&rest, "\n"), *of = take_line(&rest, "results"),
               *grade = take_line(&rest, "grade");
    out->verdict = take_line(&rest, "verdict");
    out->status = take_line(&rest, "status");
    if (strcmp(head, HEAD) != 0 || !is_of(of, results) || !grade || !out->verdict || !out->status ||
        !take_figures(&rest, out))
        return false;
    const char *geometry = rest ? strsep(&rest, "\n") : NULL;
    out->grade = (sf_grade)atoi(grade);
    out->geometry = rest;
    return geometry && strcmp(geometry, "geometry") == 0 && rest && out->grade <= SF_GRADE_DO_NOT_USE;
}

bool sf_run_record_read(const char *path, const char *results, sf_run_record *out) {
    sf_error none = SF_ERROR_INIT;
    size_t length = 0;
    *out = (sf_run_record){0};
    return sf_replace_exists(path) &&
           sf_plain_read(path, NULL, SF_PLAIN_TEXT, &out->text, &length, &none) == SF_OK &&
           is_whole(out->text, length) && take(out->text, results, out);
}

void sf_run_record_free(sf_run_record *record) {
    free(record->figure);
    free(record->text);
    *record = (sf_run_record){0};
}
