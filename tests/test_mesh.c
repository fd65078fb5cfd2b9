/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometries through gmsh to the background mesh and the missile's surface, and the checks of a mesh. */
#include "extreme.h"
#include "model_fixture.h"
#include "program_fixture.h"

#include "pre/mesher/work.h"
#include "pre/mesh/gmsh_session.h"

#include <gmshc.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const double MM = 1e-3;
static const double PI = 3.14159265358979323846;
static program_place files; /* of this run's files; set up once before the tests */

static const char *in_folder(const char *name) {
    return program_path(&files, name);
}

static void write_file(const char *name, const char *text) {
    program_write_text(&files, name, text);
}

static int set_up(void **state) {
    sf_error err = SF_ERROR_INIT;
    program_set_up(&files);
    return sf_gmsh_begin((sf_gmsh **)state, &err) != SF_OK;
}

static int tear_down(void **state) {
    sf_gmsh_end((sf_gmsh **)state);
    program_tear_down(&files);
    return 0;
}

/* A source with parameters given as name, value pairs up to NULL. */
static sf_geo_source source_of(const char *path, ...) {
    static char copy[1024];
    sf_geo_source source = {.path = copy};
    snprintf(copy, sizeof copy, "%s", path);
    va_list args;
    va_start(args, path);
    for (const char *name = va_arg(args, const char *); name; name = va_arg(args, const char *)) {
        sf_geo_parameter *p = &source.parameter[source.parameter_count++];
        snprintf(p->name, sizeof p->name, "%s", name);
        p->value = va_arg(args, double);
    }
    va_end(args);
    return source;
}

static void load_mesh(sf_gmsh *session, sf_geo_source source, sf_mesh *mesh, double *volume) {
    sf_error err = SF_ERROR_INIT;
    if (sf_gmsh_load(session, &source, &err) != SF_OK ||
        sf_gmsh_read_mesh(session, "pad", MM, mesh, &err) != SF_OK ||
        sf_mesh_check(mesh, volume, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* Meshes folder/`from`, if it is to be a mesh, and writes it as folder/`to`, in the format of that name's
 * ending: by gmsh in this process, as softfall's own can write nothing. */
static void convert(const char *from, const char *to, bool mesh) {
    int ierr = 0;
    if (sf_work_begin() != 0)
        fail_msg("%s", "gmsh cannot be started");
    gmshOptionSetNumber("General.Terminal", 0, &ierr);
    gmshOptionSetNumber("Mesh.Algorithm3D", 1, &ierr);
    gmshMerge(in_folder(from), &ierr);
    if (mesh)
        gmshModelMeshGenerate(3, &ierr);
    gmshWrite(in_folder(to), &ierr);
    assert_int_equal(ierr, 0);
    gmshFinalize(&ierr);
}

static void assert_mesh_refused(sf_gmsh *session, sf_geo_source source, const char *group, const char *part) {
    sf_error err = SF_ERROR_INIT;
    sf_mesh mesh = {0};
    double volume;
    if (sf_gmsh_load(session, &source, &err) == SF_OK &&
        sf_gmsh_read_mesh(session, group, MM, &mesh, &err) == SF_OK &&
        sf_mesh_check(&mesh, &volume, &err) == SF_OK)
        fail_msg("%s was accepted", source.path);
    if (!strstr(err.text, part))
        fail_msg("the sentence is '%s' and lacks '%s'", err.text, part);
    sf_mesh_free(&mesh);
}

typedef struct face {
    int32_t sorted[4], node[4];
    int size;
} face;

static int compare_faces(const void *a, const void *b) {
    return memcmp(((const face *)a)->sorted, ((const face *)b)->sorted, sizeof((const face *)a)->sorted);
}

static face make_face(const sf_mesh *mesh, int64_t cell, const sf_cell_shape *shape, int f) {
    face out = {{-1, -1, -1, -1}, {-1, -1, -1, -1}, sf_cell_face_size(shape, f)};
    for (int a = 0; a < out.size; a++) {
        out.node[a] = mesh->cell_node[mesh->cell_ptr[cell] + shape->face[f][a]];
        int i = a;
        for (; i > 0 && out.sorted[i - 1] > out.node[a]; i--)
            out.sorted[i] = out.sorted[i - 1];
        out.sorted[i] = out.node[a];
    }
    return out;
}

/* The faces that only one cell has; fails if one has more than two. From malloc. */
static face *boundary_faces(const sf_mesh *mesh, size_t *count) {
    face *all = malloc((size_t)mesh->cell_count * 6 * sizeof *all);
    assert_non_null(all);
    size_t n = 0;
    for (int64_t k = 0; k < mesh->cell_count; k++) {
        const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[k]);
        for (int f = 0; f < shape->faces; f++)
            all[n++] = make_face(mesh, k, shape, f);
    }
    qsort(all, n, sizeof *all, compare_faces);
    *count = 0;
    for (size_t a = 0, b; a < n; a = b) {
        for (b = a + 1; b < n && compare_faces(&all[a], &all[b]) == 0; b++)
            ;
        assert_true(b - a <= 2);
        if (b - a == 1)
            all[(*count)++] = all[a];
    }
    return all;
}

static void area_vector(const double *position, const face *f, double area[3]) {
    const double *p[4];
    for (int a = 0; a < 4; a++)
        p[a] = position + 3 * (int64_t)f->node[a < f->size ? a : 0];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        area[i] =
            0.5 * ((p[2][j] - p[0][j]) * (p[3][k] - p[1][k]) - (p[2][k] - p[0][k]) * (p[3][j] - p[1][j]));
    }
}

static bool in_set(const sf_node_set *set, int32_t node) {
    int64_t low = 0, high = set->count;
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (set->node[middle] < node)
            low = middle + 1;
        else
            high = middle;
    }
    return low < set->count && set->node[low] == node;
}

