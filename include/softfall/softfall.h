/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall: drop tests of rigid missiles on foam pads.
 *
 *     case -> model -> drop -> figures
 *
 * A case (case.cfg, docs/case.md) and its geometry give a model, which never changes after that. A drop is
 * the solution of a model as it advances in time. The figures are those of softfall-post, digit for digit.
 *
 * Two libraries: libsoftfall has all functions but those under "Building a model", "Foams" and "Input files
 * of your own", which are in libsoftfall-build, the only one that needs gmsh.
 *
 * Units are SI (m, kg, s, N, J, Pa), accelerations in figures are in g = 9.80665 m/s2. The frame is that of
 * the geometry, with the pad's top towards +z. Forces and energies are those of the whole pad and the whole
 * missile, whatever the symmetry of the model.
 *
 * Handles are opaque. A function that creates one gives it to the caller, who releases it with the function
 * of that name and `_free`, which takes NULL as well. On failure the handle is NULL.
 *
 * Nothing is printed and the process is never ended. A function that can fail returns a status; `error`, if
 * it is not NULL, then holds the status and a sentence that names the entity, the value and the bound. After
 * success `error` holds SOFTFALL_OK and "". Texts are UTF-8.
 *
 * Threads: different handles may be used by different threads of the host at the same time, except that only
 * one model can be built at a time and files are read and written by one thread at a time. */
#ifndef SOFTFALL_SOFTFALL_H
#define SOFTFALL_SOFTFALL_H

#include <stdint.h>

#if defined(__GNUC__)
#define SOFTFALL_API __attribute__((visibility("default")))
#else
#define SOFTFALL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Status, messages ---- */

/* The numbers are the exit codes of the programs. */
typedef enum softfall_status {
    SOFTFALL_OK = 0,
    SOFTFALL_INPUT = 2,   /* an argument, the case, the geometry or a curve is wrong: the user can mend it */
    SOFTFALL_FILE = 3,    /* a file could not be opened, read, written or renamed */
    SOFTFALL_MODEL = 4,   /* the model breaks one of its invariants */
    SOFTFALL_NUMERIC = 5, /* the solution failed: collapsed domain, non-finite value, energy growth */
    SOFTFALL_MEMORY = 6,  /* an allocation failed */
    SOFTFALL_LIBRARY = 7  /* gmsh, HDF5 or another library reported an error that is none of the above */
} softfall_status;

typedef struct softfall_error {
    softfall_status status;
    char text[1024]; /* one sentence, no line end */
} softfall_error;

typedef enum softfall_severity {
    SOFTFALL_NOTE = 0,   /* a choice that was made for the user */
    SOFTFALL_WARNING = 1 /* legal, but probably not intended */
} softfall_severity;

/* A sink receives warnings and notes. `sentence` is valid during the call only. A sink of NULL drops them. */
typedef struct softfall_sink {
    void (*tell)(void *user, softfall_severity severity, const char *sentence);
    void *user; /* passed to `tell` */
} softfall_sink;

/* The version, such as "1.2.0", and the git revision; static storage. */
SOFTFALL_API const char *softfall_version(void);
SOFTFALL_API const char *softfall_revision(void);

/* ---- Building a model (libsoftfall-build) ---- */

typedef struct softfall_case softfall_case;
typedef struct softfall_model softfall_model;

/* Reads and checks a case file. `overrides`: `count` texts "group.key=value" as softfall-pre's --set takes
 * them, borrowed for the call. */
SOFTFALL_API softfall_status softfall_case_read(const char *path, const char *const *overrides, int count,
                                                const softfall_sink *sink, softfall_case **out,
                                                softfall_error *error);
SOFTFALL_API void softfall_case_free(softfall_case *c);
/* The values of the case: a line for each key with its name, value as --set takes it, value in SI units, and
 * "given" or "default", between blanks; owned by the case. */
SOFTFALL_API const char *softfall_case_parameters(const softfall_case *c);
/* Sets a hash of all that the case says: its values, the points of its curves and of its motion, its geometry
 * files. The places of files do not count. What a geometry includes or merges is not part of it: ask
 * softfall_case_has_geometry_of. */
SOFTFALL_API softfall_status softfall_case_hash(const softfall_case *c, uint64_t *hash,
                                                softfall_error *error);
