/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/run.h"

#include <unistd.h>

#include "base/text.h"
#include "io/h5_data.h"
#include "material/low_density_foam.h"
#include "model/motion.h"
#include "solver/set.h"
#include "solver/step.h"

static const double REBOUND_WAIT = 1e-3; /* s, without contact before the run may end */

bool sf_ending_rebounded(const sf_model *m, const sf_state *s) {
    return m->run.stop_after_rebound && sf_missile_is_leaving(m, &s->missile) && s->contact_count == 0 &&
           s->time - s->missile.release_time > REBOUND_WAIT;
}

bool sf_ending_on_anvil(const sf_model *m, const sf_state *s) {
    return (m->anvil.depth > 0 && sf_missile_depth(m, &s->missile) >= m->anvil.depth) ||
           (m->support_travel > 0 && s->missile.displacement >= m->support_travel);
}

sf_status sf_ending_fail_on_anvil(const sf_model *m, const sf_state *s, sf_error *err) {
    return SF_FAIL(err, SF_ERR_NUMERIC,
                   "the missile reached the anvil%s at t = %.6g ms with %.4g m/s: an impact of rigid bodies "
                   "has no acceleration that could be told, and the run ends there",
                   m->support_travel > 0 ? " or the support" : "", 1e3 * s->time, s->missile.velocity_now);
}

bool sf_ending_finished(const sf_model *m, const sf_state *s) {
    return s->time >= m->run.end_time;
}

static void tell_depth(const sf_model *m, const sf_extremes *x, const sf_sink *sink) {
    const sf_missile_card *card = &m->missile;
    double height = card->sphere_radius * (1 - card->sphere_cap_cosine);
    if (card->shape == SF_SHAPE_SPHERE && x->largest_indentation > height)
        sf_sink_tell(sink, SF_WARNING, "the missile went %.4g mm deep, beyond its spherical cap of %.4g mm",
                     1e3 * x->largest_indentation, 1e3 * height);
    if (x->largest_indentation > m->thickness + m->air)
        sf_sink_tell(sink, SF_WARNING, "the missile went %.4g mm into a pad of %.4g mm: %s",
                     1e3 * x->largest_indentation, 1e3 * m->thickness,
                     x->bare_at_deepest ? "it met no contact point there; is it smaller than their spacing?"
                                        : "the foam collapsed, or the pad's base is not held");
}

/* Least strain from which the curve of a foam is the line that ends it; INFINITY: no material has one. */
static double straight_strain(const sf_model *m) {
    double least = INFINITY;
    for (int64_t k = 0; k < m->material_count; k++) {
        sf_curve curve;
        sf_error ignored = SF_ERROR_INIT;
        const char *law =
            m->material[k].law->name; /* not its address: another library may have built the model */
        if (strcmp(law, sf_low_density_foam.name) != 0)
            continue;
        const sf_foam_card *card = sf_foam_card_of(&m->material[k]);
        for (int64_t c = 0;
             c < card->curves.curve_count && sf_curve_build(card, c, &curve, &ignored) == SF_OK; c++) {
            least = fmin(least, curve.straight.start);
            sf_curve_free(&curve);
        }
    }
    return least;
}

static void tell_pole(const sf_model *m, const sf_extremes *x, const sf_sink *sink) {
    double straight = straight_strain(m);
    if (x->largest_compression > straight)
        sf_sink_tell(
            sink, SF_WARNING,
            "the foam was compressed to a strain of %.4g; from %.4g on its curve, near the pole of "
            "its densification, is a line of the program that keeps the stress finite, and no "
            "property of the material: give the curve data to larger strains, or take a stiffer foam",
            x->largest_compression, straight);
}

/* The rates of the data are those at the pad's temperature: tells where the impact leaves them. */
static void tell_rates(const sf_model *m, const sf_sink *sink) {
    double rate = fmax(m->missile.speed, sf_motion_measure(m).speed) / m->thickness;
    for (int64_t k = 0; k < m->material_count && m->run.temperature > 0; k++) {
        const sf_foam_shared *foam = m->material[k].card;
        const sf_law_curves *c = sf_material_curves(&m->material[k]);
        bool curves = c && c->curve_count > 1;
        double low = foam->rate_factor > 0 ? foam->rate_reference : 0, high = INFINITY;
        if (curves) {
            low = c->curve_rate[0];
            high = c->curve_rate[c->curve_count - 1];
        }
        if (rate < low || rate > high)
            sf_sink_tell(sink, SF_WARNING,
                         "at %g degC the rate of the impact, speed over thickness, is %.3g s-1, %s rate of "
                         "the foam's data there, %.3g s-1: the stress of that rate is taken",
                         m->run.temperature - SF_CELSIUS, rate,
                         rate < low ? "below the lowest" : "above the highest", rate < low ? low : high);
    }
}

