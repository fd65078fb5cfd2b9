/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Same input, same bits: threads, repeated runs, builds, units, mesh. And a quarter against the whole. */
#include "extreme.h"
#include "drop.h"
#include "io/h5_data.h"
#include "study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The hash of the mesh of the coarse quarter of the 50 mm pad, by version of gmsh: each makes a mesh of its
 * own, but always the same with one thread. */
static const struct {
    const char *gmsh, *hash;
} mesh_pins[] = {{"gmsh 4.8.4,", "e9dd79af3d3856be"}, {"gmsh 4.13.1,", "33269c125b003340"}};
static const char *const coarse[] = {"geometry.parameters.fine_spacing=10",
                                     "geometry.parameters.outer_spacing=20", NULL};

static void *read_all(const sf_h5 *file, const char *path, int rank, int64_t *count, sf_error *err) {
    int64_t dims[2] = {-1, -1};
    void *data = NULL;
    sf_h5_read(file, path, SF_H5_F64, rank, dims, &data, err);
    *count = rank == 1 ? dims[0] : dims[0] * dims[1];
    return data;
}

/* Largest |a - b| / largest |a| of one dataset in two files; 0 only if every bit is the same, infinite if the
 * shapes differ. */
static double difference(const sf_h5 *a, const sf_h5 *b, const char *path, int rank, sf_error *err) {
    int64_t na = 0, nb = 0;
    double *x = read_all(a, path, rank, &na, err), *y = read_all(b, path, rank, &nb, err), worst = 0,
           size = 0;
    if (err->status == SF_OK && na != nb)
        worst = INFINITY;
    for (int64_t i = 0; err->status == SF_OK && na == nb && i < na; i++) {
        worst = larger(worst, fabs(x[i] - y[i]));
        size = larger(size, fabs(x[i]));
    }
    if (err->status == SF_OK && na == nb && worst == 0 && memcmp(x, y, (size_t)na * sizeof *x) != 0)
        worst = 1e-300; /* zeros of different sign */
    free(x);
    free(y);
    return isfinite(worst) && size > 0 ? worst / size : worst;
}

/* Compares the acceleration, the indentation and the displacements at the peak of two results. */
static double compare(const char *first, const char *second, sf_error *err) {
    sf_h5 *a = NULL, *b = NULL;
    double worst = 0;
    if (sf_h5_open(first, &a, err) == SF_OK && sf_h5_open(second, &b, err) == SF_OK) {
        worst = larger(worst, difference(a, b, "/history/acceleration", 1, err));
        worst = larger(worst, difference(a, b, "/history/indentation", 1, err));
        worst = larger(worst, difference(a, b, "/peak/displacement", 2, err));
        worst = larger(worst, difference(a, b, "/peak/cauchy_stress", 2, err));
    }
    sf_h5_close(&a, err);
    sf_h5_close(&b, err);
    return err->status == SF_OK ? worst : INFINITY;
}

/* Runs the coarse drop with further overrides and compares with the first run's file. */
static void check_run(sf_study *study, const char *folder, const char *const *more, int threads, double bound,
                      const char *what) {
    const char *overrides[16];
    char path[600], first[600];
    int used = 0;
    sf_drop drop;
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; coarse[k]; k++)
        overrides[used++] = coarse[k];
    for (int k = 0; more && more[k]; k++)
        overrides[used++] = more[k];
    overrides[used] = NULL;
    snprintf(first, sizeof first, "%s/first.h5", folder);
    snprintf(path, sizeof path, "%s/other.h5", folder);
    double worst = INFINITY;
    if (sf_drop_run("eva50-v4.5", overrides, threads, path, &drop, &err) == SF_OK)
        worst = compare(first, path, &err);
    unlink(path);
    if (err.status != SF_OK)
        sf_study_fail(study, &err);
    else
        sf_study_check(study, worst, -INFINITY, bound, "%s", what);
}

