/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/xdmf.h"

#include "io/plain_file.h"
#include "io/replace.h"
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
    fprintf(x->file, "          <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"Node\">", name,
            components == 1   ? "Scalar"
            : components == 3 ? "Vector"
                              : "Tensor");
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
    fputs("</Geometry>\n", x->file);
    for (int k = 0; k < sf_missile_array_count(r); k++)
        put_attribute(x, index, sf_missile_arrays[k].name, r->surface_node_count,
                      sf_missile_arrays[k].components);
    fputs("        </Grid>\n", x->file);
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

static sf_status write_text(const sf_staging *output, const sf_results *r, const sf_shown *shown,
                            const char *data, bool full, sf_error *err) {
    const scene x = {sf_staging_open(output, "pad.xdmf", err), data, full ? 8 : 4};
    if (!x.file)
        return err->status;
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
    if (sf_plain_hash(path, NULL, SF_PLAIN_ANY, &hash, err) != SF_OK)
        return err->status;
    snprintf(data, SF_XDMF_NAME_SIZE, "pad-%016llx.h5", (unsigned long long)hash);
    char *named = sf_staging_path(output, data, err);
    if (named && rename(path, named) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be renamed to %s", path, data);
    free(named);
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
    sf_shown shown = {0};
    char *path = sf_staging_path(output, NEW_DATA, err);
    if (path && sf_shown_find(results, &shown, err) == SF_OK)
        sf_xdmf_write_data(path, results, options, &shown, err);
    if (path && shown.count == 0)
        remove(path);
    else if (err->status == SF_OK && name_data(output, path, data, err) == SF_OK)
        write_text(output, results, &shown, data, options->full, err);
    *made = tell(&shown);
    sf_shown_free(&shown);
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
