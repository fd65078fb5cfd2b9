/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesher/work.h"

#include <errno.h>
#include <gmshc.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/sets.h"
#include "pre/mesh/mesher_protocol.h"

/* The C API of gmsh differs between its versions from 4.8 on. */
#define API_AT_LEAST(major, minor)                                                                           \
    (GMSH_API_VERSION_MAJOR > (major) ||                                                                     \
     (GMSH_API_VERSION_MAJOR == (major) && GMSH_API_VERSION_MINOR >= (minor)))

#if !API_AT_LEAST(4, 8)
#error "softfall needs gmsh 4.8 or newer"
#endif

/* Starts gmsh without its configuration files and without its window. Returns its code: 0 on success. */
static int initialize(void) {
    char name[] = "softfall-pre";
    char *argv[] = {name, NULL};
    int ierr = 0;
#if API_AT_LEAST(4, 9)
    gmshInitialize(1, argv, 0, 0, &ierr);
#else
    gmshInitialize(1, argv, 0, &ierr);
#endif
    return ierr;
}

/* Writes the version of the library that runs, for example "4.8.4", which may be newer than the header. */
static void write_version(char *out, size_t size) {
    char *version = NULL;
    int ierr = 0;
    gmshOptionGetString("General.Version", &version, &ierr);
    snprintf(out, size, "%s", ierr == 0 && version ? version : GMSH_API_VERSION);
    gmshFree(version);
}

/* The mesh stream (pre/mesh/mesher_protocol.h) to SF_MESHER_DATA. A parent that does not listen ends this
 * process. */
enum { ROOM = 65536 };

static char block[ROOM];
static size_t used;

static void write_all(const char *data, size_t size) {
    while (size > 0) {
        ssize_t written = write(SF_MESHER_DATA, data, size);
        if (written < 0 && errno != EINTR)
            _exit(1);
        data += written > 0 ? written : 0;
        size -= written > 0 ? (size_t)written : 0;
    }
}

static void stream_flush(void) {
    write_all(block, used);
    used = 0;
}

/* `size` bytes, a multiple of 8. */
static void stream_words(const void *data, size_t size) {
    if (used + size > ROOM)
        stream_flush();
    if (size > ROOM) {
        write_all(data, size);
    } else if (size > 0) {
        memcpy(block + used, data, size);
        used += size;
    }
}

static void stream_word(uint64_t word) {
    stream_words(&word, sizeof word);
}

static void stream_int(int value) {
    stream_word((uint64_t)(int64_t)value);
}

static void stream_text(const char *text) {
    size_t length = strlen(text);
    uint64_t last = 0;
    stream_word(length);
    stream_words(text, length / 8 * 8);
    memcpy(&last, text + length / 8 * 8, length % 8);
    if (length % 8 > 0)
        stream_word(last);
}

static void write_head(const char *error) {
    char version[32];
    write_version(version, sizeof version);
    stream_word(SF_MESH_STREAM_BEGIN);
    stream_text(version);
    stream_text(error);
}

static void write_error(const char *error) {
    write_head(error);
    stream_word(SF_MESH_STREAM_END);
    stream_flush();
}

/* The first message of gmsh that begins with "Error" carries file and line, which `ierr` does not. True if
 * there is none and `ierr` is 0; else the stream holds it. */
static bool check(int ierr, const char *action) {
    char **log = NULL, text[1000] = "";
    size_t count = 0;
    int ignored;
    gmshLoggerGet(&log, &count, &ignored);
    for (size_t i = 0; i < count && !*text; i++)
        if (strncmp(log[i], "Error", 5) == 0)
            snprintf(text, sizeof text, "%s: %s", action, log[i] + 5 + strspn(log[i] + 5, " :"));
    if (!*text && ierr)
        snprintf(text, sizeof text, "%s: it fails without a message (code %d)", action, ierr);
    if (*text)
        write_error(text);
    return !*text;
}

int sf_work_begin(void) {
    int ierr = initialize();
    if (ierr)
        return ierr;
    gmshOptionSetNumber("General.AbortOnError", 0.0, &ierr);
    gmshOptionSetNumber("Mesh.Algorithm3D", 1.0, &ierr);
    gmshLoggerStart(&ierr);
    gmshModelAdd("geometry", &ierr);
    return ierr;
}

