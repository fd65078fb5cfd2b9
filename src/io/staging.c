/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/staging.h"

#include "io/folder.h"
#include "io/replace.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The staging directory's name begins so, then follow the process and six letters. */
#define STAGING ".softfall-"

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
    bool found = path && sf_replace_exists(path);
    free(path);
    return found;
}

/* Each file that is there may be replaced: it is plain and not an input. */
static sf_status check_files(const char *directory, const char *const *names, bool force, sf_error *err) {
    for (; *names && err->status == SF_OK; names++) {
        char *path = join(directory, *names, err);
        if (path && sf_replace_check(path, err) == SF_OK && !force && sf_replace_exists(path))
            SF_FAIL(err, SF_ERR_INPUT,
                    "%s already holds %s: give another directory, or --force to replace it", directory,
                    *names);
        free(path);
    }
    return err->status;
}

sf_status sf_staging_check(const char *directory, const char *const *names, bool force, sf_error *err) {
    struct stat info;
    if (!*directory)
        return SF_FAIL(err, SF_ERR_INPUT, "the name of the output directory is empty");
    if (stat(directory, &info) == 0)
        return S_ISDIR(info.st_mode)
                   ? check_files(directory, names, force, err)
                   : SF_FAIL(err, SF_ERR_INPUT, "%s exists and is not a directory", directory);
    if (errno != ENOENT || lstat(directory, &info) == 0)
        return SF_FAIL(err, SF_ERR_INPUT, "the directory %s cannot be made: %s", directory, strerror(errno));
    return sf_replace_check_folder(directory, err);
}

static sf_status make_directory(sf_staging *output, bool force, sf_error *err) {
    SF_TRY(sf_staging_check(output->directory, output->names, force, err));
    if (mkdir(output->directory, 0777) == 0)
        output->created = true;
    else if (errno != EEXIST)
        SF_FAIL(err, SF_ERR_IO, "cannot make the directory %s: %s", output->directory, strerror(errno));
    return err->status;
}

/* Removes the plain files of a directory with softfall's mark, and itself; a link instead of a directory is
 * not followed. */
static void remove_flat(int parent, const char *name) {
    int handle = openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    bool own = handle >= 0 && sf_folder_is_own(handle);
    DIR *listing = handle >= 0 ? fdopendir(handle) : NULL;
    struct dirent *entry;
    while (own && listing && (entry = readdir(listing)) != NULL)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlinkat(handle, entry->d_name, 0);
    if (listing)
        closedir(listing);
    else if (handle >= 0)
        close(handle);
    unlinkat(parent, name, AT_REMOVEDIR);
}

/* Removes the staging directories of processes that no longer exist (killed runs). */
static void remove_stale(const char *directory) {
    DIR *listing = opendir(directory);
    struct dirent *entry;
    while (listing && (entry = readdir(listing)) != NULL) {
        int owner = 0, end = 0;
        if (sscanf(entry->d_name, STAGING "%d-%n", &owner, &end) == 1 && end > 0 && owner > 0 &&
            strlen(entry->d_name + end) == 6 && kill(owner, 0) != 0 && errno == ESRCH)
            remove_flat(dirfd(listing), entry->d_name);
    }
    if (listing)
        closedir(listing);
}

static char *name_staging(const char *directory, sf_error *err) {
    char name[64];
    snprintf(name, sizeof name, STAGING "%d-XXXXXX", (int)getpid());
    return join(directory, name, err);
}

sf_status sf_staging_begin(const char *directory, const char *const *names, bool force, sf_staging *output,
                           sf_error *err) {
    *output = (sf_staging){.names = names};
    output->directory = strdup(directory);
    if (!output->directory)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", directory);
    if (make_directory(output, force, err) != SF_OK)
        goto failed;
    remove_stale(directory);
    output->aside = name_staging(directory, err);
    if (!output->aside)
        goto failed;
    if (!mkdtemp(output->aside)) {
        SF_FAIL(err, SF_ERR_IO, "cannot write in %s: %s", directory, strerror(errno));
        free(output->aside);
        output->aside = NULL;
        goto failed;
    }
    if (sf_folder_own(output->aside, err) != SF_OK)
        goto failed;
    return SF_OK;
failed:
    sf_staging_end(output);
    return err->status;
}

char *sf_staging_path(const sf_staging *output, const char *name, sf_error *err) {
    return join(output->aside, name, err);
}

FILE *sf_staging_open(const sf_staging *output, const char *name, sf_error *err) {
    char *path = sf_staging_path(output, name, err);
    FILE *file = path ? sf_replace_create(path, err) : NULL;
    free(path);
    return file;
}

sf_status sf_staging_close(FILE *file, const char *name, sf_error *err) {
    bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed)
        return SF_FAIL(err, SF_ERR_IO, "writing %s failed (disk full?)", name);
    return SF_OK;
}

bool sf_staging_has(const sf_staging *output, const char *name) {
    return file_exists(output->aside ? output->aside : output->directory, name);
}

void sf_staging_remove(const sf_staging *output, const char *name) {
    sf_error ignored = SF_ERROR_INIT;
    char *path = sf_staging_path(output, name, &ignored);
    if (path)
        unlink(path);
    free(path);
}

sf_status sf_staging_commit(sf_staging *output, sf_error *err) {
    SF_TRY(check_files(output->directory, output->names, true, err));
    for (const char *const *name = output->names; *name && err->status == SF_OK; name++) {
        char *from = join(output->aside, *name, err);
        char *to = from ? join(output->directory, *name, err) : NULL;
        if (to && access(from, F_OK) != 0) {
            if (unlink(to) != 0 && errno != ENOENT)
                SF_FAIL(err, SF_ERR_IO, "cannot remove the old %s: %s", to, strerror(errno));
        } else if (to) {
            sf_replace_commit(from, to, err);
        }
        free(from);
        free(to);
    }
    if (err->status != SF_OK)
        return err->status;
    if (output->created)
        sf_replace_sync_name(output->directory);
    output->created = false;
    remove_flat(AT_FDCWD, output->aside);
    free(output->aside);
    output->aside = NULL;
    return SF_OK;
}

void sf_staging_end(sf_staging *output) {
    if (output->aside)
        remove_flat(AT_FDCWD, output->aside);
    if (output->created)
        rmdir(output->directory);
    free(output->aside);
    free(output->directory);
    *output = (sf_staging){0};
}