/* Area of the boundary faces that lie in the set and in the plane x[axis] = place, along the outward normal.
 */
static double area_in_plane(const sf_mesh *mesh, const face *faces, size_t count, const char *name, int axis,
                            double place) {
    const sf_node_set *set = sf_mesh_find_set(mesh, name);
    assert_non_null(set);
    double sum = 0.0;
    for (size_t f = 0; f < count; f++) {
        bool inside = true;
        for (int a = 0; a < faces[f].size; a++)
            inside = inside && in_set(set, faces[f].node[a]) &&
                     fabs(mesh->position[3 * (int64_t)faces[f].node[a] + axis] - place) < 1e-12;
        double area[3];
        area_vector(mesh->position, &faces[f], area);
        sum += inside ? fabs(area[axis]) : 0.0;
    }
    return sum;
}

static void assert_close(double value, double expected, double relative) {
    if (!(fabs(value - expected) <= relative * fabs(expected)))
        fail_msg("%.17g is not %.17g within %g", value, expected, relative);
}

/* Side S, thickness T, in metres: every face of the box, the volume, and no surface inside. */
static void assert_box(const sf_mesh *mesh, double volume, double low, double high, double thickness,
                       bool quarter) {
    double side = high - low;
    assert_close(volume, side * side * thickness, 1e-12);
    size_t count = 0;
    face *faces = boundary_faces(mesh, &count);
    assert_close(area_in_plane(mesh, faces, count, "base", 2, 0.0), side * side, 1e-12);
    assert_close(area_in_plane(mesh, faces, count, "top", 2, thickness), side * side, 1e-12);
    for (int axis = 0; axis < 2; axis++) {
        const char *low_name = !quarter ? "sides" : axis == 0 ? "symmetry_x" : "symmetry_y";
        assert_close(area_in_plane(mesh, faces, count, "sides", axis, high), side * thickness, 1e-12);
        assert_close(area_in_plane(mesh, faces, count, low_name, axis, low), side * thickness, 1e-12);
    }
    double total = 0.0;
    for (size_t f = 0; f < count; f++) {
        double area[3];
        area_vector(mesh->position, &faces[f], area);
        total += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    }
    assert_close(total, 2.0 * side * side + 4.0 * side * thickness, 1e-12);
    assert_int_equal(mesh->set_count, quarter ? 5 : 3);
    free(faces);
}

