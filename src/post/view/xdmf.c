/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/xdmf.h"

#include "io/h5_data.h"
#include "post/figures/figures.h"
#include <dirent.h>
#include <float.h>
#include <string.h>
#include <unistd.h>

#include "base/sets.h"
#include "io/plain_file.h"
#include "io/provenance.h"
#include "io/replace.h"

enum { SPEED, ACCELERATION, FORCE, CENTRE /* only of an exact sphere: the last */, MISSILE_ARRAYS };

/* The arrays of the missile in each frame: of all its nodes, as it is rigid. */
static const struct missile_array {
    const char *name, *units, *description;
    int components;
} missile_arrays[MISSILE_ARRAYS] = {
    [SPEED] = {"speed_m_s", "m s-1", "speed of the missile along its direction of motion", 1},
    [ACCELERATION] = {"acceleration_g", "9.80665 m s-2", "the acceleration that a_max is of, not filtered",
                      1},
    [FORCE] = {"contact_force_N", "N", "on the missile, against its direction of motion", 1},
    [CENTRE] = {"sphere_centre_m", "m", "centre of the missile's exact sphere", 3},
};

static int missile_array_count(const sf_results *r) {
    return r->sphere_radius > 0 ? MISSILE_ARRAYS : CENTRE;
}

/* ---- which frames ---- */

/* True if there is a frame of the very step of /peak. */
static bool is_among_frames(const sf_results *r, const sf_frame_head *head) {
    for (int64_t k = 0; k < r->frame_count; k++)
        if (r->frames[k].time == head->time)
            return true;
    return false;
}

sf_status sf_shown_find(const sf_results *r, sf_shown *s, sf_error *err) {
    bool peak = r->frame_count > 0 && r->has_peak && !is_among_frames(r, &r->peak);
    *s = (sf_shown){.peak = -1};
    s->head = sf_alloc(err, r->frame_count + 1, sizeof *s->head, "the frames for ParaView");
    s->fields = sf_alloc(err, r->frame_count + 1, sizeof *s->fields, "the fields of the frames");
    for (int64_t k = 0; k <= r->frame_count && err->status == SF_OK; k++) {
        if (peak && s->peak < 0 && (k == r->frame_count || r->peak.time < r->frames[k].time)) {
            s->peak = s->count;
            s->head[s->count++] = &r->peak;
        }
        if (k == r->frame_count)
            break;
        if (r->has_peak && r->frames[k].time == r->peak.time)
            s->peak = s->count;
        s->head[s->count++] = &r->frames[k];
    }
    return err->status;
}

void sf_shown_free(sf_shown *s) {
    SF_CLEAR(s, s->head, s->fields);
}

/* ---- the file ---- */

/* The file, and how numbers are stored. */
typedef struct store {
    sf_h5 *file;
    const sf_results *results;
    bool full;
} store;

/* Rounds to multiples of a power of two, the largest magnitude to SF_XDMF_BITS of them; below the smallest
 * float all are 0. */
static void round_array(double *value, int64_t count) {
    double largest = 0;
    int exponent;
    for (int64_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(value[i]));
    frexp(largest, &exponent);
    double unit = ldexp(1, exponent - SF_XDMF_BITS);
    for (int64_t i = 0; i < count; i++)
        value[i] = largest < FLT_MIN ? 0 : unit * rint(value[i] / unit);
}

/* Writes an array of the pad or the missile; rounds it in its place. */
static sf_status put(const store *s, const sf_h5_info *info, int64_t rows, int columns, double *value,
                     sf_error *err) {
    const int64_t dims[2] = {rows, columns};
    int rank = columns > 1 ? 2 : 1;
    if (s->full)
        return sf_h5_write_packed(s->file, info, SF_H5_F64, rank, dims, value, err);
    round_array(value, rows * columns);
    return sf_h5_write_singles(s->file, info, rank, dims, value, err);
}

/* Writes numbers without unit, `dims` of them: rows and columns. */
static sf_status put_integers(const store *s, const sf_h5_info *info, sf_h5_type type, const int64_t dims[2],
                              const void *value, sf_error *err) {
    return sf_h5_write_packed(s->file, info, type, dims[1] > 1 ? 2 : 1, dims, value, err);
}