/* The full pad at 5 mm: only large models share their small loops among threads (base/lanes.h). */
static void check_large_model(sf_study *study, const char *folder) {
    static const char *const overrides[] = {"solver.end_time=\"1.5 ms\"", NULL};
    char path[2][600];
    sf_drop drop;
    sf_error err = SF_ERROR_INIT;
    double worst = INFINITY;
    for (int k = 0; k < 2; k++) {
        snprintf(path[k], sizeof path[k], "%s/large%d.h5", folder, k);
        if (err.status == SF_OK)
            sf_drop_run("eva50-v4.5-full", overrides, k ? 3 : 1, path[k], &drop, &err);
    }
    if (err.status == SF_OK)
        worst = compare(path[0], path[1], &err);
    unlink(path[0]);
    unlink(path[1]);
    if (err.status != SF_OK)
        sf_study_fail(study, &err);
    else
        sf_study_check(study, worst, -INFINITY, 0, "full pad at 5 mm, 1.5 ms: 3 threads against one");
}

/* The mesh of the pad as a .msh file, its coordinates in mm times `scale`. */
static sf_status write_mesh(const char *folder, const char *name, double scale, sf_error *err) {
    char command[2048];
    snprintf(command, sizeof command,
             "gmsh -3 -nt 1 -setnumber fine_spacing 10 -setnumber outer_spacing 20 -setnumber quarter 1 "
             "-setnumber "
             "Mesh.ScalingFactor %g -setnumber Mesh.MshFileVersion 4.1 '%s/geo/pad.geo' -o '%s/%s' > "
             "/dev/null 2>&1",
             scale, getenv("SF_SOURCE_DIR"), folder, name);
    if (system(command) != 0)
        return SF_FAIL(err, SF_ERR_LIBRARY, "gmsh cannot write %s", name);
    return SF_OK;
}

/* The same mesh file in millimetres and in centimetres: gmsh's own meshing is not independent of the unit. */
static void check_length_unit(sf_study *study, const char *folder) {
    char file[2][700], path[2][600];
    double worst = INFINITY;
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < 2 && err.status == SF_OK; k++) {
        sf_drop drop;
        const char *name = k ? "cm.msh" : "mm.msh";
        snprintf(file[k], sizeof file[k], "geometry.file=%s/%s", folder, name);
        snprintf(path[k], sizeof path[k], "%s/%s.h5", folder, name);
        const char *const overrides[] = {
            file[k], "geometry.parameters={}", k ? "geometry.length_unit=cm" : "geometry.length_unit=mm",
            k ? "geometry.missile_parameters={ diameter = 16.0; element_size = 1.0; quarter = 1; }"
              : "geometry.missile_parameters={ diameter = 160.0; element_size = 10.0; quarter = 1; }",
            NULL};
        if (write_mesh(folder, name, k ? 0.1 : 1, &err) == SF_OK)
            sf_drop_run("eva50-v4.5", overrides, 1, path[k], &drop, &err);
    }
    if (err.status == SF_OK)
        worst = compare(path[0], path[1], &err);
    for (int k = 0; k < 2; k++) {
        unlink(strchr(file[k], '/'));
        unlink(path[k]);
    }
    if (err.status != SF_OK)
        sf_study_fail(study, &err);
    else
        sf_study_check(study, worst, -INFINITY, 1e-12, "the geometry in centimetres");
}

static void check_mesh_hash(sf_study *study, const char *results) {
    sf_h5 *file = NULL;
    sf_error err = SF_ERROR_INIT;
    char *text = NULL, *libraries = NULL;
    const char *pinned = NULL;
    if (sf_h5_open(results, &file, &err) == SF_OK &&
        sf_h5_read_text(file, "/provenance/model/libraries", &libraries, &err) == SF_OK)
        sf_h5_read_text(file, "/provenance/model/mesh_hash", &text, &err);
    sf_h5_close(&file, &err);
    for (size_t k = 0; libraries && k < sizeof mesh_pins / sizeof mesh_pins[0]; k++)
        if (strncmp(libraries, mesh_pins[k].gmsh, strlen(mesh_pins[k].gmsh)) == 0)
            pinned = mesh_pins[k].hash;
    if (err.status != SF_OK)
        sf_study_fail(study, &err);
    else if (pinned)
        sf_study_check(study, strcmp(text, pinned) != 0, -INFINITY, 0,
                       "mesh hash %s differs from the one pinned for this gmsh, %s (1 = yes)", text, pinned);
    else
        sf_study_text(study, "No mesh hash is pinned for %s; this mesh has %s.", libraries, text);
    free(text);
    free(libraries);
}