void sf_run_tell(const sf_model *m, const sf_state *s, const sf_extremes *x, const sf_sink *sink) {
    tell_depth(m, x, sink);
    tell_pole(m, x, sink);
    tell_rates(m, sink);
    if (s->contact_unsettled > 0)
        sf_sink_tell(sink, SF_WARNING, "the contact forces of %lld steps did not settle to the last digits",
                     (long long)s->contact_unsettled);
    if (!isnan(s->missile.rim_time))
        sf_sink_tell(sink, SF_WARNING,
                     "at %.4g ms the missile had turned so far that the rim of its spherical cap was lowest: "
                     "beyond the rim there is no contact; give missile.group its whole surface, and "
                     "missile.shape = \"surface\"",
                     1e3 * s->missile.rim_time);
    if (isnan(s->missile.contact_time))
        sf_sink_tell(sink, SF_WARNING, "the missile never touched the pad");
}

/* True if every material has a reloading path of its own. */
static bool has_memory(const sf_model *m) {
    bool all = true;
    for (int64_t k = 0; k < m->material_count; k++)
        all &= sf_material_has_memory(&m->material[k]);
    return all;
}

void sf_run_tell_all(const sf_model *m, const sf_state *s, const sf_extremes *x, const sf_sink *sink) {
    if (s->drop > 1)
        sf_sink_tell(
            sink, SF_WARNING, "drop %lld on this pad, %g s after the one before: the foam is not new%s",
            (long long)s->drop, s->pause,
            has_memory(m)
                ? ""
                : ", and a material without `reload` in its `memory` loads along its unloading path up to "
                  "the largest energy so far: too soft");
    sf_run_tell(m, s, x, sink);
}

/* Sentences of a run, each ended by '\n'; cut. */
typedef struct notes {
    char text[4096];
} notes;

static void add_line(void *user, sf_severity severity, const char *sentence) {
    notes *n = user;
    (void)severity;
    if (strlen(n->text) + strlen(sentence) + 2 <= sizeof n->text)
        sf_text_add(n->text, sizeof n->text, "%s\n", sentence);
}

static const double PROGRESS_INTERVAL = 5;  /* s of wall time between plain lines */
static const double FIRST_CHECKPOINT = 0.1; /* s of wall time after which a part of a run writes its first */
static const double LONGEST_SILENCE = 60;   /* s of wall time between two replacements of results.h5 */

typedef struct drop {
    const sf_model *m;
    const sf_operators *op;
    sf_state *s;
    sf_run *run;
    sf_output *out;
    sf_recorder r;
    bool replay;            /* repeats steps that are in the files already */
    bool foreign;           /* the checkpoint on the disk is not from before these steps */
    const char *note;       /* of the program, about the steps that are kept; "": none */
    int64_t saved;          /* step of the checkpoint on the disk, -1: none */
    int64_t published;      /* rows of history in results.h5 */
    int64_t last_step;      /* of a replay */
    double first_time;      /* s, where this part of the run begins */
    double next_checkpoint; /* s, simulated */
    double start, last_line, last_checkpoint, last_published; /* s, wall clock */
    double left;                                              /* s, as it was told last */
} drop;

