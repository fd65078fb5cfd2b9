/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "layer_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

void layers_assign(const fixture_block *block, layering layer, sf_mesh *mesh) {
    double h = block->spacing, flat = block->flatness > 0 ? block->flatness : 1;
    mesh->cell_layer = malloc((size_t)mesh->cell_count);
    for (int64_t k = 0; k < mesh->cell_count; k++) {
        double x[3] = {0};
        for (int64_t v = mesh->cell_ptr[k]; v < mesh->cell_ptr[k + 1]; v++)
            for (int c = 0; c < 3; c++)
                x[c] += mesh->position[3 * (int64_t)mesh->cell_node[v] + c] / (8 * h * (c == 2 ? flat : 1));
        for (int c = 0; c < 3; c++)
            x[c] = floor(x[c]) + 0.5; /* the jitter of the nodes leaves the centroid in its cell */
        mesh->cell_layer[k] = (uint8_t)layer(x);
    }
}

void layers_make(sf_case *c, int count) {
    c->layer = calloc((size_t)count, sizeof *c->layer);
    c->layer_count = count;
    for (int k = 0; k < count; k++) {
        sf_case again;
        fixture_case(&again, NULL);
        c->layer[k] = k == 0 ? c->material : again.material;
        (k == 0 ? c : &again)->material = (sf_material){0};
        sf_case_free(&again);
        c->layer[k].name[0] = (char)('A' + k);
    }
}

void layers_case(sf_case *c, const char *const *overrides, const char *const *held, int count) {
    fixture_case(c, overrides);
    fixture_hold(c, held);
    layers_make(c, count);
}

void layers_join(sf_case *c, int layer, int other, int kind, double friction) {
    c->interface[c->interface_count++] = (sf_case_interface){"interfaces", {layer, other}, kind, friction};
}

void layers_under_plate(sf_case *c, const fixture_block *block, layering layer, fixture *out) {
    sf_mesh mesh;
    sf_surface surface;
    fixture_block_mesh(block, &mesh);
    layers_assign(block, layer, &mesh);
    fixture_plate(1, 0, 0, &surface);
    fixture_build(c, &mesh, &surface, out);
}

double layers_stress(const sf_material *material, double strain) {
    sf_error err = SF_ERROR_INIT;
    sf_material_law law;
    sf_uniaxial point = {0};
    if (sf_material_law_build(material, &law, &err) != SF_OK)
        fail_msg("%s", err.text);
    double stress = law.law->uniaxial(law.numbers, 1, strain, &point);
    sf_material_law_free(&law);
    return stress;
}

static void drop_losses(sf_foam_card *card) {
    card->shared.hysteresis_hu = 1;
    card->shared.damp = 0;
    card->shared.maxwell_modulus = 0;
    card->shared.kelvin_viscosity = 0;
    card->shared.rate_factor = 0;
}

void layers_make_linear(sf_material *material, double modulus, double density) {
    enum { POINTS = 5 }; /* fewer than the table has: its arrays stay */
    sf_foam_card *card = sf_foam_card_of(material);
    drop_losses(card);
    card->modulus = modulus;
    card->shared.density = density;
    for (int k = 0; k < POINTS; k++) {
        card->curves.curve_strain[k] = 0.2 * k;
        card->curves.curve_stress[k] = 0.2 * k * modulus;
    }
    card->curves.curve_points = card->curves.curve_ptr[1] = POINTS;
    card->densification_start = card->densification_exponent = 0;
    card->densification_limit = 1;
}

void layers_make_elastic(sf_material *material, double factor) {
    sf_foam_card *card = sf_foam_card_of(material);
    drop_losses(card);
    card->modulus *= factor;
    for (int64_t k = 0; k < card->curves.curve_points; k++)
        card->curves.curve_stress[k] *= factor;
}
