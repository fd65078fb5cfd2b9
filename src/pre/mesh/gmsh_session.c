/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/gmsh_session.h"

#include "base/near.h"
#include "base/sets.h"
#include "io/plain_file.h"
#include "pre/mesh/mesh_store.h"
#include "pre/mesh/mesher_protocol.h"
#include "pre/mesh/missile_shape.h"

#include <unistd.h>

/* Memory of softfall-pre at its peak, per node of the mesh: measured on the example pad
 * (docs/reliability.md). */
static const double BYTES_PER_NODE = 4500;

sf_status sf_gmsh_begin(sf_gmsh **session, sf_error *err) {
    *session = sf_alloc(err, 1, sizeof **session, "the gmsh session");
    return err->status;
}

void sf_gmsh_end(sf_gmsh **session) {
    if (!*session)
        return;
    sf_mesher_spare_end(&(*session)->spare);
    sf_meshed_free(&(*session)->open);
    SF_FREE((*session)->files, *session);
    *session = NULL;
}

/* A file that gmsh asked for by `path`, links unresolved. One that was asked for by its place below the
 * folder of `geometry` is listed by that place, and also by its whole path if the geometry itself may have
 * named that: then the two look the same. */
static void list_file(FILE *out, uint64_t hash, const char *path, const char *geometry) {
    const char *slash = strrchr(geometry, '/');
    size_t folder = slash ? (size_t)(slash + 1 - geometry) : 0;
    bool below = folder > 0 ? strncmp(path, geometry, folder) == 0 : *path != '/';
    char here[PATH_MAX];
    const char *inside = path + folder + (below ? strspn(path + folder, "/") : 0);
    if (below)
        fprintf(out, "%016llx %s\n", (unsigned long long)hash, inside);
    if (*path == '/' && strcmp(path, geometry) != 0)
        fprintf(out, "%016llx %s\n", (unsigned long long)hash, path);
    else if (!below)
        fprintf(out, "%016llx %s/%s\n", (unsigned long long)hash, getcwd(here, sizeof here) ? here : "",
                path);
}

/* The files that the open geometry read; from malloc. */
static char *list_files(const sf_meshed *open, const char *geometry, sf_error *err) {
    const sf_broker *read = &open->broker;
    SF_TEXT_STREAM(out, text, size);
    if (!out) {
        SF_NO_MEMORY(err, "the files of a geometry");
        return NULL;
    }
    fprintf(out, SF_GMSH_FILES_OF "\n");
    if (!open->confined)
        fputs(SF_GMSH_UNKNOWN_FILES "\n", out);
    for (size_t k = 0; k < read->count; k++)
        list_file(out, read->file[k].hash, read->file[k].path, geometry);
    fclose(out);
    return text;
}

/* After those of the earlier geometries. */
static sf_status add_files(sf_gmsh *session, const char *files, sf_error *err) {
    char *all = NULL;
    if (asprintf(&all, "%s%s", session->files ? session->files : "", files) < 0)
        return SF_NO_MEMORY(err, "the files of a geometry");
    free(session->files);
    session->files = all;
    return SF_OK;
}

/* By gmsh. */
static char *mesh(sf_gmsh *session, const sf_geo_source *source, sf_error *err) {
    if (sf_mesher_run(source, &session->limits, &session->open, err) != SF_OK)
        return NULL;
    char *files = list_files(&session->open, source->path, err);
    if (files)
        sf_mesh_store_keep(session->store, source, &session->open, files);
    return files;
}

sf_status sf_gmsh_load(sf_gmsh *session, const sf_geo_source *source, sf_error *err) {
    const sf_meshed *open = &session->open;
    const char *unconfined = getenv("SOFTFALL_UNCONFINED");
    SF_OWNED char *files = NULL;
    sf_meshed_free(&session->open);
    snprintf(session->file, sizeof session->file, "%s", source->path);
    if ((unconfined && *unconfined) || !sf_mesh_store_find(session->store, source, &session->open, &files))
        files = mesh(session, source, err);
    SF_TRY(err->status);
    snprintf(session->version, sizeof session->version, "%s%s", open->data.version,
             open->confined ? "" : " (unconfined)");
    add_files(session, files, err);
    return err->status;
}

static const char *kind_of(int dimension) {
    static const char *const kinds[] = {"curve", "surface", "volume"};
    return kinds[dimension - 1];
}