/* Returns 1 if every file that the geometries of the model behind `results` (a results.h5) read, included
 * ones too, has its content still beside the geometries of this case; 0 if not, or if it cannot be told. */
SOFTFALL_API int softfall_case_has_geometry_of(const softfall_case *c, const char *results);

/* The same of drop number `drop`, from 1, of the case's series alone, with what the series changes of the
 * missile in it. */
SOFTFALL_API softfall_status softfall_case_read_drop(const char *path, int drop, const char *const *overrides,
                                                     int count, const softfall_sink *sink,
                                                     softfall_case **out, softfall_error *error);
/* A drop of the case's series. */
typedef struct softfall_case_drop {
    int drops;       /* of the series, 1: a single drop */
    int counted;     /* 1: the series is judged by this drop */
    int own;         /* 1: its missile is not that of the first drop: softfall_case_read_drop has it */
    double interval; /* s, from the drop before */
} softfall_case_drop;
/* Drop number `drop`, from 1 to `drops`. */
SOFTFALL_API softfall_case_drop softfall_case_drop_get(const softfall_case *c, int drop);
/* Returns the strain (-) at which the data of a foam end: of layer `layer`, from 0 on, 0 for a pad of one
 * material. NaN: there is no such layer. */
SOFTFALL_API double softfall_case_data_end(const softfall_case *c, int layer);
/* SOFTFALL_INPUT: the case has no place in a study, for a parameter that a geometry does not have, or a
 * series of drops on a foam without memory. It runs no gmsh. */
SOFTFALL_API softfall_status softfall_case_check(const softfall_case *c, softfall_error *error);
/* Returns 1 if every file of the list softfall_model_geometry_files, of a model of this case, is as it was.
 */
SOFTFALL_API int softfall_case_has_files(const softfall_case *c, const char *files);
/* Keeps the database of units loaded, which every reading of a case loads anew otherwise (5 ms): for a
 * process that reads very many. To be called once, while no other thread reads anything. */
SOFTFALL_API softfall_status softfall_units_hold(softfall_error *error);

/* Sets how softfall_model_build builds: `share`, a folder, or NULL: takes meshes, smoothing domains and
 * what drops of the section told from there where a case of the same geometry has left them, and leaves them
 * there, also for other processes. The environment variable SOFTFALL_SHARE stands before `share`, and is
 * the folder of a case for which this is not called.
 * `section` 1: runs the drops of its section, or of a plate like it, that tell the errors by its mesh, as
 * softfall-pre does.
 */
SOFTFALL_API softfall_status softfall_case_set_build(softfall_case *c, const char *share, int section,
                                                     softfall_error *error);
/* Meshes the geometry of the case and builds the model. A case can be built once; afterwards it can only be
 * freed. */
SOFTFALL_API softfall_status softfall_model_build(softfall_case *c, const softfall_sink *sink,
                                                  softfall_model **out, softfall_error *error);

/* ---- Foams (libsoftfall-build) ---- */

typedef struct softfall_material softfall_material;

/* Reads and checks a material file, which holds the keys of the group `material` of a case. `temperature`: of
 * the pad, K; 0: none is given. */
SOFTFALL_API softfall_status softfall_material_read(const char *path, double temperature,
                                                    softfall_material **out, softfall_error *error);
/* The foam of a case that has not been built, with the values that its overrides set: for
 * softfall_model_vary. SOFTFALL_INPUT: the pad has layers. Its list of values is that of the whole case. */
SOFTFALL_API softfall_status softfall_case_material(const softfall_case *c, softfall_material **out,
                                                    softfall_error *error);
SOFTFALL_API void softfall_material_free(softfall_material *material);
/* Its values, as softfall_case_parameters has them; owned by the material. */
SOFTFALL_API const char *softfall_material_parameters(const softfall_material *material);
/* The compression curve number `index` from 0, of ascending rates: the number of its points, 0: there is no
 * such curve. `rate` is in 1/s, 0 if the material has one curve; `strain` and `stress` (Pa) are the
 * material's. */
SOFTFALL_API int64_t softfall_material_curve(const softfall_material *material, int index, double *rate,
                                             const double **strain, const double **stress);
/* Presses a point of the foam, from rest at the first point: `strain` over `time` (s) [count], straight
 * between the points; fills `stress` [count], nominal, in Pa. Compression is positive. Strains are from -1 to
 * below 1 and begin with 0, times ascend. `free_sides` 1: the foam bulges freely, 0: its sides are held, as
 * those of a large pad. DAMP, which depends on the mesh, is left out. */
