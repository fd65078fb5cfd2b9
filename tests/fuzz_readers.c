/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fuzz_readers.h"
#include "case/curves.h"
#include "case/read.h"
#include "material/laws.h"

#include "material/curve.h"
#include "study/fit/compression/compression_config.h"
#include "io/plain_file.h"
#include "io/replace.h"
#include "model/model_io.h"
#include "post/figures/compare.h"
#include "pre/mesh/geo_parameters.h"
#include "pre/mesh/gmsh_session.h"
#include <ftw.h>
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[256];

static const char *in_folder(const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* ---- the readers ---- */

/* As the solver does with every model. */
static void build_law(const sf_material *material) {
    sf_material_law law;
    sf_error flat = SF_ERROR_INIT;
    if (material->law && sf_material_law_build(material, &law, &flat) == SF_OK)
        sf_material_law_free(&law);
}

static sf_status read_case(const char *path, sf_error *err) {
    sf_case c;
    if (sf_case_read(path, 0, NULL, NULL, &c, err) != SF_OK)
        return err->status;
    build_law(&c.material);
    for (int k = 0; k < c.layer_count; k++)
        build_law(&c.layer[k]);
    sf_case_free(&c);
    return SF_OK;
}

static sf_status read_curve(const char *path, sf_error *err) {
    sf_case_curve curve;
    if (sf_case_curve_read(path, &curve, err) == SF_OK)
        sf_case_curve_free(&curve);
    return err->status;
}

static sf_status read_motion(const char *path, sf_error *err) {
    char case_path[512], override[600];
    const char *const overrides[] = {override};
    sf_case c;
    snprintf(case_path, sizeof case_path, "%s", in_folder("driven.cfg"));
    snprintf(override, sizeof override, "missile.motion=%s", path);
    if (sf_case_read(case_path, 1, overrides, NULL, &c, err) == SF_OK)
        sf_case_free(&c);
    return err->status;
}

static sf_status read_reference(const char *path, sf_error *err) {
    sf_reference_options options = {
        .path = path, .column_option = "x", .filter_option = "y=", .invert_option = "z", .zero_option = "u"};
    sf_reference reference;
    sf_error coarse = SF_ERROR_INIT;
    double instant;
    if (sf_reference_read(&options, &reference, err) != SF_OK)
        return err->status;
    sf_contact_instant(&reference.curve, path, 0, &instant, err);
    sf_reference_free(&reference);
    options.cfc = 60;
    if (sf_reference_read(&options, &reference, &coarse) == SF_OK)
        sf_reference_free(&reference);
    return err->status;
}

static sf_status read_compression(const char *path, sf_error *err) {
    sf_compression_config config;
    if (sf_compression_config_read(path, &config, err) == SF_OK)
        sf_compression_config_free(&config);
    return err->status;
}

static sf_status read_pressing(const char *path, sf_error *err) {
    sf_compression_test test;
    const sf_compression_source source = {
        .path = path, .rate = 0.1, .area = 25e-4, .thickness = 0.05, .toe = true};
    if (sf_compression_test_read(&source, &test, err) == SF_OK)
        sf_compression_test_free(&test);
    return err->status;
}

/* The names of a script's parameters. */
static sf_status read_geo(const char *path, sf_error *err) {
    char copy[512];
    sf_geo_source source = {.path = copy, .parameter_count = 1, .parameter = {{"side", 1}}};
    sf_broker_file file = {.path = copy, .is_text = true};
    const sf_broker read = {.count = 1, .file = &file};
    snprintf(copy, sizeof copy, "%s", path);
    if (sf_plain_read(path, "geometry", SF_PLAIN_ANY, &file.text, &file.size, err) == SF_OK)
        sf_geo_parameters_check(&source, &read, true, err);
    free(file.text);
    return err->status;
}

/* What a confined process sends as a mesh. */
static sf_status read_stream(const char *path, sf_error *err) {
    char *data = NULL;
    size_t size = 0;
    sf_geo_data mesh = {0};
    if (sf_plain_read(path, "mesh stream", SF_PLAIN_ANY, &data, &size, err) == SF_OK &&
        sf_geo_data_read(data, size, path, &mesh, err) == SF_OK) {
        size_t end;
        sf_geo_data_blocks(&mesh, 3, 1, &end);
    }
    sf_geo_data_free(&mesh);
    free(data);
    return err->status;
}

static sf_status read_model(const char *path, sf_error *err) {
    sf_model model;
    if (sf_model_read(path, &model, NULL, err) == SF_OK)
        sf_model_free(&model);
    return err->status;
}

static sf_status read_results(const char *path, sf_error *err) {
    sf_results results;
    sf_frame frame;
    sf_figures figures;
    sf_seal_add(path, SF_IGNORED); /* else nothing behind the check of the seal would be read */
    if (sf_results_open(path, &results, err) != SF_OK)
        return err->status;
    if (results.has_peak && sf_frame_read(&results, &results.peak, SF_FIELD_ALL, &frame, err) == SF_OK)
        sf_frame_free(&frame);
    for (int64_t k = 0; k < results.frame_count && err->status == SF_OK; k++)
        if (sf_frame_read(&results, &results.frames[k], SF_FIELD_ALL, &frame, err) == SF_OK)
            sf_frame_free(&frame);
    if (err->status == SF_OK && sf_figures_compute(&results, 1000, &figures, err) == SF_OK)
        sf_figures_free(&figures);
    sf_results_close(&results);
    return err->status;
}

static sf_status read_msh(const char *path, sf_error *err) {
    char copy[512];
    sf_geo_source source = {.path = copy};
    sf_gmsh *session = NULL;
    sf_mesh mesh = {0};
    sf_surface surface = {0};
    double volume;
    snprintf(copy, sizeof copy, "%s", path);
    if (sf_gmsh_begin(&session, err) == SF_OK && sf_gmsh_load(session, &source, err) == SF_OK &&
        sf_gmsh_read_mesh(session, "pad", 1e-3, &mesh, err) == SF_OK &&
        sf_gmsh_read_surface(session, "top", 1e-3, &surface, err) == SF_OK)
        sf_mesh_check(&mesh, &volume, err);
    sf_surface_free(&surface);
    sf_mesh_free(&mesh);
    sf_gmsh_end(&session);
    return err->status;
}

/* A batch, and the same text as what became of its first group. */
static const fuzz_reader readers[] = {
    {"case", "case.cfg", read_case},
    {"curve", "curve.csv", read_curve},
    {"motion", "fuzz.csv", read_motion},
    {"reference", "reference.csv", read_reference},
    {"model", "model.h5", read_model},
    {"results", "results.h5", read_results},
    {"msh", "mesh.msh", read_msh},
    {"geo", "script.geo", read_geo},
    {"stream", "mesh.stream", read_stream},
    {"compression", "fit.cfg", read_compression},
    {"pressing", "pressing.csv", read_pressing},
};

const fuzz_reader *fuzz_reader_at(int index) {
    return index < (int)(sizeof readers / sizeof readers[0]) ? &readers[index] : NULL;
}

const fuzz_reader *fuzz_reader_find(const char *name) {
    for (int k = 0; fuzz_reader_at(k); k++)
        if (strcmp(readers[k].name, name) == 0)
            return &readers[k];
    return NULL;
}

/* ---- the scratch folder ---- */

static void fail(const char *what) {
    fprintf(stderr, "fuzz: %s: ", what);
    perror(folder);
    abort();
}

static void write_file(const char *name, const void *data, size_t size) {
    FILE *file = fopen(in_folder(name), "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        fail(name);
}

#define MATERIAL                                                                                             \
    "density = \"35 kg/m3\"; E = \"0.4 MPa\"; curve = \"foam.csv\"; ED = \"1 MPa\"; BETA1 = \"5000 1/s\";\n"
#define PRESSING                                                                                             \
    "strain,stress_kPa\n"                                                                                    \
    "0.04,20\n0.07,40\n0.11,60\n0.14,80\n0.18,100\n0.21,120\n0.25,140\n0.28,160\n0.32,180\n0.35,200\n0.39,"  \
    "220\n0.42,240\n0.46,260\n0.49,280\n0.53,300\n0.56,320\n0.60,340\n0.63,360\n0.67,380\n0.70,400\n0.74,"   \
    "420\n0.77,440\n"
#define QUICK                                                                                                \
    "strain,stress_kPa\n"                                                                                    \
    "0.04,30\n0.07,60\n0.11,90\n0.14,120\n0.18,150\n0.21,180\n0.25,210\n0.28,240\n0.32,270\n0.35,300\n0.39,330\n0.42,360\n0.46,390\n0.49,420\n0.53,450\n0.56,480\n0.60,510\n0.63,540\n0.67,570\n0.70,600\n0.74,630\n0.77,660\n"
#define GEOMETRY                                                                                             \
    "geometry: { file = \"pad.geo\"; length_unit = \"mm\"; };\nsolver: { end_time = \"1 ms\"; };\n"

void fuzz_begin(void) {
    static const char *const files[][2] = {
        {"pad.geo", "DefineConstant[ side = 1, quarter = 0 ];\n"},
        {"foam.csv", "strain,stress_kPa\n0,0\n0.1,20\n0.5,100\n0.8,900\n"},
        {"motion.csv", "time_ms,displacement_mm\n0,0\n50,10\n"},
        {"measured.csv",
         "time_ms,acceleration_g\n0,0\n0.5,0\n1,0\n1.5,0\n2,0\n2.5,7.84\n3,15.6\n3.5,23.2\n4,30.6\n4.5,37.7\n5,44.4\n5.5,50.8\n6,56.6\n6.5,61.8\n7,66.5\n7.5,70.6\n8,73.9\n8.5,76.6\n9,78.5\n9.5,79.6\n10,80\n10.5,79.6\n11,78.5\n11.5,76.6\n12,73.9\n12.5,70.6\n13,66.5\n13.5,61.8\n14,56.6\n14.5,50.8\n15,44.4\n15.5,37.7\n16,30.6\n16.5,23.2\n17,15.6\n17.5,7.84\n18,9.8e-15\n18.5,9.8e-15\n19,9.8e-15\n19.5,9.8e-15\n20,9.8e-15\n20.5,9.8e-15\n21,9.8e-15\n21.5,9.8e-15\n22,9.8e-15\n"},
        {"pressing.csv", PRESSING},
        {"quick.csv", QUICK},
        {"material.cfg", MATERIAL},
        {"good.cfg",
         GEOMETRY "material: { " MATERIAL "};\nmissile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\n"},
        {"driven.cfg", GEOMETRY "material: { " MATERIAL "};\n"},
    };
    const char *root = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/softfall-fuzz-XXXXXX", root && *root ? root : "/tmp");
    if (!mkdtemp(folder))
        fail("no scratch folder");
    for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
        write_file(files[k][0], files[k][1], strlen(files[k][1]));
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *place) {
    (void)info;
    (void)kind;
    (void)place;
    return remove(path);
}

void fuzz_end(void) {
    nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

sf_status fuzz_read(const fuzz_reader *reader, const uint8_t *data, size_t size) {
    char path[512];
    sf_error err = SF_ERROR_INIT;
    write_file(reader->file, data, size);
    snprintf(path, sizeof path, "%s", in_folder(reader->file));
    sf_status status = reader->read(path, &err);
    if (status != err.status || (status != SF_OK && err.text[0] == '\0') || strchr(err.text, '\n')) {
        fprintf(stderr, "fuzz: status %d with the sentence \"%s\"\n", (int)status, err.text);
        abort();
    }
    if (H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL) > 0) {
        fprintf(stderr, "fuzz: HDF5 objects were left open\n");
        abort();
    }
    return status;
}