/* XDMF mixed topology: for each cell its code, then its vertices. */
static sf_status write_topology(const store *s, sf_error *err) {
    const sf_results *r = s->results;
    int64_t length = r->cell_nnz + r->cell_count, k = 0;
    SF_OWN(int32_t, mixed, length, "the topology", err);
    for (int64_t c = 0; c < r->cell_count; c++) {
        mixed[k++] = r->cell_type[c];
        for (int64_t v = r->cell_ptr[c]; v < r->cell_ptr[c + 1]; v++)
            mixed[k++] = r->cell_node[v];
    }
    static const sf_h5_info topology = {"/pad/topology", "1",
                                        "XDMF mixed topology: code of each cell, then its vertices"},
                            triangles = {"/missile/triangle", "1", "triangles of the missile's surface"};
    const int64_t of_pad[2] = {length, 1}, of_missile[2] = {r->surface_triangle_count, 3};
    put_integers(s, &topology, SF_H5_I32, of_pad, mixed, err);
    if (err->status == SF_OK && r->surface_triangle_count > 0)
        put_integers(s, &triangles, SF_H5_I32, of_missile, r->surface_triangle, err);
    return err->status;
}

/* Writes the material of each cell, and in a pad of layers of each node: a cell belongs to one material as
 * its nodes do. */
static sf_status write_materials(const store *s, sf_error *err) {
    const sf_results *r = s->results;
    SF_OWNED uint8_t *material = sf_alloc(err, r->cell_count, sizeof *material, "materials of cells");
    for (int64_t c = 0; c < r->cell_count && err->status == SF_OK; c++)
        material[c] = r->layer_count > 0 ? r->node_layer[r->cell_node[r->cell_ptr[c]]] : 0;
    static const sf_h5_info by_cell = {"/pad/material", "1",
                                       "number of the material of each cell, as that of the layer"},
                            by_node = {"/pad/layer", "1", "number of the layer of each node"};
    const int64_t cells[2] = {r->cell_count, 1}, nodes[2] = {r->node_count, 1};
    if (err->status == SF_OK && put_integers(s, &by_cell, SF_H5_U8, cells, material, err) == SF_OK &&
        r->layer_count > 0)
        put_integers(s, &by_node, SF_H5_U8, nodes, r->node_layer, err);
    return err->status;
}

/* Writes points where they are in a frame: the pad's by their displacement (NULL: at rest), the missile's
 * surface, `head`, by the missile's place. */
static sf_status write_points(const store *s, const sf_h5_info *info, int64_t count, const double *position,
                              const double *displacement, const sf_frame_head *head, sf_error *err) {
    SF_OWN(double, moved, 3 * count, info->description, err);
    for (int64_t i = 0; i < count; i++)
        if (head)
            sf_results_place(s->results, head, &position[3 * i], &moved[3 * i]);
        else
            for (int64_t k = 3 * i; k < 3 * i + 3; k++)
                moved[k] = position[k] + (displacement ? displacement[k] : 0);
    return put(s, info, count, 3, moved, err);
}

static sf_status write_supports(const store *s, sf_error *err) {
    const sf_results *r = s->results;
    if (r->support_triangle_count == 0)
        return SF_OK;
    const int64_t dims[2] = {r->support_triangle_count, 3};
    SF_TRY(put_integers(s, &(sf_h5_info){"/support/triangle", "1", "triangles of the rigid supports"},
                        SF_H5_I32, dims, r->support_triangle, err));
    return write_points(s, &(sf_h5_info){"/support/position", "m", "positions of their nodes"},
                        r->support_node_count, r->support_position, NULL, NULL, err);
}

static sf_status write_missile_arrays(const store *s, const sf_frame_head *head, int64_t index,
                                      sf_error *err) {
    const sf_results *r = s->results;
    int64_t row = sf_interval_find(r->history.time, r->history.rows + 1, head->time), /* the last up to it */
        n = r->surface_node_count;
    double value[MISSILE_ARRAYS][3] = {[SPEED] = {r->history.velocity[row]},
                                       [ACCELERATION] = {sf_figures_reading(r, row)},
                                       [FORCE] = {r->history.contact_force[row]}};
    sf_results_place(r, head, r->sphere_centre, value[CENTRE]);
    SF_OWNED double *all = sf_alloc(err, 3 * n, sizeof *all, "arrays of the missile");
    for (int k = 0; k < missile_array_count(r) && err->status == SF_OK; k++) {
        const struct missile_array *a = &missile_arrays[k];
        SF_PRINTED(path, 96, "/frames/%06lld/%s", (long long)index, a->name);
        for (int64_t i = 0; i < n * a->components; i++)
            all[i] = value[k][i % a->components];
        put(s, &(sf_h5_info){path, a->units, a->description}, n, a->components, all, err);
    }
    return err->status;
}

