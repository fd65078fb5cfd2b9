/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads results.h5 (docs/formats.md) and refuses what does not keep to that format: every size, index range,
 * order and finiteness is checked here, so that the rest of softfall-post may trust the numbers.
 *
 * A file of a run that failed, was killed or is in progress is read as far as it is valid; `notes` lists the
 * parts left out: history rows that are not complete or not finite, and frames without their scalars. In a
 * file whose run ended well (/summary/status `finished`, `rebound` or `interrupted`) the same defects are
 * errors. */
#pragma once
#include "base/mat3.h"
#include "io/h5.h"
#include "model/columns.h"
#include "model/model.h"
#include "post/results/revolution.h"

typedef struct sf_frame_head {
    char group[24];                 /* "/frames/000012" or "/peak" */
    double time;                    /* s */
    double missile_displacement[3]; /* m, translation of its centre since t = 0 */
    double missile_quaternion[4];   /* its orientation, base/mat3.h */
    double acceleration;            /* m s-2 */
    double *const *
        field; /* [SF_FRAME_FIELDS] of a frame in memory, NULL: not kept; borrowed. NULL: it is in the file */
} sf_frame_head;

typedef struct sf_frame {
    double *field[SF_FRAME_FIELDS]; /* [node_count][components], NULL if the file does not hold it */
} sf_frame;

/* Sums over a layer, whole pad, to date: energies in J, and the largest compression. */
enum { SF_LAYER_STORED, SF_LAYER_HYSTERESIS, SF_LAYER_VISCOUS, SF_LAYER_COMPRESSION, SF_LAYER_SUMS };

enum { SF_RESULTS_NOTES = 24, SF_RESULTS_NOTE_SIZE = 512 };

typedef struct sf_results {
    sf_h5 *file; /* open until sf_results_close */

    int64_t node_count;
    double *position; /* [node_count][3] m */
    double *volume;   /* [node_count] m3 */
    int64_t cell_count;
    int64_t cell_nnz;
    uint8_t *cell_type; /* [cell_count] XDMF topology code */
    int64_t *cell_ptr;  /* [cell_count + 1] */
    int32_t *cell_node; /* [cell_nnz] VTK order */
    int64_t surface_node_count;
    int64_t surface_triangle_count;
    double *surface_position;   /* [surface_node_count][3] m, missile at t = 0 */
    int32_t *surface_triangle;  /* [surface_triangle_count][3] */
    int64_t support_node_count; /* 0: no rigid support, or the file does not say */
    int64_t support_triangle_count;
    double *support_position;  /* [support_node_count][3] m, of the rigid supports */
    int32_t *support_triangle; /* [support_triangle_count][3] */
    bool axisymmetric; /* the file holds a section; nodes and cells here are those of a quarter of its body of
                          revolution */
    sf_revolution revolution;
    int64_t symmetry_factor;
    int64_t modelled_parts, modelled_nodes, modelled_cells; /* of the file: factor, nodes and cells */
    double symmetry_place[2]; /* m, of the symmetry planes normal to x and y; NaN: none, or the file does not
                                 say */
    double thickness;         /* m */
    double density;           /* kg m-3, mean */
    double expected_mesh_error; /* fraction of a_max, see pre/drop_check.h; NaN: not estimated */
    sf_section_drop section;    /* of the drop's section; NaN: it was not simulated */
    double air;                 /* m, gaps on the way of the thickness, which close first; NaN: not stored */
    double speed_scatter, thickness_tolerance; /* -, m: standard deviations; NaN: not stored */
    double lock_up, lock_begin; /* -, see sf_model_lock_up; NaN: none, or the file does not say */
    double slit_fraction;    /* of the nodes: those at a slit, hole or gap narrower than their supports; NaN:
                                the file does not say */
    double informed_strain;  /* -, up to which data inform the material (of layers the least); NaN: the file
                                does not say */
    double sphere_radius;    /* m, of the contact's exact sphere; NaN: triangles, or the file does not say */
    double sphere_centre[3]; /* m, at t = 0; 0 without it */
    double anvil_depth;  /* m, below the undeformed pad's top; 0: there is none; NaN: the file does not say */
    int layer_count;     /* of a pad of several materials; 0: one */
    uint8_t *node_layer; /* [node_count] number of the layer */
    char **layer_name;   /* [layer_count] parts of layer_names */
    char *layer_names;
    double *layer_density;            /* [layer_count] kg m-3 */
    double *layer_informed;           /* [layer_count] as informed_strain */
    double *layer_sum[SF_LAYER_SUMS]; /* [layer_count] of the last frame; all NULL: no frame has them */
    double impact_x, impact_y; /* m, where the missile's lowest point arrives at the pad's top; NaN: the file
                                  does not say */
    double missile_mass;       /* kg; 0 with a prescribed motion, like the speed */
    double missile_speed;      /* m s-1 */
    double gravity_along;      /* m s-2, acceleration of the missile in free flight, along its direction */
    double gravity[3];         /* m s-2, the whole of it */
    bool kinematic;            /* figures of the kinematic acceleration; else as an accelerometer reads */
    bool driven;               /* the missile had a prescribed motion; else it was free */
    bool turns;                /* it had six degrees of freedom */
    double missile_centre[3];  /* m, its centre of mass at t = 0; 0 unless it turns */
    double missile_direction[3]; /* unit vector, see sf_results_along */

    sf_history history; /* its usable rows */

    int64_t frame_count;
    sf_frame_head *frames; /* [frame_count], ascending in time */
    bool has_peak;
    sf_frame_head peak;

    bool has_summary;        /* false: the members below are empty, NaN or -1 */
    char status[512];        /* "" without summary */
    double contact_time;     /* s, NaN if the bodies never touched */
    double wall_time;        /* s */
    double vibration;        /* J, see /summary/vibration; NaN: not stored */
    double given_back;       /* J, see /summary/given_back; NaN: not stored */
    double set, set_largest; /* m, see /summary/set and set_largest; NaN: the pad has none */
    int64_t steps;
    int64_t threads;
    int64_t interactions;

    int note_count;
    char notes[SF_RESULTS_NOTES][SF_RESULTS_NOTE_SIZE]; /* sentences for the user: the solver's, and about
                                                           what was left out */
    bool note_of_ending[SF_RESULTS_NOTES]; /* that only says how the run ended, as the check `ending` does */
} sf_results;

