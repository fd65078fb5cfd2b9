/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rigid motions that the constraints of a pad leave free. */
#include "model_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 4 };

typedef struct holding {
    const char *fixed[MOST], *sliding[MOST];
    bool lifts, slides[2], turns;
    double underside;
    const char *refused; /* words of the sentence, or NULL */
} holding;

/* A block of 40 mm; the set "line" is the edge y = z = 0, "point" one end of it. */
static sf_hold hold_of(const holding *row) {
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01};
    sf_case c;
    sf_mesh mesh;
    sf_surface plate;
    fixture f;
    fixture_case(&c, NULL);
    fixture_hold(&c, row->fixed);
    for (c.sliding_count = 0; row->sliding[c.sliding_count]; c.sliding_count++)
        snprintf(c.sliding_group[c.sliding_count], SF_CASE_NAME_SIZE, "%s", row->sliding[c.sliding_count]);
    fixture_block_mesh(&block, &mesh);
    sf_node_set *set = &mesh.set[2]; /* sides: not needed here */
    set->count = 0;
    for (int32_t i = 0; i < (row->fixed[0] && strcmp(row->fixed[0], "point") == 0 ? 1 : 5); i++)
        set->node[set->count++] = i;
    free(set->name);
    set->name = strdup(row->fixed[0] && strcmp(row->fixed[0], "point") == 0 ? "point" : "line");
    fixture_plate(0.1, 0.02, 0.02, &plate);
    fixture_build(&c, &mesh, &plate, &f);
    sf_hold hold = f.report.hold;
    fixture_free(&f);
    return hold;
}

static void free_motions_are_found(void **state) {
    (void)state;
    static const holding rows[] = {
        {.fixed = {"base"}, .underside = 1},
        {.sliding = {"base"}, .slides = {true, true}, .turns = true, .underside = 1},
        {.sliding = {"base", "plane_x"}, .slides = {false, true}, .underside = 1},
        {.sliding = {"base", "plane_x", "plane_y"}, .underside = 1},
        {.fixed = {"plane_x"}, .underside = 0.2},
        {.lifts = true, .slides = {true, true}, .turns = true, .refused = "nothing holds the pad along z"},
        {.sliding = {"plane_x", "plane_y"}, .lifts = true, .refused = "nothing holds the pad along z"},
        {.fixed = {"line"},
         .lifts = true,
         .underside = 0.2,
         .refused = "5 nodes that are held along z lie at a point"},
        {.fixed = {"point"}, .lifts = true, .turns = true, .underside = 0.04, .refused = "the pad can tilt"},
    };
    const sf_model one = {0};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        const holding *row = &rows[k];
        sf_hold hold = hold_of(row);
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(hold.lifts, row->lifts);
        assert_true(hold.lifts || (hold.slides[0] == row->slides[0] && hold.slides[1] == row->slides[1]));
        assert_true(hold.lifts || hold.turns == row->turns);
        assert_true(hold.underside > row->underside - 1e-12 && hold.underside < row->underside + 1e-12);
        assert_int_equal(sf_hold_check(&hold, false, &one, &err), row->refused ? SF_ERR_INPUT : SF_OK);
        assert_true(!row->refused || strstr(err.text, row->refused));
    }
}

typedef struct heard {
    int count;
    char text[1024];
} heard;

static void hear(void *user, sf_severity severity, const char *sentence) {
    heard *h = user;
    (void)severity;
    h->count++;
    snprintf(h->text, sizeof h->text, "%s", sentence);
}

static void pads_that_slide_away_are_told(void **state) {
    (void)state;
    heard h = {0};
    const sf_sink sink = {hear, &h};
    const sf_hold smooth = {.slides = {true, true}, .turns = true, .underside = 1},
                  hanging = {.underside = 0.2};
    sf_model m = {.missile = {.direction = {0, 0, -1}}};
    sf_hold_warn(&smooth, &m, &sink);
    assert_int_equal(h.count, 0);
    m.missile.direction[1] = 0.3;
    sf_hold_warn(&smooth, &m, &sink);
    assert_int_equal(h.count, 1);
    assert_non_null(strstr(h.text, "nothing holds the pad along y"));
    sf_hold_warn(&hanging, &m, &sink);
    assert_int_equal(h.count, 2);
    assert_non_null(strstr(h.text, "20 % of the nodes of the pad's underside"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_motions_are_found),
        cmocka_unit_test(pads_that_slide_away_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