static void note_largest(const sf_results *r, const sf_frame *frame, double largest[SF_FRAME_FIELDS]) {
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        int64_t count =
            frame->field[f] ? r->node_count * sf_frame_field_get((sf_frame_field)f)->components : 0;
        for (int64_t i = 0; i < count; i++)
            largest[f] = fmax(largest[f], fabs(frame->field[f][i]));
    }
}

static sf_status write_fields(const store *s, sf_frame *frame, int64_t index, sf_error *err) {
    for (int f = 0; f < SF_FRAME_FIELDS && err->status == SF_OK; f++) {
        const sf_frame_field_info *info = sf_frame_field_get((sf_frame_field)f);
        SF_PRINTED(path, 96, "/frames/%06lld/%s", (long long)index, info->array);
        if (frame->field[f])
            put(s, &(sf_h5_info){path, info->units, info->description}, s->results->node_count,
                info->components, frame->field[f], err);
    }
    return err->status;
}

static sf_status write_frame(const store *s, const sf_frame_head *head, sf_frame *frame, int64_t index,
                             sf_error *err) {
    const sf_results *r = s->results;
    SF_PRINTED(path, 96, "/frames/%06lld/pad_position", (long long)index);
    SF_TRY(write_points(s, &(sf_h5_info){path, "m", "positions of the pad's nodes, deformed"}, r->node_count,
                        r->position, frame->field[SF_FRAME_DISPLACEMENT], NULL, err));
    snprintf(path, sizeof path, "/frames/%06lld/missile_position", (long long)index);
    SF_TRY(write_points(s, &(sf_h5_info){path, "m", "positions of the missile's surface nodes"},
                        r->surface_node_count, r->surface_position, NULL, head, err));
    SF_TRY(write_missile_arrays(s, head, index, err));
    return write_fields(s, frame, index, err);
}

/* ---- all frames ---- */

static int fields_of(const sf_frame *frame) {
    int fields = 0;
    for (int f = 0; f < SF_FRAME_FIELDS; f++)
        fields |= (frame->field[f] != NULL) << f;
    return fields;
}

/* The fields to read of frame k: /peak holds all of them, and shows those of the frames. */
static int fields_wanted(const sf_results *r, const sf_shown *shown, int64_t k) {
    const char *group = r->frames[0].group;
    int fields = 0;
    if (shown->head[k] != &r->peak)
        return SF_FIELD_ALL;
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        SF_PRINTED(path, 80, "%s/%s", group, sf_frame_field_get((sf_frame_field)f)->name);
        fields |= sf_h5_exists(r->file, path) << f;
    }
    return fields;
}

/* Every frame that can be read. */
static sf_status write_frames(const store *s, sf_results *r, sf_shown *shown, sf_error *err) {
    bool moved = true;
    for (int64_t k = 0; k < shown->count; k++) {
        const sf_frame_head *head = shown->head[k];
        SF_OWNED_BY(sf_frame_free) sf_frame frame = {0};
        sf_error problem = SF_ERROR_INIT;
        if (sf_frame_read(r, head, fields_wanted(r, shown, k), &frame, &problem) != SF_OK) {
            if (sf_results_ended_well(r))
                return SF_FAIL(err, problem.status, "%s", problem.text);
            sf_results_note(r, "frames from %.9g s on are left out: %.150s", head->time, problem.text);
            shown->count = k;
            break;
        }
        moved = moved && frame.field[SF_FRAME_DISPLACEMENT];
        shown->fields[k] = fields_of(&frame);
        note_largest(r, &frame, shown->largest);
        SF_TRY(write_frame(s, head, &frame, k, err));
    }
    if (!moved)
        sf_results_note(r, "the frames hold no displacement: ParaView shows the pad undeformed");
    return SF_OK;
}

/* Writes the file; `shown` is cut at the first frame that cannot be read. */
static sf_status write_data(const char *path, sf_results *r, const sf_xdmf_options *options, sf_shown *shown,
                            sf_error *err) {
    const sf_provenance provenance = {.program = "softfall-post", .command_line = options->command_line};
    store s = {.results = r, .full = options->full};
    SF_TRY(sf_h5_create(path, &s.file, err));
    if (sf_provenance_write(s.file, "softfall-paraview", &provenance, err) == SF_OK &&
        write_topology(&s, err) == SF_OK && write_materials(&s, err) == SF_OK &&
        write_supports(&s, err) == SF_OK)
        write_frames(&s, r, shown, err);
    sf_h5_close(&s.file, err);
    return err->status;
}

/* The text, and the name of the file that it speaks of. */
typedef struct scene {
    FILE *file;
    const char *data;
    int precision; /* bytes of a number */
} scene;

