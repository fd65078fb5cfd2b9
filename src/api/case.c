/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: cases, and models made of them. */
#include "accuracy/section_drop.h"
#include "api/material.h"
#include "base/hash.h"
#include "base/units.h"
#include "case/read.h"
#include "io/folder.h"
#include "io/h5_data.h"
#include "io/plain_file.h"
#include "pre/make.h"
#include "pre/mesh/geo_parameters.h"
#include "pre/mesh/mesh_store.h"

#include <limits.h>

struct softfall_case {
    sf_case data;
    char *store;        /* folder of meshes, NULL: none; owned */
    int override_count; /* kept for sections, which read the case once more */
    char **overrides;   /* [override_count] owned */
    bool section;       /* softfall_model_build runs the drops of the section */
    bool used_up;       /* by softfall_model_build */
};

static void tell(void *user, sf_severity severity, const char *sentence) {
    const softfall_sink *sink = user;
    if (severity != SF_FACT)
        sink->tell(sink->user, severity == SF_WARNING ? SOFTFALL_WARNING : SOFTFALL_NOTE, sentence);
}

/* The result refers to `copy`. */
static sf_sink listen(const softfall_sink *sink, softfall_sink *copy) {
    *copy = sink ? *sink : (softfall_sink){0};
    return (sf_sink){copy->tell ? tell : NULL, copy};
}

/* Reads the case and keeps what it was read of. */
static sf_status read_case(const sf_case_input *input, const sf_sink *sink, softfall_case **out,
                           sf_error *err) {
    softfall_case *c = *out = sf_alloc(err, 1, sizeof *c, "a case");
    SF_TRY(err->status);
    if (sf_case_read_values(input, sink, NULL, &c->data, err) != SF_OK) {
        free(c);
        *out = NULL;
        return err->status;
    }
    c->overrides = sf_alloc(err, input->count, sizeof *c->overrides, "the values of a case");
    for (; c->overrides && c->override_count < input->count && err->status == SF_OK; c->override_count++)
        if (!(c->overrides[c->override_count] = strdup(input->overrides[c->override_count])))
            SF_NO_MEMORY(err, "the values of a case");
    if (err->status != SF_OK) {
        softfall_case_free(c);
        *out = NULL;
    }
    return err->status;
}

softfall_status softfall_case_read(const char *path, const char *const *overrides, int count,
                                   const softfall_sink *sink, softfall_case **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    softfall_sink copy;
    const sf_sink inner = listen(sink, &copy);
    read_case(&(sf_case_input){path, 1, count, overrides}, &inner, out, &err);
    return softfall_return(&err, error);
}

softfall_status softfall_case_read_drop(const char *path, int drop, const char *const *overrides, int count,
                                        const softfall_sink *sink, softfall_case **out,
                                        softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    softfall_sink copy;
    const sf_sink inner = listen(sink, &copy);
    if (read_case(&(sf_case_input){path, drop, count, overrides}, &inner, out, &err) == SF_OK)
        (*out)->data.drops = 1;
    return softfall_return(&err, error);
}

void softfall_case_free(softfall_case *c) {
    if (!c)
        return;
    sf_case_free(&c->data);
    sf_free_all((size_t)c->override_count, c->overrides);
    SF_FREE(c->overrides, c->store, c);
}

softfall_case_drop softfall_case_drop_get(const softfall_case *c, int drop) {
    const sf_case *data = &c->data;
    const bool single = data->drops <= 1;
    if (single || drop < 1 || drop > data->drops)
        return (softfall_case_drop){.drops = single ? 1 : (int)data->drops, .counted = single};
    return (softfall_case_drop){(int)data->drops, data->counted >> (drop - 1) & 1, data->drop[drop - 1].own,
                                data->drop[drop - 1].interval};
}

double softfall_case_data_end(const softfall_case *c, int layer) {
    const sf_case *data = &c->data;
    if (layer < 0 || layer >= (data->layer_count > 0 ? data->layer_count : 1))
        return NAN;
    const sf_material *material = data->layer_count > 0 ? &data->layer[layer] : &data->material;
    return material->law->data_end(material->card);
}

softfall_status softfall_case_check(const softfall_case *c, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < SF_GEOMETRIES && err.status == SF_OK; k++)
        sf_geo_parameters_check(sf_case_geometry(&c->data, k), NULL, false, &err);
    if (err.status == SF_OK)
        sf_case_check_memory(&c->data, &err);
    return softfall_return(&err, error);
}