/* "a", "b", number 3 without a name: the groups, or "none". */
static const char *group_names(const sf_geo_data *data, int dimension, char *out, size_t size) {
    size_t used = 0;
    snprintf(out, size, "none");
    for (size_t g = 0; g < data->group_count && used + SF_GEO_NAME_SIZE + 8 < size; g++)
        if (data->group[g].dimension == dimension && *data->group[g].name)
            used +=
                (size_t)snprintf(out + used, size - used, "%s\"%s\"", used ? ", " : "", data->group[g].name);
        else if (data->group[g].dimension == dimension)
            used += (size_t)snprintf(out + used, size - used, "%snumber %d without a name", used ? ", " : "",
                                     data->group[g].tag);
    return out;
}

/* A named group's claim to an entity, or its name's place among the names. */
typedef struct claim {
    int32_t entity;
    const sf_geo_group *group;
} claim;

SF_ORDER_BY(compare_claims, claim, entity, group)

static int compare_names(const void *a, const void *b) {
    const claim *p = a, *q = b;
    int order = strcmp(p->group->name, q->group->name);
    return order ? order : compare_claims(a, b);
}

/* The named groups of a dimension, by their entities or (`names`) once each; from sf_alloc. */
static claim *list_claims(const sf_geo_data *data, int dimension, bool names, size_t *count, sf_error *err) {
    size_t total = 0;
    for (size_t g = 0; g < data->group_count; g++)
        total += names ? 1 : data->group[g].count;
    claim *list = sf_alloc(err, total, sizeof *list, "the entities of groups");
    *count = 0;
    for (size_t g = 0; list && g < data->group_count; g++) {
        const sf_geo_group *group = &data->group[g];
        if (group->dimension != dimension || !*group->name)
            continue;
        for (size_t i = 0; i < (names ? 1 : group->count); i++)
            list[(*count)++] = (claim){names ? 0 : group->entity[i], group};
    }
    if (*count > 0)
        qsort(list, *count, sizeof *list, names ? compare_names : compare_claims);
    return list;
}

/* Two groups of one name, or an entity in two named groups: which of them is meant? */
static sf_status check_groups(const sf_gmsh *session, int dimension, sf_error *err) {
    size_t names = 0, entities = 0;
    SF_OWNED claim *name = list_claims(&session->open.data, dimension, true, &names, err),
                   *entity = list_claims(&session->open.data, dimension, false, &entities, err);
    for (size_t i = 1; name && i < names && err->status == SF_OK; i++)
        if (strcmp(name[i - 1].group->name, name[i].group->name) == 0)
            SF_REFUSE(err, "%s has two %s groups called \"%s\" (physical tags %d and %d)", session->file,
                      kind_of(dimension), name[i].group->name, name[i - 1].group->tag, name[i].group->tag);
    for (size_t i = 1; entity && i < entities && err->status == SF_OK; i++)
        if (entity[i - 1].entity == entity[i].entity && entity[i - 1].group != entity[i].group)
            SF_REFUSE(err, "%s: %s %d belongs to two groups, \"%s\" and \"%s\"", session->file,
                      kind_of(dimension), entity[i].entity, entity[i - 1].group->name, entity[i].group->name);
    return err->status;
}

/* Writes how groups get their names in a file that is no .geo, "" for a .geo; returns `out`. */
static const char *tell_naming(const sf_gmsh *session, int dimension, const char *name, char *out,
                               size_t size) {
    static const char *const shapes[] = {".step", ".stp", ".brep", ".iges", ".igs"}, *const meshes[] = {
                                                                                         ".msh", ".mesh",
                                                                                         ".vtk", ".stl",
                                                                                         ".unv", ".med",
                                                                                         ".bdf"};
    const sf_geo_data *data = &session->open.data;
    int number = 0;
    bool shape = false, mesh = false;
    for (size_t g = 0; g < data->group_count; g++)
        if (data->group[g].dimension == dimension && !*data->group[g].name)
            number = data->group[g].tag;
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
        shape = shape || sf_mesher_has_suffix(session->file, shapes[k]);
    for (size_t k = 0; k < sizeof meshes / sizeof *meshes; k++)
        mesh = mesh || sf_mesher_has_suffix(session->file, meshes[k]);
    *out = '\0';
    if (number > 0 && sf_mesher_has_suffix(session->file, ".msh"))
        snprintf(out, size, "; a line %d %d \"%s\" in its section $PhysicalNames gives number %d that name",
                 dimension, number, name, number);
    else if (shape || mesh)
        snprintf(out, size, "; %s: name them in a .geo beside it: Merge \"%s\"; Physical %s(\"%s\") = {%s};",
                 shape ? "gmsh reads no groups from such a file" : "none of its parts has a name",
                 sf_path_name(session->file), dimension == 3 ? "Volume" : "Surface", name,
                 dimension == 3 ? "1" : "1, 2");
    return out;
}