static void put_float_item(const scene *x, int64_t index, const char *name, int64_t rows, int columns) {
    fprintf(x->file, "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"%d\" Dimensions=\"%lld",
            x->precision, (long long)rows);
    if (columns > 1)
        fprintf(x->file, " %d", columns);
    fprintf(x->file, "\">%s:/frames/%06lld/%s</DataItem>", x->data, (long long)index, name);
}

static void put_grid_start(const scene *x, const char *name, double time) {
    fprintf(x->file, "        <Grid Name=\"%s\" GridType=\"Uniform\">\n          <Time Value=\"%.9g\"/>\n",
            name, time);
}

static void put_attribute(const scene *x, int64_t index, const char *name, int64_t rows, int components) {
    static const char *const names[] = {[1] = "Scalar", [3] = "Vector", [9] = "Tensor"};
    fprintf(x->file, "          <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"Node\">", name,
            names[components]);
    put_float_item(x, index, name, rows, components);
    fputs("</Attribute>\n", x->file);
}

/* Numbers below 256 that do not change with time, /pad/NAME. */
static void put_numbers(const scene *x, const char *name, const char *center, int64_t rows) {
    fprintf(x->file,
            "          <Attribute Name=\"%s\" AttributeType=\"Scalar\" Center=\"%s\"><DataItem "
            "Format=\"HDF\" NumberType=\"UChar\" Dimensions=\"%lld\">%s:/pad/%s</DataItem></Attribute>\n",
            name, center, (long long)rows, x->data, name);
}

static void put_pad(const scene *x, const sf_results *r, int fields, double time, int64_t index) {
    put_grid_start(x, "pad", time);
    fprintf(x->file,
            "          <Topology TopologyType=\"Mixed\" NumberOfElements=\"%lld\"><DataItem Format=\"HDF\" "
            "NumberType=\"Int\" Precision=\"4\" Dimensions=\"%lld\">%s:/pad/topology</DataItem></Topology>\n"
            "          <Geometry GeometryType=\"XYZ\">",
            (long long)r->cell_count, (long long)(r->cell_nnz + r->cell_count), x->data);
    put_float_item(x, index, "pad_position", r->node_count, 3);
    fputs("</Geometry>\n", x->file);
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        const sf_frame_field_info *info = sf_frame_field_get((sf_frame_field)f);
        if (fields >> f & 1)
            put_attribute(x, index, info->array, r->node_count, info->components);
    }
    put_numbers(x, "material", "Cell", r->cell_count);
    if (r->layer_count > 0)
        put_numbers(x, "layer", "Node", r->node_count);
    fputs("        </Grid>\n", x->file);
}

static void put_triangles(const scene *x, const char *name, double time, int64_t count) {
    put_grid_start(x, name, time);
    fprintf(x->file,
            "          <Topology TopologyType=\"Triangle\" NumberOfElements=\"%lld\"><DataItem "
            "Format=\"HDF\" NumberType=\"Int\" Precision=\"4\" Dimensions=\"%lld "
            "3\">%s:/%s/triangle</DataItem></Topology>\n"
            "          <Geometry GeometryType=\"XYZ\">",
            (long long)count, (long long)count, x->data, name);
}

static void put_supports(const scene *x, const sf_results *r, double time) {
    if (r->support_triangle_count == 0)
        return;
    put_triangles(x, "support", time, r->support_triangle_count);
    fprintf(x->file,
            "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"%d\" Dimensions=\"%lld 3\">"
            "%s:/support/position</DataItem></Geometry>\n        </Grid>\n",
            x->precision, (long long)r->support_node_count, x->data);
}

static void put_missile(const scene *x, const sf_results *r, double time, int64_t index) {
    if (r->surface_triangle_count == 0)
        return;
    put_triangles(x, "missile", time, r->surface_triangle_count);
    put_float_item(x, index, "missile_position", r->surface_node_count, 3);
    fputs("</Geometry>\n", x->file);
    for (int k = 0; k < missile_array_count(r); k++)
        put_attribute(x, index, missile_arrays[k].name, r->surface_node_count, missile_arrays[k].components);
    fputs("        </Grid>\n", x->file);
}

static void put_frame(const scene *x, const sf_results *r, int fields, double time, int64_t index) {
    fprintf(x->file,
            "      <Grid Name=\"frame_%06lld\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
            "        <Time Value=\"%.9g\"/>\n",
            (long long)index, time);
    put_pad(x, r, fields, time, index);
    put_missile(x, r, time, index);
    put_supports(x, r, time);
    fputs("      </Grid>\n", x->file);
}

