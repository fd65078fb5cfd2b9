/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: models in files, and their properties. */
#include "api/api.h"
#include "io/h5_data.h"
#include "model/model_io.h"

/* A text of the provenance that a file may lack. */
static sf_status read_text(const sf_h5 *file, const char *path, char **text, sf_error *err) {
    return sf_h5_exists(file, path) ? sf_h5_read_text(file, path, text, err) : SF_OK;
}

static sf_status read_model(const char *path, softfall_model *m, sf_error *err) {
    SF_OWNED_BY(sf_h5_drop) sf_h5 *file = NULL;
    SF_OWNED char *libraries = NULL;
    if (sf_model_read(path, &m->model, &file, err) == SF_OK &&
        read_text(file, "/provenance/case_text", &m->case_text, err) == SF_OK &&
        read_text(file, "/provenance/parameters", &m->parameters, err) == SF_OK &&
        read_text(file, "/provenance/mesh_hash", &m->mesh_hash, err) == SF_OK &&
        read_text(file, "/provenance/geometry_files", &m->geometry_files, err) == SF_OK)
        read_text(file, "/provenance/libraries", &libraries, err);
    snprintf(m->libraries, sizeof m->libraries, "%s", libraries ? libraries : "");
    return err->status;
}

softfall_status softfall_model_read(const char *path, softfall_model **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    *out = sf_alloc(&err, 1, sizeof **out, "a model");
    if (*out && read_model(path, *out, &err) != SF_OK) {
        softfall_model_free(*out);
        *out = NULL;
    }
    return softfall_return(&err, error);
}

softfall_status softfall_model_write(const softfall_model *m, const char *path, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_provenance provenance = {.program = "libsoftfall",
                                      .libraries = m->libraries,
                                      .case_text = m->case_text,
                                      .parameters = m->parameters,
                                      .mesh_hash = m->mesh_hash,
                                      .geometry_files = m->geometry_files};
    sf_model_write(path, &m->model, &provenance, &err);
    return softfall_return(&err, error);
}

void softfall_model_free(softfall_model *m) {
    if (!m)
        return;
    sf_model_free(&m->model);
    SF_FREE(m->case_text, m->parameters, m->mesh_hash, m->geometry_files, m);
}

softfall_model_info softfall_model_describe(const softfall_model *model) {
    const sf_model *m = &model->model;
    return (softfall_model_info){.node_count = m->node_count,
                                 .symmetry_factor = m->symmetry_factor,
                                 .thickness = m->thickness,
                                 .missile_mass = m->missile.mass,
                                 .missile_speed = m->missile.speed,
                                 .end_time = m->run.end_time,
                                 .has_prescribed_motion = sf_missile_is_driven(m)};
}

const char *softfall_model_geometry_files(const softfall_model *model) {
    return model->geometry_files ? model->geometry_files : "";
}

const double *softfall_model_positions(const softfall_model *m) {
    return m->model.position;
}