SOFTFALL_API softfall_status softfall_compress(const softfall_material *material, int free_sides,
                                               const double *time, const double *strain, int64_t count,
                                               double *stress, softfall_error *error);

/* Presses a point along a record of cycles (softfall_compress, sides held), whose first strain may be above 0.
 * `pause` [count]: time (s) without load before each point, 0: none. Memory recovers in a pause. */
SOFTFALL_API softfall_status softfall_compress_cycles(const softfall_material *material, const double *time,
                                                      const double *strain, const double *pause,
                                                      int64_t count, double *stress, softfall_error *error);

/* Parameters of a hyperfoam (docs/case.md). */
enum { SOFTFALL_TERMS = 6 };
typedef struct softfall_hyperfoam {
    double density, damp; /* kg/m3, - */
    double hu, shape, unloading_alpha;
    double informed; /* largest strain of the data */
    int terms;
    double mu[SOFTFALL_TERMS], alpha[SOFTFALL_TERMS], nu[SOFTFALL_TERMS]; /* Pa, -, - */
} softfall_hyperfoam;
SOFTFALL_API softfall_status softfall_hyperfoam_material(const softfall_hyperfoam *values,
                                                         softfall_material **out, softfall_error *error);
/* Loading of a hyperfoam with free sides at ascending or descending strains: nominal stress (Pa), lateral
 * strain (positive outwards) and W (J/m3), each [count]; NaN where the sides find no rest. */
SOFTFALL_API softfall_status softfall_hyperfoam_loading(const softfall_material *material, const double *strain,
                                                        int64_t count, double *stress, double *lateral,
                                                        double *energy, softfall_error *error);

/* Sets the peak deceleration (g, F/m, CFC 1000) of a flat mass of `static_stress` (Pa, weight over area) on a
 * block of this foam, `thickness` and `drop_height` in m (ASTM D1596). SOFTFALL_NUMERIC: it collapses. */
SOFTFALL_API softfall_status softfall_cushion(const softfall_material *material, double static_stress,
                                              double thickness, double drop_height, double *peak_g,
                                              softfall_error *error);

/* ---- Forms of a foam's loading curve (libsoftfall-build) ---- */

/* A form of the loading curve (docs/identification.md, "Forms of the curve") on a start material, which has
 * all that the form does not. Its parameters are numbers in SI units, in the order of the list. */
typedef struct softfall_form softfall_form;

/* `curve`: gas, gas_solid, rusch, avalle, spline or table. `solid_density`: kg/m3, of the solid in the cell
 * walls, 0: not known. */
SOFTFALL_API softfall_status softfall_form_read(const char *material, const char *curve, double solid_density,
                                                softfall_form **out, softfall_error *error);
/* A form without a start material: of a foam of this density without hysteresis and terms of the rate. */
SOFTFALL_API softfall_status softfall_form_make(double density, const char *curve, double solid_density,
                                                softfall_form **out, softfall_error *error);
SOFTFALL_API void softfall_form_free(softfall_form *form);
/* JSON: "curve", "formula", "density" (kg/m3) and "curves" (of the start material), and of each of the
 * "parameters" "name", "unit" of "per_unit" SI units, SI unit ("quantity", "" of a number), bounds "low" and
 * "high", "prior_sd" of its logarithm, "used" (by this form), "usual" (unknown in a usual fit),
 * "of_curve" (the form's own), "rate" (the term of the rate that it belongs to) and "description"; owned by the
 * form. */
SOFTFALL_API const char *softfall_form_parameters(const softfall_form *form);
/* Fills `value` with medians of the priors and values of the start material, but for those that are `given`
 * (NaN: not given). `unknown` 1: a term that the start material does not have gets a median. */
SOFTFALL_API void softfall_form_start(const softfall_form *form, const double *given, const int *unknown,
                                      double *value);
/* Strain at which the curve of these values has its pole; it is infinite there. */
SOFTFALL_API double softfall_form_pole(const softfall_form *form, const double *value);
/* Fills `stress` [count] (Pa) of loading from rest at a constant rate (1/s; 0: the curve alone), with rate
 * factor and Maxwell branch, whether the curve rises or not. Strains ascend, from 0 on. */
SOFTFALL_API void softfall_form_loading(const softfall_form *form, const double *value, double rate,
                                        const double *strain, int64_t count, double *stress);
