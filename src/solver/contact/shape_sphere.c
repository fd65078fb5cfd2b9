/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape_sphere.h"

#include "solver/contact/pair.h"

typedef struct cap {
    double centre[3], radius, cosine; /* m, m, - of half its opening angle */
    double axis[3];                   /* unit vector from the centre to the middle of the cap */
} cap;

static sf_status build(const sf_model *m, int body, double reach, void **data, sf_error *err) {
    (void)reach;
    if (body != SF_BODY_MISSILE || m->missile.shape != SF_SHAPE_SPHERE)
        return SF_OK;
    cap *s = *data = sf_alloc(err, 1, sizeof *s, "sphere");
    SF_TRY(err->status);
    s->radius = m->missile.sphere_radius;
    s->cosine = m->missile.sphere_cap_cosine;
    memcpy(s->centre, m->missile.sphere_centre, sizeof s->centre);
    memcpy(s->axis, m->missile.direction, sizeof s->axis);
    return SF_OK;
}

static bool is_near(const void *data, const double x[3], double margin) {
    const cap *s = data;
    double r[3];
    sf_sub3(x, s->centre, r);
    return sf_dot3(r, r) <= (s->radius + margin) * (s->radius + margin);
}

static bool gap(const void *data, const double x[3], double *gap, double normal[3]) {
    const cap *s = data;
    double r[3];
    sf_sub3(x, s->centre, r);
    double distance = sqrt(sf_dot3(r, r));
    if (!(distance > 0) || sf_dot3(r, s->axis) < (s->cosine - 1e-9) * distance)
        return false;
    *gap = distance - s->radius;
    for (int k = 0; k < 3; k++)
        normal[k] = r[k] / distance;
    return true;
}

const sf_shape sf_shape_sphere = {.build = build,
                                  .release = free,
                                  .is_near = is_near,
                                  .gap = gap,
                                  .meet = sf_pair_missile,
                                  .entry = 0.1,
                                  .deepest = INFINITY,
                                  .back = INFINITY};
