/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/output.h"

#include "model/columns.h"
#include "io/folder.h"
#include "io/seal.h"
#include "solver/run/frame.h"
#include "solver/run/results_file.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NAME_SIZE = SF_PATH_SIZE + 32 };

static const char BASE[] = "base.h5", PEAK[] = "peak.h5", PEAK_GROUP[] = "/peak";

static void frame_group(char group[32], int64_t index) {
    snprintf(group, 32, "/frames/%06lld", (long long)index);
}

static void frame_name(char name[32], int64_t index) {
    snprintf(name, 32, "frame-%06lld.h5", (long long)index);
}

/* folder/name, and the name to write it under. */
static sf_status place(const sf_output *o, const char *name, char path[NAME_SIZE], char partial[SF_PATH_SIZE],
                       sf_error *err) {
    snprintf(path, NAME_SIZE, "%s/%s", o->folder, name);
    return sf_replace_begin(path, partial, err);
}

sf_status sf_output_name(sf_output *o, const char *results, sf_error *err) {
    memset(o, 0, sizeof *o);
    o->lock = -1;
    if (strlen(results) > SF_PATH_SIZE - 64)
        return SF_FAIL(err, SF_ERR_INPUT, "the path of the results file is longer than %d bytes",
                       SF_PATH_SIZE - 64);
    snprintf(o->results, sizeof o->results, "%s", results);
    snprintf(o->checkpoint, sizeof o->checkpoint, "%.4000s.restart", results);
    snprintf(o->folder, sizeof o->folder, "%.4000s.run", results);
    return SF_OK;
}

/* Base, peak or a frame, under its own name or as a partial file. */
static bool is_name(const char *name) {
    char whole[64];
    int length = (int)strcspn(name, "."), end = 0;
    long long index;
    snprintf(whole, sizeof whole, "%.*s.h5", length, name);
    bool known = strcmp(whole, BASE) == 0 || strcmp(whole, PEAK) == 0 ||
                 (sscanf(whole, "frame-%lld.h5%n", &index, &end) == 1 &&
                  end >= (int)strlen("frame-000000.h5") && whole[end] == '\0');
    return known && (strcmp(name, whole) == 0 || sf_replace_is_partial(name, whole, NULL));
}

/* Of another process. */
static bool is_rest(const char *name) {
    return is_name(name) && strstr(name, ".h5.") != NULL;
}

