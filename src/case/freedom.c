/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/freedom.h"

static sf_status check_guided(const sf_case_reader *reader, sf_error *err) {
    static const char *const of_free[] = {"inertia", "centre", "angular_velocity"};
    char where[SF_CASE_WHERE_SIZE], path[64];
    for (int k = 0; k < 3; k++) {
        snprintf(path, sizeof path, "missile.%s", of_free[k]);
        if (sf_case_is_given(reader, "missile", of_free[k]))
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s: %s has no meaning for a guided missile, which does not turn: leave it out, or set "
                "missile.freedom = \"free\"",
                sf_case_where_is(reader, path, where), path);
    }
    return SF_OK;
}

static sf_status check_inertia(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_case *c = reader->out;
    double p[3];
    if (c->inertia_count == 0 || sf_missile_inertia_is_possible(c->inertia, p))
        return SF_OK;
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "%s: missile.inertia: no body has the principal moments %.4g, %.4g and %.4g kg m2: they must be "
        "positive, and none larger than the sum of the others",
        sf_case_where_is(reader, "missile.inertia", where), p[0], p[1], p[2]);
}

sf_status sf_case_check_freedom(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_case *c = reader->out;
    if (c->freedom == SF_MISSILE_GUIDED)
        return check_guided(reader, err);
    if (c->motion_count > 0)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: missile.freedom: a missile whose displacement missile.motion prescribes cannot be free",
            sf_case_where_is(reader, "missile.freedom", where));
    if (c->centre_count > 0 && c->inertia_count == 0)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: missile.centre needs missile.inertia: a solid of uniform density has its centre already",
            sf_case_where_is(reader, "missile.centre", where));
    return check_inertia(reader, err);
}
