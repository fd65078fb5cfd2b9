/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/gmsh_session.h"

#include "pre/mesh/geo_parameters.h"
#include "pre/mesh/geometry_check.h"
#include "pre/mesh/gmsh_adapter.h"
#include "pre/mesh/gmsh_size.h"
#include "pre/mesh/memory.h"
#include "pre/mesh/mesh_raw.h"

#include <errno.h>
#include <gmshc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef _OPENMP
#include <omp.h>
#endif

enum { NAME_SIZE = 256, TRIAL_SECONDS = 600 };

/* A physical group of the open model. */
typedef struct group {
    int tag;
    char name[NAME_SIZE]; /* "" if it has none */
    int *entity;          /* [count], from gmsh */
    size_t count;
} group;

typedef struct group_list {
    int dimension;
    size_t count;
    group *item;
} group_list;

struct sf_gmsh {
    bool initialised;
    int threads; /* of OpenMP before gmsh set its own number */
    char version[32];
    char file[512];
};

const char *sf_gmsh_version(const sf_gmsh *session) {
    return session->version;
}

/* The first message of gmsh that begins with "Error": it carries file and line, which `ierr` does not. */
static sf_status check_log(const sf_gmsh *session, int ierr, const char *action, sf_error *err) {
    char **log = NULL;
    size_t count = 0;
    int ignored;
    gmshLoggerGet(&log, &count, &ignored);
    const char *message = NULL;
    for (size_t i = 0; i < count && !message; i++)
        if (strncmp(log[i], "Error", 5) == 0)
            message = log[i] + 5 + strspn(log[i] + 5, " :");
    if (message)
        SF_FAIL(err, SF_ERR_INPUT, "gmsh, %s %s: %s", action, session->file, message);
    else if (ierr)
        SF_FAIL(err, SF_ERR_LIBRARY, "gmsh failed %s %s (code %d, no message)", action, session->file, ierr);
    for (size_t i = 0; i < count; i++)
        gmshFree(log[i]);
    gmshFree(log);
    return err->status;
}

static void stop(sf_gmsh *session) {
    int ierr = 0;
    if (!session->initialised)
        return;
    gmshLoggerStop(&ierr); /* drops the messages, which would survive the end of the session */
    gmshFinalize(&ierr);
    session->initialised = false;
}

/* gmsh keeps options and messages of earlier files; only ending and starting it anew clears them. */
static sf_status restart(sf_gmsh *session, sf_error *err) {
    int ierr = 0;
    stop(session);
    ierr = sf_gmsh_adapter_initialize();
    if (ierr)
        return SF_FAIL(err, SF_ERR_LIBRARY, "gmsh cannot be started (code %d)", ierr);
    session->initialised = true;
    gmshOptionSetNumber("General.Terminal", 0.0, &ierr);
    gmshOptionSetNumber("General.AbortOnError", 0.0, &ierr);
    gmshOptionSetNumber("Mesh.Algorithm3D", 1.0, &ierr);
    gmshLoggerStart(&ierr);
    return SF_OK;
}

sf_status sf_gmsh_begin(sf_gmsh **session, sf_error *err) {
    *session = sf_alloc(err, 1, sizeof **session, "the gmsh session");
    if (!*session)
        return err->status;
#ifdef _OPENMP
    (*session)->threads = omp_get_max_threads();
#endif
    if (restart(*session, err) != SF_OK)
        sf_gmsh_end(session);
    else
        sf_gmsh_adapter_version((*session)->version, sizeof(*session)->version);
    return err->status;
}

void sf_gmsh_end(sf_gmsh **session) {
    if (!*session)
        return;
    stop(*session);
#ifdef _OPENMP
    omp_set_num_threads((*session)->threads);
#endif
    free(*session);
    *session = NULL;
}

static bool has_suffix(const char *path, const char *suffix) {
    size_t n = strlen(path), m = strlen(suffix);
    return n > m && strcasecmp(path + n - m, suffix) == 0;
}

/* Sets the parameters by a small .geo that is merged first. (gmsh's own -setnumber would outlive the session
 * and reach the next geometry; its variables outlive it too, hence the deletion.) */
