/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/spread.h"

#include "study/runner.h"
#include "case/case.h"
#include "base/hash.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double SAME_DENSITY = 1e-6; /* relative */

/* The path of draw `number`; from malloc. */
static char *draw_path(const char *folder, int number, sf_error *err) {
    char *path = NULL;
    if (asprintf(&path, "%s/draw-%03d.cfg", folder, number) < 0) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path of a draw in %s", folder);
        return NULL;
    }
    return path;
}

static bool draw_is_there(const char *folder, int number, sf_error *err) {
    char *path = draw_path(folder, number, err);
    bool there = path && access(path, F_OK) == 0;
    free(path);
    return there;
}

/* The draws from 1 on, without a gap. */
static sf_status count_draws(const char *folder, int *count, sf_error *err) {
    int number = 1;
    while (number <= SF_CFH_MOST_DRAWS && draw_is_there(folder, number, err))
        number++;
    *count = number - 1;
    if (err->status != SF_OK)
        return err->status;
    if (*count == SF_CFH_MOST_DRAWS && draw_is_there(folder, SF_CFH_MOST_DRAWS + 1, err))
        return SF_FAIL(err, SF_ERR_INPUT, "--posterior %s: more than %d draws", folder, SF_CFH_MOST_DRAWS);
    for (number = *count + 2; number <= SF_CFH_MOST_DRAWS; number++)
        if (draw_is_there(folder, number, err))
            return SF_FAIL(err, SF_ERR_INPUT,
                           "--posterior %s: draw-%03d.cfg is there, but draw-%03d.cfg is not", folder, number,
                           *count + 1);
    if (*count == 0)
        return SF_FAIL(err, SF_ERR_INPUT, "--posterior %s: there is no draw-001.cfg", folder);
    if (*count < SF_CFH_LEAST_DRAWS)
        return SF_FAIL(err, SF_ERR_INPUT, "--posterior %s: %d draws, at least %d are needed for an interval",
                       folder, *count, SF_CFH_LEAST_DRAWS);
    return err->status;
}

static sf_status check_draw(const sf_cfh_draw *draw, const sf_material *own, sf_error *err) {
    double density = sf_material_density(&draw->material), expected = sf_material_density(own);
    if (draw->material.law != own->law)
        return SF_FAIL(err, SF_ERR_INPUT, "--posterior: the law of %s is %s, that of the case's material %s",
                       draw->path, draw->material.law->name, own->law->name);
    if (fabs(density / expected - 1) > SAME_DENSITY)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "--posterior: the density of %s is %g kg/m3, that of the case's material %g kg/m3",
                       draw->path, density, expected);
    return SF_OK;
}

/* An override of the material would make it that of every draw. */
static sf_status check_overrides(int count, const char *const *overrides, sf_error *err) {
    static const char group[] = "material";
    for (int k = 0; k < count; k++) {
        const char *name = overrides[k] + strspn(overrides[k], " \t"), *end = name + strlen(group);
        if (strncmp(name, group, strlen(group)) == 0 && strchr(". \t=", *end) && *end)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "--set %s: with --posterior the draws are the material, and this would be the same in "
                "every one of them",
                overrides[k]);
    }
    return SF_OK;
}

static sf_status check_difference(const sf_cfh_draws *draws, sf_error *err) {
    uint64_t first = sf_material_hash(SF_HASH_START, &draws->draw[0].material);
    for (int k = 1; k < draws->count; k++)
        if (sf_material_hash(SF_HASH_START, &draws->draw[k].material) != first)
            return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT, "--posterior %s: all %d draws are the same material", draws->folder,
                   draws->count);
}

/* Both numbers of every draw, or none of any. */
static sf_status check_responses(sf_cfh_draws *draws, sf_error *err) {
    for (int k = 0; k < draws->count; k++) {
        const bool *given = draws->draw[k].response.given;
        bool stated = given[SF_FIT_A_MAX] || given[SF_FIT_HIC];
        if (stated && !(given[SF_FIT_A_MAX] && given[SF_FIT_HIC]))
            return SF_FAIL(err, SF_ERR_INPUT, "--posterior: response_error of %s has no %s",
                           draws->draw[k].path,
                           sf_drop_kind_get(given[SF_FIT_HIC] ? SF_FIT_A_MAX : SF_FIT_HIC)->error_key);
        if (k > 0 && stated != draws->with_response)
            return SF_FAIL(err, SF_ERR_INPUT, "--posterior: %s has %s response_error, but %s has %s",
                           draws->draw[k].path, stated ? "a" : "no", draws->draw[0].path,
                           stated ? "none" : "one");
        draws->with_response = stated;
    }
    return SF_OK;
}

/* list[0] is the place of the material. */
static sf_status read_draw(const char *case_path, int count, const char **list, const sf_material *own,
                           sf_cfh_draw *draw, sf_error *err) {
    sf_case c;
    sf_error reason = SF_ERROR_INIT;
    char *material = NULL;
    if (asprintf(&material, "material=@%s", draw->path) < 0)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", draw->path);
    list[0] = material;
    if (sf_case_read(case_path, count, list, NULL, &c, &reason) == SF_OK) {
        draw->material = c.material;
        draw->response = c.response_error;
        c.material = (sf_material){0};
        sf_case_free(&c);
        if (check_draw(draw, own, err) == SF_OK)
            sf_material_law_build(&draw->material, &draw->law, err);
    } else {
        SF_FAIL(err, reason.status, "--posterior: %.900s", reason.text);
    }
    free(material);
    return err->status;
}

sf_status sf_cfh_draws_read(const char *folder, const char *case_path, int override_count,
                            const char *const *overrides, const sf_material *own, sf_cfh_draws *out,
                            sf_error *err) {
    const char *list[SF_RUNNER_OVERRIDES + 1];
    int count = 0;
    *out = (sf_cfh_draws){.folder = folder};
    SF_TRY(check_overrides(override_count, overrides, err));
    SF_TRY(count_draws(folder, &count, err));
    out->draw = sf_alloc(err, (unsigned long)count, sizeof *out->draw, "draws");
    for (int k = 0; k < override_count; k++)
        list[k + 1] = overrides[k];
    while (err->status == SF_OK && out->count < count) {
        sf_cfh_draw *draw = &out->draw[out->count++];
        draw->path = draw_path(folder, out->count, err);
        if (draw->path)
            read_draw(case_path, override_count + 1, list, own, draw, err);
    }
    if (err->status == SF_OK && check_responses(out, err) == SF_OK)
        check_difference(out, err);
    return err->status;
}

void sf_cfh_draws_free(sf_cfh_draws *draws) {
    for (int k = 0; k < draws->count; k++) {
        sf_material_law_free(&draws->draw[k].law);
        sf_material_free(&draws->draw[k].material);
        free(draws->draw[k].path);
    }
    free(draws->draw);
    *draws = (sf_cfh_draws){0};
}