static sf_status find_group(const sf_gmsh *session, int dimension, const char *name,
                            const sf_geo_group **found, sf_error *err) {
    const sf_geo_data *data = &session->open.data;
    char volumes[300], surfaces[400], meant[SF_NEAR_HINT];
    sf_near near = sf_near_begin(name);
    *found = NULL;
    for (size_t g = 0; g < data->group_count; g++) {
        if (data->group[g].dimension != dimension)
            continue;
        if (strcmp(data->group[g].name, name) == 0)
            *found = &data->group[g];
        sf_near_offer(&near, data->group[g].name, strlen(data->group[g].name));
    }
    if (*found)
        return SF_OK;
    group_names(data, 3, volumes, sizeof volumes);
    group_names(data, 2, surfaces, sizeof surfaces);
    char how[400];
    return SF_REFUSE(err, "%s has no %s group \"%s\"%s; its volume groups: %s; its surface groups: %s%s",
                     session->file, kind_of(dimension), name, sf_near_hint(&near, meant), volumes, surfaces,
                     tell_naming(session, dimension, name, how, sizeof how));
}

/* softfall's code and the vertex count of gmsh's linear element types; 0 for every other type. */
static int cell_code(int gmsh_type, int *vertices) {
    static const int codes[] = {[2] = SF_CELL_TRIANGLE, SF_CELL_QUADRANGLE, SF_CELL_TETRAHEDRON,
                                SF_CELL_HEXAHEDRON,     SF_CELL_PRISM,      SF_CELL_PYRAMID};
    int code = gmsh_type >= 0 && gmsh_type <= 7 ? codes[gmsh_type] : 0;
    *vertices = code ? sf_cell_shape_of(code)->vertices : 0;
    return code;
}

/* The destination of the elements of one entity. */
typedef struct destination {
    sf_raw_mesh *raw;
    int dimension; /* of cells */
    int chosen;    /* of cells: 1 + place of the group, or 0 */
    int32_t group; /* of faces */
} destination;

static sf_status add_elements(const sf_gmsh *session, const destination *to, const sf_geo_block *block,
                              sf_error *err) {
    int vertices = 0, code = 0;
    if (block->dimension == to->dimension)
        code = cell_code(block->type, &vertices);
    else if (block->type >= 1 && block->type <= 3)
        vertices = block->type + 1;
    if (vertices == 0)
        return SF_REFUSE(err,
                         "%s: %s %d has elements of the type \"%s\"; only linear tetrahedra, pyramids, "
                         "prisms, hexahedra, triangles and quadrangles are supported",
                         session->file, kind_of(block->dimension), block->entity, block->type_name);
    if (block->length % (size_t)vertices != 0)
        return SF_REFUSE(err, "%s: %s %d has an element without all of its nodes", session->file,
                         kind_of(block->dimension), block->entity);
    for (size_t k = 0; k < block->length && err->status == SF_OK; k += (size_t)vertices) {
        if (block->dimension == to->dimension)
            sf_raw_mesh_add_cell(to->raw, code, to->chosen, block->node + k, vertices, err);
        else
            sf_raw_mesh_add_face(to->raw, to->group, block->entity, block->node + k, vertices, err);
    }
    return err->status;
}

_Static_assert(sizeof(size_t) == sizeof(uint64_t), "tags of gmsh");

static sf_status read_nodes(const sf_gmsh *session, sf_raw_mesh *raw, sf_error *err) {
    const sf_geo_data *data = &session->open.data;
    double need = BYTES_PER_NODE * (double)data->node_count, available = sf_memory_available();
    if (need > available)
        return SF_REFUSE(err,
                         "%s: a mesh of %zu nodes needs %.3g GB of memory, of which %.3g GB are available: "
                         "take a coarser one, or set SOFTFALL_MEMORY_MB",
                         session->file, data->node_count, 1e-9 * need, 1e-9 * available);
    raw->tag = sf_alloc(err, data->node_count, sizeof *raw->tag, "node tags");
    raw->xyz = sf_alloc(err, 3 * data->node_count, sizeof *raw->xyz, "node positions");
    if (err->status == SF_OK && data->node_count > 0) {
        raw->node_count = data->node_count;
        memcpy(raw->tag, data->tag, data->node_count * sizeof *raw->tag);
        memcpy(raw->xyz, data->xyz, 3 * data->node_count * sizeof *raw->xyz);
    }
    return err->status;
}