/* Makes the foam of these values; `informed`: largest strain about which the data inform, 0: that of the
 * curve's end. SOFTFALL_NUMERIC: they make no rising curve. */
SOFTFALL_API softfall_status softfall_form_material(const softfall_form *form, const double *value,
                                                    double informed, softfall_material **out,
                                                    softfall_error *error);
/* Multiplies every curve, as a fine table, by exp(bend), linear between `count` rising strains and constant beyond them. Where
 * the stress would fall with the strain it stays level. SOFTFALL_INPUT: no foam with curves, or no strain. */
SOFTFALL_API softfall_status softfall_material_bend(softfall_material *material, int64_t count,
                                                    const double *strain, const double *bend,
                                                    softfall_error *error);
/* Writes `folder`/`name`.cfg with its curves beside it, `title` and `comments` (lines) above; files that are
 * there are replaced. SOFTFALL_MODEL: softfall-pre would refuse the material, and none is written. */
SOFTFALL_API softfall_status softfall_material_write(const softfall_material *material, const char *folder,
                                                     const char *name, const char *title,
                                                     const char *comments, softfall_error *error);

/* ---- Compression tests (libsoftfall-build) ---- */

/* The facts about a compression test that its file does not state; zeros and NULL: none. */
typedef struct softfall_compression_source {
    const char *path;
    double rate, area, thickness; /* 1/s; m2 and m, of a specimen whose force and displacement are in the file */
    int correct_toe, invert;      /* 1: correct the toe; the sign of 1: strain, 2: stress, 3: both */
    double contact_force;         /* N, at which displacement is zero */
    const char *cycle;            /* number of the cycle that is taken; NULL: the first */
} softfall_compression_source;

/* A test as the fits take it: loading, then perhaps unloading; the arrays are its own. */
typedef struct softfall_compression_test {
    int64_t count, loading;       /* points, of which the first are loading */
    const double *strain, *stress; /* [count] -, Pa */
    double largest_strain, largest_stress;
    int cycles, dwell;          /* in the file; points of rests under strain that were left out */
    const char *interpretation; /* how the file was read */
} softfall_compression_test;
SOFTFALL_API softfall_status softfall_compression_read(const softfall_compression_source *source,
                                                       softfall_compression_test **out,
                                                       softfall_error *error);
SOFTFALL_API void softfall_compression_free(softfall_compression_test *test);

/* Fits a free curve, its rate dependence and its unloading to the tests that a file names
 * (docs/identification.md), and writes material.cfg with its curves, fit.json, fit.csv and loading_curve.csv
 * into the folder; `replace` 0: SOFTFALL_INPUT if one of them is there. */
SOFTFALL_API softfall_status softfall_fit_compression(const char *path, const char *folder, int replace,
                                                      softfall_error *error);

/* ---- Input files of your own (libsoftfall-build) ---- */

/* Reads a file in the syntax of a case (libconfig, with @include) and gives its settings as JSON: of each
 * "name", "place" ("file:line"), "kind" (group, list, array, int, float, bool or text) and "value", for a
 * group, list or array its settings. `json` is the caller's (softfall_text_free). */
SOFTFALL_API softfall_status softfall_settings_read(const char *path, char **json, softfall_error *error);
SOFTFALL_API void softfall_text_free(char *text);

/* ---- Variants of a model (libsoftfall-build) ---- */

/* A model of its own beside another one, with the same mesh; 0 or NULL: as it is there. */
typedef struct softfall_variant {
    double speed;     /* m/s, of the missile at first contact */
    double mass;      /* kg, of the whole missile */
    double thickness; /* m, of the pad, from 0.7 to 1.4 times that of the model; only of an axisymmetric one
                         that softfall_model_build has made: its heights are scaled */
    const softfall_material *material; /* of a pad of one material; borrowed for the call */
} softfall_variant;

/* Makes the variant without a process or a file: for many drops of one geometry. With another speed, mass and
 * material its drops are those of a model built with these values; with another thickness, of a mesh with as
 * many rows of cells. */
SOFTFALL_API softfall_status softfall_model_vary(const softfall_model *model, const softfall_variant *variant,
                                                 softfall_model **out, softfall_error *error);

/* ---- Models ---- */

