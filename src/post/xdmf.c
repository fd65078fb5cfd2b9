/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/xdmf.h"

#include "io/plain_file.h"
#include "io/provenance.h"
#include "io/replace.h"
#include "post/results_check.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* XDMF mixed topology: for each cell its code, then its vertices. */
static sf_status write_topology(sf_h5 *file, const sf_results *r, sf_error *err) {
    int64_t length = r->cell_nnz + r->cell_count, k = 0;
    int64_t triangles[2] = {r->surface_triangle_count, 3};
    int32_t *mixed = sf_alloc(err, (unsigned long)length, sizeof *mixed, "the topology");
    if (!mixed)
        return err->status;
    for (int64_t c = 0; c < r->cell_count; c++) {
        mixed[k++] = r->cell_type[c];
        for (int64_t v = r->cell_ptr[c]; v < r->cell_ptr[c + 1]; v++)
            mixed[k++] = r->cell_node[v];
    }
    sf_h5_info pad = {"/pad/topology", "1", "XDMF mixed topology: code of each cell, then its vertices"};
    sf_h5_info missile = {"/missile/triangle", "1", "triangles of the missile's surface"};
    if (sf_h5_write(file, &pad, SF_H5_I32, 1, &length, mixed, err) == SF_OK && r->surface_triangle_count > 0)
        sf_h5_write(file, &missile, SF_H5_I32, 2, triangles, r->surface_triangle, err);
    free(mixed);
    if (err->status == SF_OK && r->layer_count > 0)
        sf_h5_write(file, &(sf_h5_info){"/pad/layer", "1", "number of the layer of each node"}, SF_H5_U8, 1,
                    &r->node_count, r->node_layer, err);
    return err->status;
}

static sf_status write_pad(sf_h5 *file, const sf_h5_info *info, const sf_results *r,
                           const double *displacement, sf_error *err) {
    int64_t dims[2] = {r->node_count, 3};
    double *moved = sf_alloc(err, 3 * (unsigned long)r->node_count, sizeof *moved, info->description);
    if (!moved)
        return err->status;
    for (int64_t i = 0; i < 3 * r->node_count; i++)
        moved[i] = r->position[i] + (displacement ? displacement[i] : 0);
    sf_h5_write(file, info, SF_H5_F64, 2, dims, moved, err);
    free(moved);
    return err->status;
}

static sf_status write_missile(sf_h5 *file, const sf_h5_info *info, const sf_results *r,
                               const sf_frame_head *head, sf_error *err) {
    int64_t dims[2] = {r->surface_node_count, 3};
    double *moved = sf_alloc(err, 3 * (unsigned long)r->surface_node_count, sizeof *moved, info->description);
    if (!moved)
        return err->status;
    for (int64_t i = 0; i < r->surface_node_count; i++)
        sf_results_place(r, head, &r->surface_position[3 * i], &moved[3 * i]);
    sf_h5_write(file, info, SF_H5_F64, 2, dims, moved, err);
    free(moved);
    return err->status;
}

static sf_status write_frame_data(sf_h5 *file, const sf_results *r, const sf_frame_head *head,
                                  const sf_frame *frame, int64_t index, sf_error *err) {
    char path[96];
    snprintf(path, sizeof path, "/frames/%06lld/pad_position", (long long)index);
    sf_h5_info pad = {path, "m", "positions of the pad's nodes, deformed"};
    if (write_pad(file, &pad, r, frame->field[SF_FRAME_DISPLACEMENT], err))
        return err->status;
    snprintf(path, sizeof path, "/frames/%06lld/missile_position", (long long)index);
    sf_h5_info missile = {path, "m", "positions of the missile's surface nodes"};
    if (write_missile(file, &missile, r, head, err) != SF_OK)
        return err->status;
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        const sf_frame_field_info *info = sf_frame_field_get((sf_frame_field)f);
        int64_t dims[2] = {r->node_count, info->components};
        if (!frame->field[f])
            continue;
        snprintf(path, sizeof path, "/frames/%06lld/%s", (long long)index, info->array);
        sf_h5_info array = {path, info->units, info->description};
        if (sf_h5_write(file, &array, SF_H5_F64, info->components > 1 ? 2 : 1, dims, frame->field[f], err) !=
            SF_OK)
            return err->status;
    }
    return SF_OK;
}

