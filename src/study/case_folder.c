/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/case_folder.h"

#include "build_info.h"
#include "study/run_folder.h"
#include "case/case.h"
#include "case/parts.h"
#include "base/hash.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/staging.h"
#include "pre/mesh/mesher.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CASE_NAME "case.cfg"
#define README_NAME "README.md"
enum { PATH_SIZE = 4096 };

/* A file of the new folder. Strings are owned. */
typedef struct folder_file {
    char *name; /* from the new folder */
    char *path; /* where it stands, from /; "" of one that is written here */
    char *text; /* what becomes of it; NULL: nothing is copied, it is a part of the case */
    size_t size;
    bool is_text;
} folder_file;

typedef struct folder {
    const sf_case_folder_request *request;
    sf_case c;
    uint64_t hash; /* of the case */
    sf_meshed mesh[SF_GEOMETRIES];
    sf_case_parts parts;
    int count;
    folder_file *file; /* [count] */
    sf_tree tree;
} folder;

/* ---- places ---- */

static const folder_file *find_name(const folder *f, const char *name) {
    for (int k = 0; k < f->count; k++)
        if (strcmp(f->file[k].name, name) == 0)
            return &f->file[k];
    return NULL;
}

/* NULL on failure. The path and the name are copied, the text is taken. */
static folder_file *add_file(folder *f, const char *name, const char *path, char *text, size_t size,
                             sf_error *err) {
    bool full = (f->count & (f->count - 1)) == 0; /* a power of two, or 0 */
    folder_file *grown =
        full ? realloc(f->file, (size_t)(f->count ? 2 * f->count : 1) * sizeof *grown) : f->file;
    char *own_name = strdup(name), *own_path = strdup(path);
    f->file = grown ? grown : f->file;
    if (!grown || !own_name || !own_path) {
        free(own_name);
        free(own_path);
        free(text);
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the files of %s", f->request->folder);
        return NULL;
    }
    f->file[f->count] = (folder_file){own_name, own_path, text, size, text && !memchr(text, '\0', size)};
    return &f->file[f->count++];
}

/* The content of the file at `path`, added as `name`. */
static const char *copy_file(folder *f, const char *name, const char *path, const char *what, sf_error *err) {
    char *text = NULL;
    size_t size = 0;
    if (sf_plain_read(path, what, SF_PLAIN_ANY, &text, &size, err) != SF_OK)
        return NULL;
    const folder_file *file = add_file(f, name, path, text, size, err);
    return file ? file->name : NULL;
}

/* `name`, or the first of NAME-2.END and so on that nothing else has. `text`: of a part, whose name another
 * part of the same path and text shares; NULL: any file of the same path shares it. */
static const char *free_name(const folder *f, const char *name, const char *path, const char *text,
                             char out[PATH_SIZE]) {
    const char *end = strrchr(sf_path_name(name), '.');
    int stem = end && end != sf_path_name(name) ? (int)(end - name) : (int)strlen(name);
    snprintf(out, PATH_SIZE, "%s", name);
    for (int number = 2;; number++) {
        const folder_file *other = find_name(f, out);
        bool same = other && strcmp(other->path, path) == 0;
        if (!other || (same && (!text || (other->text && strcmp(other->text, text) == 0))))
            return out;
        snprintf(out, PATH_SIZE, "%.*s-%d%s", stem, name, number, name + stem);
    }
}

/* ---- geometries ---- */

/* True if a text of the geometry names the file by this very path. */
static bool is_named_whole(const sf_broker *read, const char *path) {
    char quoted[PATH_SIZE + 2];
    snprintf(quoted, sizeof quoted, "\"%s\"", path);
    for (size_t k = 0; *path == '/' && k < read->count; k++)
        if (read->file[k].is_text && strstr(read->file[k].text, quoted))
            return true;
    return false;
}

/* The files that the geometries at `path` read, from /; a name of its own for what they ask for by its place
 * from / (`whole`), where it stands with the others else. */
typedef struct reading {
    int count;
    struct {
        char *path;
        char name[PATH_SIZE];
        const char *asked;
        uint64_t hash;
        bool whole;
    } * file;
} reading;

static void free_reading(reading *r) {
    for (int k = 0; k < r->count; k++)
        free(r->file[k].path);
    free(r->file);
}