typedef struct softfall_model_info {
    int64_t node_count;
    int64_t symmetry_factor;   /* 1, 2 or 4: how many times the modelled part makes the whole */
    double thickness;          /* m, of the pad */
    double missile_mass;       /* kg, of the whole missile; 0 with a prescribed motion */
    double missile_speed;      /* m/s, at t = 0; 0 with a prescribed motion */
    double end_time;           /* s */
    int has_prescribed_motion; /* 1: the missile's motion is given, 0: it is free */
} softfall_model_info;

/* model.h5 of softfall-pre (docs/formats.md). An earlier file is replaced, whole or not at all. */
SOFTFALL_API softfall_status softfall_model_read(const char *path, softfall_model **out,
                                                 softfall_error *error);
SOFTFALL_API softfall_status softfall_model_write(const softfall_model *model, const char *path,
                                                  softfall_error *error);
SOFTFALL_API void softfall_model_free(softfall_model *model);

/* Returns what its geometries have read, with hashes: a list for softfall_case_has_files; owned by the model.
 */
SOFTFALL_API const char *softfall_model_geometry_files(const softfall_model *model);
SOFTFALL_API softfall_model_info softfall_model_describe(const softfall_model *model);
/* [node_count][3] m, reference positions of the nodes; owned by the model. */
SOFTFALL_API const double *softfall_model_positions(const softfall_model *model);

/* ---- Drops ---- */

typedef struct softfall_drop softfall_drop;

typedef struct softfall_drop_options {
    int threads;     /* OpenMP threads, 0: the default of OpenMP; results do not depend on it, bit for bit */
    double end_time; /* s, 0: that of the model */
} softfall_drop_options;

typedef enum softfall_ending {
    SOFTFALL_RUNNING = 0,
    SOFTFALL_REBOUND = 1, /* the missile has left the pad upwards */
    SOFTFALL_FINISHED = 2 /* the end time is reached */
} softfall_ending;

/* A column of the history, a field over the nodes, or a figure; static storage. */
typedef struct softfall_quantity {
    const char *name, *units, *description;
    int components; /* 1, 3 or 9 (row-major) */
} softfall_quantity;

/* A drop at t = 0 before its first step. The model is borrowed: it must outlive the drop, and several drops
 * may share it. `options` may be NULL: all zero. */
SOFTFALL_API softfall_status softfall_drop_create(const softfall_model *model,
                                                  const softfall_drop_options *options, softfall_drop **out,
                                                  softfall_error *error);
/* The next drop of the same missile on the pad as `before` has left it, after a rest of `pause` (s): the bits
 * are those of a series of softfall-solve. `before` must have ended with the missile away from the pad; it
 * does not change, and may be freed, but its model must outlive the new drop. Threads and end time are those
 * of `before`. Later drops of a foam without memory are too soft. */
SOFTFALL_API softfall_status softfall_drop_next(const softfall_drop *before, double pause,
                                                softfall_drop **out, softfall_error *error);
/* The same with another missile, that of `model`, on the same pad; `model` NULL: that of `before`. */
SOFTFALL_API softfall_status softfall_drop_next_of(const softfall_drop *before, const softfall_model *model,
                                                   double pause, softfall_drop **out, softfall_error *error);
SOFTFALL_API void softfall_drop_free(softfall_drop *drop);

/* Advances the drop by one step; the first computes the state at t = 0. `ending` (may be NULL) tells whether
 * the drop has ended with it; further steps of an ended drop change nothing. After a failure the history up
 * to the last good step can still be read, and further steps return the same failure. A missile that reaches
 * the anvil is a failure, too; the history has that step. */
SOFTFALL_API softfall_status softfall_drop_step(softfall_drop *drop, softfall_ending *ending,
                                                softfall_error *error);

/* Steps until the drop ends, or until `observe` (may be NULL), which is called after each step, returns
 * nonzero: then `ending` is SOFTFALL_RUNNING and the drop can be continued. */
SOFTFALL_API softfall_status softfall_drop_run(softfall_drop *drop,
                                               int (*observe)(void *user, const softfall_drop *drop),
                                               void *user, softfall_ending *ending, softfall_error *error);

/* Steps that the drop has, that of t = 0 included: 0 before the first. */
SOFTFALL_API int64_t softfall_drop_steps(const softfall_drop *drop);
/* Value of a column of the history in the last step; NaN before the first, or if there is no such column. */
SOFTFALL_API double softfall_drop_latest(const softfall_drop *drop, const char *name);