static sf_status write_text(const sf_staging *output, const sf_results *r, const sf_shown *shown,
                            const char *data, bool full, sf_error *err) {
    const scene x = {sf_staging_open(output, "pad.xdmf", err), data, full ? 8 : 4};
    SF_TRY(err->status);
    fputs("<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\">\n  "
          "<Domain>\n"
          "    <Grid Name=\"softfall\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
          x.file);
    for (int64_t k = 0; k < shown->count; k++)
        put_frame(&x, r, shown->fields[k], shown->head[k]->time, k);
    fputs("    </Grid>\n  </Domain>\n</Xdmf>\n", x.file);
    return sf_staging_close(x.file, "pad.xdmf", err);
}

static const char NEW_DATA[] = "pad.h5"; /* before it has its name */

/* Gives the data their name, and the text. */
static sf_status name_data(const sf_staging *output, const char *path, char data[SF_XDMF_NAME_SIZE],
                           sf_error *err) {
    uint64_t hash = 0;
    SF_TRY(sf_plain_hash(path, NULL, SF_PLAIN_ANY, &hash, err));
    snprintf(data, SF_XDMF_NAME_SIZE, "pad-%016llx.h5", (unsigned long long)hash);
    SF_OWNED char *named = sf_staging_path(output, data, err);
    if (named && rename(path, named) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be renamed to %s", path, data);
    return err->status;
}

static sf_xdmf tell(const sf_shown *shown) {
    sf_xdmf made = {.frames = shown->count, .fields = SF_FIELD_ALL, .peak_time = NAN};
    memcpy(made.largest, shown->largest, sizeof made.largest);
    if (shown->count == 0)
        return made;
    for (int64_t k = 0; k < shown->count; k++)
        made.fields &= shown->fields[k];
    if (shown->peak >= 0 && shown->peak < shown->count)
        made.peak_time = shown->head[shown->peak]->time;
    return made;
}

sf_status sf_xdmf_write(const sf_staging *output, sf_results *results, const sf_xdmf_options *options,
                        char data[SF_XDMF_NAME_SIZE], sf_xdmf *made, sf_error *err) {
    SF_OWNED_BY(sf_shown_free) sf_shown shown = {0};
    SF_OWNED char *path = sf_staging_path(output, NEW_DATA, err);
    if (path && sf_shown_find(results, &shown, err) == SF_OK)
        write_data(path, results, options, &shown, err);
    if (path && shown.count == 0)
        remove(path);
    else if (err->status == SF_OK && name_data(output, path, data, err) == SF_OK)
        write_text(output, results, &shown, data, options->full, err);
    *made = tell(&shown);
    return err->status;
}

/* True if an .xdmf file of the directory names these data, or if that is not known. */
static bool is_named(const char *directory, const char *data) {
    DIR *listing = opendir(directory);
    bool named = !listing;
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry && !named;
         entry = readdir(listing)) {
        char path[SF_PATH_SIZE];
        SF_OWNED char *text = NULL;
        size_t length = strlen(entry->d_name);
        if (length < 5 || strcmp(entry->d_name + length - 5, ".xdmf") != 0)
            continue;
        named = snprintf(path, sizeof path, "%s/%s", directory, entry->d_name) >= (int)sizeof path ||
                sf_plain_read(path, NULL, SF_PLAIN_TEXT, &text, NULL, SF_IGNORED) != SF_OK ||
                strstr(text, data);
    }
    if (listing)
        closedir(listing);
    return named;
}

/* True if the name is that of data which softfall wrote: pad-HASH.h5 with the hash of the content. */
static bool are_ours(const char *path, const char *name) {
    unsigned long long hash = 0;
    uint64_t found = 0;
    return strncmp(name, "pad-", 4) == 0 && strspn(name + 4, "0123456789abcdef") == 16 &&
           strcmp(name + 20, ".h5") == 0 && sscanf(name + 4, "%16llx", &hash) == 1 &&
           sf_plain_hash(path, NULL, SF_PLAIN_ANY, &found, SF_IGNORED) == SF_OK && found == hash;
}

void sf_xdmf_remove_old(const char *directory, const char *data) {
    DIR *listing = opendir(directory);
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry; entry = readdir(listing)) {
        char path[SF_PATH_SIZE];
        const char *name = entry->d_name;
        if (snprintf(path, sizeof path, "%s/%s", directory, name) < (int)sizeof path &&
            strcmp(name, data) != 0 && are_ours(path, name) && !is_named(directory, name))
            unlink(path);
    }
    if (listing)
        closedir(listing);
}