/* Every node is used, sets ascend, indices are in range. */
static void assert_no_orphans(const sf_mesh *mesh) {
    uint8_t *used = calloc((size_t)mesh->node_count, 1);
    assert_non_null(used);
    for (int64_t i = 0; i < mesh->cell_ptr[mesh->cell_count]; i++) {
        assert_in_range(mesh->cell_node[i], 0, mesh->node_count - 1);
        used[mesh->cell_node[i]] = 1;
    }
    for (int64_t n = 0; n < mesh->node_count; n++)
        assert_true(used[n]);
    free(used);
    for (int s = 0; s < mesh->set_count; s++)
        for (int64_t i = 1; i < mesh->set[s].count; i++)
            assert_true(mesh->set[s].node[i - 1] < mesh->set[s].node[i]);
}

static void pad_at_10_mm_is_an_exact_conforming_box(void **state) {
    for (int quarter = 0; quarter < 2; quarter++) {
        sf_mesh mesh;
        double volume;
        load_mesh(
            *state,
            source_of(fixture_source("geo/pad.geo"), "fine_spacing", 10.0, "quarter", (double)quarter, NULL),
            &mesh, &volume);
        assert_box(&mesh, volume, quarter ? 0.0 : -0.2, 0.2, 0.05, quarter);
        assert_no_orphans(&mesh);
        assert_int_equal(mesh.orphan_count, 0);
        sf_mesh_free(&mesh);
    }
}

static void pad_meshes_over_its_range_of_sizes(void **state) {
    static const double sizes[][4] = {/* side, thickness, fine, outer: mm */
                                      {280, 20, 20.0 / 3.0, 10},
                                      {600, 30, 10, 20},
                                      {280, 100, 10, 10},
                                      {300, 35, 20.0 / 3.0, 15},
                                      {280, 20, 4, 8}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        sf_mesh mesh;
        double volume;
        const double *s = sizes[k];
        load_mesh(*state,
                  source_of(fixture_source("geo/pad.geo"), "side", s[0], "thickness", s[1], "fine_spacing",
                            s[2], "outer_spacing", s[3], "quarter", 1.0, NULL),
                  &mesh, &volume);
        assert_box(&mesh, volume, 0.0, 0.5 * s[0] * MM, s[1] * MM, true);
        sf_mesh_free(&mesh);
    }
}

/* The impact zone is a lattice: its hexahedra are all of one size, and their number follows from the spacing.
 */
static void impact_zone_is_a_lattice_of_cubes(void **state) {
    sf_mesh mesh;
    double volume;
    load_mesh(*state, source_of(fixture_source("geo/pad.geo"), "quarter", 1.0, NULL), &mesh, &volume);
    int64_t hexahedra = 0, pyramids = 0;
    for (int64_t k = 0; k < mesh.cell_count; k++) {
        hexahedra += mesh.cell_type[k] == SF_CELL_HEXAHEDRON;
        pyramids += mesh.cell_type[k] == SF_CELL_PYRAMID;
        if (mesh.cell_type[k] == SF_CELL_HEXAHEDRON)
            assert_close(sf_mesh_cell_volume(&mesh, k), 125e-9, 1e-9);
        if (mesh.cell_type[k] == SF_CELL_PYRAMID)
            assert_close(sf_mesh_cell_volume(&mesh, k), 125e-9 / 6.0, 1e-9);
    }
    assert_int_equal(hexahedra, 19 * 19 * 10);
    assert_true(pyramids > 0);
    sf_mesh_free(&mesh);
}