sf_status sf_output_open(sf_output *o, sf_error *err) {
    if (sf_folder_own(o->folder, err) != SF_OK)
        return err->status;
    o->lock = sf_folder_open(o->folder);
    if (o->lock < 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be opened: %s", o->folder, strerror(errno));
    if (flock(o->lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        sf_output_close(o);
        return SF_FAIL(err, SF_ERR_INPUT, "another softfall-solve is writing %s", o->results);
    }
    if (sf_folder_check(o->lock, o->folder, is_name, err) == SF_OK)
        sf_folder_remove_known(o->lock, is_rest, NULL);
    return err->status;
}

void sf_output_close(sf_output *o) {
    if (o->lock >= 0)
        close(o->lock);
    o->lock = -1;
}

void sf_output_clear(const sf_output *o) {
    sf_folder_remove_known(o->lock, is_name, NULL);
    sf_folder_leave(o->folder);
}

/* Closes a file, seals it and gives it its name; removes it if it failed. */
static sf_status commit(sf_h5 **file, const char *partial, const char *path, sf_error *err) {
    sf_h5_close(file, err);
    if (err->status == SF_OK && sf_seal_add(partial, err) == SF_OK)
        return sf_replace_commit(partial, path, err);
    unlink(partial);
    return err->status;
}

static int64_t size_of(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 ? (int64_t)info.st_size : 0;
}

sf_status sf_output_base(const sf_output *o, const sf_model *m, const sf_h5 *model_file,
                         const sf_provenance *provenance, sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    sf_h5 *file = NULL;
    if (place(o, BASE, path, partial, err) != SF_OK)
        return err->status;
    sf_results_create(partial, m, model_file, provenance, &file, err);
    return sf_h5_close(&file, err) == SF_OK && err->status == SF_OK ? sf_seal_add(partial, err) : err->status;
}

sf_status sf_output_start(const sf_output *o, bool keep, sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    if (place(o, BASE, path, partial, err) != SF_OK)
        return err->status;
    if (sf_replace_commit(partial, path, err) == SF_OK && !keep)
        sf_folder_remove_known(o->lock, is_name, BASE);
    return err->status;
}

void sf_output_abandon(const sf_output *o) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    sf_error ignored = SF_ERROR_INIT;
    if (o->lock < 0)
        return;
    if (place(o, BASE, path, partial, &ignored) == SF_OK)
        unlink(partial);
    sf_folder_leave(o->folder); /* stays if an earlier run has files in it */
}

/* The present state as the group of a file of the folder, whose size is added to `*size` (NULL: to none). */
static sf_status write_state(const sf_output *o, const sf_model *m, const sf_operators *op, const sf_state *s,
                             int64_t fields, const char *name, const char *group, int64_t *size,
                             sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    sf_h5 *file = NULL;
    if (place(o, name, path, partial, err) != SF_OK || sf_h5_create(partial, &file, err) != SF_OK)
        return err->status;
    sf_frame_write(m, op, s, fields, group, file, err);
    if (commit(&file, partial, path, err) == SF_OK && size)
        *size += size_of(path);
    return err->status;
}

sf_status sf_output_frame(sf_output *o, const sf_model *m, const sf_operators *op, const sf_state *s,
                          int64_t index, sf_error *err) {
    char name[32], group[32];
    frame_name(name, index);
    frame_group(group, index);
    return write_state(o, m, op, s, m->run.output_fields, name, group, &o->fresh, err);
}

sf_status sf_output_peak(const sf_output *o, const sf_model *m, const sf_operators *op, const sf_state *s,
                         sf_error *err) {
    return write_state(o, m, op, s, SF_FIELD_ALL, PEAK, PEAK_GROUP, NULL, err);
}

/* The group of another file as a file of the folder. */
static sf_status recover(const sf_h5 *from, const char *group, const char *path, const char *partial,
                         sf_error *err) {
    sf_h5 *file = NULL;
    if (sf_h5_create(partial, &file, err) != SF_OK)
        return err->status;
    sf_h5_copy(from, group, file, err);
    return commit(&file, partial, path, err);
}

sf_status sf_output_recover_peak(const sf_output *o, const sf_h5 *checkpoint, sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    if (place(o, PEAK, path, partial, err) != SF_OK)
        return err->status;
    return recover(checkpoint, PEAK_GROUP, path, partial, err);
}

/* Opens results.h5 if it is whole; it may be missing or damaged. */
static sf_status open_results(const sf_output *o, sf_h5 **results, sf_error *err) {
    sf_seal_state state;
    SF_TRY(sf_seal_examine(o->results, &state, err));
    return state == SF_SEAL_SOUND || state == SF_SEAL_NONE ? sf_h5_open_alone(o->results, results, err)
                                                           : SF_OK;
}

/* Frame `k`: if its file is not sound, then from results.h5, where it must not be a link. */
static sf_status recover_frame(const sf_output *o, int64_t k, sf_h5 **results, bool *lost, sf_error *err) {
    char name[32], group[32], path[NAME_SIZE], partial[SF_PATH_SIZE];
    sf_seal_state state;
    frame_name(name, k);
    frame_group(group, k);
    if (place(o, name, path, partial, err) != SF_OK || sf_seal_examine(path, &state, err) != SF_OK ||
        state == SF_SEAL_SOUND)
        return err->status;
    if (!*results && open_results(o, results, err) != SF_OK)
        return err->status;
    *lost = !*results || !sf_h5_exists(*results, group);
    return *lost ? SF_OK : recover(*results, group, path, partial, err);
}

sf_status sf_output_recover(const sf_output *o, int64_t count, int64_t *lost, sf_error *err) {
    sf_h5 *results = NULL;
    bool gone = false;
    *lost = -1;
    for (int64_t k = 0; k < count && !gone && err->status == SF_OK; k++)
        if (recover_frame(o, k, &results, &gone, err) == SF_OK && gone)
            *lost = k;
    sf_h5_close(&results, err);
    return err->status;
}

bool sf_output_is_due(const sf_output *o, int64_t rows) {
    return o->fresh + rows * SF_HISTORY_COUNT * (int64_t)sizeof(double) >= 4 * o->size;
}

/* One object of a file in the folder, linked or copied. */
static sf_status take(const sf_output *o, bool copied, const char *name, const char *const *objects,
                      sf_h5 *file, sf_error *err) {
    char path[NAME_SIZE];
    const char *slash = strrchr(o->folder, '/');
    sf_h5 *part = NULL;
    snprintf(path, sizeof path, "%s/%s", copied ? o->folder : slash ? slash + 1 : o->folder, name);
    if (copied && (sf_seal_check(path, err) != SF_OK || sf_h5_open_alone(path, &part, err) != SF_OK))
        return err->status;
    for (; *objects && err->status == SF_OK; objects++) {
        if (copied)
            sf_h5_copy(part, *objects, file, err);
        else
            sf_h5_link(file, *objects, path, err);
    }
    sf_h5_close(&part, err);
    return err->status;
}

sf_status sf_output_copy_peak(const sf_output *o, sf_h5 *file, sf_error *err) {
    return take(o, true, PEAK, (const char *const[]){PEAK_GROUP, NULL}, file, err);
}

sf_status sf_output_begin(sf_output *o, bool copied, int64_t count, sf_h5 **file, sf_error *err) {
    static const char *const base[] = {"/provenance", "/model", NULL};
    if (sf_replace_begin(o->results, o->partial, err) != SF_OK ||
        sf_h5_create(o->partial, file, err) != SF_OK ||
        sf_provenance_mark(*file, "softfall-results", err) != SF_OK)
        return err->status;
    take(o, copied, BASE, base, *file, err);
    for (int64_t k = 0; k < count && err->status == SF_OK; k++) {
        char name[32], group[32];
        frame_name(name, k);
        frame_group(group, k);
        take(o, copied, name, (const char *const[]){group, NULL}, *file, err);
    }
    return err->status;
}

sf_status sf_output_commit(sf_output *o, sf_h5 **file, sf_error *err) {
    if (commit(file, o->partial, o->results, err) == SF_OK) {
        o->fresh = 0;
        o->size = size_of(o->results);
    }
    return err->status;
}