/* The history, a value for each step: `columns` [count] lists its columns. The values of a column are owned
 * by the drop and valid until its next step; the result is their number, -1 if there is no such column. */
SOFTFALL_API const softfall_quantity *softfall_drop_columns(const softfall_drop *drop, int *count);
SOFTFALL_API int64_t softfall_drop_history(const softfall_drop *drop, const char *name,
                                           const double **values);

/* Fields over the nodes after the last step. `values` [node_count][components] belongs to the caller; `size`
 * is its number of doubles. SOFTFALL_INPUT: no such field, another size, or no step yet. */
SOFTFALL_API const softfall_quantity *softfall_drop_fields(const softfall_drop *drop, int *count);
SOFTFALL_API softfall_status softfall_drop_field(const softfall_drop *drop, const char *name, double *values,
                                                 int64_t size, softfall_error *error);

/* ---- Figures ---- */

/* The numbers of summary.json (docs/formats.md), by their keys there and in the units that the keys name:
 * "a_max_g", "hic", "hic_t1_ms", "max_indentation_mm", "rebounded" (0 or 1), and the verdict with them.
 * A figure that the run does not define (the missile never touched, contact had not ended, its motion was
 * prescribed) is NaN. Indicative, not a certification. */
typedef struct softfall_figures softfall_figures;

/* Computes the figures of a drop so far (three steps at least), or of a results.h5 of softfall-solve.
 * `filter`: channel frequency class (SAE J211) 60, 180, 600 or 1000; softfall-post takes 1000 by default.
 * `out` is owned by the caller. */
SOFTFALL_API softfall_status softfall_drop_figures(const softfall_drop *drop, double filter,
                                                   softfall_figures **out, softfall_error *error);
SOFTFALL_API softfall_status softfall_results_figures(const char *path, double filter, softfall_figures **out,
                                                      softfall_error *error);
SOFTFALL_API void softfall_figures_free(softfall_figures *figures);

/* The list of figures [count]: name (the key) and description; the unit stands in the key. It is the same of
 * all figures, and of NULL. */
SOFTFALL_API const softfall_quantity *softfall_figures_list(const softfall_figures *figures, int *count);
/* Sets `value`, NaN if the run does not define the figure. SOFTFALL_INPUT: there is no such figure. */
SOFTFALL_API softfall_status softfall_figure(const softfall_figures *figures, const char *key, double *value,
                                             softfall_error *error);

/* The verdict of softfall-post: 0: valid, 1: valid with remarks, 2: do not use; and that with the findings,
 * in words, the worst first; owned by the figures. */
SOFTFALL_API int softfall_figures_grade(const softfall_figures *figures);
SOFTFALL_API const char *softfall_figures_verdict(const softfall_figures *figures);
/* Returns the part of a_max that is certain although the verdict is "do not use" (1: a_max can only be too
 * low; 0: nothing is certain). */
SOFTFALL_API double softfall_figures_sure(const softfall_figures *figures);
/* Returns how the run ended: "rebound", "finished", a sentence, or "" if it has not ended; owned by the
 * figures. */
SOFTFALL_API const char *softfall_figures_status(const softfall_figures *figures);

/* Many drops side by side, each on one thread. */
typedef struct softfall_batch {
    int threads;            /* drops at a time, 0: the default of OpenMP; the figures do not depend on it */
    double filter;          /* channel frequency class */
    int keys;               /* number of figures */
    const char *const *key; /* [keys] their names, as of softfall_figure */
} softfall_batch;

/* Runs a drop of each of the `count` models (which may be the same) to its end, and fills `values`
 * [count][keys] and `errors` [count]; the values of a drop that failed are NaN. SOFTFALL_INPUT: the batch has
 * no such figure or filter. */
SOFTFALL_API softfall_status softfall_batch_run(const softfall_model *const *models, int64_t count,
                                                const softfall_batch *batch, double *values,
                                                softfall_error *errors, softfall_error *error);

/* ---- Curves of your own ---- */

/* Curves [count] are piecewise linear over `time`, in s, ascending. */

/* Head injury criterion of a deceleration in g, with windows of at most `window` s (INFINITY: no limit): its
 * value, and the start and the end (s) of the window where it is reached. The value is NaN, and these are 0,
 * on failure and if the curve never decelerates. */