static sf_status list_reading(const folder *f, const char *path, reading *r, sf_error *err) {
    size_t most = 0;
    for (int k = 0; k < SF_GEOMETRIES; k++)
        most += f->mesh[k].broker.count;
    r->file = sf_alloc(err, most, sizeof *r->file, "the files of a geometry");
    for (int k = 0; k < SF_GEOMETRIES && err->status == SF_OK; k++) {
        const sf_geo_source *source = sf_campaign_geometry(&f->c, k);
        const sf_broker *read = &f->mesh[k].broker;
        char *own = source->path ? sf_path_whole(NULL, source->path, err) : NULL;
        for (size_t i = 0; own && strcmp(own, path) == 0 && i < read->count && err->status == SF_OK; i++) {
            const char *asked = read->file[i].path;
            r->file[r->count].path = sf_path_whole(NULL, asked, err);
            r->file[r->count].asked = asked;
            r->file[r->count].hash = read->file[i].hash;
            r->file[r->count].whole = is_named_whole(read, asked);
            r->count += err->status == SF_OK;
        }
        free(own);
    }
    return err->status;
}

/* The folder that holds all files but those named from /: its length in `path`, 0: the root. */
static size_t common_folder(const reading *r, const char *path) {
    size_t length = sf_path_folder_length(path);
    for (int k = 0; k < r->count; k++)
        while (length > 0 && !r->file[k].whole &&
               !(strncmp(r->file[k].path, path, length) == 0 && r->file[k].path[length] == '/')) {
            do
                length--;
            while (length > 0 && path[length] != '/');
        }
    return length <= 1 ? 0 : length;
}

/* Names all files below the folder `root` ("": the new folder); false: one of the names is taken. */
static bool try_root(const folder *f, reading *r, const char *path, size_t common, const char *root) {
    bool fits = true;
    for (int k = 0; k < r->count; k++) {
        const char *own = r->file[k].path;
        bool below = strncmp(own, path, common) == 0 && own[common] == '/';
        int length = snprintf(r->file[k].name, PATH_SIZE, "%s%s%s", root, *root ? "/" : "",
                              below ? own + common + 1 : sf_path_name(own));
        const folder_file *other = find_name(f, r->file[k].name);
        fits = fits && length < PATH_SIZE && !(other && strcmp(other->path, own) != 0);
        for (int i = 0; i < k; i++)
            fits =
                fits && (strcmp(r->file[i].name, r->file[k].name) != 0 || strcmp(r->file[i].path, own) == 0);
    }
    return fits;
}

static void name_reading(const folder *f, reading *r, const char *path, const char *wanted) {
    size_t common = common_folder(r, path);
    const char *inner = path + common + 1;
    char root[PATH_SIZE] = "geo";
    size_t length = wanted ? strlen(wanted) : 0, tail = strlen(inner);
    if (length >= tail && strcmp(wanted + length - tail, inner) == 0 &&
        (length == tail || wanted[length - tail - 1] == '/'))
        snprintf(root, sizeof root, "%.*s", (int)(length - tail - (length > tail)), wanted);
    for (int number = 1; !try_root(f, r, path, common, root) && number < 1000; number++)
        snprintf(root, sizeof root, number > 1 ? "geo-%d" : "geo", number);
}

/* In a text, in place of the name from /. */
static sf_status rename_in(folder_file *file, const char *asked, const char *name, sf_error *err) {
    char *between = sf_path_between(file->name, name, err), *out = NULL;
    size_t size = 0, length = strlen(asked);
    FILE *changed = between ? open_memstream(&out, &size) : NULL;
    for (const char *at = file->text, *found; changed && *at; at = found) {
        for (found = at; (found = strstr(found, asked)); found++)
            if (found > file->text && found[-1] == '"' && found[length] == '"')
                break;
        fprintf(changed, "%.*s%s", found ? (int)(found - at) : (int)strlen(at), at, found ? between : "");
        found = found ? found + length : at + strlen(at);
    }
    free(between);
    if (!changed || fclose(changed) != 0)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the text of %s", file->path);
    free(file->text);
    file->text = out;
    file->size = size;
    return SF_OK;
}

static sf_status add_reading(folder *f, const reading *r, sf_error *err) {
    int first = f->count;
    for (int k = 0; k < r->count && err->status == SF_OK; k++) {
        uint64_t hash = 0;
        if (find_name(f, r->file[k].name))
            continue;
        if (!copy_file(f, r->file[k].name, r->file[k].path, NULL, err))
            return err->status;
        const folder_file *file = &f->file[f->count - 1];
        hash = sf_hash_bytes(SF_HASH_START, file->text, file->size);
        if (hash != r->file[k].hash)
            SF_FAIL(err, SF_ERR_IO, "%s has changed while it was read", file->path);
    }
    for (int k = 0; k < r->count; k++)
        for (int i = first; r->file[k].whole && i < f->count && err->status == SF_OK; i++)
            if (f->file[i].is_text)
                rename_in(&f->file[i], r->file[k].asked, r->file[k].name, err);
    return err->status;
}

