/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/gnuplot.h"

#include "io/process.h"
#include <stdio.h>
#include <string.h>

void sf_gnuplot_draw(const sf_staging *output, const char *script, const char *picture, char *warning,
                     size_t size) {
    warning[0] = '\0';
    const char *const arguments[] = {"gnuplot", script, NULL};
    const sf_process gnuplot = {.arguments = arguments, .folder = output->aside};
    int code = 0, reason = sf_process_run(&gnuplot, &code);
    if (reason != 0)
        snprintf(warning, size,
                 "%s was not drawn, as gnuplot cannot be run (%s): install it and run \"gnuplot %s\" in the "
                 "output directory",
                 picture, strerror(reason), script);
    else if (code != 0 || !sf_staging_has(output, picture))
        snprintf(warning, size,
                 "%s was not drawn: gnuplot ended with code %d; run \"gnuplot %s\" in the output directory "
                 "to see why",
                 picture, code, script);
}