static sf_status merge_parameters(sf_gmsh *session, const sf_geo_source *source, sf_error *err) {
    const char *folder = getenv("TMPDIR");
    char path[512];
    int length = snprintf(path, sizeof path, "%s/softfall-XXXXXX.geo", folder && *folder ? folder : "/tmp");
    int handle = length < (int)sizeof path ? mkstemps(path, 4) : -1;
    FILE *out = handle >= 0 ? fdopen(handle, "w") : NULL;
    if (!out) {
        if (handle >= 0)
            close(handle);
        return SF_FAIL(err, SF_ERR_IO, "the temporary file %s cannot be written: %s", path, strerror(errno));
    }
    fputs("Delete Variables;\n", out);
    for (int k = 0; k < source->parameter_count; k++)
        fprintf(out, "%s = %.17g;\n", source->parameter[k].name, source->parameter[k].value);
    int ierr = 0;
    if (fclose(out) != 0)
        SF_FAIL(err, SF_ERR_IO, "the temporary file %s cannot be written: %s", path, strerror(errno));
    else
        gmshMerge(path, &ierr);
    unlink(path);
    return err->status != SF_OK ? err->status : check_log(session, ierr, "setting the parameters of", err);
}

static bool has_elements(int dimension) {
    int *types = NULL, ierr = 0;
    size_t count = 0;
    gmshModelMeshGetElementTypes(&types, &count, dimension, -1, &ierr);
    gmshFree(types);
    return count > 0;
}

static sf_status merge_source(sf_gmsh *session, const sf_geo_source *source, sf_error *err) {
    int ierr = 0;
    if (restart(session, err) != SF_OK)
        return err->status;
    gmshModelAdd("geometry", &ierr);
    if (merge_parameters(session, source, err) != SF_OK)
        return err->status;
    gmshMerge(source->path, &ierr);
    return check_log(session, ierr, "reading", err);
}

/* gmsh does not check a mesh file: a damaged one can crash it or make it allocate any amount of memory. So a
 * child process reads the file first; this process reads it only if the child succeeds. */
static sf_status try_mesh(sf_gmsh *session, const sf_geo_source *source, sf_error *err) {
    int status = 0;
    fflush(NULL);
    pid_t child = fork();
    if (child < 0)
        return SF_FAIL(err, SF_ERR_IO, "no process to try %s in: %s", source->path, strerror(errno));
    if (child == 0) {
        const struct rlimit no_core = {0, 0}, seconds = {TRIAL_SECONDS, TRIAL_SECONDS};
        static const int fatal[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};
        sf_error ignored = SF_ERROR_INIT; /* met again in earnest */
        for (size_t k = 0; k < sizeof fatal / sizeof fatal[0]; k++)
            signal(fatal[k], SIG_DFL); /* a crash is expected: no handler of anyone shall report it */
        if (!freopen("/dev/null", "w", stderr))
            _exit(1);
        setrlimit(RLIMIT_CORE, &no_core);
        setrlimit(RLIMIT_CPU, &seconds);
        sf_memory_limit_process();
        merge_source(session, source, &ignored);
        has_elements(3);
        _exit(0);
    }
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return SF_FAIL(err, SF_ERR_IO, "the trial of %s was lost: %s", source->path, strerror(errno));
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT,
                   "%s: gmsh fails on it (%s): the mesh is damaged, or larger than the memory", source->path,
                   WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "it ends the process");
}

sf_status sf_gmsh_load(sf_gmsh *session, const sf_geo_source *source, sf_error *err) {
    int ierr = 0;
    bool is_mesh = has_suffix(source->path, ".msh");
    if (sf_geometry_check(source->path, err) != SF_OK || sf_geo_parameters_check(source, err) != SF_OK)
        return err->status;
    snprintf(session->file, sizeof session->file, "%s", source->path);
    if ((is_mesh && try_mesh(session, source, err) != SF_OK) || merge_source(session, source, err) != SF_OK)
        return err->status;
    if (!has_elements(3) && !is_mesh) {
        /* The file may have set another number of threads, with which meshes differ from run to run. */
        gmshOptionSetNumber("General.NumThreads", 1.0, &ierr);
        static const char *const per_dimension[] = {"Mesh.MaxNumThreads1D", "Mesh.MaxNumThreads2D",
                                                    "Mesh.MaxNumThreads3D"};
        for (int i = 0; i < 3; i++)
            gmshOptionSetNumber(per_dimension[i], 1.0, &ierr);
        if (sf_gmsh_check_size(source->path, err) != SF_OK)
            return err->status;
        gmshModelMeshGenerate(3, &ierr);
        if (check_log(session, ierr, "meshing", err) != SF_OK)
            return err->status;
    }
    if (!has_elements(3) && !has_elements(2))
        return SF_FAIL(err, SF_ERR_INPUT, "%s holds no mesh%s", session->file,
                       is_mesh ? "" : ": gmsh found no volume or surface to mesh");
    return SF_OK;
}

