/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: cases, and models made of them. */
#include "api/api_material.h"
#include "base/hash.h"
#include "case/read.h"
#include "io/h5_data.h"
#include "io/plain_file.h"
#include "pre/make.h"
#include "pre/mesh/mesh_store.h"

#include <limits.h>

struct softfall_case {
    sf_case data;
    bool used_up; /* by softfall_model_build */
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

softfall_status softfall_case_read(const char *path, const char *const *overrides, int count,
                                   const softfall_sink *sink, softfall_case **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    softfall_sink copy;
    const sf_sink inner = listen(sink, &copy);
    *out = sf_alloc(&err, 1, sizeof **out, "a case");
    if (*out && sf_case_read(path, count, overrides, &inner, &(*out)->data, &err) != SF_OK) {
        free(*out);
        *out = NULL;
    }
    return softfall_return(&err, error);
}

void softfall_case_free(softfall_case *c) {
    if (c)
        sf_case_free(&c->data);
    free(c);
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

int softfall_case_has_geometry_of(const softfall_case *c, const char *results) {
    char folder[SF_GEOMETRIES][PATH_MAX] = {{0}};
    const char *folders[SF_GEOMETRIES];
    SF_OWNED_BY(sf_h5_drop) sf_h5 *file = NULL;
    SF_OWNED char *files = NULL;
    for (int k = 0; k < SF_GEOMETRIES; k++) {
        const char *path = sf_case_geometry(&c->data, k)->path;
        int length = path ? (int)sf_path_folder_length(path) : 0;
        if (path)
            snprintf(folder[k], PATH_MAX, "%.*s", length ? length : 1, length ? path : ".");
        folders[k] = folder[k];
    }
    return sf_h5_open(results, &file, SF_IGNORED) == SF_OK &&
           sf_h5_read_text(file, "/provenance/model/geometry_files", &files, SF_IGNORED) == SF_OK &&
           sf_geometry_files_are_same(folders, files);
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
        if (sf_model_make(&c->data, &m->model, &report, m->libraries, NULL, &inner, &err) == SF_OK)
            keep_texts(c, &report, m, &err);
        m->kernel = (sf_kernel){c->data.support_ratio, c->data.condition_limit};
    }
    if (err.status == SF_OK)
        *out = m;
    else
        softfall_model_free(m);
    return softfall_return(&err, error);
}