static void same_mesh_whatever_was_loaded_before(void **state) {
    sf_mesh first, second;
    double volume;
    sf_error err = SF_ERROR_INIT;
    sf_geo_source coarse =
        source_of(fixture_source("geo/pad.geo"), "fine_spacing", 20.0, "outer_spacing", 20.0, NULL);
    load_mesh(*state, coarse, &first, &volume);
    sf_geo_source other = source_of(fixture_source("geo/hemisphere.geo"), "quarter", 1.0, NULL);
    assert_int_equal(sf_gmsh_load(*state, &other, &err), SF_OK);
    sf_geo_source thick = source_of(fixture_source("geo/pad.geo"), "fine_spacing", 20.0, "outer_spacing",
                                    20.0, "thickness", 100.0, NULL);
    assert_int_equal(sf_gmsh_load(*state, &thick, &err), SF_OK);
    coarse = source_of(fixture_source("geo/pad.geo"), "fine_spacing", 20.0, "outer_spacing", 20.0, NULL);
    load_mesh(*state, coarse, &second, &volume);
    assert_int_equal(first.node_count, second.node_count);
    assert_int_equal(first.cell_count, second.cell_count);
    assert_memory_equal(first.position, second.position, (size_t)first.node_count * 3 * sizeof(double));
    assert_memory_equal(first.cell_node, second.cell_node,
                        (size_t)first.cell_ptr[first.cell_count] * sizeof *first.cell_node);
    sf_mesh_free(&first);
    sf_mesh_free(&second);
}

static void msh_is_taken_as_it_is(void **state) {
    char text[2048];
    snprintf(text, sizeof text,
             "DefineConstant[ fine_spacing = 20, outer_spacing = 20, quarter = 1 ];\nInclude \"%s\";\n",
             fixture_source("geo/pad.geo"));
    write_file("save.geo", text);
    sf_mesh meshed, read;
    double volume;
    load_mesh(*state, source_of(in_folder("save.geo"), NULL), &meshed, &volume);
    convert("save.geo", "pad.msh", true);
    load_mesh(*state, source_of(in_folder("pad.msh"), NULL), &read, &volume);
    assert_box(&read, volume, 0.0, 0.2, 0.05, true);
    assert_int_equal(read.cell_count, meshed.cell_count);
    assert_int_equal(read.node_count, meshed.node_count);
    for (int64_t i = 0; i < 3 * read.node_count; i++)
        assert_true(fabs(read.position[i] - meshed.position[i]) < 1e-15);
    assert_memory_equal(read.cell_node, meshed.cell_node,
                        (size_t)read.cell_ptr[read.cell_count] * sizeof *read.cell_node);
    sf_mesh_free(&meshed);
    sf_mesh_free(&read);
}

/* gmsh would scale a file that it writes: a pad of 0.05 mm passed for one of 50 mm. */
static void scales_and_groups_without_names_are_told(void **state) {
    write_file(
        "scaled.geo",
        "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 30, 20, 10};\nPhysical Volume(\"pad\") = {1};\n"
        "Mesh.ScalingFactor = 0.001;\n");
    assert_mesh_refused(*state, source_of(in_folder("scaled.geo"), NULL), "pad",
                        "Mesh.ScalingFactor is 0.001");
    write_file("numbers.geo",
               "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 30, 20, 10};\nPhysical Volume(7) = {1};\n");
    assert_mesh_refused(*state, source_of(in_folder("numbers.geo"), NULL), "pad",
                        "its volume groups: number 7 without a name");
}

static void step_is_meshed_through_a_geo_that_names_groups(void **state) {
    write_file("box.geo", "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 30, 20, 10};\n");
    convert("box.geo", "box.step", false);
    assert_mesh_refused(*state, source_of(in_folder("box.step"), NULL), "pad",
                        "gmsh reads no groups from such a file: name them in a .geo beside it: Merge \"");
    write_file("named.geo", "SetFactory(\"OpenCASCADE\");\nMerge \"box.step\";\npad() = Volume{:}; Physical "
                            "Volume(\"pad\") = pad();\n"
                            "base() = Surface In BoundingBox{-1, -1, -0.1, 31, 21, 0.1};\n"
                            "Physical Surface(\"base\") = base();\nMesh.MeshSizeMax = 5;\n");
    sf_mesh mesh;
    double volume;
    load_mesh(*state, source_of(in_folder("named.geo"), NULL), &mesh, &volume);
    assert_close(volume, 30e-3 * 20e-3 * 10e-3, 1e-12);
    assert_non_null(sf_mesh_find_set(&mesh, "base"));
    sf_mesh_free(&mesh);
}