static void print_progress(drop *d, bool last) {
    const sf_model *m = d->m;
    const sf_state *s = d->s;
    const sf_run *run = d->run;
    double now = sf_process_now(), interval = run->terminal ? 0.2 : PROGRESS_INTERVAL;
    if (d->replay || (!last && now - d->last_line < interval))
        return;
    d->last_line = now;
    /* The line states time, step, acceleration or force, depth, compression and the energy error. */
    double done = (s->time - d->first_time) / (m->run.end_time - d->first_time), spent = now - d->start;
    bool driven = sf_missile_is_driven(m);
    fprintf(run->log,
            "%st %7.3f / %.3g ms  step %6lld  dt %6.2f us  %s %6.1f %s  indentation %5.1f mm  compression "
            "%.3f  energy %+.3f %%",
            run->terminal ? "\r" : "", 1e3 * s->time, 1e3 * m->run.end_time, (long long)s->step, 1e6 * s->dt,
            driven ? "force" : "a", sf_recorder_measure(m, s) / (driven ? 1 : SF_STANDARD_GRAVITY),
            driven ? "N" : "g", 1e3 * sf_missile_depth(m, &s->missile), s->largest_compression,
            100 * s->ledger.error);
    /* The remaining time never rises: steps shrink, but the rebound ends the run early. */
    if (done > 0 && !last) {
        d->left = fmin(d->left, spent * (1 - done) / done);
        fprintf(run->log, "  left about %.0f s  ", d->left);
    }
    /* A terminal overwrites its line until the last one. */
    if (!run->terminal || last)
        fputc('\n', run->log);
    fflush(run->log);
}

/* results.h5 as far as it is known, with the frames as links. */
static sf_status publish(drop *d, sf_error *err) {
    sf_h5 *file = NULL;
    if (sf_output_begin(d->out, false, d->r.frames, &file, err) == SF_OK)
        sf_history_write(&d->r.history, file, err);
    d->published = d->r.history.rows;
    d->last_published = sf_process_now();
    return sf_output_commit(d->out, &file, err);
}

static sf_status publish_if_due(drop *d, sf_error *err) {
    bool due = sf_output_is_due(d->out, d->r.history.rows - d->published) ||
               sf_process_now() - d->last_published >= LONGEST_SILENCE;
    return due ? publish(d, err) : SF_OK;
}

static sf_status save(drop *d, sf_error *err) {
    double before = d->r.wall_time;
    d->r.wall_time += sf_process_now() - d->start;
    sf_checkpoint_write(d->out, d->run->provenance, d->m, d->s, &d->r, err);
    d->r.wall_time = before;
    d->foreign = false;
    d->saved = d->s->step;
    d->last_checkpoint = sf_process_now();
    d->next_checkpoint = d->s->time + d->run->checkpoint_time;
    return err->status;
}

/* The first one early, and the next ones when twice as much has been computed again: a run that is killed
 * over and over keeps at least a third of what it computes each time, and short runs write few. */
static bool checkpoint_is_due(const drop *d) {
    double interval =
        fmin(d->run->checkpoint_wall, fmax(FIRST_CHECKPOINT, 2 * (d->last_checkpoint - d->start)));
    return d->run->checkpoints && !d->replay &&
           (d->s->time >= d->next_checkpoint || sf_process_now() - d->last_checkpoint >= interval);
}

/* A new step: forces, a row of history, the fields at the peak and a frame if they are due. */
static sf_status take_step(drop *d, sf_error *err) {
    /* The forces of the present positions give the accelerations, which the history records. */
    if (sf_step_evaluate(d->m, d->op, d->s, err) != SF_OK || sf_recorder_add(&d->r, d->m, d->s, err) != SF_OK)
        return err->status;
    /* The fields of a peak are written in the first step after it, if it is clearly above the last one. */
    if (sf_recorder_peak_due(&d->r, d->s) && sf_output_peak(d->out, d->m, d->op, d->s, err) != SF_OK)
        return err->status;
    /* A frame is written at its times, and results.h5 then links to it; a replay has its frames already. */
    if (!sf_recorder_frame_due(&d->r, d->m, d->s) || d->replay)
        return SF_OK;
    SF_TRY(sf_output_frame(d->out, d->m, d->op, d->s, d->r.frames - 1, err));
    return publish_if_due(d, err);
}

/* Returns how the run ends with the present step; NULL: it goes on. */
static const char *find_ending(const drop *d) {
    if (d->replay)
        return d->s->step == d->last_step ? "failed" : NULL;
    if (*d->run->stop)
        return "interrupted";
    if (sf_ending_on_anvil(d->m, d->s))
        return "anvil";
    if (!d->r.past_rebound && sf_ending_rebounded(d->m, d->s))
        return "rebound";
    return sf_ending_finished(d->m, d->s) ? "finished" : NULL;
}