/* With everything that gmsh reads for it, in the same places to each other. */
static const char *place_geometry(folder *f, const sf_case_file *asked, sf_error *err) {
    reading r = {0};
    const char *name = NULL;
    if (list_reading(f, asked->path, &r, err) == SF_OK) {
        name_reading(f, &r, asked->path, asked->wanted);
        add_reading(f, &r, err);
    }
    for (int k = 0; err->status == SF_OK && k < r.count && !name; k++)
        if (strcmp(r.file[k].path, asked->path) == 0)
            name = find_name(f, r.file[k].name)->name;
    free_reading(&r);
    if (!name)
        SF_FAIL(err, SF_ERR_INPUT, "%s: gmsh did not read this geometry", asked->path);
    return name;
}

/* ---- texts and data ---- */

static const char *place(void *context, const sf_case_file *asked, sf_error *err) {
    folder *f = context;
    char name[PATH_SIZE], wanted[PATH_SIZE];
    bool part = asked->kind == SF_CASE_FILE_PART;
    if (asked->kind == SF_CASE_FILE_GEOMETRY)
        return place_geometry(f, asked, err);
    if (asked->wanted)
        snprintf(wanted, sizeof wanted, "%s", asked->wanted);
    else
        snprintf(wanted, sizeof wanted, "%s/%s", part ? "materials" : "data", sf_path_name(asked->path));
    free_name(f, wanted, asked->path, asked->text, name);
    const folder_file *there = find_name(f, name);
    if (there)
        return there->name;
    if (!part)
        return copy_file(f, name, asked->path, NULL, err);
    char *text = strdup(asked->text);
    const folder_file *added = add_file(f, name, asked->path, text, text ? strlen(text) : 0, err);
    return added ? added->name : NULL;
}

/* The first comment of the case, or something to say. */
static void find_title(const char *text, char *out, size_t size) {
    const char *from = text + strspn(text, "# \t");
    int length = (int)strcspn(from, "\r\n");
    if (*text == '#' && length > 0)
        snprintf(out, size, "%.*s", length, from);
    else
        snprintf(out, size, "A drop test");
}

static sf_status write_readme(folder *f, sf_error *err) {
    const sf_case_folder_request *q = f->request;
    char title[PATH_SIZE], *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the README of %s", q->folder);
    find_title(f->parts.part[0].text, title, sizeof title);
    fprintf(
        out,
        "%s\n\n"
        "This folder holds all that the case needs; it may be moved, packed and sent. softfall " SF_VERSION
        " made it from %s",
        title, q->origin ? q->origin : q->case_path);
    for (int k = 0; k < q->override_count; k++) /* the title may be true of the original only */
        fprintf(out, "%s--set '%.200s'", k ? " " : " with ", q->overrides[k]);
    fputs(
        ".\n\n"
        "    softfall-pre case.cfg -o model.h5       # mesh the geometry, build and check the model\n"
        "    softfall-solve model.h5 -o results.h5   # the drop\n"
        "    softfall-post results.h5 -o out         # figures, out/report.html, files for ParaView\n\n"
        "Edit case.cfg and run the three again, each with --force. softfall-pre --keys explains every key.\n",
        out);
    if (fclose(out) != 0)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the README of %s", q->folder);
    add_file(f, README_NAME, "", text, size, err);
    return err->status;
}

/* Collects every file: first their names, then their texts. */
static sf_status collect(folder *f, sf_error *err) {
    const sf_case_folder_request *q = f->request;
    SF_TRY(sf_case_parts_read(q->case_path, &f->parts, err));
    for (int k = 0; k < q->override_count; k++)
        SF_TRY(sf_case_parts_set(&f->parts, q->overrides[k], err));
    if (!(f->parts.part[0].name = strdup(CASE_NAME)))
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the files of %s", q->folder);
    if (!add_file(f, CASE_NAME, f->parts.part[0].path, NULL, 0, err))
        return err->status;
    SF_TRY(write_readme(f, err));
    return sf_case_parts_finish(&f->parts, place, f, err);
}

/* ---- writing ---- */

static sf_status write_files(folder *f, sf_error *err) {
    for (int k = 0; k < f->count && err->status == SF_OK; k++) {
        const folder_file *file = &f->file[k];
        const sf_case_part *part = NULL;
        for (int i = 0; i < f->parts.count && !part; i++)
            if (f->parts.part[i].name && strcmp(f->parts.part[i].name, file->name) == 0)
                part = &f->parts.part[i];
        if (sf_process_stopped())
            return SF_FAIL(err, SF_INTERRUPTED, "interrupted; %s was not made", f->request->folder);
        sf_tree_put(&f->tree, file->name, part ? part->text : file->text,
                    part ? strlen(part->text) : file->size, err);
    }
    return err->status;
}

