/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/output.h"

#include "io/h5_data.h"
#include "io/plain_file.h"
#include "model/flight.h"
#include "model/model_check.h"
#include "solver/run/frame.h"
#include <errno.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "io/folder.h"

/* Returns the place of the symmetry plane normal to an axis; NaN: there is none. */
static double find_plane(const sf_model *m, int axis) {
    double place;
    return !m->axisymmetric && sf_symmetry_plane(m, axis, &place) ? place : NAN;
}

static sf_status write_arrays(const sf_model *m, sf_h5 *file, sf_error *err) {
    int64_t driven = sf_missile_is_driven(m), turns = sf_missile_turns(m);
    const double unknown = NAN, *impact = m->missile.impact_known ? m->missile.impact : NULL;
    const double informed = sf_model_informed_strain(m);
    double pull[3], lock_begin;
    const double lock_up = sf_model_lock_up(m, &lock_begin);
    sf_flight_gravity(&m->missile, pull);
    const double gravity = sf_flight_pull(&m->missile), density = sf_model_density(m);
    const double plane[2] = {find_plane(m, 0), find_plane(m, 1)};
    const double radius = m->missile.shape == SF_SHAPE_SPHERE ? m->missile.sphere_radius : 0;
    const struct {
        sf_h5_info info;
        sf_h5_type type;
        int rank;
        int64_t dims[2];
        const void *data;
    } item[] = {
        /* clang-format off */
        {{"/model/support_position", "m", "surfaces of the rigid supports"}, SF_H5_F64, 2, {m->support_node_count, 3}, m->support_position},
        {{"/model/support_triangle", "1", "their triangles"}, SF_H5_I32, 2, {m->support_triangle_count, 3}, m->support_triangle},
        {{"/model/position", "m", "reference position of the nodes"}, SF_H5_F64, 2, {m->node_count, 3}, m->position},
        {{"/model/volume", "m3", "volume of the smoothing domains"}, SF_H5_F64, 1, {m->node_count, 0}, m->volume},
        {{"/model/cell_type", "1", "XDMF topology code"}, SF_H5_U8, 1, {m->cell_count, 0}, m->cell_type},
        {{"/model/cell_ptr", "1", "start of each cell in cell_node"}, SF_H5_I64, 1, {m->cell_count + 1, 0}, m->cell_ptr},
        {{"/model/cell_node", "1", "vertices in VTK order"}, SF_H5_I32, 1, {m->cell_nnz, 0}, m->cell_node},
        {{"/model/surface_position", "m", "missile surface at t = 0"}, SF_H5_F64, 2, {m->surface_node_count, 3}, m->surface_position},
        {{"/model/surface_triangle", "1", "missile surface triangles"}, SF_H5_I32, 2, {m->surface_triangle_count, 3}, m->surface_triangle},
        {{"/model/symmetry_factor", "1", "modelled parts that make the whole"}, SF_H5_I64, 0, {0}, &m->symmetry_factor},
        {{"/model/axisymmetric", "1", "1: a plane section, x the radius, of a body of revolution about z; 0: solid"}, SF_H5_I64, 0, {0}, &m->axisymmetric},
        {{"/model/symmetry_x", "m", "where the symmetry plane normal to x lies; NaN: there is none"}, SF_H5_F64, 0, {0}, &plane[0]},
        {{"/model/symmetry_y", "m", "the same of that normal to y"}, SF_H5_F64, 0, {0}, &plane[1]},
        {{"/model/thickness", "m", "foam under the contact, along the missile's path, its vertical part"}, SF_H5_F64, 0, {0}, &m->thickness},
        {{"/model/expected_mesh_error", "1", "expected relative error of a_max by the mesh, 0: not estimated"}, SF_H5_F64, 0, {0}, &m->expected_mesh_error},
        {{"/model/slit_fraction", "1", "part of the nodes that lie at a slit, hole or gap narrower than their supports"}, SF_H5_F64, 0, {0}, &m->slit_fraction},
        {{"/model/anvil_depth", "m", "of the anvil below the undeformed pad's top, 0: there is none"}, SF_H5_F64, 0, {0}, &m->anvil.depth},
        {{"/model/density", "kg m-3", "mean density of the undeformed pad"}, SF_H5_F64, 0, {0}, &density},
        {{"/model/informed_strain", "1", "least, over the materials, of the strain up to which data inform"}, SF_H5_F64, 0, {0}, &informed},
        {{"/model/missile_mass", "kg", "mass of the whole missile"}, SF_H5_F64, 0, {0}, &m->missile.mass},
        {{"/model/missile_speed", "m s-1", "speed at first contact"}, SF_H5_F64, 0, {0}, &m->missile.speed},
        {{"/model/air", "m", "gaps on the same way as the thickness, which close first"}, SF_H5_F64, 0, {0}, &m->air},
        {{"/model/speed_scatter", "1", "standard deviation of the missile's speed over it"}, SF_H5_F64, 0, {0}, &m->run.speed_scatter},
        {{"/model/thickness_tolerance", "m", "standard deviation of the pad's thickness"}, SF_H5_F64, 0, {0}, &m->run.thickness_tolerance},
        {{"/model/lock_up", "1", "strain at which the only foam locks up; NaN: none, or several foams"}, SF_H5_F64, 0, {0}, &lock_up},
        {{"/model/lock_begin", "1", "strain from which that pole bends its stress"}, SF_H5_F64, 0, {0}, &lock_begin},
        {{"/model/impact_x", "m", "where the missile's lowest point arrives at the pad's top, x; NaN: not known"}, SF_H5_F64, 0, {0}, impact ? &impact[0] : &unknown},
        {{"/model/impact_y", "m", "the same, y"}, SF_H5_F64, 0, {0}, impact ? &impact[1] : &unknown},
        {{"/model/missile_driven", "1", "1: the missile had a prescribed motion, 0: none"}, SF_H5_I64, 0, {0}, &driven},
        {{"/model/missile_free", "1", "1: the missile had six degrees of freedom, 0: it was guided or driven"}, SF_H5_I64, 0, {0}, &turns},
        {{"/model/missile_centre", "m", "centre of mass at t = 0; of a free missile"}, SF_H5_F64, 1, {3, 0}, m->missile.centre},
        {{"/model/sphere_radius", "m", "of the missile's exact sphere, 0: contact with its triangles"}, SF_H5_F64, 0, {0}, &radius},
        {{"/model/sphere_centre", "m", "of the missile's exact sphere at t = 0"}, SF_H5_F64, 1, {3, 0}, m->missile.sphere_centre},
        {{"/model/gravity_along", "m s-2", "acceleration of the missile in free flight, along its direction"}, SF_H5_F64, 0, {0}, &gravity},
        {{"/model/gravity", "m s-2", "acceleration of the missile by gravity"}, SF_H5_F64, 1, {3, 0}, pull},
        {{"/model/kinematic", "1", "figures of 0: the specific force; 1: the kinematic acceleration"}, SF_H5_I64, 0, {0}, &m->run.kinematic},
        {{"/model/missile_direction", "1", "direction of motion"}, SF_H5_F64, 1, {3, 0}, sf_missile_direction(m)},
        /* clang-format on */
    };
    char foam[SF_MODEL_HASH_SIZE];
    size_t count = sizeof item / sizeof item[0];
    sf_model_foam_hash(m, foam);
    SF_TRY(sf_h5_write_text(file, &(sf_h5_info){"/model/foam", "1", "hash of the materials"}, foam, err));
    for (size_t k = m->support_triangle_count > 0 ? 0 : 2; k < count; k++)
        SF_TRY(sf_h5_write(file, &item[k].info, item[k].type, item[k].rank, item[k].dims, item[k].data, err));
    return SF_OK;
}