/* Opens, reads and checks; on success release with sf_results_close. On failure `results` is already
 * released. */
sf_status sf_results_open(const char *path, sf_results *results, sf_error *err);
void sf_results_close(sf_results *results);

/* Reads those of `fields`, bits SF_FIELD_*, that the group holds, checked for shape and finiteness. Release
 * with sf_frame_free. SF_ERR_IO: the group is gone, too, as a run in progress moves its frames: open the
 * results again. */
sf_status sf_frame_read(const sf_results *results, const sf_frame_head *head, int fields, sf_frame *frame,
                        sf_error *err);
void sf_frame_free(sf_frame *frame);
/* The frame of the largest acceleration; NULL: there are none. */
const sf_frame_head *sf_frame_of_peak(const sf_results *results);

/* Component of a vector along the missile's direction of motion. */
static inline double sf_results_along(const sf_results *results, const double vector[3]) {
    return sf_dot3(vector, results->missile_direction);
}
/* Finds the position in that frame of the missile's point that was at x (m) at t = 0. */
void sf_results_place(const sf_results *results, const sf_frame_head *head, const double x[3], double out[3]);
/* Modelled parts that make the whole pad: see sf_model_whole. */
double sf_results_whole(const sf_results *results);
/* Mean cross-section of the whole pad, its volume over its thickness, m2. */
double sf_results_cross_section(const sf_results *results);

/* True for the statuses finished, rebound and interrupted. */
bool sf_results_ended_well(const sf_results *results);

/* The section of an axisymmetric drop becomes a quarter of its body of revolution; its arrays are owned. */
sf_status sf_results_revolve(sf_results *results, sf_error *err);

/* Adds a sentence of the solver to the notes, as if the file held it. */
void sf_results_note_run(sf_results *results, const char *sentence);
/* Adds a sentence to the notes; further ones are dropped when they are full. */
void sf_results_note(sf_results *results, const char *format, ...) __attribute__((format(printf, 2, 3)));
