/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/tree.h"

#include "io/replace.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_empty(const char *path) {
    DIR *list = opendir(path);
    const struct dirent *entry;
    int count = 0;
    while (list && (entry = readdir(list)) != NULL)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    if (list)
        closedir(list);
    return list && count == 0;
}

static sf_status check_place(const char *path, bool *there, sf_error *err) {
    struct stat info;
    if (!*path)
        return SF_FAIL(err, SF_ERR_INPUT, "the name of the new folder is empty");
    *there = lstat(path, &info) == 0;
    if (*there && (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)))
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists and is not a folder: give another name", path);
    if (*there && access(path, W_OK | X_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be written in: %s", path, strerror(errno));
    if (*there)
        return is_empty(path) ? SF_OK
                              : SF_FAIL(err, SF_ERR_INPUT,
                                        "the folder %s exists and is not empty: give another name", path);
    return sf_replace_check_folder(path, err);
}

/* Without the slashes at its end, as rename and the name aside need it. */
static char *copy_name(const char *path) {
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    return strndup(path, length);
}

/* Gives the folder the mode that mkdir would give; mkdtemp lets only the owner in. */
static void open_to_others(const char *path) {
    mode_t mask = umask(0);
    umask(mask);
    if (chmod(path, 0777 & ~mask) != 0)
        return; /* a file system without modes */
}

sf_status sf_tree_begin(const char *path, sf_tree *tree, sf_error *err) {
    *tree = (sf_tree){0};
    SF_TRY(check_place(path, &tree->there, err));
    tree->path = copy_name(path);
    if (!tree->path ||
        asprintf(&tree->aside, "%s%s.partial-XXXXXX", tree->path, tree->there ? "/" : "") < 0) {
        tree->aside = NULL;
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", path);
    }
    if (!mkdtemp(tree->aside)) {
        SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", path, strerror(errno));
        free(tree->aside);
        tree->aside = NULL;
        return err->status;
    }
    open_to_others(tree->aside);
    return SF_OK;
}

static sf_status join(const char *folder, const char *name, char path[PATH_MAX], sf_error *err) {
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX)
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT, "the path of %.200s is longer than %d characters", name, PATH_MAX - 1);
}

static bool is_made(const sf_tree *tree, const char *name) {
    for (int k = 0; k < tree->count; k++)
        if (strcmp(tree->made[k], name) == 0)
            return true;
    return false;
}

/* Notes the name of what is made next. */
static sf_status note(sf_tree *tree, const char *name, size_t length, sf_error *err) {
    if (tree->count == tree->capacity) {
        int capacity = tree->capacity ? 2 * tree->capacity : 16;
        char **grown = realloc(tree->made, (size_t)capacity * sizeof *grown);
        if (!grown)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the files of %s", tree->path);
        tree->made = grown;
        tree->capacity = capacity;
    }
    char *copy = strndup(name, length);
    if (!copy)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the files of %s", tree->path);
    tree->made[tree->count++] = copy;
    return SF_OK;
}

static sf_status make_folders(sf_tree *tree, const char *name, sf_error *err) {
    char path[PATH_MAX];
    for (const char *slash = strchr(name, '/'); slash; slash = strchr(slash + 1, '/')) {
        char folder[PATH_MAX];
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - name), name);
        if (is_made(tree, folder))
            continue;
        SF_TRY(join(tree->aside, folder, path, err));
        if (mkdir(path, 0777) != 0)
            return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", path, strerror(errno));
        SF_TRY(note(tree, folder, strlen(folder), err));
    }
    return SF_OK;
}

sf_status sf_tree_put(sf_tree *tree, const char *name, const char *text, size_t size, sf_error *err) {
    char path[PATH_MAX];
    SF_TRY(join(tree->aside, name, path, err));
    SF_TRY(make_folders(tree, name, err));
    FILE *file = sf_replace_create(path, err);
    if (!file)
        return err->status;
    note(tree, name, strlen(name), err);
    bool done = fwrite(text, 1, size, file) == size && fflush(file) == 0 && fsync(fileno(file)) == 0;
    if (fclose(file) != 0 || !done)
        SF_FAIL(err, SF_ERR_IO, "writing %s failed (disk full?)", path);
    return err->status;
}

/* Never onto something; some file systems cannot promise that. */
static sf_status move_one(const char *from, const char *to, sf_error *err) {
    if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0 ||
        ((errno == EINVAL || errno == ENOSYS) && access(to, F_OK) != 0 && rename(from, to) == 0))
        return SF_OK;
    if (errno == EEXIST || errno == ENOTEMPTY || errno == ENOTDIR)
        return SF_FAIL(err, SF_ERR_INPUT, "%s has come to be meanwhile: give another name", to);
    return SF_FAIL(err, SF_ERR_IO, "%s cannot be moved to %s: %s", from, to, strerror(errno));
}

/* Into the empty folder that is there, one by one. */
static sf_status move_into(sf_tree *tree, sf_error *err) {
    char from[PATH_MAX], to[PATH_MAX];
    for (int k = 0; k < tree->count; k++)
        if (!strchr(tree->made[k], '/') &&
            (join(tree->aside, tree->made[k], from, err) != SF_OK ||
             join(tree->path, tree->made[k], to, err) != SF_OK || move_one(from, to, err) != SF_OK))
            return err->status;
    rmdir(tree->aside);
    return SF_OK;
}

sf_status sf_tree_commit(sf_tree *tree, sf_error *err) {
    SF_TRY(tree->there ? move_into(tree, err) : move_one(tree->aside, tree->path, err));
    sf_replace_sync_name(tree->path);
    free(tree->aside);
    tree->aside = NULL;
    return SF_OK;
}

void sf_tree_end(sf_tree *tree) {
    sf_error none = SF_ERROR_INIT;
    char path[PATH_MAX];
    while (tree->count > 0) {
        const char *name = tree->made[--tree->count];
        if (tree->aside && join(tree->aside, name, path, &none) == SF_OK)
            remove(path);
        free(tree->made[tree->count]);
    }
    if (tree->aside)
        rmdir(tree->aside);
    free(tree->made);
    free(tree->aside);
    free(tree->path);
    *tree = (sf_tree){0};
}