static void free_groups(group_list *list) {
    for (size_t g = 0; g < list->count; g++)
        gmshFree(list->item[g].entity);
    free(list->item);
    memset(list, 0, sizeof *list);
}

static sf_status read_groups(int dimension, group_list *list, sf_error *err) {
    int *pairs = NULL, ierr = 0;
    size_t length = 0;
    gmshModelGetPhysicalGroups(&pairs, &length, dimension, &ierr);
    *list = (group_list){dimension, 0, sf_alloc(err, length / 2, sizeof(group), "physical groups")};
    for (size_t g = 0; list->item && g < length / 2; g++) {
        group *item = &list->item[list->count++];
        char *name = NULL;
        item->tag = pairs[2 * g + 1];
        gmshModelGetPhysicalName(dimension, item->tag, &name, &ierr);
        snprintf(item->name, sizeof item->name, "%s", name ? name : "");
        gmshFree(name);
        gmshModelGetEntitiesForPhysicalGroup(dimension, item->tag, &item->entity, &item->count, &ierr);
        if (ierr)
            item->count = 0;
        for (size_t i = 0; i < item->count; i++)
            item->entity[i] = abs(item->entity[i]);
    }
    gmshFree(pairs);
    return err->status;
}

static const char *kind_of(int dimension) {
    return dimension == 3 ? "volume" : "surface";
}

/* "a", "b": the names of the groups, or "none". */
static const char *group_names(const group_list *list, char *out, size_t size) {
    size_t used = 0;
    snprintf(out, size, "none");
    for (size_t g = 0; g < list->count && used + NAME_SIZE + 8 < size; g++)
        if (*list->item[g].name)
            used +=
                (size_t)snprintf(out + used, size - used, "%s\"%s\"", used ? ", " : "", list->item[g].name);
    return out;
}

/* Two groups of one name, or an entity in two named groups: which of them is meant? */
static sf_status check_groups(const sf_gmsh *session, const group_list *list, sf_error *err) {
    for (size_t a = 0; a < list->count; a++) {
        const group *p = &list->item[a];
        for (size_t b = a + 1; b < list->count && *p->name; b++) {
            const group *q = &list->item[b];
            if (strcmp(p->name, q->name) == 0)
                return SF_FAIL(err, SF_ERR_INPUT,
                               "%s has two %s groups called \"%s\" (physical tags %d and %d)", session->file,
                               kind_of(list->dimension), p->name, p->tag, q->tag);
            for (size_t i = 0; i < p->count && *q->name; i++)
                for (size_t j = 0; j < q->count; j++)
                    if (p->entity[i] == q->entity[j])
                        return SF_FAIL(err, SF_ERR_INPUT,
                                       "%s: %s %d belongs to two groups, \"%s\" and \"%s\"", session->file,
                                       kind_of(list->dimension), p->entity[i], p->name, q->name);
        }
    }
    return SF_OK;
}

static sf_status find_group(const sf_gmsh *session, const group_list *list, const char *name,
                            const group **found, sf_error *err) {
    *found = NULL;
    for (size_t g = 0; g < list->count; g++)
        if (strcmp(list->item[g].name, name) == 0)
            *found = &list->item[g];
    if (*found)
        return SF_OK;
    char volumes[300], surfaces[400];
    group_list other = {0};
    if (read_groups(5 - list->dimension, &other, err) != SF_OK)
        return err->status;
    group_names(list->dimension == 3 ? list : &other, volumes, sizeof volumes);
    group_names(list->dimension == 3 ? &other : list, surfaces, sizeof surfaces);
    bool step = has_suffix(session->file, ".step") || has_suffix(session->file, ".stp");
    SF_FAIL(err, SF_ERR_INPUT, "%s has no %s group \"%s\"; its volume groups: %s; its surface groups: %s%s",
            session->file, kind_of(list->dimension), name, volumes, surfaces,
            step ? "; gmsh reads no groups from a STEP file: name them in a .geo that merges it" : "");
    free_groups(&other);
    return err->status;
}

