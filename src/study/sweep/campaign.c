/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/campaign.h"

#include "base/hash.h"
#include "io/folder.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/replace.h"
#include <errno.h>
#include <unistd.h>

static const double WRITE_INTERVAL = 20; /* s between two tables, or this many times what one takes */
static const double WRITE_SHARE = 20;
enum { KEY_SIZE = 256 };

typedef struct path {
    char text[PATH_MAX];
} path;

static path file_of(const sf_sweep_campaign *c, const char *name) {
    path p;
    snprintf(p.text, sizeof p.text, "%s/%s", c->folder, name);
    return p;
}

/* ---- whose folder it is: the file sweep.key ---- */

typedef struct keys {
    bool there;
    uint64_t table, inputs, text; /* `text`: of runs.csv; 0: not known, by an earlier revision */
} keys;

static sf_status read_keys(const sf_sweep_campaign *c, keys *k, sf_error *err) {
    path p = file_of(c, "sweep.key");
    unsigned long long table = 0, inputs = 0, runs = 0;
    SF_OWNED char *text = NULL;
    *k = (keys){0};
    if (access(p.text, F_OK) != 0)
        return SF_OK;
    if (sf_plain_read(p.text, NULL, KEY_SIZE, &text, NULL, err) == SF_OK &&
        sscanf(text, "softfall-sweep table %16llx inputs %16llx runs.csv %16llx", &table, &inputs, &runs) >=
            2)
        *k = (keys){true, table, inputs, runs};
    else if (err->status == SF_OK)
        SF_REFUSE(err, "%s is not a file of softfall-sweep: give another directory", p.text);
    return err->status;
}

static sf_status write_keys(const sf_sweep_campaign *c, uint64_t runs, sf_error *err) {
    sf_replacement out;
    path p = file_of(c, "sweep.key");
    FILE *file = sf_replace_open(p.text, &out, err);
    SF_TRY(err->status);
    fprintf(file, "softfall-sweep table %016llx inputs %016llx runs.csv %016llx\n",
            (unsigned long long)sf_plan_hash(c->plan), (unsigned long long)c->inputs,
            (unsigned long long)runs);
    return sf_replace_close(&out, err);
}

static void remove_report(const sf_sweep_campaign *c) {
    for (const char *const *name = c->report; name && *name; name++)
        sf_folder_remove_file(file_of(c, *name).text);
}

/* sweep.key knows the table by its text: what something else has written, or was written under another key,
 * is not believed. `turned`: to other inputs or another plan, so that the report of the rows as they were
 * goes, after the table could be written and before sweep.key says of what it is: after a kill in between the
 * next start finds it turned again (but for a file that only the geometry knows of). */
static sf_status write_table(const sf_sweep_campaign *c, const sf_runs *runs, bool turned, sf_error *err) {
    path table = file_of(c, "runs.csv"), key = file_of(c, "sweep.key");
    uint64_t hash = 0;
    if (access(key.text, F_OK) != 0) /* first of all: without it the table is somebody else's */
        SF_TRY(write_keys(c, 0, err));
    SF_TRY(sf_runs_write(runs, table.text, &hash, err));
    if (turned)
        remove_report(c);
    return write_keys(c, hash, err);
}

static sf_status check_keys(const sf_sweep_campaign *c, keys *k, bool *known, sf_error *err) {
    *known = false;
    SF_TRY(read_keys(c, k, err));
    *known = k->there && k->table == sf_plan_hash(c->plan);
    if (k->there && !*known && !c->force)
        return SF_REFUSE(err,
                         "%s holds the runs of another plan: give another directory, or --force to replace "
                         "its table (finished drops of the same inputs are used again)",
                         c->folder);
    return SF_OK;
}

sf_status sf_sweep_campaign_check(const sf_sweep_campaign *c, bool *known, sf_error *err) {
    keys k;
    return check_keys(c, &k, known, err);
}

/* ---- what is there ---- */

/* A run whose folder somebody removed is to be done again. Where all folders are missing, the results are
 * rather on a disk that is not there. */
static sf_status open_missing(const sf_sweep_campaign *c, sf_runs *runs, sf_error *err) {
    char place[PATH_MAX];
    int64_t there = 0, gone = 0;
    for (int64_t row = 0; row < runs->count && c->drops; row++) {
        if (runs->state[row] != SF_SWEEP_DONE || !runs->folder[row])
            continue;
        snprintf(place, sizeof place, "%s/%s/results.h5", c->drops, runs->folder[row]);
        bool missing = access(place, F_OK) != 0 && (errno == ENOENT || errno == ENOTDIR);
        there += !missing;
        gone += missing;
        if (missing)
            sf_runs_open(runs, row);
    }
    if (gone > 0 && there == 0)
        return SF_REFUSE(err,
                         "runs.csv has runs that are done, but the folder %s has the results of none of "
                         "them: put them back, or remove runs.csv to begin anew",
                         c->drops);
    return SF_OK;
}

/* `*changed`: what the folder holds, if anything, is of other inputs, of another plan, or of a table that is
 * not there. */