SOFTFALL_API softfall_status softfall_hic(const double *time, const double *deceleration, int64_t count,
                                          double window, double hic[3], softfall_error *error);
/* Values of the curve filtered with a channel frequency class, at the same times, as softfall-post filters a
 * measured curve: at its own rate if that is uniform. `filtered` [count] belongs to the caller. */
SOFTFALL_API softfall_status softfall_cfc(const double *time, const double *value, int64_t count,
                                          double filter, double *filtered, softfall_error *error);
/* The instrument that a deceleration passes before it is read. */
typedef struct softfall_instrument {
    double frequency; /* Hz, of the accelerometer on its mount; 0: rigid */
    double damping;   /* -, of the mount, between 0 and 1 */
    double coupling;  /* s, time constant of a high pass; 0: none */
    double filter;    /* channel frequency class */
} softfall_instrument;

/* Reads a deceleration in g, which has begun at rest, as `instrument` (not NULL) does. Fills `read` [count]
 * at the same times, and `contact` (s), the instant at which contact begins by the curve alone, as
 * softfall-post aligns it. */
SOFTFALL_API softfall_status softfall_reading(const double *time, const double *value, int64_t count,
                                              const softfall_instrument *instrument, double *read,
                                              double *contact, softfall_error *error);
/* A figure at ever finer meshes and its error, `refined`, from those at a spacing and at `ratio` times it
 * (docs/python.md, "Two meshes for one answer"). `cells`: the finer mesh's number of cells over the coarser
 * one's; INFINITY: not known. SOFTFALL_INPUT, and NaN, where the pair tells no value; the sentence says why.
 */
SOFTFALL_API softfall_status softfall_refine(double fine, double coarse, double ratio, double cells,
                                             double refined[2], softfall_error *error);

/* Reads a quantity with its unit, such as "10 mph", into SI; `*unit` is the SI unit of its kind ("m s-1"),
 * static. */
SOFTFALL_API softfall_status softfall_units_read(const char *text, double *value, const char **unit,
                                                 softfall_error *error);

/* A measured record of one impact in a CSV file (docs/formats.md), read, filtered and judged as softfall-post
 * does with --reference. `options` [count]: "filter=600" or "filter=none" (default 1000), "column=HEADING",
 * "columns=x,y,z", "impact=2", "invert", "zero",
 * "speed=4.5 m/s" (known at contact), "range=200 g" (of the channel). `out`
 * is owned by the caller. */
typedef struct softfall_record softfall_record;
SOFTFALL_API softfall_status softfall_record_read(const char *path, const char *const *options, int count,
                                                  softfall_record **out, softfall_error *error);
/* The samples of a file that the caller has read. */
typedef struct softfall_samples {
    const char *name;    /* of the file, for sentences */
    const char *reading; /* how it was read, in words */
    int64_t count;
    const double *time;     /* [count] s, ascending */
    int axes;               /* 1: the deceleration; 2 or 3: axes, whose resultant it is */
    const double *value[3]; /* [axes][count] g */
} softfall_samples;
/* The record of such samples, by the same options except column and columns. */
SOFTFALL_API softfall_status softfall_record_make(const softfall_samples *samples, const char *const *options,
                                                  int count, softfall_record **out, softfall_error *error);
SOFTFALL_API void softfall_record_free(softfall_record *record);
/* The filtered curve: time in s on the clock of the file, deceleration in g; returns the number of points.
 * The arrays are the record's. */
SOFTFALL_API int64_t softfall_record_curve(const softfall_record *record, const double **time,
                                           const double **deceleration);
/* 0: valid, 1: valid with remarks, 2: not to be used; and that with the findings, in words. */
SOFTFALL_API int softfall_record_grade(const softfall_record *record);
SOFTFALL_API const char *softfall_record_verdict(const softfall_record *record);
/* Returns how the file was read, in words. */
SOFTFALL_API const char *softfall_record_interpretation(const softfall_record *record);
/* Sets `value`: a_max_g, a_max_time_ms, hic, hic_t1_ms, hic_t2_ms, hic15, hic36, gadd, clip_3ms_g,
 * clip_3ms_cumulative_g as in summary.json. SOFTFALL_INPUT: another key. */
SOFTFALL_API softfall_status softfall_record_figure(const softfall_record *record, const char *key,
                                                    double *value, softfall_error *error);

#ifdef __cplusplus
}
#endif

#endif
