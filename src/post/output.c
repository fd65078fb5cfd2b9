/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/output.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Every file that this program may write. pad.h5 is moved before pad.xdmf, which refers to it. */
static const char *const output_names[] = {"pad.h5",           "pad.xdmf",        "history.csv",
                                           "section.csv",      "reference.csv",   "compression.csv",
                                           "compression.gp",   "compression.png", "acceleration.gp",
                                           "acceleration.png", "summary.json"};
enum { OUTPUT_NAMES = sizeof output_names / sizeof output_names[0] };

static char *join(const char *directory, const char *name, sf_error *err) {
    char *path = NULL;
    if (asprintf(&path, "%s/%s", directory, name) < 0) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path of %s", name);
        return NULL;
    }
    return path;
}

static bool file_exists(const char *directory, const char *name) {
    sf_error ignored = SF_ERROR_INIT;
    char *path = join(directory, name, &ignored);
    bool found = path && access(path, F_OK) == 0;
    free(path);
    return found;
}

static sf_status make_directory(sf_output *output, bool force, sf_error *err) {
    struct stat status;
    if (mkdir(output->directory, 0777) == 0) {
        output->created = true;
        return SF_OK;
    }
    if (errno != EEXIST)
        return SF_FAIL(err, SF_ERR_IO, "cannot make the directory %s: %s", output->directory,
                       strerror(errno));
    if (stat(output->directory, &status) != 0 || !S_ISDIR(status.st_mode))
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists and is not a directory", output->directory);
    for (int k = 0; k < OUTPUT_NAMES && !force; k++)
        if (file_exists(output->directory, output_names[k]))
            return SF_FAIL(err, SF_ERR_INPUT,
                           "%s already holds %s: give another directory, or --force to replace it",
                           output->directory, output_names[k]);
    return SF_OK;
}

sf_status sf_output_begin(const char *directory, bool force, sf_output *output, sf_error *err) {
    *output = (sf_output){0};
    output->directory = strdup(directory);
    if (!output->directory)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", directory);
    if (make_directory(output, force, err) != SF_OK)
        goto failed;
    output->staging = join(directory, ".softfall-post-XXXXXX", err);
    if (!output->staging)
        goto failed;
    if (!mkdtemp(output->staging)) {
        SF_FAIL(err, SF_ERR_IO, "cannot write in %s: %s", directory, strerror(errno));
        free(output->staging);
        output->staging = NULL;
        goto failed;
    }
    return SF_OK;
failed:
    sf_output_end(output);
    return err->status;
}

char *sf_output_path(const sf_output *output, const char *name, sf_error *err) {
    return join(output->staging, name, err);
}

FILE *sf_output_open(const sf_output *output, const char *name, sf_error *err) {
    char *path = sf_output_path(output, name, err);
    FILE *file = path ? fopen(path, "w") : NULL;
    if (path && !file)
        SF_FAIL(err, SF_ERR_IO, "cannot write %s: %s", path, strerror(errno));
    free(path);
    return file;
}

sf_status sf_output_close(FILE *file, const char *name, sf_error *err) {
    bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed)
        return SF_FAIL(err, SF_ERR_IO, "writing %s failed (disk full?)", name);
    return SF_OK;
}

bool sf_output_has(const sf_output *output, const char *name) {
    return file_exists(output->staging ? output->staging : output->directory, name);
}

sf_status sf_output_commit(sf_output *output, sf_error *err) {
    for (int k = 0; k < OUTPUT_NAMES && err->status == SF_OK; k++) {
        char *from = join(output->staging, output_names[k], err);
        char *to = from ? join(output->directory, output_names[k], err) : NULL;
        if (to && access(from, F_OK) != 0) {
            if (unlink(to) != 0 && errno != ENOENT)
                SF_FAIL(err, SF_ERR_IO, "cannot remove the old %s: %s", to, strerror(errno));
        } else if (to && rename(from, to) != 0) {
            SF_FAIL(err, SF_ERR_IO, "cannot move %s into place: %s", to, strerror(errno));
        }
        free(from);
        free(to);
    }
    if (err->status != SF_OK)
        return err->status;
    output->created = false;
    rmdir(output->staging);
    free(output->staging);
    output->staging = NULL;
    return SF_OK;
}

void sf_output_end(sf_output *output) {
    sf_error ignored = SF_ERROR_INIT;
    DIR *listing = output->staging ? opendir(output->staging) : NULL;
    struct dirent *entry;
    while (listing && (entry = readdir(listing)) != NULL) {
        char *path = entry->d_name[0] == '.' ? NULL : join(output->staging, entry->d_name, &ignored);
        if (path)
            unlink(path);
        free(path);
    }
    if (listing)
        closedir(listing);
    if (output->staging)
        rmdir(output->staging);
    if (output->created)
        rmdir(output->directory);
    free(output->staging);
    free(output->directory);
    *output = (sf_output){0};
}