static sf_status read_table(const sf_sweep_campaign *c, sf_runs *runs, bool *changed, sf_error *err) {
    keys k;
    bool known = false;
    path table = file_of(c, "runs.csv");
    SF_TRY(check_keys(c, &k, &known, err));
    *changed = !known || k.inputs != c->inputs || access(table.text, F_OK) != 0;
    if (known && access(table.text, F_OK) == 0 && sf_runs_read(runs, table.text, k.text, err) == SF_OK)
        open_missing(c, runs, err);
    return err->status;
}

sf_status sf_sweep_campaign_status(const sf_sweep_campaign *c, sf_runs *runs, int64_t *open, sf_error *err) {
    bool changed = false;
    SF_TRY(read_table(c, runs, &changed, err));
    *open = sf_runs_count(runs, SF_SWEEP_OPEN) + (c->retry ? sf_runs_count(runs, SF_SWEEP_FAILED) : 0);
    *open = changed ? runs->count : *open;
    return SF_OK;
}

static void open_all(sf_runs *runs, sf_sweep_state state) {
    for (int64_t row = 0; row < runs->count; row++)
        if (runs->state[row] == state)
            sf_runs_open(runs, row);
}

/* Opens the rows that are done or failed. */
static void open_ended(sf_runs *runs) {
    open_all(runs, SF_SWEEP_DONE);
    open_all(runs, SF_SWEEP_FAILED);
}

/* Rows since the last look may be of other inputs than those before. All are opened, as a row that is there
 * is soon found again. */
static sf_status check_unchanged(const sf_sweep_campaign *c, sf_runs *runs, sf_error *err) {
    uint64_t inputs = c->inputs;
    sf_error refused = SF_ERROR_INIT;
    if (!c->look || (c->look(c->plan, &inputs, &refused) == SF_OK && inputs == c->inputs))
        return SF_OK;
    open_ended(runs);
    open_all(runs, SF_SWEEP_PREDICTED);
    return SF_FAIL(err, SF_ERR_IO,
                   "the inputs of the campaign changed while it ran: %.700s; finished drops are kept: repeat "
                   "the command",
                   refused.status != SF_OK ? refused.text
                                           : "a file that the case or the plan leads to, or a program");
}

/* No row of other inputs comes into the table. It is written in any case; the first failure counts. */
static sf_status save(const sf_sweep_campaign *c, sf_runs *runs, bool turned, sf_error *err) {
    sf_error second = SF_ERROR_INIT;
    turned = check_unchanged(c, runs, err) != SF_OK || turned;
    if (write_table(c, runs, turned, &second) != SF_OK && err->status == SF_OK)
        *err = second;
    return err->status;
}

static sf_status take_over(const sf_sweep_campaign *c, sf_runs *runs, bool *changed, sf_error *err) {
    SF_TRY(read_table(c, runs, changed, err));
    if (*changed) {
        bool there = sf_runs_count(runs, SF_SWEEP_OPEN) < runs->count;
        open_ended(runs);
        if (c->log && there)
            fputs("  files or programs have changed since: every run is looked at again\n", c->log);
    }
    if (c->retry)
        open_all(runs, SF_SWEEP_FAILED);
    return SF_OK;
}

/* ---- what only the geometry knows of ---- */

/* The values of the factors of the geometry in a row. */
static uint64_t geometry_of(const sf_plan *plan, int64_t row) {
    uint64_t hash = SF_HASH_START;
    for (int f = 0; f < plan->factor_count; f++)
        if (strncmp(plan->factor[f].key, "geometry", 8) == 0) {
            double value = sf_plan_value(plan, f, row);
            hash = sf_hash_bytes(hash, &value, sizeof value);
        }
    return hash;
}

/* A row that is done or failed. */
typedef struct geometry {
    uint64_t hash;
    bool failed;
    int64_t row;
} geometry;

/* By geometry; of one, rows that are done come first. */
static int compare_geometries(const void *a, const void *b) {
    const geometry *p = a, *q = b;
    int order = (p->hash > q->hash) - (p->hash < q->hash);
    order = order ? order : p->failed - q->failed;
    return order ? order : (p->row > q->row) - (p->row < q->row);
}

/* Returns the rows, sorted; from sf_alloc, NULL on failure. */
static geometry *list_geometries(const sf_runs *runs, int64_t *count, sf_error *err) {
    int64_t ended = runs->count - sf_runs_count(runs, SF_SWEEP_OPEN);
    geometry *list = sf_alloc(err, ended, sizeof *list, "geometries");
    *count = 0;
    for (int64_t row = 0; row < runs->count && list; row++)
        if (runs->state[row] != SF_SWEEP_OPEN)
            list[(*count)++] =
                (geometry){geometry_of(runs->plan, row), runs->state[row] == SF_SWEEP_FAILED, row};
    if (*count > 0)
        qsort(list, (size_t)*count, sizeof *list, compare_geometries);
    return list;
}

/* The last row of the geometry of row `first` of the list. */
static int64_t last_of_geometry(const geometry *list, int64_t count, int64_t first) {
    while (first + 1 < count && list[first + 1].hash == list[first].hash)
        first++;
    return first;
}