static sf_status mesh_each(const sf_case *c, sf_meshed mesh[SF_GEOMETRIES], sf_error *err) {
    const sf_mesher_limits limits = {c->mesh_time_limit, NULL};
    for (int k = 0; k < SF_GEOMETRIES && err->status == SF_OK; k++)
        if (sf_campaign_geometry(c, k)->path)
            sf_mesher_run(sf_campaign_geometry(c, k), &limits, &mesh[k], err);
    return err->status;
}

/* Checks that the new case reads no file outside of the new folder. */
static sf_status check_reading(const folder *f, const sf_broker *read, const char *root, sf_error *err) {
    for (size_t k = 0; k < read->count && err->status == SF_OK; k++) {
        char *whole = sf_path_whole(NULL, read->file[k].path, err);
        if (whole && !sf_path_below(root, whole))
            SF_FAIL(err, SF_ERR_INPUT,
                    "%s has no folder of its own: its geometry reads %s by a path from / that does not stand "
                    "in quotes in its text; name it relative to the geometry",
                    f->request->case_path, whole);
        free(whole);
    }
    return err->status;
}

static sf_status check_meshes(const folder *f, const sf_case *c, sf_error *err) {
    sf_meshed mesh[SF_GEOMETRIES] = {0};
    char *root = sf_path_whole(NULL, f->tree.aside, err);
    if (root)
        mesh_each(c, mesh, err);
    for (int k = 0; k < SF_GEOMETRIES && err->status == SF_OK; k++)
        if (check_reading(f, &mesh[k].broker, root, err) == SF_OK &&
            (mesh[k].size != f->mesh[k].size ||
             (mesh[k].size > 0 && memcmp(mesh[k].stream, f->mesh[k].stream, mesh[k].size) != 0)))
            SF_FAIL(err, SF_ERR_INPUT, "%s has no folder of its own: in another folder %s gives another mesh",
                    f->request->case_path, sf_campaign_geometry(&f->c, k)->path);
    for (int k = 0; k < SF_GEOMETRIES; k++)
        sf_meshed_free(&mesh[k]);
    free(root);
    return err->status;
}

/* The new folder is the same case, and needs no other. */
static sf_status check(const folder *f, sf_error *err) {
    char path[PATH_SIZE];
    sf_case c;
    sf_error inner = SF_ERROR_INIT;
    snprintf(path, sizeof path, "%s/" CASE_NAME, f->tree.aside);
    if (sf_case_read(path, 0, NULL, NULL, &c, &inner) != SF_OK)
        return SF_FAIL(err, inner.status,
                       "%s cannot be given a folder of its own: there it would be refused (%s)",
                       f->request->case_path, inner.text);
    if (sf_campaign_case_hash(&c) != f->hash)
        SF_FAIL(err, SF_ERR_LIBRARY, "%s cannot be given a folder of its own: there it would be another case",
                f->request->case_path);
    else
        check_meshes(f, &c, err);
    sf_case_free(&c);
    return err->status;
}

static void release(folder *f) {
    sf_tree_end(&f->tree);
    for (int k = 0; k < f->count; k++) {
        free(f->file[k].name);
        free(f->file[k].path);
        free(f->file[k].text);
    }
    free(f->file);
    for (int k = 0; k < SF_GEOMETRIES; k++)
        sf_meshed_free(&f->mesh[k]);
    sf_case_parts_free(&f->parts);
    sf_case_free(&f->c);
}

sf_status sf_case_folder_make(const sf_case_folder_request *q, const sf_sink *sink, sf_error *err) {
    folder f = {.request = q};
    if (sf_tree_begin(q->folder, &f.tree, err) == SF_OK &&
        sf_case_read(q->case_path, q->override_count, q->overrides, sink, &f.c, err) == SF_OK) {
        f.hash = sf_campaign_case_hash(&f.c);
        if (f.c.run.drops > 1)
            SF_FAIL(
                err, SF_ERR_INPUT,
                "%s: series.drops = %g: studies run single drops; leave the series out, and run it by softfall-solve",
                q->case_path, f.c.run.drops);
        else if (mesh_each(&f.c, f.mesh, err) == SF_OK && collect(&f, err) == SF_OK &&
                 write_files(&f, err) == SF_OK && check(&f, err) == SF_OK)
            sf_tree_commit(&f.tree, err);
    }
    release(&f);
    return err->status;
}