/* 1 + place of the group that the volume belongs to; 0: of none. */
static int chosen_of(const sf_geo_group *const *chosen, int count, int32_t entity) {
    for (int k = 0; k < count; k++)
        if (sf_geo_group_has(chosen[k], entity))
            return k + 1;
    return 0;
}

/* All cells of all volumes; those of the `count` groups chosen are marked. */
static sf_status read_cells(const sf_gmsh *session, int dimension, const sf_geo_group *const *chosen,
                            int count, sf_raw_mesh *raw, sf_error *err) {
    const sf_geo_data *data = &session->open.data;
    for (size_t k = 0; k < data->block_count && err->status == SF_OK; k++) {
        const sf_geo_block *block = &data->block[k];
        if (block->dimension != dimension)
            continue;
        const destination to = {
            .raw = raw, .dimension = dimension, .chosen = chosen_of(chosen, count, block->entity)};
        add_elements(session, &to, block, err);
    }
    return err->status;
}

/* No volume, or surface of a section, of the group is without cells. */
static sf_status check_cells(const sf_gmsh *session, const sf_geo_group *chosen, sf_error *err) {
    for (size_t i = 0; i < chosen->count; i++) {
        size_t end,
            begin = sf_geo_data_blocks(&session->open.data, chosen->dimension, chosen->entity[i], &end);
        if (begin == end)
            return SF_REFUSE(err, "%s: %s %d of the group \"%s\" holds no cells", session->file,
                             kind_of(chosen->dimension), chosen->entity[i], chosen->name);
    }
    if (chosen->count == 0)
        return SF_REFUSE(err, "%s: the %s group \"%s\" is empty", session->file, kind_of(chosen->dimension),
                         chosen->name);
    return SF_OK;
}

/* Marks the nodes of the chosen cells, by place; owned by the caller. */
static uint8_t *mark_chosen(const sf_raw_mesh *raw, const sf_tag_index *index, sf_error *err) {
    uint8_t *mark = sf_alloc(err, raw->node_count, 1, "nodes of the layers");
    for (size_t k = 0; mark && k < raw->cell_count; k++)
        for (int a = 0; raw->cell_chosen[k] && a < SF_RAW_CELL; a++) {
            size_t tag = raw->cell_node[SF_RAW_CELL * k + (size_t)a];
            size_t place = tag ? sf_raw_mesh_find(raw, index, tag) : SIZE_MAX;
            if (place != SIZE_MAX)
                mark[place] = 1;
        }
    return mark;
}

/* Some place (geometry's unit) of an element of the block that has a face's worth of marked nodes, or, with
 * `any`, of its first element; NULL: none. */
static const double *find_touch(const sf_raw_mesh *raw, const sf_tag_index *index, const uint8_t *mark,
                                const sf_geo_block *block, bool any) {
    int vertices = 0;
    cell_code(block->type, &vertices);
    for (size_t k = 0; vertices > 0 && k + (size_t)vertices <= block->length; k += (size_t)vertices) {
        const double *at = NULL;
        int shared = any ? block->dimension : 0;
        for (int a = 0; a < vertices; a++) {
            size_t place = sf_raw_mesh_find(raw, index, block->node[k + (size_t)a]);
            if (place == SIZE_MAX || (!any && !mark[place]))
                continue;
            at = &raw->xyz[3 * place];
            shared++;
        }
        if (shared >= block->dimension && at)
            return at;
    }
    return NULL;
}

/* True if a volume group (or one of surfaces of a section) is none of the pad's. */
static bool has_others(const sf_geo_data *data, const sf_geo_group *const *chosen, int count) {
    for (size_t g = 0; g < data->group_count; g++) {
        bool own = data->group[g].dimension != chosen[0]->dimension || !*data->group[g].name;
        for (int k = 0; k < count; k++)
            own = own || &data->group[g] == chosen[k];
        if (!own)
            return true;
    }
    return false;
}

/* No volume without a layer may belong to the pad. Of a pad of one material that holds for named groups: a
 * volume of no group is left out, as gmsh leaves it out of its files. */