/* A file that only the geometry knows of may have changed since the last campaign: it shows by one finished
 * run of each geometry, and then every run is looked at again. Failed rows of a geometry without a finished
 * run are opened, as they may have read such a file. */
static sf_status probe(const sf_sweep_campaign *c, const sf_sweep_engine *engine, sf_runs *runs,
                       sf_error *err) {
    int64_t n, last;
    SF_OWNED geometry *list = list_geometries(runs, &n, err);
    bool changed = false;
    for (int64_t k = 0; k < n; k = last + 1) {
        last = last_of_geometry(list, n, k);
        for (int64_t j = k; j <= last && list[k].failed; j++)
            sf_runs_open(runs, list[j].row);
        changed = changed || (!list[k].failed && engine->is_current &&
                              !engine->is_current(engine->context, runs, list[k].row));
    }
    if (!changed)
        return err->status;
    open_ended(runs);
    sf_log_print(c->log,
                 "  a file of the geometry or a result has changed since: every run is looked at again\n");
    return save(c, runs, true, err);
}

enum { LOOKED_AT = 200 }; /* geometries at the end */

/* The same at the end: the first and the last row that is done of each geometry (of many geometries, some
 * evenly spread ones, as all come from a few files). If one is of other files, all rows are opened, as these
 * may be of either. */
static sf_status probe_again(const sf_sweep_engine *engine, sf_runs *runs, sf_error *err) {
    int64_t n, geometries = 0, at = 0, last;
    SF_OWNED geometry *list = engine->is_current ? list_geometries(runs, &n, err) : NULL;
    if (!list)
        return err->status;
    for (int64_t k = 0; k < n; k = last_of_geometry(list, n, k) + 1)
        geometries++;
    int64_t every = geometries / LOOKED_AT + 1;
    for (int64_t k = 0; k < n && err->status == SF_OK; k = last + 1, at++) {
        int64_t done = last = last_of_geometry(list, n, k);
        while (done >= k && list[done].failed)
            done--;
        const int64_t pair[] = {k, done};
        for (int j = 0; j < 2 && at % every == 0 && done >= k; j++)
            if (!engine->is_current(engine->context, runs, list[pair[j]].row))
                SF_FAIL(err, SF_ERR_IO,
                        "a file that the geometry of run %lld includes or merges, or its result, changed "
                        "while the campaign ran; finished drops are kept: repeat the command",
                        (long long)list[pair[j]].row + 1);
    }
    if (err->status != SF_OK)
        open_ended(runs);
    return err->status;
}

/* ---- the work ---- */

static int next_piece(const sf_runs *runs, int64_t *from, int most, int64_t *row) {
    int count = 0;
    for (; *from < runs->count && count < most; ++*from)
        if (runs->state[*from] == SF_SWEEP_OPEN)
            row[count++] = *from;
    return count;
}

static void tell_progress(const sf_sweep_campaign *c, int64_t begun, int64_t done, int64_t open,
                          double start) {
    double spent = sf_process_now() - start, left = spent / (double)done * (double)(open - done);
    sf_log_print(c->log, "%lld of %lld runs; %.0f s so far, about %.0f s to go\n", (long long)(begun + done),
                 (long long)(begun + open), spent, left);
}

static sf_status work(const sf_sweep_campaign *c, const sf_sweep_engine *engine, sf_runs *runs, int64_t *row,
                      sf_error *err) {
    int64_t from = 0, done = 0, open = sf_runs_count(runs, SF_SWEEP_OPEN);
    double start = sf_process_now(), written = start, duration = 0;
    int count;
    while (err->status == SF_OK &&
           (count = c->chooser ? c->chooser->next(c->chooser->context, runs, engine->piece, row, err)
                               : next_piece(runs, &from, engine->piece, row)) > 0) {
        int fresh = 0;
        SF_TRY(engine->run(engine->context, runs, count, row, &fresh, err));
        done += count;
        double time = sf_process_now();
        if (time - written < WRITE_INTERVAL || time - written < WRITE_SHARE * duration)
            continue;
        save(c, runs, false, err);
        written = sf_process_now();
        duration = written - time;
        if (!c->chooser)
            tell_progress(c, runs->count - open, done, open, start);
    }
    return err->status;
}

sf_status sf_sweep_campaign_run(const sf_sweep_campaign *c, const sf_sweep_engine *engine, sf_runs *runs,
                                sf_error *err) {
    SF_OWNED int64_t *row = sf_alloc(err, engine->piece, sizeof *row, "the runs at work");
    bool turned = false;
    if (row && take_over(c, runs, &turned, err) == SF_OK) {
        if (write_table(c, runs, turned, err) == SF_OK && probe(c, engine, runs, err) == SF_OK &&
            work(c, engine, runs, row, err) == SF_OK)
            turned = probe_again(engine, runs, err) != SF_OK || turned;
        if (c->chooser && err->status == SF_OK)
            c->chooser->finish(c->chooser->context, runs, err);
        save(c, runs, turned, err);
    }
    return err->status;
}