/* The results hold what the model says of the drop of its section. */
static sf_status write_section(const sf_model *m, sf_h5 *file, sf_error *err) {
#define WRITE(member, units, text)                                                                           \
    if (err->status == SF_OK)                                                                                \
        sf_h5_write(file, &(sf_h5_info){"/model/section/" #member, units, text}, SF_H5_F64, 0, NULL,         \
                    &m->section.member, err);
    if (m->section.a_max_g > 0) {
        SF_SECTION_DROP(WRITE)
    }
#undef WRITE
    return err->status;
}

/* The layers of a pad of several materials. */
static sf_status write_layers(const sf_model *m, sf_h5 *file, sf_error *err) {
    double density[SF_MATERIAL_MAX], informed[SF_MATERIAL_MAX];
    char names[SF_MATERIAL_MAX * SF_MATERIAL_NAME_SIZE] = "";
    if (m->material_count < 2)
        return SF_OK;
    for (int64_t k = 0; k < m->material_count; k++) {
        const sf_material *material = &m->material[k];
        density[k] = sf_material_density(material);
        informed[k] = sf_material_informed(material);
        sf_text_add(names, sizeof names, "%s%s", k ? "\n" : "", material->name);
    }
    sf_h5_write(file, &(sf_h5_info){"/model/node_layer", "1", "number of the layer of each node, ascending"},
                SF_H5_U8, 1, &m->node_count, m->node_material, err);
    sf_h5_write(file, &(sf_h5_info){"/model/layer_density", "kg m-3", "density of each layer"}, SF_H5_F64, 1,
                &m->material_count, density, err);
    sf_h5_write(file,
                &(sf_h5_info){"/model/layer_informed_strain", "1",
                              "strain up to which data inform the material of each layer"},
                SF_H5_F64, 1, &m->material_count, informed, err);
    return sf_h5_write_text(
        file, &(sf_h5_info){"/model/layer_names", "1", "names of the layers, a line each"}, names, err);
}

/* Creates results.h5 before the first step, with its provenance and that of the model, and the part of the
 * model that post-processing needs. On success the caller owns `*file`. */
static sf_status create_results(const char *path, const sf_model *m, const sf_h5 *model_file,
                                const sf_provenance *provenance, sf_h5 **file, sf_error *err) {
    SF_TRY(sf_h5_create(path, file, err));
    if (sf_provenance_write(*file, "softfall-results", provenance, err) == SF_OK &&
        sf_provenance_copy(model_file, *file, err) == SF_OK && write_arrays(m, *file, err) == SF_OK &&
        write_section(m, *file, err) == SF_OK && write_layers(m, *file, err) == SF_OK)
        return SF_OK;
    sf_h5_drop(file);
    return err->status;
}

enum { NAME_SIZE = SF_PATH_SIZE + 32 };

static const char BASE[] = "base.h5", PEAK[] = "peak.h5", PEAK_GROUP[] = "/peak";

/* Names the file of a frame, and its group in the file. */
static void name_frame(int64_t index, char name[32], char group[32]) {
    snprintf(name, 32, "frame-%06lld.h5", (long long)index);
    snprintf(group, 32, "/frames/%06lld", (long long)index);
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
        return SF_REFUSE(err, "the path of the results file is longer than %d bytes", SF_PATH_SIZE - 64);
    snprintf(o->results, sizeof o->results, "%s", results);
    snprintf(o->checkpoint, sizeof o->checkpoint, "%.4000s.restart", results);
    snprintf(o->folder, sizeof o->folder, "%.4000s.run", results);
    return SF_OK;
}

/* Base, peak or a frame, under its own name or as a partial file. */
static bool is_name(const char *name) {
    int length = (int)strcspn(name, "."), end = 0;
    long long index;
    SF_PRINTED(whole, 64, "%.*s.h5", length, name);
    bool known = strcmp(whole, BASE) == 0 || strcmp(whole, PEAK) == 0 ||
                 (sscanf(whole, "frame-%lld.h5%n", &index, &end) == 1 &&
                  end >= (int)strlen("frame-000000.h5") && whole[end] == '\0');
    return known && (strcmp(name, whole) == 0 || sf_replace_is_partial(name, whole, NULL));
}

/* True if the name is that of a file which another process left. */
static bool is_rest(const char *name) {
    return is_name(name) && strstr(name, ".h5.") != NULL;
}

sf_status sf_output_open(sf_output *o, sf_error *err) {
    SF_TRY(sf_folder_own(o->folder, err));
    o->lock = sf_folder_open(o->folder);
    if (o->lock < 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be opened: %s", o->folder, strerror(errno));
    if (flock(o->lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        sf_output_close(o);
        return SF_REFUSE(err, "another softfall-solve is writing %s", o->results);
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

sf_status sf_output_seal(sf_h5 **file, const char *partial, const char *path, sf_error *err) {
    sf_h5_close(file, err);
    if (err->status == SF_OK)
        sf_seal_add(partial, err);
    return sf_replace_commit(partial, path, err);
}

static int64_t size_of(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 ? (int64_t)info.st_size : 0;
}

sf_status sf_output_base(const sf_output *o, const sf_model *m, const sf_h5 *model_file,
                         const sf_provenance *provenance, sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    sf_h5 *file = NULL;
    SF_TRY(place(o, BASE, path, partial, err));
    create_results(partial, m, model_file, provenance, &file, err);
    return sf_h5_close(&file, err) == SF_OK && err->status == SF_OK ? sf_seal_add(partial, err) : err->status;
}

sf_status sf_output_start(const sf_output *o, bool keep, sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    SF_TRY(place(o, BASE, path, partial, err));
    if (sf_replace_commit(partial, path, err) == SF_OK && !keep)
        sf_folder_remove_known(o->lock, is_name, BASE);
    return err->status;
}

void sf_output_abandon(const sf_output *o) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    if (o->lock < 0)
        return;
    if (place(o, BASE, path, partial, SF_IGNORED) == SF_OK)
        unlink(partial);
    sf_folder_leave(o->folder); /* stays if an earlier run has files in it */
}

/* A file of the folder that holds a state. */
typedef struct state_file {
    const char *name, *group;
    int64_t fields; /* bits of sf_frame_field */
    int64_t size;   /* bytes, once it is written */
} state_file;

static sf_status write_state(const sf_output *o, const sf_model *m, const sf_operators *op, const sf_state *s,
                             state_file *to, sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    sf_h5 *file = NULL;
    if (place(o, to->name, path, partial, err) != SF_OK || sf_h5_create(partial, &file, err) != SF_OK)
        return err->status;
    sf_frame_write(m, op, s, to->fields, to->group, file, err);
    if (sf_output_seal(&file, partial, path, err) == SF_OK)
        to->size = size_of(path);
    return err->status;
}

sf_status sf_output_frame(sf_output *o, const sf_model *m, const sf_operators *op, const sf_state *s,
                          int64_t index, sf_error *err) {
    char name[32], group[32];
    name_frame(index, name, group);
    state_file frame = {.name = name, .group = group, .fields = m->run.output_fields};
    write_state(o, m, op, s, &frame, err);
    o->fresh += frame.size;
    return err->status;
}

sf_status sf_output_peak(const sf_output *o, const sf_model *m, const sf_operators *op, const sf_state *s,
                         sf_error *err) {
    state_file peak = {.name = PEAK, .group = PEAK_GROUP, .fields = SF_FIELD_ALL};
    return write_state(o, m, op, s, &peak, err);
}

/* The group of another file as a file of the folder. */
static sf_status recover(const sf_h5 *from, const char *group, const char *path, const char *partial,
                         sf_error *err) {
    sf_h5 *file = NULL;
    SF_TRY(sf_h5_create(partial, &file, err));
    sf_h5_copy(from, group, file, err);
    return sf_output_seal(&file, partial, path, err);
}

sf_status sf_output_recover_peak(const sf_output *o, const sf_h5 *checkpoint, sf_error *err) {
    char path[NAME_SIZE], partial[SF_PATH_SIZE];
    SF_TRY(place(o, PEAK, path, partial, err));
    return recover(checkpoint, PEAK_GROUP, path, partial, err);
}

/* Opens results.h5 if it is whole; it may be missing or damaged. */
static sf_status open_results(const sf_output *o, sf_h5 **results, sf_error *err) {
    sf_seal_state state;
    SF_TRY(sf_seal_examine(o->results, &state, err));
    return state == SF_SEAL_SOUND ? sf_h5_open_alone(o->results, results, err) : SF_OK;
}

/* Frame `k`: if its file is not sound, then from results.h5, where it must not be a link. */
static sf_status recover_frame(const sf_output *o, int64_t k, sf_h5 **results, bool *lost, sf_error *err) {
    char name[32], group[32], path[NAME_SIZE], partial[SF_PATH_SIZE];
    sf_seal_state state;
    name_frame(k, name, group);
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
    sf_h5 *part = NULL;
    SF_PRINTED(path, NAME_SIZE, "%s/%s", copied ? o->folder : sf_path_name(o->folder), name);
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
    SF_TRY(sf_replace_begin(o->results, o->partial, err));
    SF_TRY(sf_h5_create(o->partial, file, err));
    SF_TRY(sf_provenance_mark(*file, "softfall-results", err));
    take(o, copied, BASE, base, *file, err);
    for (int64_t k = 0; k < count && err->status == SF_OK; k++) {
        char name[32], group[32];
        name_frame(k, name, group);
        take(o, copied, name, (const char *const[]){group, NULL}, *file, err);
    }
    return err->status;
}

sf_status sf_output_commit(sf_output *o, sf_h5 **file, sf_error *err) {
    if (sf_output_seal(file, o->partial, o->results, err) == SF_OK) {
        o->fresh = 0;
        o->size = size_of(o->results);
    }
    return err->status;
}
