/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "calculix/ccx.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

bool sf_ccx_present(char version[64]) {
    char line[256];
    bool found = false;
    FILE *pipe = popen("ccx -v 2>/dev/null", "r");
    version[0] = '\0';
    while (pipe && fgets(line, sizeof line, pipe))
        found = sscanf(line, " This is Version %63[^\n]", version) == 1 || found;
    if (pipe)
        pclose(pipe);
    return found;
}

double sf_children_cpu(void) {
    struct rusage u;
    getrusage(RUSAGE_CHILDREN, &u);
    return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

/* The last line of the log that begins with *ERROR. */
static void read_ending(const char *folder, const char *job, char ending[256]) {
    char path[1024], line[256];
    snprintf(path, sizeof path, "%s/%s.log", folder, job);
    FILE *file = fopen(path, "r");
    ending[0] = '\0';
    while (file && fgets(line, sizeof line, file))
        if (strstr(line, "*ERROR"))
            sscanf(line, " %255[^\n]", ending);
    if (file)
        fclose(file);
}

/* The time of the last converged increment: the last row of the .sta file whose number of attempts has no U.
 */
static double read_reached(const char *folder, const char *job) {
    char path[1024], line[256], attempt[16];
    double reached = 0, time;
    snprintf(path, sizeof path, "%s/%s.sta", folder, job);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "%*d %*d %15s %*d %lf", attempt, &time) == 2 && !strchr(attempt, 'U'))
            reached = time;
    if (file)
        fclose(file);
    return reached;
}

sf_status sf_ccx_solve(const char *folder, const char *job, sf_ccx_run *run, sf_error *err) {
    char command[2048];
    snprintf(command, sizeof command,
             "cd '%s' && rm -f %s.dat %s.sta && OMP_NUM_THREADS=1 ccx -i %s > %s.log 2>&1", folder, job, job,
             job, job);
    double start = sf_children_cpu();
    int code = system(
        command); /* the study owns every part of the command; the exit code says less than the files */
    if (code == -1)
        return SF_FAIL(err, SF_ERR_IO, "the shell cannot be started");
    run->cpu = sf_children_cpu() - start;
    run->reached = read_reached(folder, job);
    read_ending(folder, job, run->ending);
    return SF_OK;
}

static sf_status append(sf_ccx_forces *out, double time, const double f[3], sf_error *err) {
    if ((out->count & (out->count - 1)) == 0) {
        size_t room = out->count ? 2 * (size_t)out->count : 1;
        double *t = realloc(out->time, room * sizeof *t);
        out->time = t ? t : out->time;
        double *force = realloc(out->force, 3 * room * sizeof *force);
        out->force = force ? force : out->force;
        if (!t || !force)
            return SF_FAIL(err, SF_ERR_MEMORY, "no memory for %zu increments", room);
    }
    out->time[out->count] = time;
    memcpy(&out->force[3 * out->count++], f, 3 * sizeof *f);
    return SF_OK;
}

sf_status sf_ccx_forces_read(const char *folder, const char *job, const char *set, sf_ccx_forces *out,
                             sf_error *err) {
    char path[1024], line[256], name[128];
    double time, f[3];
    *out = (sf_ccx_forces){0};
    snprintf(path, sizeof path, "%s/%s.dat", folder, job);
    FILE *file = fopen(path, "r");
    if (!file)
        return SF_FAIL(err, SF_ERR_IO, "CalculiX wrote no %s", path);
    while (err->status == SF_OK && fgets(line, sizeof line, file)) {
        if (sscanf(line, " total force (fx,fy,fz) for set %127s and time %lf", name, &time) != 2 ||
            strcmp(name, set) != 0)
            continue;
        while (fgets(line, sizeof line, file))
            if (sscanf(line, "%lf %lf %lf", &f[0], &f[1], &f[2]) == 3) {
                append(out, time, f, err);
                break;
            }
    }
    fclose(file);
    if (err->status == SF_OK && out->count == 0)
        SF_FAIL(err, SF_ERR_NUMERIC, "no increment of %s converged", job);
    if (err->status != SF_OK)
        sf_ccx_forces_free(out);
    return err->status;
}

void sf_ccx_forces_free(sf_ccx_forces *forces) {
    free(forces->time);
    free(forces->force);
    *forces = (sf_ccx_forces){0};
}