/* softfall's code and the vertex count of gmsh's linear element types; 0 for every other type. */
static int cell_code(int gmsh_type, int *vertices) {
    switch (gmsh_type) {
    case 4:
        *vertices = 4;
        return SF_CELL_TETRAHEDRON;
    case 5:
        *vertices = 8;
        return SF_CELL_HEXAHEDRON;
    case 6:
        *vertices = 6;
        return SF_CELL_PRISM;
    case 7:
        *vertices = 5;
        return SF_CELL_PYRAMID;
    default:
        return 0;
    }
}

static int face_vertices(int gmsh_type) {
    return gmsh_type == 2 ? 3 : gmsh_type == 3 ? 4 : 0;
}

/* Where the elements of one entity go. */
typedef struct destination {
    sf_raw_mesh *raw;
    int dimension;
    int tag;
    bool chosen;   /* cells */
    int32_t group; /* faces */
} destination;

static sf_status add_elements(const sf_gmsh *session, const destination *to, int type, const size_t *node,
                              size_t length, sf_error *err) {
    int vertices = 0, code = 0;
    if (to->dimension == 3)
        code = cell_code(type, &vertices);
    else
        vertices = face_vertices(type);
    if (vertices == 0) {
        char *name = NULL;
        int dimension, order, count, primary, ierr;
        double *local = NULL;
        size_t local_length = 0;
        gmshModelMeshGetElementProperties(type, &name, &dimension, &order, &count, &local, &local_length,
                                          &primary, &ierr);
        SF_FAIL(err, SF_ERR_INPUT,
                "%s: %s %d has elements of the type \"%s\"; only linear tetrahedra, pyramids, prisms, "
                "hexahedra, triangles and quadrangles are supported",
                session->file, kind_of(to->dimension), to->tag, name ? name : "unknown");
        gmshFree(name);
        gmshFree(local);
        return err->status;
    }
    for (size_t k = 0; k < length / (size_t)vertices && err->status == SF_OK; k++) {
        const size_t *tags = node + k * (size_t)vertices;
        if (to->dimension == 3)
            sf_raw_mesh_add_cell(to->raw, code, to->chosen, tags, vertices, err);
        else
            sf_raw_mesh_add_face(to->raw, to->group, to->tag, tags, vertices, err);
    }
    return err->status;
}

static sf_status read_entity(const sf_gmsh *session, const destination *to, sf_error *err) {
    int *types = NULL, ierr = 0;
    size_t type_count = 0, **elements = NULL, *element_counts = NULL, element_lists = 0;
    size_t **nodes = NULL, *node_counts = NULL, node_lists = 0;
    gmshModelMeshGetElements(&types, &type_count, &elements, &element_counts, &element_lists, &nodes,
                             &node_counts, &node_lists, to->dimension, to->tag, &ierr);
    if (ierr)
        return check_log(session, ierr, "reading elements of", err);
    for (size_t t = 0; t < type_count && err->status == SF_OK; t++)
        add_elements(session, to, types[t], nodes[t], node_counts[t], err);
    for (size_t t = 0; t < element_lists; t++)
        gmshFree(elements[t]);
    for (size_t t = 0; t < node_lists; t++)
        gmshFree(nodes[t]);
    gmshFree(types);
    gmshFree(elements);
    gmshFree(element_counts);
    gmshFree(nodes);
    gmshFree(node_counts);
    return err->status;
}

static sf_status read_nodes(const sf_gmsh *session, sf_raw_mesh *raw, sf_error *err) {
    size_t *tags = NULL, count = 0, coordinate_count = 0, parameter_count = 0;
    double *xyz = NULL, *parameters = NULL;
    int ierr = 0;
    gmshModelMeshGetNodes(&tags, &count, &xyz, &coordinate_count, &parameters, &parameter_count, -1, -1, 0, 0,
                          &ierr);
    if (check_log(session, ierr, "reading nodes of", err) == SF_OK) {
        raw->tag = sf_alloc(err, count, sizeof *raw->tag, "node tags");
        raw->xyz = sf_alloc(err, 3 * count, sizeof *raw->xyz, "node positions");
        if (err->status == SF_OK && count > 0) {
            raw->node_count = count;
            memcpy(raw->tag, tags, count * sizeof *tags);
            memcpy(raw->xyz, xyz, 3 * count * sizeof *xyz);
        }
        gmshFree(tags);
        gmshFree(xyz);
        gmshFree(parameters);
    }
    return err->status;
}