static void wrong_names_are_refused_with_what_exists(void **state) {
    assert_mesh_refused(
        *state, source_of(fixture_source("geo/pad.geo"), "thicknes", 70.0, NULL), "pad",
        "pad.geo has no parameter \"thicknes\" (did you mean \"thickness\"?); its DefineConstant parameters are: side, thickness, "
        "zone_side, fine_spacing, outer_spacing, quarter");
    sf_geo_source coarse =
        source_of(fixture_source("geo/pad.geo"), "fine_spacing", 20.0, "outer_spacing", 20.0, NULL);
    assert_mesh_refused(
        *state, coarse, "foam",
        "has no volume group \"foam\"; its volume groups: \"pad\"; its surface groups: \"sides\", "
        "\"base\", \"top\"");
    sf_error err = SF_ERROR_INIT;
    sf_surface surface;
    assert_int_equal(sf_gmsh_read_surface(*state, "dome", MM, &surface, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "has no surface group \"dome\"; its volume groups: \"pad\""));
    assert_mesh_refused(*state, source_of(in_folder("none.geo"), NULL), "pad",
                        "none.geo cannot be read: No such file");
    assert_mesh_refused(*state, source_of(files.folder, NULL), "pad", "is not a plain file");
}

static void parameters_are_found_in_included_files_only_if_defined(void **state) {
    write_file("inner.geo",
               "/* DefineConstant[ hidden = 1 ]; */\nDefineConstant[ height = {3, Name \"a, b = 2\"} ];\n");
    write_file("outer.geo", "// DefineConstant[ hidden = 1 ];\nInclude \"inner.geo\";\nplain = 4;\n"
                            "DefineConstant[ a = {1, Min 0, Max 2, Name \"x\"}, b, c = 5 ];\n"
                            "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, a, 1, height};\n"
                            "Physical Volume(\"pad\") = {1}; Mesh.MeshSizeMax = 1;\n");
    sf_mesh mesh;
    double volume;
    load_mesh(*state, source_of(in_folder("outer.geo"), "height", 2.0, "a", 1.5, NULL), &mesh, &volume);
    assert_close(volume, 3e-9, 1e-12);
    sf_mesh_free(&mesh);
    assert_mesh_refused(*state, source_of(in_folder("outer.geo"), "plain", 2.0, NULL), "pad",
                        "DefineConstant parameters are: a, b, c, height");
    assert_mesh_refused(*state, source_of(in_folder("outer.geo"), "hidden", 2.0, NULL), "pad",
                        "no parameter");
}

static void faults_in_the_geometry_are_told(void **state) {
    write_file("syntax.geo", "Point(1) = {0, 0, 0};\nLine(1) = {1, nowhere};\n");
    assert_mesh_refused(*state, source_of(in_folder("syntax.geo"), NULL), "pad", "syntax.geo', line 2:");
    write_file("nothing.geo", "a = 1;\n");
    assert_mesh_refused(*state, source_of(in_folder("nothing.geo"), NULL), "pad", "holds no mesh");
    assert_mesh_refused(*state, source_of(fixture_source("geo/pad.geo"), "zone_side", 400.0, NULL), "pad",
                        "zone_side = 400 leaves less than one fine spacing up to side = 400");
#define BOX                                                                                                  \
    "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1, 1, 1}; Mesh.MeshSizeMax = 1;\nPhysical "             \
    "Volume(\"pad\") = {1};\n"
    write_file(
        "double.geo",
        BOX "base() = Surface In BoundingBox{-1, -1, -0.1, 2, 2, 0.1};\n"
            "Physical Surface(\"base\") = base(); all() = Surface{:}; Physical Surface(\"all\") = all();\n");
    assert_mesh_refused(*state, source_of(in_folder("double.geo"), NULL), "pad",
                        " belongs to two groups, \"base\" and \"all\"");
    /* gmsh keeps no group without entities. */
    write_file("empty.geo",
               "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1, 1, 1}; Mesh.MeshSizeMax = 1;\n"
               "Physical Volume(\"pad\") = {};\nPhysical Volume(\"foam\") = {1};\n");
    assert_mesh_refused(*state, source_of(in_folder("empty.geo"), NULL), "pad",
                        "its volume groups: \"foam\"");
    /* A second volume group that shares a face with the pad is no part of it; one that lies apart may be a
     * missile. */
    write_file("second.geo",
               BOX "Box(2) = {0, 0, 1, 1, 1, 1}; Coherence;\nPhysical Volume(\"lid\") = {2};\n");
    assert_mesh_refused(*state, source_of(in_folder("second.geo"), NULL), "pad", "of the group \"lid\", at ");
    write_file("bare.msh",
               "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 2 \"top\"\n3 1 \"pad\"\n"
               "$EndPhysicalNames\n$Entities\n0 0 1 1\n1 0 0 0 1 1 0 1 2 0\n1 0 0 0 1 1 1 1 1 0\n"
               "$EndEntities\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
               "$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n");
    assert_mesh_refused(*state, source_of(in_folder("bare.msh"), NULL), "pad",
                        "the surface group \"top\" is empty: it holds no mesh faces");
    write_file("order2.geo", BOX "Mesh.ElementOrder = 2;\n");
    assert_mesh_refused(*state, source_of(in_folder("order2.geo"), NULL), "pad", "only linear tetrahedra");
}