softfall_status softfall_case_set_build(softfall_case *c, const char *share, int section,
                                        softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    share = sf_store_folder(share);
    free(c->store);
    c->store = share ? strdup(share) : NULL;
    c->data.store = c->store;
    c->section = section != 0;
    if (share && !c->store)
        SF_NO_MEMORY(&err, "the folder %s", share);
    return softfall_return(&err, error);
}

softfall_status softfall_units_hold(softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_units_hold(&err);
    return softfall_return(&err, error);
}

const char *softfall_case_parameters(const softfall_case *c) {
    return c->data.parameters;
}

softfall_status softfall_case_hash(const softfall_case *c, uint64_t *hash, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    *hash = sf_case_hash(&c->data);
    for (int k = 0; k < SF_GEOMETRIES && err.status == SF_OK; k++) {
        const char *path = sf_case_geometry(&c->data, k)->path;
        uint64_t content = 0;
        if (path && sf_plain_hash_kept(path, &content, &err) == SF_OK)
            *hash = sf_hash_bytes(*hash, &content, sizeof content);
    }
    return softfall_return(&err, error);
}

softfall_status softfall_case_material(const softfall_case *c, softfall_material **out,
                                       softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    softfall_material *m = NULL;
    *out = NULL;
    if (c->used_up)
        SF_REFUSE(&err, "the case %s has been built already: read it again", c->data.path);
    else if (c->data.layer_count > 0)
        SF_REFUSE(&err, "the case %s has a pad of layers: it is not of one material", c->data.path);
    else if ((m = sf_alloc(&err, 1, sizeof *m, "a material")) &&
             sf_material_copy(&c->data.material, &m->data, &err) == SF_OK &&
             !(m->parameters = strdup(c->data.parameters)))
        SF_NO_MEMORY(&err, "the values of a case");
    if (err.status == SF_OK)
        *out = m;
    else
        softfall_material_free(m);
    return softfall_return(&err, error);
}

int softfall_case_has_files(const softfall_case *c, const char *files) {
    char folder[SF_GEOMETRIES][PATH_MAX] = {{0}};
    const char *folders[SF_GEOMETRIES];
    for (int k = 0; k < SF_GEOMETRIES; k++) {
        const char *path = sf_case_geometry(&c->data, k)->path;
        int length = path ? (int)sf_path_folder_length(path) : 0;
        if (path)
            snprintf(folder[k], PATH_MAX, "%.*s", length ? length : 1, length ? path : ".");
        folders[k] = folder[k];
    }
    return sf_geometry_files_are_same(folders, files);
}

int softfall_case_has_geometry_of(const softfall_case *c, const char *results) {
    SF_OWNED_BY(sf_h5_drop) sf_h5 *file = NULL;
    SF_OWNED char *files = NULL;
    return sf_h5_open(results, &file, SF_IGNORED) == SF_OK &&
           sf_h5_read_text(file, "/provenance/model/geometry_files", &files, SF_IGNORED) == SF_OK &&
           softfall_case_has_files(c, files);
}

/* The provenance in the model's file. */
static void keep_texts(softfall_case *c, const sf_build_report *report, softfall_model *m, sf_error *err) {
    m->case_text = strdup(c->data.text);
    m->parameters = strdup(c->data.parameters);
    m->mesh_hash = strdup(report->mesh_hash);
    m->geometry_files = strdup(c->data.geometry_files);
    if (!m->case_text || !m->parameters || !m->mesh_hash || !m->geometry_files)
        SF_NO_MEMORY(err, "the texts of the case");
}

softfall_status softfall_model_build(softfall_case *c, const softfall_sink *sink, softfall_model **out,
                                     softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_build_report report;
    SF_OWNED_BY(sf_sections_free) sf_sections sections = {0};
    softfall_sink copy;
    const sf_sink inner = listen(sink, &copy);
    *out = NULL;
    if (c->used_up) {
        SF_REFUSE(&err, "the case %s has been built already: read it again", c->data.path);
        return softfall_return(&err, error);
    }
    softfall_model *m = sf_alloc(&err, 1, sizeof *m, "a model");
    if (m) {
        c->used_up = true;
        if (sf_model_make(&c->data, &m->model, &report, m->libraries, c->section ? &sections : NULL, &inner,
                          &err) == SF_OK) {
            const sf_case_input again = {c->data.path, 1, c->override_count,
                                         (const char *const *)c->overrides};
            sf_section_drop_refer(&again, &report, &sections, &m->model, &inner);
            keep_texts(c, &report, m, &err);
        }
        m->kernel = (sf_kernel){c->data.support_ratio, c->data.condition_limit};
    }
    if (err.status == SF_OK)
        *out = m;
    else
        softfall_model_free(m);
    return softfall_return(&err, error);
}
