/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models in memory for the tests of the discretisation and the solver: the real pad through gmsh, or a block
 * of hexahedra made here. Everything starts from examples/eva50-v4.5/case.cfg (SF_SOURCE_DIR). Any failure
 * ends the running test with the program's own sentence. Structs are filled by the functions and released by
 * fixture_free or the modules' own free functions. */
#ifndef SF_TESTS_MODEL_FIXTURE_H
#define SF_TESTS_MODEL_FIXTURE_H

#include "pre/build.h"
#include "material/low_density_foam.h"
#include "solver/operators.h"
#include "solver/state.h"

/* A lattice of hexahedra over [0, cells x spacing] in x, y and z, with the node sets base, top, sides (all
 * four), plane_x (x = 0) and plane_y (y = 0). */
typedef struct fixture_block {
    int cells[3];
    double spacing;        /* m */
    double jitter;         /* largest shift of an interior node, in spacings */
    double surface_jitter; /* the same of a node on the surface, within its plane or along its edge */
    double flatness;       /* factor on z; 0 = 1 */
} fixture_block;

typedef struct fixture {
    sf_model model;
    sf_build_report report;
    sf_operators operators;
    sf_state state;
} fixture;

/* Evenly distributed over [-1, 1); the same numbers on every machine. */
double fixture_random(uint64_t *seed);

/* SF_SOURCE_DIR/name, valid until the fourth call after this one. */
const char *fixture_source(const char *name);

/* Reads the example case with the foam tests/materials/eva35_first.cfg, which has a Maxwell branch and no
 * rate factor; `overrides` as of --set, up to NULL. */
void fixture_case(sf_case *c, const char *const *overrides);

/* The largest W of a node so far, J m-3. */
double fixture_peak(const fixture *f, int64_t node);

/* Replaces the foam by a linear elastic one without losses: stress = E strain up to 80 %. */
void fixture_make_linear(sf_case *c);
/* Keeps the curve, without hysteresis or any viscosity. */
void fixture_make_elastic(sf_case *c);
/* Holds exactly these node sets, up to NULL; no symmetry planes. */
void fixture_hold(sf_case *c, const char *const *names);
/* Makes the first `count` of plane_x and plane_y symmetry planes. */
void fixture_mirror(sf_case *c, int count);
/* Directs the missile down, turned by `slant` (rad) towards +x. */
void fixture_slant(sf_case *c, double slant);

/* Pad and missile surface of the case's geometry. */
void fixture_geometry(const sf_case *c, sf_mesh *mesh, sf_surface *surface);
void fixture_block_mesh(const fixture_block *block, sf_mesh *mesh);
/* Parts a block at its lattice plane x = `column` above the layer `tip` of nodes (-1: altogether): the nodes
 * there are doubled, those of the right side shifted by `width` (m), and all of them join the set "sides". */
void fixture_open_slit(const fixture_block *block, int column, int tip, double width, sf_mesh *mesh);
/* A square plate facing down, side `side` (m), its centre over (x, y). */
void fixture_plate(double side, double x, double y, sf_surface *surface);
/* The lower half of a sphere, its pole over (x, y), in `rings` rings of triangles with their vertices on the
 * sphere. */
void fixture_dome(double radius, int rings, double x, double y, sf_surface *surface);

/* Builds the model; case, mesh and surface are released. The solver's parts stay empty until fixture_start.
 */
void fixture_build(sf_case *c, sf_mesh *mesh, sf_surface *surface, fixture *out);
/* Builds a block under a plate or a dome as above; the case is released. */
void fixture_under_plate(sf_case *c, const fixture_block *block, double side, double x, double y,
                         fixture *out);
void fixture_under_dome(sf_case *c, const fixture_block *block, double radius, int rings, double x, double y,
                        fixture *out);
/* The real pad with `overrides` of the example case. */
void fixture_pad(const char *const *overrides, fixture *out);
/* A block under a plate, all its surface held. */
void fixture_held_block(const fixture_block *block, fixture *out);
/* The same of a mesh made from a block; it is released. */
void fixture_hold_mesh(sf_mesh *mesh, fixture *out);
/* Operators and a fresh state; may be called again after a change of the model. */
void fixture_start(fixture *f);
void fixture_free(fixture *f);

/* Forces without contact and constraints at the present coefficients: domains, stabilisation, internal
 * forces. */
void fixture_forces(fixture *f);
/* Coefficient x (V_I/n_I + V_J/n_J) / (2 |X_J - X_I|^2), m. */
double fixture_pair_weight(const sf_model *m, int64_t i, int64_t j);
/* Force (N) and couple (J) of the stabilisation on node i at the present d and F, with this stiffness (Pa)
 * now and before; returns half the energy of its pairs, J. */
double fixture_pairs(const fixture *f, const double *stiffness, int64_t i, double force[3], double couple[9]);
/* d = gradient X + shift. */
void fixture_set_affine(fixture *f, const double gradient[9], const double shift[3]);
/* Evaluates one step; fails the test with the solver's sentence. */
void fixture_step(fixture *f);
/* Evaluates one step and moves on to the next time. */
void fixture_advance(fixture *f);
/* Largest acceleration behind the projection to the constraints, over the largest that the forces alone give.
 */
double fixture_held_acceleration(fixture *f, const sf_constraint *constraint);

#endif