/* The text, and the name of the file that it speaks of. */
typedef struct scene {
    FILE *file;
    const char *data;
} scene;

static void put_float_item(const scene *x, int64_t index, const char *name, int64_t rows, int columns) {
    fprintf(x->file, "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"%lld",
            (long long)rows);
    if (columns > 1)
        fprintf(x->file, " %d", columns);
    fprintf(x->file, "\">%s:/frames/%06lld/%s</DataItem>", x->data, (long long)index, name);
}

static void put_grid_start(const scene *x, const char *name, double time) {
    fprintf(x->file, "        <Grid Name=\"%s\" GridType=\"Uniform\">\n          <Time Value=\"%.9g\"/>\n",
            name, time);
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
        if (!(fields >> f & 1))
            continue;
        fprintf(x->file, "          <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"Node\">",
                info->array,
                info->components == 1   ? "Scalar"
                : info->components == 3 ? "Vector"
                                        : "Tensor");
        put_float_item(x, index, info->array, r->node_count, info->components);
        fputs("</Attribute>\n", x->file);
    }
    if (r->layer_count > 0)
        fprintf(
            x->file,
            "          <Attribute Name=\"layer\" AttributeType=\"Scalar\" Center=\"Node\"><DataItem "
            "Format=\"HDF\" NumberType=\"UChar\" Dimensions=\"%lld\">%s:/pad/layer</DataItem></Attribute>\n",
            (long long)r->node_count, x->data);
    fputs("        </Grid>\n", x->file);
}

static void put_missile(const scene *x, const sf_results *r, double time, int64_t index) {
    if (r->surface_triangle_count == 0)
        return;
    put_grid_start(x, "missile", time);
    fprintf(x->file,
            "          <Topology TopologyType=\"Triangle\" NumberOfElements=\"%lld\"><DataItem "
            "Format=\"HDF\" NumberType=\"Int\" Precision=\"4\" Dimensions=\"%lld "
            "3\">%s:/missile/triangle</DataItem></Topology>\n"
            "          <Geometry GeometryType=\"XYZ\">",
            (long long)r->surface_triangle_count, (long long)r->surface_triangle_count, x->data);
    put_float_item(x, index, "missile_position", r->surface_node_count, 3);
    fputs("</Geometry>\n        </Grid>\n", x->file);
}

static void put_frame(const scene *x, const sf_results *r, int fields, double time, int64_t index) {
    fprintf(x->file,
            "      <Grid Name=\"frame_%06lld\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
            "        <Time Value=\"%.9g\"/>\n",
            (long long)index, time);
    put_pad(x, r, fields, time, index);
    put_missile(x, r, time, index);
    fputs("      </Grid>\n", x->file);
}

/* Every frame that can be read; `fields` [frame_count] gets which fields each has, a bit for each. */
static sf_status write_frames(sf_h5 *file, sf_results *r, int *fields, int64_t *frames, sf_error *err) {
    bool moved = true;
    for (int64_t k = 0; k < r->frame_count; k++) {
        sf_frame frame = {0};
        sf_error problem = SF_ERROR_INIT;
        if (sf_frame_read(r, &r->frames[k], &frame, &problem) != SF_OK) {
            if (sf_results_ended_well(r))
                return SF_FAIL(err, problem.status, "%s", problem.text);
            sf_results_note(r, "frames from %.9g s on are left out: %.150s", r->frames[k].time, problem.text);
            return SF_OK;
        }
        moved = moved && frame.field[SF_FRAME_DISPLACEMENT];
        fields[k] = 0;
        for (int f = 0; f < SF_FRAME_FIELDS; f++)
            fields[k] |= (frame.field[f] != NULL) << f;
        if (write_frame_data(file, r, &r->frames[k], &frame, k, err) == SF_OK)
            (*frames)++;
        sf_frame_free(&frame);
        if (err->status != SF_OK)
            return err->status;
    }
    if (!moved)
        sf_results_note(r, "the frames hold no displacement: ParaView shows the pad undeformed");
    return SF_OK;
}