static sf_status check_volumes(const sf_gmsh *session, const sf_geo_group *const *chosen,
                               const sf_pad_volumes *volumes, double unit, const sf_raw_mesh *raw,
                               sf_error *err) {
    const sf_geo_data *data = &session->open.data;
    SF_OWNED sf_tag_index *index = sf_raw_mesh_index(raw, err);
    SF_OWNED uint8_t *mark = index ? mark_chosen(raw, index, err) : NULL;
    for (size_t k = 0; mark && k < data->block_count && err->status == SF_OK; k++) {
        const sf_geo_block *block = &data->block[k];
        if (block->dimension != chosen[0]->dimension || chosen_of(chosen, volumes->count, block->entity))
            continue;
        const char *name = "";
        for (size_t g = 0; g < data->group_count; g++)
            if (data->group[g].dimension == block->dimension &&
                sf_geo_group_has(&data->group[g], block->entity))
                name = data->group[g].name;
        const double *at =
            volumes->layers || *name ? find_touch(raw, index, mark, block, volumes->alone) : NULL;
        if (at && !volumes->layers)
            SF_REFUSE(
                err,
                "%s: %s %d of the group \"%s\", at (%.4g, %.4g, %.4g) mm, is no part of the pad, which is the group "
                "\"%s\": add it to that group, give each group a material (materials.NAME), or take it away",
                session->file, kind_of(block->dimension), block->entity, name, 1e3 * unit * at[0],
                1e3 * unit * at[1], 1e3 * unit * at[2], chosen[0]->name);
        else if (at)
            SF_REFUSE(err,
                      "%s: %s %d%s%s%s, at (%.4g, %.4g, %.4g) mm, has no material: the case has no group "
                      "of this name in materials",
                      session->file, kind_of(block->dimension), block->entity,
                      *name ? " of the group \"" : " (of no named group)", name, *name ? "\"" : "",
                      1e3 * unit * at[0], 1e3 * unit * at[1], 1e3 * unit * at[2]);
    }
    return err->status;
}

static sf_status read_faces(const sf_gmsh *session, const sf_geo_group *g, sf_raw_mesh *raw, sf_error *err) {
    const sf_geo_data *data = &session->open.data;
    const destination to = {.raw = raw, .group = (int32_t)raw->group_count};
    if (!sf_grow(&raw->group_name, (size_t)raw->group_count, sizeof *raw->group_name) ||
        !(raw->group_name[raw->group_count] = strdup(g->name)))
        return SF_NO_MEMORY(err, "the group \"%s\"", g->name);
    raw->group_count++;
    size_t before = raw->face_count;
    for (size_t i = 0; i < g->count && err->status == SF_OK; i++) {
        size_t end, k = sf_geo_data_blocks(data, g->dimension, g->entity[i], &end);
        for (; k < end && err->status == SF_OK; k++)
            add_elements(session, &to, &data->block[k], err);
    }
    if (err->status == SF_OK && raw->face_count == before)
        SF_REFUSE(err, "%s: the %s group \"%s\" is empty: it holds no mesh faces", session->file,
                  kind_of(g->dimension), g->name);
    return err->status;
}

/* The pad's volume groups, and their cells. */
static sf_status read_volumes(const sf_gmsh *session, const sf_pad_volumes *volumes, int dimension,
                              double unit, const sf_geo_group **chosen, sf_raw_mesh *raw, sf_error *err) {
    int count = volumes->count;
    for (int k = 0; k < count; k++)
        SF_TRY(find_group(session, dimension, volumes->group[k], &chosen[k], err));
    if (check_groups(session, dimension, err) != SF_OK ||
        check_groups(session, dimension - 1, err) != SF_OK || read_nodes(session, raw, err) != SF_OK ||
        read_cells(session, dimension, chosen, count, raw, err) != SF_OK)
        return err->status;
    for (int k = 0; k < count; k++)
        SF_TRY(check_cells(session, chosen[k], err));
    return volumes->layers || has_others(&session->open.data, chosen, count)
               ? check_volumes(session, chosen, volumes, unit, raw, err)
               : SF_OK;
}

sf_status sf_gmsh_read_mesh(sf_gmsh *session, const char *pad_group, double unit, sf_mesh *mesh,
                            sf_error *err) {
    return sf_gmsh_read_layers(session, &(sf_pad_volumes){1, &pad_group, false, false, false}, unit, mesh,
                               err);
}

