/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "calculix/deck.h"

#include "model/model.h"
#include <math.h>
#include <stdlib.h>

static const double MM = 1e3;   /* per m */
static const double MPA = 1e-6; /* per Pa */

static void put_material(const sf_ogden *law, FILE *f) {
    fprintf(f, "*MATERIAL,NAME=FOAM\n*HYPERFOAM,N=%d\n", SF_OGDEN_TERMS);
    for (int k = 0; k < SF_OGDEN_TERMS; k++)
        fprintf(f, "%.12g,%.12g,", law->mu[k] * MPA, law->alpha[k]);
    for (int k = 0; k < SF_OGDEN_TERMS; k++)
        fprintf(f, "%.12g%s", law->nu[k], k + 1 < SF_OGDEN_TERMS ? "," : "\n");
    fprintf(f, "*SOLID SECTION,ELSET=EPAD,MATERIAL=FOAM\n");
}

void sf_deck_element(const sf_ogden *law, const double stretch[3], FILE *f) {
    static const char axis[3] = {'X', 'Y', 'Z'};
    fprintf(f, "*NODE,NSET=NALL\n");
    for (int v = 0; v < 8; v++)
        fprintf(f, "%d,%d,%d,%d\n", v + 1, v % 4 == 1 || v % 4 == 2, v % 4 >= 2, v >= 4);
    fprintf(f, "*ELEMENT,TYPE=C3D8,ELSET=EPAD\n1,1,2,3,4,5,6,7,8\n");
    fprintf(f, "*NSET,NSET=NX\n2,3,6,7\n*NSET,NSET=NY\n3,4,7,8\n*NSET,NSET=NZ\n5,6,7,8\n");
    fprintf(f, "*NSET,NSET=MX\n1,4,5,8\n*NSET,NSET=MY\n1,2,5,6\n*NSET,NSET=MZ\n1,2,3,4\n");
    put_material(law, f);
    fprintf(f, "*BOUNDARY\nMX,1\nMY,2\nMZ,3\n*STEP,NLGEOM,INC=1000\n*STATIC,DIRECT\n0.02,1.\n*BOUNDARY\n");
    for (int c = 0; c < 3; c++)
        fprintf(f, "N%c,%d,%d,%.12g\n", axis[c], c + 1, c + 1, stretch[c] - 1);
    for (int c = 0; c < 3; c++)
        fprintf(f, "*NODE PRINT,NSET=N%c,TOTALS=ONLY\nRF\n", axis[c]);
    fprintf(f, "*END STEP\n");
}

void sf_deck_path(const sf_ogden *law, int count, const double (*f)[9], FILE *file) {
    static const char axis[3] = {'X', 'Y', 'Z'};
    fprintf(file, "*NODE,NSET=NALL\n");
    for (int v = 0; v < 8; v++)
        fprintf(file, "%d,%d,%d,%d\n", v + 1, v % 4 == 1 || v % 4 == 2, v % 4 >= 2, v >= 4);
    fprintf(file, "*ELEMENT,TYPE=C3D8,ELSET=EPAD\n1,1,2,3,4,5,6,7,8\n");
    fprintf(file, "*NSET,NSET=NX\n2,3,6,7\n*NSET,NSET=NY\n3,4,7,8\n*NSET,NSET=NZ\n5,6,7,8\n");
    put_material(law, file);
    for (int v = 0; v < 8; v++)
        for (int c = 0; c < 3; c++) {
            const int x[3] = {v % 4 == 1 || v % 4 == 2, v % 4 >= 2, v >= 4};
            fprintf(file, "*AMPLITUDE,NAME=A%d%c,TIME=TOTAL TIME\n0.,0.\n", v + 1, axis[c]);
            for (int k = 0; k < count; k++) {
                double u = -x[c];
                for (int j = 0; j < 3; j++)
                    u += f[k][3 * c + j] * x[j];
                fprintf(file, "%d.,%.15g\n", k + 1, u);
            }
        }
    fprintf(file, "*STEP,NLGEOM,INC=1000\n*STATIC,DIRECT\n1.,%d.\n", count);
    for (int v = 0; v < 8; v++)
        for (int c = 0; c < 3; c++)
            fprintf(file, "*BOUNDARY,AMPLITUDE=A%d%c\n%d,%d,%d,1.\n", v + 1, axis[c], v + 1, c + 1, c + 1);
    for (int c = 0; c < 3; c++)
        fprintf(file, "*NODE PRINT,NSET=N%c,TOTALS=ONLY\nRF\n", axis[c]);
    fprintf(file, "*END STEP\n");
}

static void put_set(const sf_mesh *mesh, const char *set, const char *name, FILE *f) {
    const sf_node_set *s = sf_mesh_find_set(mesh, set);
    fprintf(f, "*NSET,NSET=%s\n", name);
    for (int64_t k = 0; s && k < s->count; k++)
        fprintf(f, "%d\n", s->node[k] + 1);
}

