/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-bench: steps of the 50 mm, 4.5 m/s drop at several spacings, without files, and how far they are
 * from what the machine can do. Writes JSON; docs/performance.md explains it. */
#include "build_info.h"
#include "base/program.h"
#include "case/read.h"
#include "machine.h"
#include "model/model_io.h"
#include "report/row.h"
#include "pre/build.h"
#include "pre/mesh/gmsh_session.h"
#include "solver/step.h"
#include "traffic.h"

#include <argp.h>
#include <malloc.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { MOST = 8 };

static const char *const phase_name[SF_PHASES] = {"stress",  "stabilisation", "force", "time_step",
                                                  "contact", "constraint",    "motion"};

typedef struct options {
    const char *source, *model, *output;
    double spacing[MOST], end_time;
    int spacings, thread[MOST], threads, repeats;
    bool quarter, full;
} options;

/* Times of the phases in every step, of one run or the shortest of several: each repeats the same steps bit
 * by bit, so that what differs is what else the machine did. */
typedef struct record {
    int64_t steps, room;
    double (*phase)[SF_PHASES]; /* [room] s, owned */
    double wall;                /* s, of the fastest run */
    double dt_sum;
    int64_t first_products, products; /* Lanczos products of the first step, and of all */
} record;

/* Bytes that the program has in memory now. */
static double resident_bytes(void) {
    long pages = 0, skipped;
    malloc_trim(0);
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &skipped, &pages) != 2)
        pages = 0;
    if (file)
        fclose(file);
    return (double)pages * (double)sysconf(_SC_PAGESIZE);
}

/* Bytes of the model's arrays. What meshing leaves behind in the heap does not count. */
static double model_bytes(const sf_model *m) {
    static const double size[] = {[SF_H5_F64] = 8, [SF_H5_I32] = 4, [SF_H5_I64] = 8, [SF_H5_U8] = 1};
    const char *base = (const char *)m;
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    double sum = 0;
    for (size_t k = 0; k < count; k++)
        if (field[k].rows_offset != SIZE_MAX && *(void *const *)(base + field[k].offset))
            sum += size[field[k].type] * field[k].columns *
                   (double)(*(const int64_t *)(base + field[k].rows_offset) + field[k].rows_extra);
    return sum;
}

static int parse_list(const char *text, double *out) {
    int count = 0;
    for (char *end; *text && count < MOST; text = *end == ',' ? end + 1 : end) {
        out[count] = strtod(text, &end);
        if (end == text || !(out[count] > 0) || (*end && *end != ','))
            return 0;
        count++;
    }
    return count;
}

