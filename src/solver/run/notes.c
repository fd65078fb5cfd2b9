/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/notes.h"

#include "material/curve.h"
#include "material/foam.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static void tell_depth(const sf_model *m, const sf_extremes *x, const sf_sink *sink) {
    const sf_missile_card *card = &m->missile;
    double height = card->sphere_radius * (1 - card->sphere_cap_cosine);
    if (card->shape == SF_SHAPE_SPHERE && x->largest_indentation > height)
        sf_sink_tell(sink, SF_WARNING, "the missile went %.4g mm deep, beyond its spherical cap of %.4g mm",
                     1e3 * x->largest_indentation, 1e3 * height);
    if (x->largest_indentation > m->thickness)
        sf_sink_tell(sink, SF_WARNING, "the missile went %.4g mm into a pad of %.4g mm: %s",
                     1e3 * x->largest_indentation, 1e3 * m->thickness,
                     x->bare_at_deepest ? "it met no contact point there; is it smaller than their spacing?"
                                        : "the foam collapsed, or the pad's base is not held");
}

/* Least strain from which the curve of a foam is the line that ends it; INFINITY: no material has one. */
static double straight_strain(const sf_model *m) {
    double least = INFINITY;
    for (int64_t k = 0; k < m->material_count; k++) {
        sf_curve curve;
        sf_error ignored = SF_ERROR_INIT;
        if (m->material[k].law != &sf_low_density_foam)
            continue;
        const sf_foam_card *card = sf_foam_card_of(&m->material[k]);
        for (int64_t c = 0; c < card->curve_count && sf_curve_build(card, c, &curve, &ignored) == SF_OK;
             c++) {
            least = fmin(least, curve.straight.start);
            sf_curve_free(&curve);
        }
    }
    return least;
}

static void tell_pole(const sf_model *m, const sf_extremes *x, const sf_sink *sink) {
    double straight = straight_strain(m);
    if (x->largest_compression > straight)
        sf_sink_tell(
            sink, SF_WARNING,
            "the foam was compressed to a strain of %.4g; from %.4g on its curve, near the pole of "
            "its densification, is a line of the program that keeps the stress finite, and no property of the material: give the curve data to larger strains, or take a stiffer foam",
            x->largest_compression, straight);
}

void sf_run_tell(const sf_model *m, const sf_state *s, const sf_extremes *x, const sf_sink *sink) {
    tell_depth(m, x, sink);
    tell_pole(m, x, sink);
    if (s->contact_unsettled > 0)
        sf_sink_tell(sink, SF_WARNING, "the contact forces of %lld steps did not settle to the last digits",
                     (long long)s->contact_unsettled);
    if (!isnan(s->missile.rim_time))
        sf_sink_tell(
            sink, SF_WARNING,
            "at %.4g ms the missile had turned so far that the rim of its spherical cap was lowest: beyond "
            "the rim there is no contact; give missile.group its whole surface, and missile.shape = "
            "\"surface\"",
            1e3 * s->missile.rim_time);
    if (isnan(s->missile.contact_time))
        sf_sink_tell(sink, SF_WARNING, "the missile never touched the pad");
}

static void add_line(void *user, sf_severity severity, const char *sentence) {
    sf_run_notes *notes = user;
    size_t used = strlen(notes->text);
    (void)severity;
    if (used + strlen(sentence) + 2 <= sizeof notes->text)
        snprintf(notes->text + used, sizeof notes->text - used, "%s\n", sentence);
}

sf_sink sf_run_notes_sink(sf_run_notes *notes) {
    return (sf_sink){add_line, notes};
}