static bool has_volumes(const sf_geo_data *data) {
    for (size_t g = 0; g < data->group_count; g++)
        if (data->group[g].dimension == 3)
            return true;
    return false;
}

sf_status sf_gmsh_read_layers(sf_gmsh *session, const sf_pad_volumes *volumes, double unit, sf_mesh *mesh,
                              sf_error *err) {
    const sf_geo_data *data = &session->open.data;
    SF_OWNED_BY(sf_raw_mesh_free) sf_raw_mesh raw = {0};
    memset(mesh, 0, sizeof *mesh);
    SF_OWNED const sf_geo_group **chosen = sf_alloc(err, volumes->count, sizeof *chosen, "the pad's volumes");
    int dimension = volumes->section && !has_volumes(data) ? 2 : 3;
    if (!chosen || read_volumes(session, volumes, dimension, unit, chosen, &raw, err) != SF_OK)
        return err->status;
    for (size_t g = 0; g < data->group_count; g++)
        if (data->group[g].dimension == dimension - 1 && *data->group[g].name &&
            read_faces(session, &data->group[g], &raw, err) != SF_OK)
            return err->status;
    return sf_mesh_assemble(&raw, volumes->count, unit, mesh, err);
}

/* Nodes, cells and the faces of the missile's group. */
static sf_status read_missile(const sf_gmsh *session, const char *surface_group, sf_raw_mesh *raw,
                              sf_error *err) {
    const sf_geo_group *found = NULL;
    if (find_group(session, 2, surface_group, &found, err) == SF_OK &&
        check_groups(session, 2, err) == SF_OK && read_nodes(session, raw, err) == SF_OK &&
        read_cells(session, 3, NULL, 0, raw, err) == SF_OK)
        read_faces(session, found, raw, err);
    return err->status;
}

sf_status sf_gmsh_read_surface(sf_gmsh *session, const char *surface_group, double unit, sf_surface *surface,
                               sf_error *err) {
    SF_OWNED_BY(sf_raw_mesh_free) sf_raw_mesh raw = {0};
    memset(surface, 0, sizeof *surface);
    SF_TRY(read_missile(session, surface_group, &raw, err));
    return sf_surface_assemble(&raw, unit, surface, err);
}

bool sf_gmsh_has_profile(const sf_gmsh *session, const char *curve_group) {
    const sf_geo_data *data = &session->open.data;
    for (size_t g = 0; g < data->group_count; g++)
        if (data->group[g].dimension == 1 && strcmp(data->group[g].name, curve_group) == 0)
            return true;
    return false;
}

sf_status sf_gmsh_read_profile(sf_gmsh *session, const char *curve_group, double unit, sf_surface *profile,
                               sf_error *err) {
    SF_OWNED_BY(sf_raw_mesh_free) sf_raw_mesh raw = {0};
    const sf_geo_group *found = NULL;
    memset(profile, 0, sizeof *profile);
    if (find_group(session, 1, curve_group, &found, err) != SF_OK ||
        read_nodes(session, &raw, err) != SF_OK || read_faces(session, found, &raw, err) != SF_OK)
        return err->status;
    SF_OWNED sf_tag_index *index = sf_raw_mesh_index(&raw, err);
    profile->position = sf_alloc(err, 6 * raw.face_count, sizeof *profile->position, "a profile");
    for (size_t k = 0; err->status == SF_OK && k < 2 * raw.face_count; k++) {
        const double *x = sf_raw_mesh_place(&raw, index, raw.face_node[SF_RAW_FACE * (k / 2) + k % 2]);
        double *out = &profile->position[3 * profile->node_count++];
        if (!x || x[2] != 0)
            SF_REFUSE(
                err,
                "%s: the curve group \"%s\" leaves the plane z = 0: a profile has the radius along x and "
                "the height along y",
                session->file, curve_group);
        out[0] = x ? unit * x[0] : 0;
        out[2] = x ? unit * x[1] : 0;
    }
    if (err->status != SF_OK)
        sf_surface_free(profile);
    return err->status;
}

sf_status sf_gmsh_read_hull(sf_gmsh *session, const char *surface_group, double unit, sf_surface *surface,
                            sf_error *err) {
    SF_OWNED_BY(sf_raw_mesh_free) sf_raw_mesh raw = {0};
    SF_TRY(read_missile(session, surface_group, &raw, err));
    return sf_hull_assemble(&raw, unit, surface, err);
}