/* Steps to the end; SF_OK also if that is the anvil. A checkpoint holds a step that has been taken. */
static sf_status run_steps(drop *d, bool taken, sf_error *err) {
    for (;; taken = false) {
        /* The first step is left out where the checkpoint holds it already. */
        if (!taken && take_step(d, err) != SF_OK)
            return err->status;
        /* The loop ends after the step that meets an ending, without moving the nodes again. */
        const char *ending = find_ending(d);
        print_progress(d, ending != NULL);
        if (ending) {
            d->run->ending = ending;
            return SF_OK;
        }
        /* A checkpoint goes with results.h5, so that both hold the same steps after a kill. */
        if (checkpoint_is_due(d) && save(d, err) == SF_OK)
            publish_if_due(d, err);
        SF_TRY(err->status);
        /* The accelerations move nodes and missile to the next step. */
        sf_step_advance(d->m, d->s);
    }
}

/* The notes on the run, beginning with that of the program. */
static sf_status write_notes(const drop *d, sf_h5 *file, sf_error *err) {
    sf_h5_info info = {"/summary/notes", "1", "what the solver noted of the run, a sentence per line"};
    notes list = {""};
    const sf_sink sink = {add_line, &list};
    const sf_extremes extremes = sf_recorder_extremes(&d->r);
    /* The program's sentence comes first, then those of the run. */
    if (d->note[0])
        sf_sink_tell(&sink, SF_WARNING, "%s", d->note);
    sf_run_tell_all(d->m, d->s, &extremes, &sink);
    return sf_h5_write_text(file, &info, list.text, err);
}

static sf_status write_summary(const drop *d, const char *status, sf_h5 *file, sf_error *err) {
    const sf_model *m = d->m;
    const sf_state *s = d->s;
    const bool later = s->drop > 1;
    const int64_t pad = sf_state_pad(m, s->time, s->history);
    double set[2];
    if (m->set)
        sf_set_measure(m, set);
    const double given_back = sf_model_whole(m) * s->given_back, vibration = sf_model_whole(m) * s->vibration;
    /* Each scalar of /summary is one entry; `told` leaves out what the run does not have. */
    const struct {
        bool told;
        sf_h5_info info;
        const void *value;
        sf_h5_type type;
    } item[] = {
        /* clang-format off */
        {true, {"/summary/steps", "1", "time steps"}, &s->step, SF_H5_I64},
        {true, {"/summary/threads", "1", "OpenMP threads"}, &(int64_t){d->run->threads}, SF_H5_I64},
        {true, {"/summary/nodes", "1", "nodes"}, &m->node_count, SF_H5_I64},
        {true, {"/summary/interactions", "1", "(domain, node) pairs"}, &m->domain_nnz, SF_H5_I64},
        {true, {"/summary/power_iterations", "1", "spent on the time step"}, &s->power_iterations, SF_H5_I64},
        {m->series_count > 1, {"/summary/drops", "1", "drops of the series"}, &m->series_count, SF_H5_I64},
        {later, {"/summary/drop", "1", "number of the drop on this pad, from 1"}, &s->drop, SF_H5_I64},
        {true, {"/summary/pad_after", "1", "hash of the foam's history at the end"}, &pad, SF_H5_I64},
        {later, {"/summary/pad_before", "1", "the same of the drop before"}, &s->pad_before, SF_H5_I64},
        {later, {"/summary/pause", "s", "rest of the pad before it"}, &s->pause, SF_H5_F64},
        {later && m->set, {"/summary/set", "m", "permanent set of the pad before it: depth at the impact point"}, &set[0], SF_H5_F64},
        {later && m->set, {"/summary/set_largest", "m", "its largest depth"}, &set[1], SF_H5_F64},
        {true, {"/summary/restarts", "1", "times that the run went on from a checkpoint"}, &d->r.restarts, SF_H5_I64},
        {true, {"/summary/wall_time", "s", "time of the run"}, &d->run->wall_time, SF_H5_F64},
        {true, {"/summary/given_back", "J", "most that dissipation of single nodes had given back at one time, summed over the nodes"}, &given_back, SF_H5_F64},
        {true, {"/summary/vibration", "J", "largest energy of motion that alternates from step to step"}, &vibration, SF_H5_F64},
        {true, {"/summary/contact_time", "s", "first contact, NaN if none"}, &s->missile.contact_time, SF_H5_F64},
        /* clang-format on */
    };
    /* The sentence of the ending stands first, the notes last. */
    sf_h5_write_text(file, &(sf_h5_info){"/summary/status", "1", "how the run ended"}, status, err);
    for (size_t k = 0; k < sizeof item / sizeof item[0] && err->status == SF_OK; k++)
        if (item[k].told)
            sf_h5_write(file, &item[k].info, item[k].type, 0, NULL, item[k].value, err);
    return err->status == SF_OK ? write_notes(d, file, err) : err->status;
}