static error_t parse(int key, char *arg, struct argp_state *state) {
    options *o = state->input;
    double list[MOST] = {0};
    switch (key) {
    case 'o':
        o->output = arg;
        return 0;
    case 's':
        if (!(o->spacings = parse_list(arg, o->spacing)))
            argp_error(state, "--spacings takes up to %d lengths in mm, not \"%s\"", MOST, arg);
        return 0;
    case 't':
        if (!(o->threads = parse_list(arg, list)))
            argp_error(state, "--threads takes up to %d numbers, not \"%s\"", MOST, arg);
        for (int k = 0; k < o->threads; k++)
            o->thread[k] = (int)list[k];
        return 0;
    case 'm':
        o->model = arg;
        return 0;
    case 'r':
        if (parse_list(arg, list) != 1 || list[0] < 1)
            argp_error(state, "--repeats takes a number from 1, not \"%s\"", arg);
        o->repeats = (int)list[0];
        return 0;
    case 'e':
        if (parse_list(arg, &o->end_time) != 1)
            argp_error(state, "--end-time takes a time in ms, not \"%s\"", arg);
        return 0;
    case 'q':
        o->full = false;
        return 0;
    case 'f':
        o->quarter = false;
        return 0;
    case ARGP_KEY_ARG:
        if (o->source)
            argp_error(state, "one source folder at a time: \"%s\" is one too many", arg);
        o->source = arg;
        return 0;
    case ARGP_KEY_END:
        if (!o->source == !o->model)
            argp_error(state, "usage: softfall-bench SOURCE-FOLDER|--model model.h5 [-o bench.json]");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static sf_status build(const options *o, double spacing, bool full, sf_model *model, sf_error *err) {
    sf_case c = {0};
    sf_mesh mesh = {0};
    sf_surface surface = {0};
    sf_build_report report;
    sf_gmsh *session = NULL;
    char path[1024], fine[64], coarse[64], end[64];
    snprintf(path, sizeof path, "%s/examples/%s/case.cfg", o->source,
             full ? "eva50-v4.5-full" : "eva50-v4.5");
    snprintf(fine, sizeof fine, "geometry.parameters.fine_spacing=%g", spacing);
    snprintf(coarse, sizeof coarse, "geometry.parameters.outer_spacing=%g", 2 * spacing);
    snprintf(end, sizeof end, "solver.end_time=%g ms", o->end_time);
    const char *const overrides[] = {fine, coarse, end, "pad.mesh_error_limit=1e6"};
    if (sf_case_read(path, 4, overrides, NULL, &c, err) == SF_OK && sf_gmsh_begin(&session, err) == SF_OK &&
        sf_gmsh_load(session, &c.pad, err) == SF_OK &&
        sf_gmsh_read_mesh(session, c.pad_group, c.length_unit, &mesh, err) == SF_OK &&
        (!c.missile.path || sf_gmsh_load(session, &c.missile, err) == SF_OK) &&
        sf_gmsh_read_surface(session, c.surface_group, c.length_unit, &surface, err) == SF_OK)
        sf_model_build(&c, &mesh, &surface, model, &report, NULL, err);
    sf_gmsh_end(&session);
    sf_surface_free(&surface);
    sf_mesh_free(&mesh);
    sf_case_free(&c);
    return err->status;
}

static void free_record(record *r) {
    free(r->phase);
    memset(r, 0, sizeof *r);
}

static sf_status keep_step(record *r, const sf_stopwatch *watch, sf_error *err) {
    if (r->steps == r->room) {
        int64_t room = r->room ? 2 * r->room : 1024;
        double(*phase)[SF_PHASES] = sf_alloc(err, (unsigned long)room, sizeof *phase, "times");
        if (!phase)
            return err->status;
        if (r->steps > 0)
            memcpy(phase, r->phase, (size_t)r->steps * sizeof *phase);
        free(r->phase);
        r->phase = phase;
        r->room = room;
    }
    memcpy(r->phase[r->steps++], watch->seconds, sizeof watch->seconds);
    return SF_OK;
}

static sf_status run_steps(const sf_model *m, const sf_operators *op, double end_time, sf_state *s, record *r,
                           sf_error *err) {
    double start = sf_process_now();
    sf_stopwatch watch = {.mark = start};
    s->watch = &watch;
    while (s->time < end_time) {
        if (sf_step_evaluate(m, op, s, err) != SF_OK)
            return err->status;
        r->dt_sum += s->dt;
        r->products = s->power_iterations;
        if (s->step == 0)
            r->first_products = s->power_iterations;
        sf_step_advance(m, s);
        if (keep_step(r, &watch, err) != SF_OK)
            return err->status;
        memset(watch.seconds, 0, sizeof watch.seconds);
    }
    r->wall = sf_process_now() - start;
    return SF_OK;
}

/* Keeps of every phase of every step the shorter time. */
static void keep_shortest(record *best, const record *r) {
    best->wall = fmin(best->wall, r->wall);
    for (int64_t k = 0; k < best->steps; k++)
        for (int p = 0; p < SF_PHASES; p++)
            best->phase[k][p] = fmin(best->phase[k][p], r->phase[k][p]);
}

/* The first step has a long measurement of its own and stays out. */
static double quiet_seconds(const record *r, int phase) {
    double sum = 0;
    for (int64_t k = 1; k < r->steps; k++)
        sum += r->phase[k][phase];
    return sum;
}

static void write_phases(const record *r, const bench_traffic *t, double products, sf_json *json) {
    double steps = (double)(r->steps - 1);
    sf_json_open(json, "phases", '{');
    for (int p = 0; p < SF_PHASES; p++) {
        double quiet = quiet_seconds(r, p), extra = p == SF_PHASE_TIME_STEP ? products : 0;
        sf_json_open(json, phase_name[p], '{');
        sf_json_number(json, "quiet_seconds", quiet);
        sf_json_number(json, "bytes_per_second", (steps * t->bytes[p] + extra * t->product_bytes) / quiet);
        sf_json_number(json, "flops_per_second", (steps * t->flops[p] + extra * t->product_flops) / quiet);
        sf_json_close(json);
    }
    sf_json_close(json);
}

static void write_run(const sf_model *m, const sf_operators *op, const record *r, double bandwidth,
                      double peak, double held, sf_json *json) {
    bench_traffic t = bench_count(m, op);
    double n = (double)m->node_count, steps = (double)(r->steps - 1), quiet = 0, bytes = 0, flops = 0;
    double products = (double)(r->products - r->first_products);
    for (int p = 0; p < SF_PHASES; p++) {
        quiet += quiet_seconds(r, p);
        bytes += t.bytes[p] * steps;
        flops += t.flops[p] * steps;
    }
    bytes += products * t.product_bytes;
    flops += products * t.product_flops;
    sf_json_integer(json, "steps", r->steps);
    sf_json_integer(json, "lanczos_products", r->products);
    sf_json_number(json, "mean_step_s", r->dt_sum / (double)r->steps);
    sf_json_number(json, "wall_s", r->wall);
    sf_json_number(json, "node_steps_per_s", n * (double)r->steps / r->wall);
    sf_json_number(json, "quiet_node_steps_per_s", n * steps / quiet);
    sf_json_number(json, "quiet_interactions_per_s", (double)m->domain_nnz * steps / quiet);
    sf_json_number(json, "memory_bytes", held);
    sf_json_number(json, "memory_bytes_per_node", held / n);
    sf_json_number(json, "bytes_per_step", bytes / steps);
    sf_json_number(json, "flops_per_step", flops / steps);
    sf_json_number(json, "bandwidth_bytes_per_s", bandwidth);
    sf_json_number(json, "fraction_of_bandwidth", bytes / quiet / bandwidth);
    sf_json_number(json, "peak_flops_per_s", peak);
    sf_json_number(json, "fraction_of_peak_flops", flops / quiet / peak);
    write_phases(r, &t, products, json);
}

/* The drop from its start to `end_time`, `repeats` times. */
static sf_status repeat_steps(const sf_model *m, const sf_operators *op, const options *o, record *best,
                              sf_error *err) {
    double end_time = fmin(m->run.end_time, 1e-3 * o->end_time);
    for (int k = 0; k < o->repeats && err->status == SF_OK; k++) {
        sf_state state = {0};
        record r = {0};
        if (sf_state_create(m, &state, err) == SF_OK &&
            run_steps(m, op, end_time, &state, &r, err) == SF_OK) {
            if (k > 0)
                keep_shortest(best, &r);
            else {
                *best = r;
                r = (record){0};
            }
        }
        free_record(&r);
        sf_state_free(&state);
    }
    return err->status;
}

static sf_status run_one(const sf_model *m, const sf_operators *op, const options *o, int threads,
                         double held, sf_json *json, sf_error *err) {
    record r = {0};
    double bandwidth;
    omp_set_num_threads(threads);
    if (repeat_steps(m, op, o, &r, err) == SF_OK && bench_bandwidth(&bandwidth, err) == SF_OK) {
        sf_json_open(json, NULL, '{');
        sf_json_integer(json, "threads", threads);
        write_run(m, op, &r, bandwidth, bench_peak_flops(), held, json);
        sf_json_close(json);
    }
    free_record(&r);
    return err->status;
}

/* Runs `model`, which it frees. */
static sf_status run_model(const options *o, sf_model *model, double spacing, const char *part, sf_json *json,
                           sf_error *err) {
    sf_operators operators = {0};
    sf_state state = {0};
    struct rusage usage;
    sf_model_drop_mesh(model);
    if (sf_operators_build(model, &operators, err) ==
        SF_OK) /* once before: pages of libraries do not count */
        sf_operators_free(&operators);
    double before = resident_bytes() - model_bytes(model);
    if (sf_operators_take(model, &operators, err) == SF_OK && sf_state_create(model, &state, err) == SF_OK) {
        double held = resident_bytes() - before;
        sf_state_free(&state);
        sf_json_open(json, NULL, '{');
        sf_json_number(json, "core_spacing_mm", spacing);
        sf_json_text(json, "part", part);
        sf_json_integer(json, "nodes", model->node_count);
        sf_json_integer(json, "interactions", model->domain_nnz);
        sf_json_open(json, "runs", '[');
        for (int k = 0; k < o->threads && err->status == SF_OK; k++)
            run_one(model, &operators, o, o->thread[k], held, json, err);
        sf_json_close(json);
        getrusage(RUSAGE_SELF, &usage); /* so far, with the meshing, the building and the triad */
        sf_json_number(json, "peak_memory_of_the_program_bytes", 1024.0 * (double)usage.ru_maxrss);
        sf_json_close(json);
    }
    sf_operators_free(&operators);
    sf_model_free(model);
    return err->status;
}

static sf_status run_models(const options *o, sf_json *json, sf_error *err) {
    sf_model model = {0};
    if (o->model)
        return sf_model_read(o->model, &model, NULL, err) == SF_OK
                   ? run_model(o, &model, NAN, "of the file", json, err)
                   : err->status;
    for (int k = 0; k < o->spacings; k++)
        for (int full = o->quarter ? 0 : 1; full <= (o->full ? 1 : 0) && err->status == SF_OK; full++)
            if (build(o, o->spacing[k], full, &model, err) == SF_OK)
                run_model(o, &model, o->spacing[k], full ? "full" : "quarter", json, err);
    return err->status;
}

static sf_status run_all(const options *o, sf_error *err) {
    FILE *file = o->output ? fopen(o->output, "w") : stdout;
    if (!file)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be written", o->output);
    sf_json json = {.file = file, .empty = true};
    sf_json_open(&json, NULL, '{');
    sf_json_text(&json, "version", SF_VERSION " (" SF_GIT_REVISION ")");
    sf_json_text(&json, "compiler", SF_COMPILER " " SF_COMPILER_FLAGS);
    sf_json_number(&json, "end_time_ms", o->end_time);
    sf_json_open(&json, "models", '[');
    run_models(o, &json, err);
    sf_json_close(&json);
    sf_json_close(&json);
    fputc('\n', file);
    if (o->output && fclose(file) != 0)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be written", o->output);
    return err->status;
}

int main(int argc, char **argv) {
    static const struct argp_option list[] = {
        {"output", 'o', "JSON", 0, "file to write (default: standard output)", 0},
        {"spacings", 's', "MM,...", 0, "core spacings in mm (default: 10,5,2.5)", 0},
        {"threads", 't', "N,...", 0, "numbers of threads (default: 1,2)", 0},
        {"end-time", 'e', "MS", 0, "end of every drop in ms (default: 6)", 0},
        {"repeats", 'r', "N", 0, "times that every run is repeated (default: 3)", 0},
        {"model", 'm', "FILE", 0, "this model instead of the 50 mm pad's", 0},
        {"quarter", 'q', 0, 0, "quarter models only", 0},
        {"full", 'f', 0, 0, "full models only", 0},
        {0},
    };
    static const struct argp argp = {.options = list,
                                     .parser = parse,
                                     .args_doc = "[SOURCE-FOLDER]",
                                     .doc = "Times the steps of the 50 mm, 4.5 m/s drop and compares them "
                                            "with the machine's bandwidth and peak."};
    options o = {.spacing = {10, 5, 2.5},
                 .spacings = 3,
                 .thread = {1, 2},
                 .threads = 2,
                 .end_time = 6,
                 .repeats = 3,
                 .quarter = true,
                 .full = true};
    sf_error err = SF_ERROR_INIT;
    if (!getenv("OMP_WAIT_POLICY") && setenv("OMP_WAIT_POLICY", "passive", 1) == 0)
        execv("/proc/self/exe", argv); /* as softfall-solve does */
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    run_all(&o, &err);
    return sf_error_report(&err, "softfall-bench");
}
