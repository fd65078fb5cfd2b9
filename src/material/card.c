/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/card.h"

#include <math.h>

#include "base/hash.h"

sf_status sf_material_create(const sf_law *law, sf_material *material, sf_error *err) {
    *material = (sf_material){.law = law, .card = sf_alloc(err, 1, law->card_size, "material card")};
    return err->status;
}

void sf_law_curves_free(sf_law_curves *curves) {
    SF_CLEAR(curves, curves->curve_rate, curves->curve_ptr, curves->curve_strain, curves->curve_stress);
}

void sf_material_free(sf_material *material) {
    sf_law_curves *curves = material->card ? sf_material_curves(material) : NULL;
    if (curves)
        sf_law_curves_free(curves);
    SF_CLEAR(material, material->card);
}

/* A copy of `count` doubles or integers, owned by the caller; NULL of NULL. */
static void *copy_block(const void *from, int64_t count, size_t size, sf_error *err) {
    void *block = from ? sf_alloc(err, count, size, "a curve") : NULL;
    if (block)
        memcpy(block, from, (size_t)count * size);
    return block;
}

sf_status sf_material_copy(const sf_material *from, sf_material *out, sf_error *err) {
    SF_TRY(sf_material_create(from->law, out, err));
    memcpy(out->card, from->card, from->law->card_size);
    memcpy(out->name, from->name, sizeof out->name);
    sf_law_curves *c = sf_material_curves(out);
    if (!c)
        return SF_OK;
    const sf_law_curves old = *c;
    c->curve_rate = copy_block(old.curve_rate, old.curve_count, sizeof *c->curve_rate, err);
    c->curve_ptr = copy_block(old.curve_ptr, old.curve_count + 1, sizeof *c->curve_ptr, err);
    c->curve_strain = copy_block(old.curve_strain, old.curve_points, sizeof *c->curve_strain, err);
    c->curve_stress = copy_block(old.curve_stress, old.curve_points, sizeof *c->curve_stress, err);
    if (err->status != SF_OK)
        sf_material_free(out);
    return err->status;
}

sf_law_curves *sf_material_curves(const sf_material *material) {
    size_t offset = material->law->curves;
    return offset == SIZE_MAX ? NULL : (sf_law_curves *)((char *)material->card + offset);
}

static double member(const sf_material *material, size_t offset) {
    return *(const double *)((const char *)material->card + offset);
}

double sf_material_density(const sf_material *material) {
    return member(material, material->law->density);
}

double sf_material_informed(const sf_material *material) {
    double informed = member(material, material->law->informed);
    return informed > 0 ? informed : material->law->data_end(material->card);
}

double sf_material_rest_modulus(const sf_material *material) {
    return material->law->rest_modulus(material->card);
}

double sf_material_length(const sf_material *material, double spacing) {
    double fixed = material->law->length == SIZE_MAX ? 0 : member(material, material->law->length);
    return fixed > 0 ? fixed : spacing;
}

bool sf_parameter_acts(const sf_parameter *p, const void *card) {
    return !p->acts || p->acts(card);
}

bool sf_parameter_is_stored(const sf_parameter *p, const void *card) {
    return p->kind <= SF_PARAMETER_CHOICE && (!p->optional || sf_parameter_acts(p, card));
}

/* ---- checks ---- */

static sf_status check_parameter(const sf_material *m, const sf_parameter *p, int64_t index, sf_error *err) {
    if (p->kind != SF_PARAMETER_NUMBER && p->kind != SF_PARAMETER_QUANTITY)
        return SF_OK;
    double value = member(m, p->offset), high = p->high * (1 + 1e-12); /* converted with a rounding */
    bool idle = !sf_parameter_acts(p, m->card) && value == 0;
    bool word = p->kind == SF_PARAMETER_QUANTITY && p->words && value == p->word_value;
    if (word || idle || (value <= high && (p->low_open ? value > p->low : value >= p->low)))
        return SF_OK;
    const char *unit = p->kind == SF_PARAMETER_QUANTITY ? sf_quantity_unit(p->quantity) : "";
    return SF_FAIL(err, SF_ERR_MODEL, "material %lld (%s): %s" SF_OUTSIDE("%g", "%g", "%g%s%s"),
                   (long long)index, m->law->name, p->key, value, p->low, p->high, *unit ? " " : "", unit);
}

static bool all_finite(const double *value, int64_t count) {
    for (int64_t k = 0; k < count; k++)
        if (!isfinite(value[k]))
            return false;
    return true;
}

double sf_law_curve_stress(const sf_law_curves *c, int64_t k, double strain) {
    int64_t low = c->curve_ptr[k], i = c->curve_ptr[k + 1] - 1;
    while (i - low > 1) {
        int64_t middle = low + (i - low) / 2;
        *(c->curve_strain[middle] < strain ? &low : &i) = middle;
    }
    double x = (strain - c->curve_strain[i - 1]) / (c->curve_strain[i] - c->curve_strain[i - 1]);
    return c->curve_stress[i - 1] + fmin(1, x) * (c->curve_stress[i] - c->curve_stress[i - 1]);
}