/* A .msh (format 2) of the given nodes and elements in the volume group "pad". */
static void write_msh(const char *name, int node_count, const char *nodes, int cell_count,
                      const char *cells) {
    char text[4096];
    snprintf(text, sizeof text,
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"pad\"\n$EndPhysicalNames\n"
             "$Nodes\n%d\n%s$EndNodes\n$Elements\n%d\n%s$EndElements\n",
             node_count, nodes, cell_count, cells);
    write_file(name, text);
}

#define CUBE "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n"

static void mirrored_cells_are_turned_round(void **state) {
    static const struct {
        const char *cell;
        double volume;
    } cells[] = {{"1 5 2 1 1 5 6 7 8 1 2 3 4\n", 1.0},
                 {"1 5 2 1 1 1 2 3 4 5 6 7 8\n", 1.0},
                 {"1 4 2 1 1 1 4 2 5\n", 1.0 / 6.0},
                 {"1 6 2 1 1 5 6 7 1 2 3\n", 0.5},
                 {"1 7 2 1 1 1 4 3 2 5\n", 1.0 / 3.0}};
    for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
        sf_mesh mesh;
        double volume;
        write_msh("mirror.msh", 8, CUBE, 1, cells[k].cell);
        load_mesh(*state, source_of(in_folder("mirror.msh"), NULL), &mesh, &volume);
        assert_close(volume, cells[k].volume * 1e-9, 1e-14);
        assert_no_orphans(&mesh);
        sf_mesh_free(&mesh);
    }
}

static void orphans_are_counted_and_dropped(void **state) {
    write_file("orphan.geo", BOX "Point(100) = {5, 5, 5};\n");
    sf_mesh mesh;
    double volume;
    load_mesh(*state, source_of(in_folder("orphan.geo"), NULL), &mesh, &volume);
    assert_int_equal(mesh.orphan_count, 1);
    assert_no_orphans(&mesh);
    for (int64_t i = 0; i < 3 * mesh.node_count; i++)
        assert_true(mesh.position[i] < 1.5 * MM);
    sf_mesh_free(&mesh);
}

static void bad_meshes_are_refused(void **state) {
    /* Two vertices of the top are exchanged: corners of both hands. */
    write_msh("twisted.msh", 8, CUBE, 1, "1 5 2 1 1 1 2 3 4 6 5 7 8\n");
    assert_mesh_refused(*state, source_of(in_folder("twisted.msh"), NULL), "pad",
                        "cell 0 (hexahedron) at (0.0005, 0.0005, 0.0005) m is inverted");
    write_msh("flat.msh", 8, CUBE, 1, "1 4 2 1 1 1 2 3 4\n");
    assert_mesh_refused(*state, source_of(in_folder("flat.msh"), NULL), "pad",
                        "cell 0 (tetrahedron) at (0.0005, 0.0005, 0) m is inverted or flat");
    assert_mesh_refused(*state, source_of(in_folder("flat.msh"), "a", 2.0, NULL), "pad",
                        "no parameter \"a\"; its DefineConstant parameters are: none");
    write_msh("crack.msh", 9, CUBE "9 0 0 0\n", 2, "1 4 2 1 1 1 2 4 5\n2 4 2 1 1 9 2 4 5\n");
    assert_mesh_refused(*state, source_of(in_folder("crack.msh"), NULL), "pad", "coincide at (0, 0, 0) m");
    write_msh("tiny.msh", 9, CUBE "9 1e-7 0 0\n", 2, "1 4 2 1 1 1 2 4 5\n2 4 2 1 1 1 9 4 5\n");
    assert_mesh_refused(*state, source_of(in_folder("tiny.msh"), NULL), "pad", "cell 1 (tetrahedron)");
    assert_mesh_refused(*state, source_of(in_folder("tiny.msh"), NULL), "pad", "is tiny");
}