/* gmsh scales a mesh when it writes one, so that its factor would have no effect here. */
static bool has_plain_scale(void) {
    int ierr = 0;
    double factor = 1;
    char text[200];
    gmshOptionGetNumber("Mesh.ScalingFactor", &factor, &ierr);
    if (ierr || factor == 1)
        return true;
    snprintf(text, sizeof text,
             "Mesh.ScalingFactor is %g: it scales files that gmsh writes, not the geometry; leave it at 1 "
             "and give the unit by geometry.length_unit",
             factor);
    write_error(text);
    return false;
}

_Bool sf_work_parse(const char *parameters, const char *path) {
    int ierr = 0;
    gmshMerge(parameters, &ierr);
    if (!check(ierr, "setting the parameters"))
        return false;
    gmshMerge(path, &ierr);
    return check(ierr, "reading") && has_plain_scale();
}

static bool has_elements(int dimension) {
    int *types = NULL, ierr = 0;
    size_t count = 0;
    gmshModelMeshGetElementTypes(&types, &count, dimension, -1, &ierr);
    gmshFree(types);
    return count > 0;
}

/* With several threads meshes differ from run to run; the file may have asked for them. */
static void mesh_on_one_thread(void) {
    static const char *const numbers[] = {"General.NumThreads", "Mesh.MaxNumThreads1D",
                                          "Mesh.MaxNumThreads2D", "Mesh.MaxNumThreads3D"};
    int ierr = 0;
    for (int i = 0; i < 4; i++)
        gmshOptionSetNumber(numbers[i], 1.0, &ierr);
}

static void write_nodes(void) {
    size_t *tags = NULL, count = 0, coordinates = 0, parameters = 0;
    double *xyz = NULL, *parameter = NULL;
    int ierr = 0;
    gmshModelMeshGetNodes(&tags, &count, &xyz, &coordinates, &parameter, &parameters, -1, -1, 0, 0, &ierr);
    if (ierr)
        _exit(1); /* the stream has begun: the parent says that gmsh failed */
    stream_word(count);
    stream_words(tags, count * sizeof *tags);
    stream_words(xyz, 3 * count * sizeof *xyz);
    gmshFree(tags);
    gmshFree(xyz);
    gmshFree(parameter);
}

typedef struct entity_list {
    int *entity;
    size_t count;
} entity_list;

/* Sorts and drops what is there twice. */
static size_t sort_entities(int *entity, size_t count) {
    size_t kept = 0;
    if (count > 0)
        qsort(entity, count, sizeof *entity, sf_by_number);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || entity[i] != entity[i - 1])
            entity[kept++] = entity[i];
    return kept;
}

/* More entities for a list. */
static void append(entity_list *list, const int *entity, size_t count) {
    list->entity = realloc(list->entity, (list->count + count + 1) * sizeof *list->entity);
    if (!list->entity)
        _exit(1);
    memcpy(list->entity + list->count, entity, count * sizeof *entity);
    list->count += count;
}

/* The groups of a dimension go to the stream; the entities of the named ones to `named` too, unless NULL. */
static void write_groups(int dimension, const int *pairs, size_t length, entity_list *named) {
    for (size_t g = 0; g < length / 2; g++) {
        int *member = NULL, ierr = 0, tag = pairs[2 * g + 1];
        size_t members = 0;
        char *name = NULL;
        gmshModelGetPhysicalName(dimension, tag, &name, &ierr);
        gmshModelGetEntitiesForPhysicalGroup(dimension, tag, &member, &members, &ierr);
        if (ierr)
            members = 0;
        stream_int(dimension);
        stream_int(tag);
        stream_text(name ? name : "");
        stream_word(members);
        for (size_t i = 0; i < members; i++) {
            member[i] = abs(member[i]);
            stream_int(member[i]);
        }
        if (named && name && *name && members > 0)
            append(named, member, members);
        gmshFree(name);
        gmshFree(member);
    }
}

/* The elements of some entities: first they are counted, then written. */
typedef struct element_list {
    bool counting;
    size_t count;
} element_list;