static sf_status write_data(const char *path, sf_results *r, const char *command_line, int *fields,
                            int64_t *frames, sf_error *err) {
    const sf_provenance provenance = {.program = "softfall-post", .command_line = command_line};
    sf_error ignored = SF_ERROR_INIT;
    sf_h5 *file = NULL;
    if (sf_h5_create(path, &file, err) != SF_OK)
        return err->status;
    if (sf_provenance_write(file, "softfall-paraview", &provenance, err) == SF_OK &&
        write_topology(file, r, err) == SF_OK)
        write_frames(file, r, fields, frames, err);
    sf_h5_close(&file, err->status == SF_OK ? err : &ignored);
    return err->status;
}

static sf_status write_text(const sf_staging *output, const sf_results *r, const int *fields, int64_t frames,
                            const char *data, sf_error *err) {
    const scene x = {sf_staging_open(output, "pad.xdmf", err), data};
    if (!x.file)
        return err->status;
    fputs("<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\">\n  "
          "<Domain>\n"
          "    <Grid Name=\"softfall\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
          x.file);
    for (int64_t k = 0; k < frames; k++)
        put_frame(&x, r, fields[k], r->frames[k].time, k);
    fputs("    </Grid>\n  </Domain>\n</Xdmf>\n", x.file);
    return sf_staging_close(x.file, "pad.xdmf", err);
}

static const char NEW_DATA[] = "pad.h5"; /* before it has its name */

/* Gives the data their name, and the text. */
static sf_status name_data(const sf_staging *output, const char *path, char data[SF_XDMF_NAME_SIZE],
                           sf_error *err) {
    uint64_t hash = 0;
    if (sf_plain_hash(path, NULL, SF_PLAIN_ANY, &hash, err) != SF_OK)
        return err->status;
    snprintf(data, SF_XDMF_NAME_SIZE, "pad-%016llx.h5", (unsigned long long)hash);
    char *named = sf_staging_path(output, data, err);
    if (named && rename(path, named) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be renamed to %s", path, data);
    free(named);
    return err->status;
}

sf_status sf_xdmf_write(const sf_staging *output, sf_results *results, const char *command_line,
                        char data[SF_XDMF_NAME_SIZE], int64_t *frames, sf_error *err) {
    *frames = 0;
    char *path = sf_staging_path(output, NEW_DATA, err);
    int *fields =
        sf_alloc(err, (unsigned long)results->frame_count, sizeof *fields, "the fields of the frames");
    if (err->status == SF_OK)
        write_data(path, results, command_line, fields, frames, err);
    if (path && *frames == 0)
        remove(path);
    else if (err->status == SF_OK && name_data(output, path, data, err) == SF_OK)
        write_text(output, results, fields, *frames, data, err);
    free(fields);
    free(path);
    return err->status;
}

/* Does an .xdmf file of the directory speak of these data? Also if that is not known. */
static bool is_named(const char *directory, const char *data) {
    DIR *listing = opendir(directory);
    bool named = !listing;
    for (struct dirent *entry = listing ? readdir(listing) : NULL; entry && !named;
         entry = readdir(listing)) {
        char path[SF_PATH_SIZE], *text = NULL;
        sf_error unread = SF_ERROR_INIT;
        size_t length = strlen(entry->d_name);
        if (length < 5 || strcmp(entry->d_name + length - 5, ".xdmf") != 0)
            continue;
        named = snprintf(path, sizeof path, "%s/%s", directory, entry->d_name) >= (int)sizeof path ||
                sf_plain_read(path, NULL, SF_PLAIN_TEXT, &text, NULL, &unread) != SF_OK || strstr(text, data);
        free(text);
    }
    if (listing)
        closedir(listing);
    return named;
}

/* Is that the name of data that softfall wrote: pad-HASH.h5 with the hash of the content? */
static bool are_ours(const char *path, const char *name) {
    unsigned long long hash = 0;
    uint64_t found = 0;
    sf_error unread = SF_ERROR_INIT;
    return strncmp(name, "pad-", 4) == 0 && strspn(name + 4, "0123456789abcdef") == 16 &&
           strcmp(name + 20, ".h5") == 0 && sscanf(name + 4, "%16llx", &hash) == 1 &&
           sf_plain_hash(path, NULL, SF_PLAIN_ANY, &found, &unread) == SF_OK && found == hash;
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