/* The pad's faces with all four nodes in the set "top". */
static sf_status put_contact_faces(const sf_mesh *mesh, FILE *f, sf_error *err) {
    static const int face[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                   {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
    const sf_node_set *top = sf_mesh_find_set(mesh, "top");
    uint8_t *in = sf_alloc(err, (size_t)mesh->node_count, 1, "top nodes");
    if (!in)
        return err->status;
    for (int64_t k = 0; top && k < top->count; k++)
        in[top->node[k]] = 1;
    fprintf(f, "*SURFACE,NAME=SPAD,TYPE=ELEMENT\n");
    for (int64_t cell = 0; cell < mesh->cell_count; cell++)
        for (int side = 0; side < 6; side++) {
            const int32_t *node = &mesh->cell_node[mesh->cell_ptr[cell]];
            const int *v = face[side];
            if (in[node[v[0]]] && in[node[v[1]]] && in[node[v[2]]] && in[node[v[3]]])
                fprintf(f, "%lld,S%d\n", (long long)cell + 1, side + 1);
        }
    free(in);
    return SF_OK;
}

static sf_status put_pad(const sf_deck *deck, const sf_mesh *mesh, FILE *f, sf_error *err) {
    fprintf(f, "*NODE,NSET=NPAD\n");
    for (int64_t k = 0; k < mesh->node_count; k++) {
        const double *x = &mesh->position[3 * k];
        fprintf(f, "%lld,%.12g,%.12g,%.12g\n", (long long)k + 1, x[0] * MM, x[1] * MM, x[2] * MM);
    }
    fprintf(f, "*ELEMENT,TYPE=%s,ELSET=EPAD\n", deck->element);
    for (int64_t cell = 0; cell < mesh->cell_count; cell++) {
        if (mesh->cell_type[cell] != SF_CELL_HEXAHEDRON)
            return SF_FAIL(err, SF_ERR_INPUT, "cell %lld is no hexahedron", (long long)cell);
        fprintf(f, "%lld", (long long)cell + 1);
        for (int v = 0; v < 8; v++)
            fprintf(f, ",%d", mesh->cell_node[mesh->cell_ptr[cell] + v] + 1);
        fprintf(f, "\n");
    }
    put_set(mesh, "base", "NBASE", f);
    put_set(mesh, "top", "NTOP", f);
    put_set(mesh, "symmetry_x", "NSX", f);
    put_set(mesh, "symmetry_y", "NSY", f);
    return put_contact_faces(mesh, f, err);
}

/* Wedges between the surface and a copy of it, nearer to the centre by a tenth of the radius. */
static void put_missile(const sf_deck *deck, const sf_mesh *mesh, const sf_surface *s, FILE *f) {
    double top = -INFINITY, tip = INFINITY;
    for (int64_t k = 0; k < mesh->node_count; k++)
        top = larger(top, mesh->position[3 * k + 2]);
    for (int64_t k = 0; k < s->node_count; k++)
        tip = smaller(tip, s->position[3 * k + 2]);
    double centre = top + deck->radius;
    long long first = mesh->node_count + 1, cell = mesh->cell_count + 1;
    fprintf(f, "*NODE,NSET=NMISSILE\n");
    for (int layer = 0; layer < 2; layer++)
        for (int64_t k = 0; k < s->node_count; k++) {
            const double *x = &s->position[3 * k], scale = (layer == 0 ? 1 : 0.9) * MM;
            fprintf(f, "%lld,%.12g,%.12g,%.12g\n", first + layer * s->node_count + k, x[0] * scale,
                    x[1] * scale, centre * MM + (x[2] - tip + top - centre) * scale);
        }
    fprintf(f, "*ELEMENT,TYPE=C3D6,ELSET=EMISSILE\n");
    for (int64_t k = 0; k < s->triangle_count; k++) {
        const int32_t *t = &s->triangle[3 * k];
        long long inner = first + s->node_count;
        fprintf(f, "%lld,%lld,%lld,%lld,%lld,%lld,%lld\n", cell + k, inner + t[0], inner + t[1], inner + t[2],
                first + t[0], first + t[1], first + t[2]);
    }
    fprintf(f, "*SURFACE,NAME=SMISSILE,TYPE=ELEMENT\nEMISSILE,S2\n");
    fprintf(f, "*MATERIAL,NAME=STEEL\n*ELASTIC\n210000.,0.3\n*SOLID SECTION,ELSET=EMISSILE,MATERIAL=STEEL\n");
}

static void put_step(const sf_deck *deck, FILE *f) {
    int count = (int)ceil(deck->depth / deck->interval - 1e-9);
    fprintf(f, "*TIME POINTS,NAME=PRINTED\n");
    for (int k = 1; k <= count; k++)
        fprintf(f, "%.12g\n", fmin(1, k * deck->interval / deck->depth));
    /* A fixed reference force: with the default, an average that starts near zero, the first touch does not
     * converge. */
    fprintf(f, "*STEP,NLGEOM,INC=5000\n*STATIC\n0.005,1.,1e-6,%.12g\n", deck->interval / deck->depth);
    fprintf(f, "*CONTROLS,PARAMETERS=FIELD\n0.005,0.01,,1.\n*BOUNDARY\nNMISSILE,3,3,%.12g\n",
            -deck->depth * MM);
    fprintf(f, "*NODE PRINT,NSET=NBASE,TOTALS=ONLY,TIME POINTS=PRINTED\nRF\n*END STEP\n");
}

sf_status sf_deck_indentation(const sf_ogden *law, const sf_deck *deck, const sf_mesh *mesh,
                              const sf_surface *surface, FILE *f, sf_error *err) {
    if (put_pad(deck, mesh, f, err) != SF_OK)
        return err->status;
    put_missile(deck, mesh, surface, f);
    put_material(law, f);
    if (deck->nodes)
        fprintf(f, "*SURFACE,NAME=SNODES,TYPE=NODE\nNTOP\n");
    fprintf(f, "*SURFACE INTERACTION,NAME=TOUCH\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n%g\n",
            deck->penalty);
    fprintf(f, "*CONTACT PAIR,INTERACTION=TOUCH,TYPE=%s TO SURFACE\n%s,SMISSILE\n",
            deck->nodes ? "NODE" : "SURFACE", deck->nodes ? "SNODES" : "SPAD");
    fprintf(f, "*BOUNDARY\nNBASE,1,3\nNSX,1\nNSY,2\nNMISSILE,1,2\n");
    put_step(deck, f);
    return SF_OK;
}
