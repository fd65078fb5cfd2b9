/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/phrase.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *sf_compression_rate_phrase(sf_rate_model model) {
    static const char *const phrases[SF_RATE_MODELS] = {
        "none: one curve for all rates",
        "log: curve times 1 + c ln(rate/slowest rate), written as a curve for each rate",
        "maxwell: one curve and a Maxwell branch ED, BETA1",
        "curves: a curve of its own for each rate",
    };
    return phrases[model];
}

const char *sf_compression_rule_phrase(sf_rule rule) {
    static const char *const phrases[SF_RULES] = {
        "H1, exponent by A = 0: B/(1 - strain)^m",
        "H1, exponent free: A + B/(1 - strain)^m",
        "H2: A + B/(limit - strain)^m",
    };
    return phrases[rule];
}

void sf_compression_text(const sf_estimate *e, double value, char *out, size_t size) {
    bool pressure = strcmp(e->unit, "Pa") == 0;
    double scale = pressure ? 1e-3 : 1;
    const char *unit = pressure ? "kPa" : e->unit;
    if (isfinite(value))
        snprintf(out, size, "%.5g%s%s", value * scale, *unit ? " " : "", unit);
    else
        snprintf(out, size, "-");
}