bool sf_law_curve_falls(const sf_law_curves *c, int64_t k, sf_curve_fall *fall) {
    static const double SLACK = 0.01; /* of the stress there and halfway: noise where the curves are one */
    double end = fmin(c->curve_strain[c->curve_ptr[k] - 1], c->curve_strain[c->curve_ptr[k + 1] - 1]),
           half = sf_law_curve_stress(c, k - 1, 0.5 * end), worst = 0;
    for (int64_t i = c->curve_ptr[k - 1]; i < c->curve_ptr[k + 1]; i++) { /* the points of both */
        double strain = c->curve_strain[i];
        if (strain > end)
            continue;
        double slow = sf_law_curve_stress(c, k - 1, strain), fast = sf_law_curve_stress(c, k, strain),
               excess = (slow - fast) / (slow + half) - SLACK;
        if (excess > worst) {
            worst = excess;
            *fall = (sf_curve_fall){.strain = strain, .slow = slow, .fast = fast};
        }
    }
    return worst > 0;
}

static sf_status check_curves(const sf_law_curves *c, sf_error *err) {
    if (c->curve_count < 1 || c->curve_ptr[0] != 0 || c->curve_ptr[c->curve_count] != c->curve_points)
        return SF_FAIL(err, SF_ERR_MODEL, "the material has no usable compression curve");
    if (!all_finite(c->curve_rate, c->curve_count) || !all_finite(c->curve_strain, c->curve_points) ||
        !all_finite(c->curve_stress, c->curve_points))
        return SF_FAIL(err, SF_ERR_MODEL, "a compression curve holds a NaN or infinity");
    for (int64_t k = 0; k < c->curve_count; k++) {
        int64_t first = c->curve_ptr[k], last = c->curve_ptr[k + 1];
        if (first < 0 || last < first || last > c->curve_points || last - first < 4)
            return SF_FAIL(err, SF_ERR_MODEL, "compression curve %lld has fewer than 4 points", (long long)k);
        if (k > 0 && c->curve_rate[k] <= c->curve_rate[k - 1])
            return SF_FAIL(err, SF_ERR_MODEL, "compression curve %lld: rates must ascend", (long long)k);
        if (c->curve_strain[first] != 0 || c->curve_stress[first] != 0)
            return SF_FAIL(err, SF_ERR_MODEL, "compression curve %lld does not start at (0, 0)",
                           (long long)k);
        for (int64_t i = first + 1; i < last; i++)
            if (c->curve_strain[i] <= c->curve_strain[i - 1] || c->curve_stress[i] < c->curve_stress[i - 1] ||
                c->curve_strain[i] >= 1)
                return SF_FAIL(err, SF_ERR_MODEL, "compression curve %lld does not rise at strain %g",
                               (long long)k, c->curve_strain[i]);
        sf_curve_fall fall;
        if (k > 0 && sf_law_curve_falls(c, k, &fall))
            return SF_FAIL(err, SF_ERR_MODEL,
                           "compression curve %lld at %g s-1 falls below that at %g s-1: %g Pa after %g Pa "
                           "at a strain of %g; such a foam would create energy",
                           (long long)k, c->curve_rate[k], c->curve_rate[k - 1], fall.fast, fall.slow,
                           fall.strain);
    }
    return SF_OK;
}

sf_status sf_material_check(const sf_material *m, int64_t index, sf_error *err) {
    if (!m->law || !m->card)
        return SF_FAIL(err, SF_ERR_MODEL, "material %lld has no law", (long long)index);
    for (int k = 0; k < m->law->parameter_count; k++)
        SF_TRY(check_parameter(m, &m->law->parameter[k], index, err));
    const sf_law_curves *curves = sf_material_curves(m);
    if (curves && check_curves(curves, err) != SF_OK)
        return err->status;
    return m->law->check ? m->law->check(m->card, err) : SF_OK;
}

uint64_t sf_material_hash(uint64_t hash, const sf_material *m) {
    hash = sf_hash_identity(hash, m->name, strlen(m->name));
    hash = sf_hash_identity(hash, m->law->name, strlen(m->law->name));
    for (int k = 0; k < m->law->parameter_count; k++)
        if (sf_parameter_is_stored(&m->law->parameter[k], m->card)) /* 8 bytes each */
            hash = sf_hash_identity(hash, (const char *)m->card + m->law->parameter[k].offset, 8);
    const sf_law_curves *c = sf_material_curves(m);
    if (!c || c->curve_count == 0)
        return hash;
    hash = sf_hash_identity(hash, c->curve_rate, (size_t)c->curve_count * sizeof *c->curve_rate);
    hash = sf_hash_identity(hash, c->curve_ptr, (size_t)(c->curve_count + 1) * sizeof *c->curve_ptr);
    hash = sf_hash_identity(hash, c->curve_strain, (size_t)c->curve_points * sizeof *c->curve_strain);
    return sf_hash_identity(hash, c->curve_stress, (size_t)c->curve_points * sizeof *c->curve_stress);
}