static void write_block(int dimension, int entity, int type, const size_t *node, size_t length) {
    char *name = NULL;
    int type_dimension, order, vertices, primary, ierr;
    double *local = NULL;
    size_t local_length = 0;
    gmshModelMeshGetElementProperties(type, &name, &type_dimension, &order, &vertices, &local, &local_length,
                                      &primary, &ierr);
    stream_int(dimension);
    stream_int(entity);
    stream_int(type);
    stream_text(name ? name : "unknown");
    stream_word(length);
    stream_words(node, length * sizeof *node);
    gmshFree(name);
    gmshFree(local);
}

static void list_entity(element_list *list, int dimension, int entity) {
    int *types = NULL, ierr = 0;
    size_t type_count = 0, **elements = NULL, *element_counts = NULL, element_lists = 0;
    size_t **nodes = NULL, *node_counts = NULL, node_lists = 0;
    gmshModelMeshGetElements(&types, &type_count, &elements, &element_counts, &element_lists, &nodes,
                             &node_counts, &node_lists, dimension, entity, &ierr);
    if (ierr)
        return; /* a group of an entity that does not exist: it has no elements */
    for (size_t t = 0; t < type_count; t++) {
        list->count += list->counting;
        if (!list->counting)
            write_block(dimension, entity, types[t], nodes[t], node_counts[t]);
    }
    for (size_t t = 0; t < element_lists; t++)
        gmshFree(elements[t]);
    for (size_t t = 0; t < node_lists; t++)
        gmshFree(nodes[t]);
    gmshFree(types);
    gmshFree(elements);
    gmshFree(element_counts);
    gmshFree(nodes);
    gmshFree(node_counts);
}

static void write_elements(const entity_list *curves, const int *surface, size_t surfaces, const int *volume,
                           size_t volumes) {
    for (int counting = 1; counting >= 0; counting--) {
        element_list list = {.counting = counting};
        for (size_t i = 0; i < curves->count; i++)
            list_entity(&list, 1, curves->entity[i]);
        for (size_t i = 0; i < surfaces; i++)
            list_entity(&list, 2, surface[i]);
        for (size_t i = 0; i < volumes; i++)
            list_entity(&list, 3, volume[i]);
        if (counting)
            stream_word(list.count);
    }
}

static void write_mesh(void) {
    int *pairs[3] = {NULL, NULL, NULL}, *volume = NULL, ierr = 0;
    size_t length[3] = {0, 0, 0}, volumes = 0;
    entity_list curve = {NULL, 0}, surface = {NULL, 0};
    write_head("");
    write_nodes();
    for (int k = has_elements(3) ? 1 : 0; k < 3; k++) /* curves bound a section, where there are no cells */
        gmshModelGetPhysicalGroups(&pairs[k], &length[k], k + 1, &ierr);
    stream_word((length[0] + length[1] + length[2]) / 2);
    write_groups(1, pairs[0], length[0], &curve);
    write_groups(2, pairs[1], length[1], &surface);
    write_groups(3, pairs[2], length[2], NULL);
    curve.count = sort_entities(curve.entity, curve.count);
    surface.count = sort_entities(surface.entity, surface.count);
    gmshModelGetEntities(&volume, &volumes, 3, &ierr);
    volumes /= 2;
    for (size_t i = 0; i < volumes; i++)
        volume[i] = volume[2 * i + 1];
    volumes = sort_entities(volume, volumes);
    write_elements(&curve, surface.entity, surface.count, volume, volumes);
    stream_word(SF_MESH_STREAM_END);
    stream_flush();
    for (int k = 0; k < 3; k++)
        gmshFree(pairs[k]);
    gmshFree(volume);
    free(surface.entity);
    free(curve.entity);
}

/* True if a curve is in a group: the profile of a body of revolution. */
static bool has_profile(void) {
    int *pairs = NULL, ierr = 0;
    size_t length = 0;
    gmshModelGetPhysicalGroups(&pairs, &length, 1, &ierr);
    gmshFree(pairs);
    return length > 0 && has_elements(1);
}

void sf_work_mesh(const char *path) {
    int ierr = 0;
    bool is_mesh = sf_mesher_has_suffix(path, ".msh");
    if (!has_elements(3) && !is_mesh) {
        mesh_on_one_thread();
        gmshModelMeshGenerate(3, &ierr);
        if (!check(ierr, "meshing"))
            return;
    }
    if (has_elements(3) || has_elements(2) || has_profile())
        write_mesh();
    else
        write_error(is_mesh ? "it holds no mesh" : "it holds no mesh: there is no volume or surface to mesh");
}
