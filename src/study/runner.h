/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drops simulated by softfall-pre and softfall-solve, each in a folder of its own that stays: a campaign (a
 * fit, a series of drop heights) that was interrupted reuses its finished drops and resumes an interrupted
 * drop from its checkpoint.
 *
 * The programs are those in the folder of the running program, or in SF_BIN_DIR if that is set. */
#pragma once
#include "study/batch.h"
#include "study/run_folder.h"

typedef struct sf_runner {
    const char *folder; /* holds the drops' folders; made if need be; borrowed */
    int threads;        /* of softfall-solve, together, but at least one of each drop that runs */
    int jobs;           /* drops of a batch that run side by side, at most SF_PROCESS_JOBS; 0: as many as
                           threads. More than threads: the log says so */
    FILE *log;          /* a line for each drop; borrowed; NULL: silent */
    int64_t simulated;  /* drops so far, out */
    int64_t reused;     /* drops whose results were there, out */
    sf_runner_engine engine;
} sf_runner;

enum { SF_RUNNER_COUNTED = 104 };

/* The results of a drop for a campaign; figures of the CFC 1000 curve. Those of a series of drops on one pad
 * are the means over the drops that count (sf_case.counted), `steps` and `wall_s` the sums over all; the
 * largest local strain and the grade are those of the worst drop, curve, window, contact time and `status`
 * those of the last. Of a series up to the drop sf_runner_drop.number that drop alone counts. */
typedef struct sf_runner_result {
    double a_max_g, hic;                /* g, - */
    double hic_window;                  /* s, length of its window */
    double contact_time;                /* s, of contact, from the first; NaN if it had not ended */
    double v0, v_rebound;               /* m s-1; v_rebound NaN if contact had not ended */
    double max_indentation;             /* m */
    double max_local_strain;            /* - */
    double energy_error;                /* - */
    sf_grade grade;                     /* of the run, as softfall-post gives it */
    char verdict[SF_VERDICT_LINE_SIZE]; /* sf_verdict_line of it */
    double *figure;                     /* [of sf_figure_at] sf_figure_number; owned */
    char status[80];                    /* how the run ended: the figure that is a text */
    sf_series curve;                    /* s, g: filtered; owned */
    char *path;                         /* of its results.h5; owned */
    char counted[SF_RUNNER_COUNTED];    /* sf_run_counted_text */
    bool reused;
} sf_runner_result;

/* Reads the single drop of a folder, or all drops of its series; writes the record of figures that is
 * missing. */
sf_status sf_runner_read(const sf_run_folder *at, sf_runner_result *out, sf_error *err);

/* A number of the list of figures; NaN: the run does not define it. */
double sf_runner_figure(const sf_runner_result *result, const char *key);

/* Simulates the drop unless a finished run of the same inputs is there: the same values of every key of the
 * case and the material, the same curves and geometry files, and programs of the same revision. Release with
 * sf_runner_result_free. Errors: the message of the program that failed, with the path of its log; a drop
 * that never touched the pad; SF_INTERRUPTED when a program was interrupted. */
sf_status sf_runner_run(sf_runner *runner, const sf_runner_drop *drop, sf_runner_result *result,
                        sf_error *err);
/* In the sentence of a drop whose files are no longer those of its key (SF_ERR_IO): it was not simulated, and
 * other drops of its batch may be of either. */
#define SF_RUNNER_CHANGED "has changed while the batch ran"
/* Several drops, side by side: the threads are shared among those that must be simulated, the bits are the
 * same. A finished drop is kept whatever happens to the others; a drop that is in the batch twice is
 * simulated once. result [count]: release each with sf_runner_result_free, also on failure. Errors: of the
 * first drop that failed, other than numerically if there is one. */
sf_status sf_runner_run_batch(sf_runner *runner, int count, const sf_runner_drop *drop,
                              sf_runner_result *result, sf_error *err);
/* The same, but a drop that fails does not end the others: failure [count] holds each one's status and
 * sentence; a drop without one has its result. `result` NULL: no results are read, as of many drops, and
 * neither simulated nor reused ones are counted. Errors: of what all drops need, and interruptions. */
sf_status sf_runner_run_each(sf_runner *runner, int count, const sf_runner_drop *drop,
                             sf_runner_result *result, sf_error *failure, sf_error *err);
void sf_runner_result_free(sf_runner_result *result);

/* The key of the drop's inputs: its folder is runner->folder/label-<key, 16 hexadecimal digits>. */
sf_status sf_runner_key(const sf_runner *runner, const sf_runner_drop *drop, uint64_t *key, sf_error *err);

typedef enum sf_runner_state { SF_DROP_OPEN, SF_DROP_RUNNING, SF_DROP_DONE, SF_DROP_FAILED } sf_runner_state;

/* Finds the status of a drop; `*failure` of one that failed. Changes nothing. Errors: those of its inputs. */
sf_status sf_runner_find_status(const sf_runner *runner, const sf_runner_drop *drop, sf_runner_state *state,
                                sf_error *failure, sf_error *err);
/* open, running, done, failed */
const char *sf_runner_state_name(sf_runner_state state);