/* The whole pad has a mesh of its own: no bits to compare, only the figures. */
static void check_full_model(sf_study *study, const sf_drop *quarter) {
    static const char *const full[] = {
        "geometry.parameters.fine_spacing=10", "geometry.parameters.outer_spacing=20",
        "geometry.parameters.quarter=0", "geometry.missile_parameters.quarter=0", NULL};
    sf_drop drop;
    sf_error err = SF_ERROR_INIT;
    if (sf_drop_run("eva50-v4.5", full, 1, NULL, &drop, &err) != SF_OK) {
        sf_study_fail(study, &err);
        return;
    }
    sf_study_check(study, fabs(drop.a_max_g / quarter->a_max_g - 1), -INFINITY, 0.005,
                   "full model (%.0f nodes) instead of the quarter (%.0f): a_max", drop.nodes,
                   quarter->nodes);
    sf_study_check(study, fabs(drop.hic / quarter->hic - 1), -INFINITY, 0.005, "the same: HIC");
}

/* The programs of another build, if there are any (tools/verification.sh names the folder). */
static void check_debug_build(sf_study *study, const char *folder) {
    const char *release = getenv("SF_BIN_DIR"), *debug = getenv("SF_DEBUG_BIN_DIR");
    char kept[1024];
    if (!release || !debug) {
        sf_study_text(study, "\nNot compared with a Debug build: there is none "
                             "(`cmake --preset debug && cmake --build build-debug`).\n\n");
        return;
    }
    snprintf(kept, sizeof kept, "%s", release);
    setenv("SF_BIN_DIR", debug, 1);
    check_run(study, folder, NULL, 1, 0, "Debug instead of Release build");
    setenv("SF_BIN_DIR", kept, 1);
}

int main(int argc, char **argv) {
    static const char *const units[] = {"missile.mass=4600 g",          "missile.velocity=450 cm/s",
                                        "material.density=0.035 g/cm3", "material.E=413.6 kPa",
                                        "material.ED=34.3 bar",         "solver.end_time=0.04 s",
                                        "solver.step_limit=0.05 ms",    NULL};
    sf_study study;
    sf_error err = SF_ERROR_INIT;
    sf_drop drop;
    char folder[] = "/tmp/softfall-study-XXXXXX", first[600];
    sf_study_begin(&study, "reproducibility", "Reproducibility", argc, argv);
    sf_study_text(
        &study,
        "The 50 mm, 4.5 m/s drop at 10 mm core spacing, with one change at a time: largest difference of "
        "acceleration and indentation over time, and of every node's displacement and Cauchy stress at the "
        "peak, from the first run (Release, one thread, quarter of the pad), relative to the largest "
        "value. 0 means the same bits. The full model has different nodes, so only a_max and HIC are "
        "compared.\n\n");
    if (!mkdtemp(folder)) {
        SF_FAIL(&err, SF_ERR_IO, "no temporary folder");
        sf_study_fail(&study, &err);
        return sf_study_end(&study);
    }
    snprintf(first, sizeof first, "%s/first.h5", folder);
    if (sf_drop_run("eva50-v4.5", coarse, 1, first, &drop, &err) != SF_OK) {
        sf_study_fail(&study, &err);
    } else {
        check_run(&study, folder, NULL, 1, 0, "the same again");
        check_run(&study, folder, NULL, 2, 0, "2 threads");
        check_run(&study, folder, NULL, 3, 0, "3 threads");
        check_run(&study, folder, NULL, 4, 0, "4 threads");
        check_large_model(&study, folder);
        check_debug_build(&study, folder);
        check_run(&study, folder, units, 1, 1e-12, "mass, speed, density, moduli and times in other units");
        check_length_unit(&study, folder);
        check_mesh_hash(&study, first);
        check_full_model(&study, &drop);
    }
    sf_study_text(
        &study,
        "\nBuilds agree because `-ffp-contract=off` prevents fused multiplications and additions, and no compiler "
        "option reorders sums. The Debug build runs its small loops on several threads, too (base/lanes.h).\n");
    unlink(first);
    rmdir(folder);
    return sf_study_end(&study);
}