/* All cells of all volumes; those of `chosen` (may be NULL) are marked. */
static sf_status read_cells(const sf_gmsh *session, const group *chosen, sf_raw_mesh *raw, sf_error *err) {
    int *pairs = NULL, ierr = 0;
    size_t length = 0;
    gmshModelGetEntities(&pairs, &length, 3, &ierr);
    for (size_t i = 0; i < length / 2 && err->status == SF_OK; i++) {
        destination to = {.raw = raw, .dimension = 3, .tag = pairs[2 * i + 1]};
        for (size_t k = 0; chosen && k < chosen->count; k++)
            to.chosen = to.chosen || chosen->entity[k] == to.tag;
        size_t before = raw->cell_count;
        if (read_entity(session, &to, err) == SF_OK && to.chosen && raw->cell_count == before)
            SF_FAIL(err, SF_ERR_INPUT, "%s: volume %d of the group \"%s\" holds no cells", session->file,
                    to.tag, chosen->name);
    }
    gmshFree(pairs);
    return err->status;
}

static sf_status read_faces(const sf_gmsh *session, const group *g, sf_raw_mesh *raw, sf_error *err) {
    char **names = realloc(raw->group_name, (size_t)(raw->group_count + 1) * sizeof *names);
    if (names)
        raw->group_name = names;
    char *name = names ? strdup(g->name) : NULL;
    if (!name)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the group \"%s\"", g->name);
    raw->group_name[raw->group_count++] = name;
    size_t before = raw->face_count;
    for (size_t i = 0; i < g->count && err->status == SF_OK; i++) {
        destination to = {
            .raw = raw, .dimension = 2, .tag = g->entity[i], .group = (int32_t)(raw->group_count - 1)};
        read_entity(session, &to, err);
    }
    if (err->status == SF_OK && raw->face_count == before)
        SF_FAIL(err, SF_ERR_INPUT, "%s: the surface group \"%s\" is empty: it holds no mesh faces",
                session->file, g->name);
    return err->status;
}

sf_status sf_gmsh_read_mesh(sf_gmsh *session, const char *pad_group, double unit, sf_mesh *mesh,
                            sf_error *err) {
    group_list volumes = {0}, surfaces = {0};
    sf_raw_mesh raw = {0};
    const group *pad = NULL;
    memset(mesh, 0, sizeof *mesh);
    if (read_groups(3, &volumes, err) != SF_OK || read_groups(2, &surfaces, err) != SF_OK ||
        find_group(session, &volumes, pad_group, &pad, err) != SF_OK ||
        check_groups(session, &volumes, err) != SF_OK || check_groups(session, &surfaces, err) != SF_OK)
        goto done;
    if (read_nodes(session, &raw, err) != SF_OK || read_cells(session, pad, &raw, err) != SF_OK)
        goto done;
    if (pad->count == 0) {
        SF_FAIL(err, SF_ERR_INPUT, "%s: the volume group \"%s\" is empty", session->file, pad_group);
        goto done;
    }
    for (size_t g = 0; g < surfaces.count; g++)
        if (*surfaces.item[g].name && read_faces(session, &surfaces.item[g], &raw, err) != SF_OK)
            goto done;
    sf_mesh_assemble(&raw, unit, mesh, err);
done:
    sf_raw_mesh_free(&raw);
    free_groups(&volumes);
    free_groups(&surfaces);
    return err->status;
}

sf_status sf_gmsh_read_surface(sf_gmsh *session, const char *surface_group, double unit, sf_surface *surface,
                               sf_error *err) {
    group_list surfaces = {0};
    sf_raw_mesh raw = {0};
    const group *found = NULL;
    memset(surface, 0, sizeof *surface);
    if (read_groups(2, &surfaces, err) != SF_OK ||
        find_group(session, &surfaces, surface_group, &found, err) != SF_OK ||
        check_groups(session, &surfaces, err) != SF_OK)
        goto done;
    if (read_nodes(session, &raw, err) == SF_OK && read_cells(session, NULL, &raw, err) == SF_OK &&
        read_faces(session, found, &raw, err) == SF_OK)
        sf_surface_assemble(&raw, unit, surface, err);
done:
    sf_raw_mesh_free(&raw);
    free_groups(&surfaces);
    return err->status;
}