static void mesh_check_wants_cells_and_finite_positions(void **state) {
    (void)state;
    double position[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, volume;
    uint8_t type = SF_CELL_TETRAHEDRON;
    int64_t ptr[2] = {0, 4};
    int32_t node[4] = {0, 1, 2, 3};
    sf_mesh mesh = {.node_count = 4,
                    .position = position,
                    .cell_count = 1,
                    .cell_type = &type,
                    .cell_ptr = ptr,
                    .cell_node = node};
    sf_error good = SF_ERROR_INIT, nan = SF_ERROR_INIT, none = SF_ERROR_INIT;
    assert_int_equal(sf_mesh_check(&mesh, &volume, &good), SF_OK);
    assert_close(volume, 1.0 / 6.0, 1e-15);
    position[7] = NAN;
    assert_int_equal(sf_mesh_check(&mesh, &volume, &nan), SF_ERR_MODEL);
    assert_non_null(strstr(nan.text, "node 2 has the position"));
    mesh.cell_count = 0;
    assert_int_equal(sf_mesh_check(&mesh, &volume, &none), SF_ERR_MODEL);
    assert_non_null(strstr(none.text, "the mesh has 0 cells"));
}

static void load_surface(sf_gmsh *session, sf_geo_source source, const char *group, sf_surface *surface) {
    sf_error err = SF_ERROR_INIT;
    if (sf_gmsh_load(session, &source, &err) != SF_OK ||
        sf_gmsh_read_surface(session, group, MM, surface, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* All nodes on the sphere, all triangles turned away from its centre; returns the sum of the area vectors. */
static void assert_on_sphere(const sf_surface *surface, const double centre[3], double radius, double sum[3],
                             double *area) {
    memset(sum, 0, 3 * sizeof *sum);
    *area = 0.0;
    assert_true(surface->triangle_count > 0);
    for (int64_t n = 0; n < surface->node_count; n++) {
        const double *x = surface->position + 3 * n;
        assert_close(hypot(hypot(x[0] - centre[0], x[1] - centre[1]), x[2] - centre[2]), radius, 1e-9);
    }
    for (int64_t t = 0; t < surface->triangle_count; t++) {
        face f = {.size = 3};
        double a[3], outward = 0.0;
        memcpy(f.node, surface->triangle + 3 * t, 3 * sizeof *f.node);
        area_vector(surface->position, &f, a);
        for (int i = 0; i < 3; i++) {
            outward += a[i] * (surface->position[3 * (int64_t)f.node[0] + i] - centre[i]);
            sum[i] += a[i];
        }
        assert_true(outward > 0.0);
        *area += sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    }
}

static void hemisphere_dome_is_a_sphere_turned_outwards(void **state) {
    const double r = 0.08, centre[3] = {0.0, 0.0, r};
    for (int quarter = 0; quarter < 2; quarter++) {
        sf_surface dome;
        double sum[3], area, share = quarter ? 0.25 : 1.0;
        load_surface(*state,
                     source_of(fixture_source("geo/hemisphere.geo"), "quarter", (double)quarter, NULL),
                     "missile_surface", &dome);
        assert_on_sphere(&dome, centre, r, sum, &area);
        /* Chords lie inside the sphere: its area and its disc's are approached from below. */
        assert_true(area < share * 2.0 * PI * r * r && area > 0.99 * share * 2.0 * PI * r * r);
        assert_true(-sum[2] < share * PI * r * r && -sum[2] > 0.99 * share * PI * r * r);
        double lowest = INFINITY;
        for (int64_t n = 0; n < dome.node_count; n++)
            lowest = smaller(lowest, dome.position[3 * n + 2]);
        assert_true(fabs(lowest) < 1e-12);
        sf_surface_free(&dome);
    }
}

static void surface_without_volume_is_turned_away_from_its_middle(void **state) {
    write_file("shell.geo",
               "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 10};\nDelete { Volume{1}; }\n"
               "shell() = Surface{:}; Physical Surface(\"shell\") = shell();\nMesh.MeshSizeMax = 4;\n");
    write_file("inside_out.geo", "Include \"shell.geo\";\nReverseMesh Surface{:};\n");
    const char *const names[] = {"shell.geo", "inside_out.geo"};
    const double centre[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 2; k++) {
        sf_surface shell;
        double sum[3], area;
        load_surface(*state, source_of(in_folder(names[k]), NULL), "shell", &shell);
        assert_on_sphere(&shell, centre, 0.01, sum, &area);
        assert_true(fabs(sum[0]) + fabs(sum[1]) + fabs(sum[2]) < 1e-12 * area);
        sf_surface_free(&shell);
    }
}

static void quadrangles_are_split_and_inner_surfaces_refused(void **state) {
    write_file("block.geo",
               "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nBox(2) = {1, 0, 0, 1, 1, 1};\n"
               "Coherence;\nMeshSize{:} = 1;\nTransfinite Curve{:} = 3;\nTransfinite Surface{:};\n"
               "Recombine Surface{:};\nTransfinite Volume{:};\nPhysical Volume(\"pad\") = {1};\n"
               "left() = Surface In BoundingBox{-0.1, -1, -1, 0.1, 2, 2};\n"
               "between() = Surface In BoundingBox{0.9, -1, -1, 1.1, 2, 2};\n"
               "Physical Surface(\"left\") = left();\nPhysical Surface(\"between\") = between();\n");
    sf_surface left, between;
    load_surface(*state, source_of(in_folder("block.geo"), NULL), "left", &left);
    assert_int_equal(left.triangle_count, 8);
    double sum = 0.0;
    for (int64_t t = 0; t < left.triangle_count; t++) {
        face f = {.size = 3};
        double a[3];
        memcpy(f.node, left.triangle + 3 * t, 3 * sizeof *f.node);
        area_vector(left.position, &f, a);
        assert_true(a[0] < 0.0);
        sum += a[0];
    }
    assert_close(sum, -1e-6, 1e-14);
    sf_surface_free(&left);
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_gmsh_read_surface(*state, "between", MM, &between, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "cells on both sides"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pad_at_10_mm_is_an_exact_conforming_box),
        cmocka_unit_test(pad_meshes_over_its_range_of_sizes),
        cmocka_unit_test(impact_zone_is_a_lattice_of_cubes),
        cmocka_unit_test(same_mesh_whatever_was_loaded_before),
        cmocka_unit_test(msh_is_taken_as_it_is),
        cmocka_unit_test(scales_and_groups_without_names_are_told),
        cmocka_unit_test(step_is_meshed_through_a_geo_that_names_groups),
        cmocka_unit_test(wrong_names_are_refused_with_what_exists),
        cmocka_unit_test(parameters_are_found_in_included_files_only_if_defined),
        cmocka_unit_test(faults_in_the_geometry_are_told),
        cmocka_unit_test(mirrored_cells_are_turned_round),
        cmocka_unit_test(orphans_are_counted_and_dropped),
        cmocka_unit_test(bad_meshes_are_refused),
        cmocka_unit_test(mesh_check_wants_cells_and_finite_positions),
        cmocka_unit_test(hemisphere_dome_is_a_sphere_turned_outwards),
        cmocka_unit_test(surface_without_volume_is_turned_away_from_its_middle),
        cmocka_unit_test(quadrangles_are_split_and_inner_surfaces_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
