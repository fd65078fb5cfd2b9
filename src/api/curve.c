/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: curves of the host, whose arrays are read only. */
#include "api/api.h"
#include "post/figures/compare.h"

static sf_series borrow(const double *time, const double *value, int64_t count) {
    return (sf_series){.count = count, .time = (double *)time, .value = (double *)value};
}

softfall_status softfall_hic(const double *time, const double *deceleration, int64_t count, double window,
                             double hic[3], softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, deceleration, count);
    sf_hic found = {0};
    if (!(window > 0))
        SF_REFUSE(&err, "window: %g s" SF_NOT_ABOVE_0, window);
    else if (sf_series_check(&curve, "the deceleration", &err) == SF_OK)
        sf_hic_evaluate(&curve, window, &found, &err);
    hic[0] = err.status == SF_OK ? found.value : NAN;
    hic[1] = found.t1;
    hic[2] = found.t2;
    return softfall_return(&err, error);
}

softfall_status softfall_cfc(const double *time, const double *value, int64_t count, double filter,
                             double *filtered, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, value, count);
    SF_OWNED_BY(sf_series_free) sf_series made = {0};
    if (softfall_check_filter(filter, &err) == SF_OK &&
        sf_series_check(&curve, "the curve to filter", &err) == SF_OK &&
        sf_signal_filter(&curve, filter, &made, &err) == SF_OK)
        for (int64_t i = 0; i < count; i++)
            filtered[i] = sf_series_at(&made, time[i]);
    return softfall_return(&err, error);
}

static sf_status read_curve(const sf_series *curve, const softfall_instrument *by, double *read,
                            double *contact, sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series uniform = {0}, made = {0};
    const sf_signal_chain passed = {by->frequency, by->damping, by->coupling};
    SF_TRY(softfall_check_filter(by->filter, err));
    if (!(by->frequency >= 0 && by->coupling >= 0) ||
        (by->frequency > 0 && !(by->damping > 0 && by->damping < 1)))
        return SF_REFUSE(err,
                         "a mount of %g Hz with damping %g, or a coupling of %g s: frequency and time are "
                         "from 0 on, damping is between 0 and 1",
                         by->frequency, by->damping, by->coupling);
    SF_TRY(sf_series_check(curve, "the curve to read", err));
    SF_TRY(sf_signal_resample(curve, sf_signal_rate(curve), &uniform, err));
    sf_signal_pass(&passed, &uniform);
    SF_TRY(sf_signal_filter_cfc(&uniform, by->filter, &made, err));
    for (int64_t i = 0; i < curve->count; i++)
        read[i] = sf_series_at(&made, curve->time[i]);
    return sf_contact_instant(&made, "the curve to read", 0, contact, err);
}

softfall_status softfall_reading(const double *time, const double *value, int64_t count,
                                 const softfall_instrument *instrument, double *read, double *contact,
                                 softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, value, count);
    read_curve(&curve, instrument, read, contact, &err);
    return softfall_return(&err, error);
}
