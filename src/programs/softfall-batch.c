/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-batch MANIFEST [--group GROUP]: what an engine starts for each group of a batch. */
#include "study/runner.h"
#include "base/program.h"
#include "io/process.h"
#include "io/replace.h"

#include <errno.h>
#include <unistd.h>

typedef struct options {
    const char *manifest, *group;
    int threads;
} options;

static const sf_option known[] = {
    {"group", 'g', "GROUP", "simulate the drops of this group that are not there",
     .member = offsetof(options, group)},
    {"threads", 't', "N", "drops side by side, one thread each (default 1)",
     .member = offsetof(options, threads), .low = 1, .high = SF_MOST_THREADS},
    {0},
};

static const char *find_fault(const sf_command *command) {
    const options *o = command->list[0].values;
    return o->manifest ? NULL
                       : "give the manifest of a batch, DIR/runs/" SF_MANIFEST_FOLDER "/" SF_MANIFEST_NAME;
}

/* The runs of a group: [*first, *last). */
static sf_status find_group(const sf_manifest *m, const options *o, int *first, int *last, sf_error *err) {
    for (*first = 0; *first < m->count && strcmp(m->run[*first].group, o->group) != 0;)
        ++*first;
    *last = *first < m->count ? sf_manifest_group_end(m, *first) : *first;
    if (*first == *last)
        return SF_REFUSE(err, "%s has no group %s", o->manifest, o->group);
    return SF_OK;
}

/* A drop is as the manifest says: the same inputs, and programs of the same revision. */
static sf_status check_keys(int count, const sf_manifest_run *run, const uint64_t *key, sf_error *err) {
    for (int k = 0; k < count; k++)
        if (run[k].key != 0 && run[k].key != key[k])
            return SF_REFUSE(err,
                             "the drop %s is not the one of the manifest: its inputs or the programs are "
                             "others here",
                             run[k].drop.label);
    return SF_OK;
}

/* A failure that comes again whenever the drop is simulated, a crash of a program, too; with others, as a
 * program that was killed, the group is not done. */
static bool is_permanent(const sf_error *failure) {
    return failure->status == SF_ERR_NUMERIC || failure->status == SF_ERR_MODEL ||
           failure->status == SF_ERR_INPUT ||
           (failure->status == SF_ERR_LIBRARY && !strstr(failure->text, SF_PROCESS_KILLED));
}

static sf_status finish_group(const char *outcome, int count, const sf_manifest_run *run,
                              const sf_error *failure, sf_error *err) {
    int failed = 0;
    for (int k = 0; k < count; k++) {
        failed += failure[k].status != SF_OK;
        if (failure[k].status != SF_OK && !is_permanent(&failure[k]))
            return SF_FAIL(err, failure[k].status, "%s", failure[k].text);
        if (failure[k].status != SF_OK)
            printf("%s failed: %s\n", run[k].drop.label, failure[k].text);
    }
    printf("%d drops done, %d of them failed\n", count, failed);
    return sf_manifest_write_outcome(outcome, count, run, failure, err);
}

static sf_status run_group(const options *o, const sf_manifest *m, const char *outcome, sf_error *err) {
    int first, last;
    SF_TRY(find_group(m, o, &first, &last, err));
    int count = last - first;
    const sf_manifest_run *run = &m->run[first];
    sf_runner runner = {.folder = m->runs, .threads = o->threads, .log = stdout};
    SF_OWNED sf_runner_drop *drop = sf_alloc(err, count, sizeof *drop, "drops");
    SF_OWNED sf_error *failure = sf_alloc(err, count, sizeof *failure, "failures");
    SF_OWNED uint64_t *key = sf_alloc(err, count, sizeof *key, "keys");
    for (int k = 0; err->status == SF_OK && k < count; k++)
        drop[k] = run[k].drop;
    for (int k = 0; err->status == SF_OK && k < count; k++)
        sf_runner_key(&runner, &drop[k], &key[k], err);
    if (err->status == SF_OK && check_keys(count, run, key, err) == SF_OK &&
        sf_runner_run_each(&runner, count, drop, NULL, failure, err) == SF_OK)
        finish_group(outcome, count, run, failure, err);
    return err->status;
}

/* Lists the status of the runs; those that failed with their sentences. */
static sf_status list_runs(const sf_manifest *m, sf_error *err) {
    const sf_runner runner = {.folder = m->runs};
    int number[4] = {0};
    for (int k = 0; k < m->count; k++) {
        sf_runner_state state = SF_DROP_OPEN;
        sf_error failure = SF_ERROR_INIT;
        SF_TRY(sf_runner_find_status(&runner, &m->run[k].drop, &state, &failure, err));
        number[state]++;
        printf("%016llx\t%s\t%s\t%s\t%s\n", (unsigned long long)m->run[k].key, m->run[k].group,
               sf_runner_state_name(state), m->run[k].drop.label, failure.text);
    }
    for (int state = 0; state < 4; state++)
        printf("%s%d %s", state ? ", " : "", number[state], sf_runner_state_name((sf_runner_state)state));
    printf("\n");
    return SF_OK;
}

static sf_status run(const options *o, sf_error *err) {
    char outcome[SF_PATH_SIZE + 64], file[PATH_MAX];
    SF_OWNED_BY(sf_manifest_free) sf_manifest m = {0};
    if (!realpath(o->manifest, file))
        SF_REFUSE(err, "the manifest %s cannot be read: %s", o->manifest, strerror(errno));
    else if (sf_manifest_read(file, &m, err) == SF_OK && chdir(m.folder) != 0)
        SF_REFUSE(err, "the folder of the campaign, %s, cannot be entered: %s", m.folder, strerror(errno));
    else if (err->status == SF_OK && o->group) {
        sf_manifest_outcome_path(file, o->group, outcome, sizeof outcome);
        run_group(o, &m, outcome, err);
    } else if (err->status == SF_OK)
        list_runs(&m, err);
    return err->status;
}

int main(int argc, char **argv) {
    options o = {.threads = 1};
    sf_error err = SF_ERROR_INIT;
    const sf_command line = {
        .program = "softfall-batch",
        .operands = "MANIFEST",
        .meaning =
            "Lists the drops of a batch with their state, or simulates a group of them: what an engine "
            "(Snakemake) starts. Finished drops are not simulated again.",
        .second = "one manifest at a time: \"%s\" is one too many",
        .operand = offsetof(options, manifest),
        .fault = find_fault,
        .is_usage = true,
        .list = {{known, &o}}};
    sf_process_handle_signals();
    if (sf_program_begin(argv, &err) == SF_OK && sf_command_parse(&line, argc, argv, &err) == SF_OK &&
        sf_units_hold(&err) == SF_OK) {
        run(&o, &err);
        sf_units_let_go();
    }
    return sf_error_report(&err, "softfall-batch");
}
