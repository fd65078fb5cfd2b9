/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/case_folder.h"

#include "build_info.h"
#include "io/staging.h"
#include "case/grammar.h"
#include "base/hash.h"
#include "case/edit.h"
#include "case/read.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "pre/mesh/mesher.h"

#define CASE_NAME "case.cfg"
#define README_NAME "README.md"
enum { PATH_SIZE = 4096 };

/* A file of the new folder. Strings are owned. */
typedef struct folder_file {
    char *name; /* from the new folder */
    char *path; /* where it stands, from / */
    char *text; /* of an included file, as it was before its files had new names; else NULL */
} folder_file;

/* A file that gmsh read for a geometry. Both paths begin at /; owned. */
typedef struct geometry_file {
    char *geometry, *path;
    uint64_t hash;
} geometry_file;

typedef struct folder {
    const sf_case_folder_request *request;
    sf_case c;
    uint64_t hash; /* of the case */
    sf_meshed mesh[SF_GEOMETRIES];
    int read_count;
    geometry_file *read;    /* [read_count] */
    char *case_folder;      /* from / */
    char *text;             /* of the case (case/edit.c) */
    sf_edit_settings named; /* the settings in it that name files */
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

/* `text`: of an included file, else NULL; taken. */
static sf_status add_file(folder *f, const char *name, const char *path, char *text, sf_error *err) {
    folder_file file = {strdup(name), strdup(path), text};
    if (file.name && file.path && sf_grow(&f->file, (size_t)f->count, sizeof file)) {
        f->file[f->count++] = file;
        return SF_OK;
    }
    SF_FREE(file.name, file.path, text);
    return SF_NO_MEMORY(err, "the files of %s", f->request->folder);
}

/* Adds the file at `path` as `name`; `hash`: of what was read of it, NULL: anything. */
static sf_status copy_file(folder *f, const char *name, const char *path, const uint64_t *hash,
                           sf_error *err) {
    SF_OWNED char *text = NULL;
    size_t size = 0;
    if (sf_process_stopped())
        return SF_FAIL(err, SF_INTERRUPTED, "interrupted; %s was not made", f->request->folder);
    SF_TRY(sf_plain_read(path, NULL, SF_PLAIN_ANY, &text, &size, err));
    if (hash && sf_hash_bytes(SF_HASH_START, text, size) != *hash)
        SF_FAIL(err, SF_ERR_IO, "%s has changed while it was read", path);
    else if (add_file(f, name, path, NULL, err) == SF_OK)
        sf_tree_put(&f->tree, name, text, size, err);
    return err->status;
}

/* Returns the place in the new folder of the file that its file `from` calls `name`; NULL: outside of it, or
 * err says why not. From malloc. */
static char *place_beside(const char *from, const char *name, sf_error *err) {
    static const char root[] = "/\001"; /* no folder's name */
    SF_PRINTED(beside, PATH_SIZE, "%s/%.*s", root, (int)sf_path_folder_length(from), from);
    char *whole = *name == '/' ? NULL : sf_path_whole(beside, name, err);
    const char *below = whole ? sf_path_below(root, whole) : NULL;
    if (below)
        memmove(whole, below, strlen(below) + 1);
    else
        free(whole);
    return below ? whole : NULL;
}

/* Writes the place in the new folder of the file at `path`, which its file `from` calls `name`: there, or in
 * the folder `aside`. */
static sf_status find_place(const char *from, const char *name, const char *path, const char *aside,
                            char out[PATH_SIZE], sf_error *err) {
    SF_OWNED char *beside = place_beside(from, name, err);
    if (beside)
        snprintf(out, PATH_SIZE, "%s", beside);
    else
        snprintf(out, PATH_SIZE, "%s/%s", aside, sf_path_name(path));
    return err->status;
}

/* Makes NAME.END the first of NAME.END, NAME-2.END and so on that no file of another path has. `text`: of an
 * included file, whose place only one of the same text shares. */
static void number_place(const folder *f, const char *path, const char *text, char place[PATH_SIZE]) {
    SF_PRINTED(first, PATH_SIZE, "%s", place);
    const char *end = strrchr(sf_path_name(first), '.');
    int stem = end && end != sf_path_name(first) ? (int)(end - first) : (int)strlen(first);
    const folder_file *other;
    for (int number = 2; (other = find_name(f, place)); number++) {
        if (strcmp(other->path, path) == 0 && (!text || (other->text && strcmp(other->text, text) == 0)))
            break;
        snprintf(place, PATH_SIZE, "%.*s-%d%s", stem, first, number, first + stem);
    }
}

/* ---- geometries ---- */

/* Lists the files that gmsh read for each geometry. */
static sf_status list_reading(folder *f, sf_error *err) {
    for (int k = 0; k < SF_GEOMETRIES; k++)
        for (size_t i = 0; i < f->mesh[k].broker.count && err->status == SF_OK; i++) {
            const sf_broker_file *file = &f->mesh[k].broker.file[i];
            if (!sf_grow(&f->read, (size_t)f->read_count, sizeof *f->read))
                return SF_NO_MEMORY(err, "the files of a geometry");
            f->read[f->read_count++] =
                (geometry_file){sf_path_whole(NULL, sf_case_geometry(&f->c, k)->path, err),
                                sf_path_whole(NULL, file->path, err), file->hash};
        }
    return err->status;
}

/* The length in `path` of the folder that holds all that gmsh read for this geometry; 0: the root. */
static size_t common_folder(const folder *f, const char *path) {
    size_t length = sf_path_folder_length(path);
    for (int k = 0; k < f->read_count; k++)
        while (length > 0 && strcmp(f->read[k].geometry, path) == 0 &&
               !(strncmp(f->read[k].path, path, length) == 0 && f->read[k].path[length] == '/'))
            do
                length--;
            while (length > 0 && path[length] != '/');
    return length <= 1 ? 0 : length;
}

/* Copies what gmsh read for the geometry from below its common folder to below `root` ("": the new folder).
 * False: other files have these names. */
static bool copy_reading(folder *f, const char *path, size_t common, const char *root, bool copy,
                         sf_error *err) {
    for (int k = 0; k < f->read_count && err->status == SF_OK; k++) {
        const geometry_file *r = &f->read[k];
        if (strcmp(r->geometry, path) != 0)
            continue;
        SF_PRINTED(name, PATH_SIZE, "%s%s%s", root, *root ? "/" : "", r->path + common + 1);
        const folder_file *other = find_name(f, name);
        if (other && strcmp(other->path, r->path) != 0)
            return false;
        if (copy && !other)
            copy_file(f, name, r->path, &r->hash, err);
    }
    return true;
}

/* Places the geometry with everything that gmsh reads for it, in the same places to each other. */
static sf_status place_geometry(folder *f, const char *from, const char *name, const char *path,
                                char out[PATH_SIZE], sf_error *err) {
    SF_OWNED char *wanted = place_beside(from, name, err);
    char root[PATH_SIZE] = "geo";
    size_t common = common_folder(f, path), length = wanted ? strlen(wanted) : 0;
    const char *inner = path + common + 1;
    size_t tail = strlen(inner);
    if (length >= tail && strcmp(wanted + length - tail, inner) == 0 &&
        (length == tail || wanted[length - tail - 1] == '/'))
        snprintf(root, sizeof root, "%.*s", (int)(length - tail - (length > tail)), wanted);
    for (int number = 1; !copy_reading(f, path, common, root, false, err); number++)
        snprintf(root, sizeof root, number > 1 ? "geo-%d" : "geo", number);
    copy_reading(f, path, common, root, true, err);
    snprintf(out, PATH_SIZE, "%s%s%s", root, *root ? "/" : "", inner);
    return err->status;
}

/* ---- texts ---- */

/* A file of the case's text on its way to the new folder. */
typedef struct part {
    folder *f;
    const char *path, *name; /* from /, and in the new folder */
} part;

/* Copies the file that a setting names; its new name is relative to that of the part. */
static char *place_file(void *context, const char *setting, const char *name, sf_error *err) {
    const part *p = context;
    SF_OWNED char *beside = sf_case_folder_of(p->path, err),
                  *path = beside ? sf_path_whole(beside, name, err) : NULL;
    char place[PATH_SIZE];
    if (path && strncmp(setting, "geometry.", 9) == 0)
        place_geometry(p->f, p->name, name, path, place, err);
    else if (path && find_place(p->name, name, path, "data", place, err) == SF_OK) {
        number_place(p->f, path, NULL, place);
        if (!find_name(p->f, place))
            copy_file(p->f, place, path, NULL, err);
    }
    return err->status == SF_OK ? sf_path_between(p->name, place, err) : NULL;
}

static void write_part(const part *p, const char *at, sf_error *err);

/* Returns the place behind the mark that ends the included file at `at`, or the end of the text. */
static const char *pass_part(const char *at) {
    for (int depth = 1; depth > 0 && (at = strpbrk(at, SF_CASE_MARKS)); at++)
        depth += *at == SF_CASE_BEGIN ? 1 : -1;
    return at;
}

/* Writes the line of an include, which stands at `at` behind its mark, and the file. */
static const char *write_include(const part *p, const char *at, FILE *out, sf_error *err) {
    const char *name = strchr(at, '"') + 1, *end = strchr(name, '"'), *text = strchr(end, '\n') + 1,
               *behind = pass_part(text);
    SF_OWNED char *asked = strndup(name, (size_t)(end - name)), *own = strndup(text, (size_t)(behind - text));
    char place[PATH_SIZE];
    SF_OWNED char *path = asked && own ? sf_path_whole(p->f->case_folder, asked, err) : NULL;
    if (!asked || !own)
        SF_NO_MEMORY(err, "the text of a case");
    if (path && find_place(CASE_NAME, asked, path, "materials", place, err) == SF_OK) {
        number_place(p->f, path, own, place);
        fprintf(out, "%.*s@include \"%s%.*s", (int)strspn(at, " \t"), at, place, (int)(text - end), end);
        const part inner = {p->f, path, place};
        char *kept = own;
        if (find_name(p->f, place))
            return behind + 1;
        own = NULL; /* add_file takes it, also on failure */
        if (add_file(p->f, place, path, kept, err) == SF_OK)
            write_part(&inner, text, err);
    }
    return behind + 1;
}

/* Writes the file whose text begins at `at`, with those that it names. */
static void write_part(const part *p, const char *at, sf_error *err) {
    SF_OWNED SF_TEXT_STREAM(out, text, size);
    for (bool open = out; open && err->status == SF_OK;) {
        const char *mark = strpbrk(at, SF_CASE_MARKS), *end = mark ? mark - 1 : at + strlen(at);
        sf_case_edit_write(p->f->text, (size_t)(at - p->f->text), (size_t)(end - p->f->text), &p->f->named,
                           &(sf_edit_rename){place_file, (void *)p}, out, err);
        open = mark && *mark == SF_CASE_BEGIN && err->status == SF_OK;
        at = open ? write_include(p, mark + 1, out, err) : end;
    }
    if (!out || fclose(out) != 0)
        SF_NO_MEMORY(err, "the text of %s", p->path);
    if (err->status == SF_OK)
        sf_tree_put(&p->f->tree, p->name, text, size, err);
}

/* The README: the first comment of the case, and what the folder was made of; the title may be true of the
 * case without its --set texts only. */
static sf_status write_readme(folder *f, sf_error *err) {
    const sf_case_folder_request *q = f->request;
    const char *title = f->text + strspn(f->text, "# \t");
    int length = *f->text == '#' ? (int)strcspn(title, "\r\n") : 0;
    SF_OWNED SF_TEXT_STREAM(out, text, size);
    if (!out)
        return SF_NO_MEMORY(err, "the README of %s", q->folder);
    if (length > 0)
        fprintf(out, "%.*s\n\n", length, title);
    else
        fputs("A drop test\n\n", out);
    fprintf(
        out,
        "This folder holds all that the case needs; it may be moved, packed and sent. softfall " SF_VERSION
        " made it from %s",
        q->origin ? q->origin : q->case_path);
    for (int k = 0; k < q->override_count; k++)
        fprintf(out, "%s--set '%.200s'", k ? " " : " with ", q->overrides[k]);
    fputs(
        ".\n\n"
        "    softfall-pre case.cfg -o model.h5       # mesh the geometry, build and check the model\n"
        "    softfall-solve model.h5 -o results.h5   # the drop\n"
        "    softfall-post results.h5 -o out         # figures, out/report.html, files for ParaView\n\n"
        "Edit case.cfg and run the three again, each with --force; `softfall run` of the Python package does all of this. "
        "softfall-pre --keys explains every key.\n",
        out);
    fclose(out);
    SF_TRY(add_file(f, README_NAME, "", NULL, err));
    return sf_tree_put(&f->tree, README_NAME, text, size, err);
}

/* Writes the files of the new folder, the case with its --set texts first. */
static sf_status write_files(folder *f, sf_error *err) {
    const sf_case_folder_request *q = f->request;
    SF_OWNED char *path = sf_path_whole(NULL, q->case_path, err);
    part whole = {f, path, CASE_NAME};
    f->case_folder = path ? sf_case_folder_of(path, err) : NULL;
    f->text = f->case_folder ? sf_case_load_marked(q->case_path, false, err) : NULL;
    for (int k = 0; k < q->override_count && err->status == SF_OK; k++)
        sf_case_edit_set(&f->text, q->case_path, q->overrides[k], err);
    if (err->status == SF_OK && sf_case_edit_find(f->text, true, &f->named, err) == SF_OK &&
        add_file(f, CASE_NAME, path, NULL, err) == SF_OK && write_readme(f, err) == SF_OK)
        write_part(&whole, f->text, err);
    return err->status;
}

static sf_status mesh_each(const sf_case *c, sf_meshed mesh[SF_GEOMETRIES], sf_error *err) {
    SF_OWNED_BY(sf_mesher_spare_end) sf_mesher_spare spare = {0};
    const sf_mesher_limits limits = {c->mesh_time_limit, NULL, &spare};
    for (int k = 0; k < SF_GEOMETRIES && err->status == SF_OK; k++)
        if (sf_case_geometry(c, k)->path)
            sf_mesher_run(sf_case_geometry(c, k), &limits, &mesh[k], err);
    return err->status;
}

/* Checks that the new case reads no file outside of the new folder. */
static sf_status check_reading(const folder *f, const sf_broker *read, const char *root, sf_error *err) {
    for (size_t k = 0; k < read->count && err->status == SF_OK; k++) {
        SF_OWNED char *whole = sf_path_whole(NULL, read->file[k].path, err);
        if (whole && !sf_path_below(root, whole))
            SF_REFUSE(err,
                      "%s has no folder of its own: its geometry reads %s by a path from /; name it relative "
                      "to the geometry",
                      f->request->case_path, whole);
    }
    return err->status;
}

static sf_status check_meshes(const folder *f, const sf_case *c, sf_error *err) {
    sf_meshed mesh[SF_GEOMETRIES] = {0};
    SF_OWNED char *root = sf_path_whole(NULL, f->tree.aside, err);
    if (root)
        mesh_each(c, mesh, err);
    for (int k = 0; k < SF_GEOMETRIES && err->status == SF_OK; k++)
        if (check_reading(f, &mesh[k].broker, root, err) == SF_OK &&
            (mesh[k].size != f->mesh[k].size ||
             (mesh[k].size > 0 && memcmp(mesh[k].stream, f->mesh[k].stream, mesh[k].size) != 0)))
            SF_REFUSE(err, "%s has no folder of its own: in another folder %s gives another mesh",
                      f->request->case_path, sf_case_geometry(&f->c, k)->path);
    for (int k = 0; k < SF_GEOMETRIES; k++)
        sf_meshed_free(&mesh[k]);
    return err->status;
}

/* The new folder is the same case, and needs no other. */
static sf_status check(const folder *f, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    sf_error inner = SF_ERROR_INIT;
    SF_PRINTED(path, PATH_SIZE, "%s/" CASE_NAME, f->tree.aside);
    if (sf_case_read(path, 0, NULL, NULL, &c, &inner) != SF_OK)
        return SF_FAIL(err, inner.status,
                       "%s cannot be given a folder of its own: there it would be refused (%s)",
                       f->request->case_path, inner.text);
    if (sf_case_hash(&c) != f->hash)
        SF_FAIL(err, SF_ERR_LIBRARY, "%s cannot be given a folder of its own: there it would be another case",
                f->request->case_path);
    else
        check_meshes(f, &c, err);
    return err->status;
}

static void release(folder *f) {
    sf_tree_end(&f->tree);
    for (int k = 0; k < f->count; k++)
        SF_FREE(f->file[k].name, f->file[k].path, f->file[k].text);
    free(f->file);
    for (int k = 0; k < f->read_count; k++)
        SF_FREE(f->read[k].geometry, f->read[k].path);
    free(f->read);
    for (int k = 0; k < SF_GEOMETRIES; k++)
        sf_meshed_free(&f->mesh[k]);
    SF_FREE(f->named.setting, f->text, f->case_folder);
    sf_case_free(&f->c);
}

sf_status sf_case_folder_make(const sf_case_folder_request *q, const sf_sink *sink, sf_error *err) {
    folder f = {.request = q};
    if (sf_tree_begin(q->folder, &f.tree, err) == SF_OK &&
        sf_case_read(q->case_path, q->override_count, q->overrides, sink, &f.c, err) == SF_OK) {
        f.hash = sf_case_hash(&f.c);
        if (mesh_each(&f.c, f.mesh, err) == SF_OK && list_reading(&f, err) == SF_OK &&
            write_files(&f, err) == SF_OK && check(&f, err) == SF_OK)
            sf_tree_commit(&f.tree, err);
    }
    release(&f);
    return err->status;
}
