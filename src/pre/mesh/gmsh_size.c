/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/gmsh_size.h"

#include "pre/mesh/memory.h"
#include <errno.h>
#include <gmshc.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TRIAL_SECONDS = 60 };

/* Of softfall-pre at its peak, per node of the mesh: measured on the example pad (docs/reliability.md). */
static const double BYTES_PER_NODE = 4500;

typedef struct estimate {
    double nodes;
    double spacing; /* smallest mean spacing of a volume's curves, in the geometry's unit */
} estimate;

/* Volume and diagonal of an entity's box. */
static double measure_box(int dimension, int tag, double *diagonal) {
    double low[3], high[3], volume = 1;
    int ierr = 0;
    *diagonal = 0;
    gmshModelGetBoundingBox(dimension, tag, &low[0], &low[1], &low[2], &high[0], &high[1], &high[2], &ierr);
    for (int c = 0; c < 3 && ierr == 0; c++) {
        volume *= high[c] - low[c];
        *diagonal = hypot(*diagonal, high[c] - low[c]);
    }
    return ierr == 0 ? volume : 0;
}

/* Cells of a meshed curve. */
static double count_cells(int curve) {
    size_t *tags = NULL, count = 0, coordinates = 0, parameters = 0;
    double *xyz = NULL, *parameter = NULL;
    int ierr = 0;
    gmshModelMeshGetNodes(&tags, &count, &xyz, &coordinates, &parameter, &parameters, 1, curve, 0, 0, &ierr);
    gmshFree(tags);
    gmshFree(xyz);
    gmshFree(parameter);
    return (double)count + 1;
}

/* Mean spacing on all curves of the volume. */
static double mean_spacing(int volume) {
    int pair[2] = {3, volume}, *faces = NULL, *curves = NULL, ierr = 0;
    size_t face_length = 0, curve_length = 0;
    double length = 0, cells = 0, diagonal;
    gmshModelGetBoundary(pair, 2, &faces, &face_length, 0, 0, 0, &ierr);
    gmshModelGetBoundary(faces, face_length, &curves, &curve_length, 0, 0, 0, &ierr);
    for (size_t k = 0; k < curve_length / 2; k++) {
        measure_box(1, curves[2 * k + 1], &diagonal);
        length += diagonal;
        cells += count_cells(curves[2 * k + 1]);
    }
    gmshFree(faces);
    gmshFree(curves);
    return cells > 0 && length > 0 ? length / cells : INFINITY;
}

static estimate estimate_mesh(void) {
    estimate e = {0, INFINITY};
    int *volumes = NULL, ierr = 0;
    size_t length = 0;
    gmshModelMeshGenerate(1, &ierr);
    gmshModelGetEntities(&volumes, &length, 3, &ierr);
    for (size_t k = 0; k < length / 2; k++) {
        double diagonal, volume = measure_box(3, volumes[2 * k + 1], &diagonal),
                         h = mean_spacing(volumes[2 * k + 1]);
        e.nodes += volume / (h * h * h);
        e.spacing = fmin(e.spacing, h);
    }
    gmshFree(volumes);
    return e;
}

/* In the child: nothing of it comes back but the figures. */
static void report_estimate(int channel) {
    const struct rlimit seconds = {TRIAL_SECONDS, TRIAL_SECONDS}, no_core = {0, 0};
    setrlimit(RLIMIT_CPU, &seconds);
    setrlimit(RLIMIT_CORE, &no_core);
    sf_memory_limit_process();
    estimate e = estimate_mesh();
    _exit(write(channel, &e, sizeof e) != (ssize_t)sizeof e);
}

sf_status sf_gmsh_check_size(const char *file, sf_error *err) {
    double available = sf_memory_available();
    estimate e = {0};
    int channel[2], status = 0;
    fflush(NULL);
    if (pipe(channel) != 0)
        return SF_FAIL(err, SF_ERR_IO, "no pipe to estimate the mesh of %s: %s", file, strerror(errno));
    pid_t child = fork();
    if (child == 0)
        report_estimate(channel[1]);
    close(channel[1]);
    ssize_t received = child > 0 ? read(channel[0], &e, sizeof e) : -1;
    close(channel[0]);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    if (child < 0)
        return SF_FAIL(err, SF_ERR_IO, "no process to estimate the mesh of %s in: %s", file, strerror(errno));
    if (received != (ssize_t)sizeof e)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: meshing its curves alone takes more than %.3g GB of memory or %d s: the mesh "
                       "size is too small, or gmsh fails on the geometry",
                       file, 1e-9 * available, TRIAL_SECONDS);
    if (!(e.nodes * BYTES_PER_NODE > available))
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT,
                   "%s: a spacing of %.3g (in the geometry's unit) means about %.2g nodes and %.3g GB of "
                   "memory, of which %.3g GB are available: take a coarser one, or set SOFTFALL_MEMORY_MB",
                   file, e.spacing, e.nodes, 1e-9 * e.nodes * BYTES_PER_NODE, 1e-9 * available);
}