/* The complete results.h5, with a frame of the last step; a state with a NaN or infinity is not shown. */
static sf_status conclude(drop *d, const char *status, sf_error *err) {
    sf_h5 *file = NULL;
    int64_t frames = d->r.frames;
    bool shown = sf_state_is_finite(d->m, d->s);
    /* The last step gets a frame, and the peak its fields, unless they are written already. */
    if (shown && d->r.frame_step != d->s->step)
        sf_output_frame(d->out, d->m, d->op, d->s, frames++, err);
    if (shown && err->status == SF_OK && sf_recorder_peak_ahead(&d->r))
        sf_output_peak(d->out, d->m, d->op, d->s, err);
    /* The new file replaces results.h5 only when it is complete. */
    if (err->status == SF_OK && sf_output_begin(d->out, true, frames, &file, err) == SF_OK &&
        sf_history_write(&d->r.history, file, err) == SF_OK &&
        sf_output_copy_peak(d->out, file, err) == SF_OK)
        write_summary(d, status, file, err);
    return file ? sf_output_commit(d->out, &file, err) : err->status;
}

/* State and recorder from a checkpoint, or at t = 0. */
static sf_status load(drop *d, const sf_checkpoint *from, sf_error *err) {
    sf_recorder_begin(&d->r);
    if (from)
        sf_checkpoint_read(from, d->m, d->out, d->s, &d->r, err);
    d->first_time = d->s->time;
    return err->status;
}

/* A run that had ended by rebound goes on if an end time is asked for; else it ends again at once. */
static void resume_rebounded(drop *d) {
    if (d->r.past_rebound || !sf_ending_rebounded(d->m, d->s))
        return;
    d->r.past_rebound = d->run->to_end_time;
    if (!d->run->to_end_time)
        fprintf(d->run->log, "the run had ended by rebound at %.3f ms; --end-time continues it\n",
                1e3 * d->s->time);
}

/* The state at t = 0 once more. */
static sf_status begin_again(const drop *d, sf_error *err) {
    return sf_series_begin(&d->run->earlier, d->m, d->op, d->s, err);
}

/* Everything anew at t = 0, in place of a checkpoint that cannot be used: of its recorder only what is told
 * of the run as a whole remains. */
static sf_status start_anew(drop *d, int64_t frame, sf_error *err) {
    const sf_recorder old = d->r;
    if (d->s->drop > 1 && !d->run->earlier.results)
        return SF_REFUSE(err,
                         "frame %lld of the run so far is missing or damaged, and the run began from the pad "
                         "of an earlier one: start it again with --force and --start-from",
                         (long long)frame);
    sf_sink_tell(d->run->sink, SF_WARNING,
                 "frame %lld of the run so far is missing or damaged: the run starts from the beginning",
                 (long long)frame);
    /* State and recorder begin at t = 0; the checkpoint on the disk does not belong to them. */
    sf_recorder_free(&d->r);
    sf_state_free(d->s);
    d->foreign = true;
    d->note = "";
    if (begin_again(d, err) != SF_OK || load(d, NULL, err) != SF_OK)
        return err->status;
    /* The figures of the run as a whole are kept. */
    d->r.restarts = old.restarts;
    d->r.wall_time = old.wall_time;
    d->r.past_rebound = old.past_rebound;
    return SF_OK;
}

/* Sets the state at which the run begins; `*taken`: this state includes a step that has been taken. */
static sf_status begin(drop *d, const sf_checkpoint *from, bool *taken, sf_error *err) {
    int64_t lost;
    *taken = from != NULL;
    SF_TRY(load(d, from, err));
    d->saved = from ? d->s->step : -1;
    if (from)
        resume_rebounded(d);
    /* If a frame up to the checkpoint is lost, the run starts anew. */
    if (sf_output_recover(d->out, d->r.frames, &lost, err) != SF_OK || lost < 0)
        return err->status;
    *taken = false;
    d->saved = -1;
    return start_anew(d, lost, err);
}

