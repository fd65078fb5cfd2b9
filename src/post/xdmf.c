/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/xdmf.h"

#include "io/provenance.h"
#include "post/results_check.h"
#include <stdlib.h>
#include <string.h>

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
    return err->status;
}

/* `count` positions moved by `field` ([count][3], or NULL) and `shift`. */
static sf_status write_positions(sf_h5 *file, const sf_h5_info *info, int64_t count, const double *position,
                                 const double *field, const double shift[3], sf_error *err) {
    int64_t dims[2] = {count, 3};
    double *moved = sf_alloc(err, (unsigned long)(3 * count), sizeof *moved, info->description);
    if (!moved)
        return err->status;
    for (int64_t i = 0; i < 3 * count; i++)
        moved[i] = position[i] + (field ? field[i] : 0) + shift[i % 3];
    sf_h5_write(file, info, SF_H5_F64, 2, dims, moved, err);
    free(moved);
    return err->status;
}

static sf_status write_frame_data(sf_h5 *file, const sf_results *r, const sf_frame_head *head,
                                  const sf_frame *frame, int64_t index, sf_error *err) {
    const double still[3] = {0, 0, 0};
    char path[96];
    snprintf(path, sizeof path, "/frames/%06lld/pad_position", (long long)index);
    sf_h5_info pad = {path, "m", "positions of the pad's nodes, deformed"};
    if (write_positions(file, &pad, r->node_count, r->position, frame->field[SF_FRAME_DISPLACEMENT], still,
                        err))
        return err->status;
    snprintf(path, sizeof path, "/frames/%06lld/missile_position", (long long)index);
    sf_h5_info missile = {path, "m", "positions of the missile's surface nodes"};
    if (write_positions(file, &missile, r->surface_node_count, r->surface_position, NULL,
                        head->missile_displacement, err) != SF_OK)
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

static void put_float_item(FILE *x, int64_t index, const char *name, int64_t rows, int columns) {
    fprintf(x, "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"%lld",
            (long long)rows);
    if (columns > 1)
        fprintf(x, " %d", columns);
    fprintf(x, "\">pad.h5:/frames/%06lld/%s</DataItem>", (long long)index, name);
}

static void put_grid_start(FILE *x, const char *name, double time) {
    fprintf(x, "        <Grid Name=\"%s\" GridType=\"Uniform\">\n          <Time Value=\"%.9g\"/>\n", name,
            time);
}

static void put_pad(FILE *x, const sf_results *r, const sf_frame *frame, double time, int64_t index) {
    put_grid_start(x, "pad", time);
    fprintf(
        x,
        "          <Topology TopologyType=\"Mixed\" NumberOfElements=\"%lld\"><DataItem Format=\"HDF\" "
        "NumberType=\"Int\" Precision=\"4\" Dimensions=\"%lld\">pad.h5:/pad/topology</DataItem></Topology>\n"
        "          <Geometry GeometryType=\"XYZ\">",
        (long long)r->cell_count, (long long)(r->cell_nnz + r->cell_count));
    put_float_item(x, index, "pad_position", r->node_count, 3);
    fputs("</Geometry>\n", x);
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        const sf_frame_field_info *info = sf_frame_field_get((sf_frame_field)f);
        if (!frame->field[f])
            continue;
        fprintf(x, "          <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"Node\">", info->array,
                info->components == 1   ? "Scalar"
                : info->components == 3 ? "Vector"
                                        : "Tensor");
        put_float_item(x, index, info->array, r->node_count, info->components);
        fputs("</Attribute>\n", x);
    }
    fputs("        </Grid>\n", x);
}

static void put_missile(FILE *x, const sf_results *r, double time, int64_t index) {
    if (r->surface_triangle_count == 0)
        return;
    put_grid_start(x, "missile", time);
    fprintf(x,
            "          <Topology TopologyType=\"Triangle\" NumberOfElements=\"%lld\"><DataItem "
            "Format=\"HDF\" NumberType=\"Int\" Precision=\"4\" Dimensions=\"%lld "
            "3\">pad.h5:/missile/triangle</DataItem></Topology>\n"
            "          <Geometry GeometryType=\"XYZ\">",
            (long long)r->surface_triangle_count, (long long)r->surface_triangle_count);
    put_float_item(x, index, "missile_position", r->surface_node_count, 3);
    fputs("</Geometry>\n        </Grid>\n", x);
}

static void put_frame(FILE *x, const sf_results *r, const sf_frame *frame, double time, int64_t index) {
    fprintf(x,
            "      <Grid Name=\"frame_%06lld\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
            "        <Time Value=\"%.9g\"/>\n",
            (long long)index, time);
    put_pad(x, r, frame, time, index);
    put_missile(x, r, time, index);
    fputs("      </Grid>\n", x);
}

/* Every frame to pad.h5 and, as text, to `x`. */
static sf_status write_frames(sf_h5 *file, FILE *x, sf_results *r, int64_t *frames, sf_error *err) {
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
        if (write_frame_data(file, r, &r->frames[k], &frame, *frames, err) == SF_OK)
            put_frame(x, r, &frame, r->frames[k].time, (*frames)++);
        sf_frame_free(&frame);
        if (err->status != SF_OK)
            return err->status;
    }
    if (!moved)
        sf_results_note(r, "the frames hold no displacement: ParaView shows the pad undeformed");
    return SF_OK;
}

static sf_status write_all(sf_h5 **file, FILE *x, sf_results *r, const char *command_line, int64_t *frames,
                           sf_error *err) {
    const sf_provenance provenance = {.program = "softfall-post", .command_line = command_line};
    if (sf_provenance_write(*file, "softfall-paraview", &provenance, err) != SF_OK ||
        write_topology(*file, r, err) != SF_OK)
        return err->status;
    fputs("<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\">\n  "
          "<Domain>\n"
          "    <Grid Name=\"softfall\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
          x);
    if (write_frames(*file, x, r, frames, err) != SF_OK)
        return err->status;
    fputs("    </Grid>\n  </Domain>\n</Xdmf>\n", x);
    return sf_h5_close(file, err);
}

sf_status sf_xdmf_write(const sf_staging *output, sf_results *results, const char *command_line,
                        int64_t *frames, sf_error *err) {
    sf_h5 *file = NULL;
    FILE *text = NULL;
    sf_error ignored = SF_ERROR_INIT;
    *frames = 0;
    char *data = sf_staging_path(output, "pad.h5", err);
    char *xdmf = data ? sf_staging_path(output, "pad.xdmf", err) : NULL;
    if (!xdmf || sf_h5_create(data, &file, err) != SF_OK)
        goto done;
    text = sf_staging_open(output, "pad.xdmf", err);
    if (!text)
        goto done;
    write_all(&file, text, results, command_line, frames, err);
    sf_staging_close(text, "pad.xdmf", err);
done:
    if (file)
        sf_h5_close(&file, err->status == SF_OK ? err : &ignored);
    if (*frames == 0 && xdmf) {
        remove(data);
        remove(xdmf);
    }
    free(data);
    free(xdmf);
    return err->status;
}
