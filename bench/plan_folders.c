/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plan_folders PLAN.cfg DIR FROM: makes the folder of each row of a plan below DIR/runs, as if its drop were
 * done: with the results and figures of one drop, linked from FROM-0 for the first 50,000 rows, FROM-1 for
 * the next, ..., as a file has at most 65,000 names on some file systems. For tools/campaign_rows.sh. */
#include "study/run_folder.h"
#include "base/program.h"
#include "base/units.h"
#include "io/folder.h"
#include "study/sweep/campaign.h"
#include "study/sweep/plan.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <string.h>
#include <unistd.h>

enum { ROWS_OF_PART = 50000, PATH_SIZE = PATH_MAX + 128 };

static sf_status link_file(const char *from, int64_t row, const char *name, const char *target,
                           sf_error *err) {
    char source[PATH_SIZE];
    snprintf(source, sizeof source, "%s-%" PRId64 "/%s", from, row / ROWS_OF_PART, name);
    return link(source, target) == 0 ? SF_OK : SF_FAIL(err, SF_ERR_IO, "%s: %s", target, strerror(errno));
}

static sf_status make_folder(const sf_plan *plan, int64_t row, const char *runs, const char *from,
                             sf_error *err) {
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    sf_run_folder at;
    sf_runner_drop drop = {.label = SF_SWEEP_LABEL, .case_path = plan->case_path};
    uint64_t key = 0;
    drop.override_count = sf_plan_overrides(plan, row, text, drop.overrides);
    if (sf_runner_key(&(sf_runner){.folder = runs}, &drop, &key, err) != SF_OK)
        return err->status;
    sf_run_folder_name_key(runs, SF_SWEEP_LABEL, key, &at);
    if (sf_folder_own(at.path, err) == SF_OK && link_file(from, row, "results.h5", at.results, err) == SF_OK)
        link_file(from, row, "figures.txt", at.figures, err);
    return err->status;
}

int main(int argc, char **argv) {
    sf_error err = SF_ERROR_INIT;
    sf_plan plan = {0};
    char runs[PATH_MAX];
    if (argc != 4)
        SF_FAIL(&err, SF_ERR_INPUT, "usage: plan_folders PLAN.cfg DIR FROM");
    else if (sf_plan_read(argv[1], true, false, &plan, &err) == SF_OK && sf_units_hold(&err) == SF_OK) {
        snprintf(runs, sizeof runs, "%s/runs", argv[2]);
        sf_folder_own(runs, &err);
        for (int64_t row = 0; row < plan.rows && err.status == SF_OK; row++)
            make_folder(&plan, row, runs, argv[3], &err);
        sf_units_let_go();
    }
    sf_plan_free(&plan);
    return sf_error_report(&err, "plan_folders");
}