/* After a failure: repeats the steps up to the last valid one, for a checkpoint there. */
static sf_status replay(drop *d, sf_error *err) {
    SF_OWNED_BY(sf_checkpoint_close) sf_checkpoint last = {0};
    d->last_step = d->s->step - 1;
    d->replay = true;
    if (d->last_step < 0)
        return SF_OK;
    /* The repetition begins at the checkpoint of these steps, or else at t = 0. */
    bool there = !d->foreign && access(d->out->checkpoint, F_OK) == 0;
    if (there && sf_checkpoint_open(d->out->checkpoint, &last, err) != SF_OK)
        return err->status;
    /* A repeated step has the bits of the first time, so that the last valid one is reached. */
    sf_recorder_free(&d->r);
    sf_state_free(d->s);
    SF_TRY(there ? sf_state_create(d->m, d->s, err) : begin_again(d, err));
    if (load(d, there ? &last : NULL, err) == SF_OK && run_steps(d, there, err) == SF_OK)
        save(d, err);
    return err->status;
}

/* Ends a run that has gone as far as it could: by a failure, or with the sentence `end` if it has a status.
 * `late`: what failed in doing so. */
static void end_run(drop *d, const sf_error *failure, const sf_error *end, sf_error *late) {
    bool failed = failure->status != SF_OK;
    sf_error unsaved = SF_ERROR_INIT; /* results without a checkpoint are better than none */
    /* A run that did not fail leaves a checkpoint of its last step. */
    if (d->run->checkpoints && !failed && d->saved != d->s->step)
        save(d, &unsaved);
    d->run->wall_time = d->r.wall_time + sf_process_now() - d->start;
    /* A step with a NaN or infinity is replaced by the last valid one before results.h5 is written. */
    d->run->shown = sf_state_is_finite(d->m, d->s);
    if (d->run->checkpoints && !d->run->shown)
        replay(d, &unsaved);
    const char *ending = end->status != SF_OK ? end->text : d->run->ending;
    bool whole = conclude(d, failed ? failure->text : ending, late) == SF_OK;
    /* After another failure the results show the failed step, and the checkpoint is the step before. */
    if (d->run->checkpoints && failed && d->run->shown)
        replay(d, &unsaved);
    /* Complete results need no files of parts of the run. */
    if (whole)
        sf_output_clear(d->out);
    if (unsaved.status != SF_OK)
        SF_FAIL(late, unsaved.status, "%s", unsaved.text);
}

sf_status sf_run_drop(const sf_model *m, const sf_operators *op, sf_state *s, sf_run *run, sf_output *out,
                      const sf_checkpoint *from, sf_error *err) {
    drop d = {.m = m,
              .op = op,
              .s = s,
              .run = run,
              .out = out,
              .note = run->note,
              .start = sf_process_now(),
              .left = INFINITY};
    sf_error late = SF_ERROR_INIT, end = SF_ERROR_INIT;
    /* The run steps from the checkpoint or from t = 0 to an ending or a failure. */
    d.last_checkpoint = d.start;
    bool taken = false;
    run->ending = "failed";
    if (begin(&d, from, &taken, err) == SF_OK) {
        d.next_checkpoint = s->time + run->checkpoint_time;
        d.r.restarts += from != NULL;
        run_steps(&d, taken, err);
    }
    /* Results are written also after a numerical failure, but not after another one, as of a file. */
    run->wall_time = d.r.wall_time + sf_process_now() - d.start;
    if (err->status == SF_OK && strcmp(run->ending, "anvil") == 0)
        sf_ending_fail_on_anvil(m, s, &end);
    if (err->status == SF_OK || err->status == SF_ERR_NUMERIC)
        end_run(&d, err, &end, &late);
    /* The error is the first of: a failure in ending the run, the missile on the anvil, an interruption. */
    if (late.status != SF_OK)
        SF_FAIL(err, late.status, "%s", late.text);
    else if (end.status != SF_OK)
        SF_FAIL(err, end.status, "%s", end.text);
    else if (err->status == SF_OK && strcmp(run->ending, "interrupted") == 0)
        SF_FAIL(err, SF_INTERRUPTED, "interrupted at t = %.6g s; results up to there are readable%s", s->time,
                run->checkpoints ? "; --restart resumes the run" : "");
    run->extremes = sf_recorder_extremes(&d.r);
    sf_recorder_free(&d.r);
    return err->status;
}
