/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of a chart's script by gnuplot. */
#include "report/chart_data.h"

#include "io/plain_file.h"
#include "io/process.h"
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 64 };

/* Runs NAME.gp for a picture of that ending. `program`: that writes the page of the picture, or NULL if the
 * script stays and draws it later. */
static void run(const sf_staging *output, const char *name, const char *ending, const char *program,
                char *warning, size_t size) {
    char script[NAME_SIZE], picture[NAME_SIZE], command[NAME_SIZE];
    snprintf(script, sizeof script, "%s.gp", name);
    snprintf(picture, sizeof picture, "%s.%s", name, ending);
    snprintf(command, sizeof command, "gnuplot %s.gp", name);
    warning[0] = '\0';
    const char *const arguments[] = {"gnuplot", "-c", script, ending, NULL};
    const sf_process gnuplot = {.arguments = arguments, .folder = output->aside};
    int code = 0, reason = sf_process_run(&gnuplot, &code);
    if (reason != 0)
        snprintf(warning, size,
                 program
                     ? "%s was not drawn, as gnuplot cannot be run (%s): install gnuplot and run %s again"
                     : "%s was not drawn, as gnuplot cannot be run (%s): install it and run \"%s\" in the "
                       "output directory",
                 picture, strerror(reason), program ? program : command);
    else if (code != 0 || !sf_staging_has(output, picture))
        snprintf(warning, size,
                 program
                     ? "%s was not drawn: gnuplot ended with code %d; try another gnuplot and run %s again"
                     : "%s was not drawn: gnuplot ended with code %d; run \"%s\" in the output directory "
                       "to see why",
                 picture, code, program ? program : command);
}

/* Reads a file of the staging directory and removes it; NULL on failure. */
static char *take_file(const sf_staging *output, const char *name) {
    sf_error ignored = SF_ERROR_INIT;
    char *text = NULL, *path = sf_staging_path(output, name, &ignored);
    if (path) {
        sf_plain_read(path, NULL, SF_PLAIN_TEXT, &text, NULL, &ignored);
        sf_staging_remove(output, name);
    }
    free(path);
    return text;
}

/* Returns the length of the beginning of an id, or of a reference to one; 0: there is none. */
static size_t id_prefix(const char *text) {
    static const char *const prefix[] = {" id=\"", " id='", "href=\"#", "href='#", "url(#"};
    for (size_t k = 0; k < sizeof prefix / sizeof prefix[0]; k++)
        if (strncmp(text, prefix[k], strlen(prefix[k])) == 0)
            return strlen(prefix[k]);
    return 0;
}

/* Returns the length of the element <title> that begins here, or 0. A browser would show gnuplot's names of
 * the curves. */
static size_t title_length(const char *text) {
    static const char end[] = "</title>";
    const char *behind = strncmp(text, "<title>", 7) == 0 ? strstr(text, end) : NULL;
    return behind ? (size_t)(behind - text) + strlen(end) : 0;
}

char *sf_gnuplot_element(const char *text, const char *name) {
    const char *at = strstr(text, "<svg");
    char *element = NULL;
    size_t size = 0;
    FILE *out = at ? open_memstream(&element, &size) : NULL;
    if (!out)
        return NULL;
    while (*at) {
        size_t title = title_length(at);
        if (title > 0) {
            at += title;
            continue;
        }
        size_t length = id_prefix(at);
        fwrite(at, 1, length > 0 ? length : 1, out);
        if (length > 0)
            fprintf(out, "%s-", name);
        at += length > 0 ? length : 1;
    }
    if (fclose(out) == 0)
        return element;
    free(element);
    return NULL;
}

char *sf_chart_svg(const sf_staging *output, const char *name, const char *program, char *warning,
                   size_t size) {
    char picture[NAME_SIZE], *element = NULL;
    run(output, name, "svg", program, warning, size);
    snprintf(picture, sizeof picture, "%s.svg", name);
    char *text = take_file(output, picture);
    if (text && !*warning)
        element = sf_gnuplot_element(text, name);
    if (!element && !*warning)
        snprintf(warning, size, "%s was drawn, but cannot be read", picture);
    free(text);
    return element;
}

sf_status sf_chart_write(const sf_chart *chart, const sf_staging *output, char *warning, size_t size,
                         sf_error *err) {
    warning[0] = '\0';
    if (!chart || sf_chart_script(chart, output, err) != SF_OK)
        return err->status;
    run(output, chart->name, "png", NULL, warning, size);
    return SF_OK;
}

char *sf_chart_page(const sf_chart *chart, const sf_staging *output, const char *program, char *warning,
                    size_t size, sf_error *err) {
    char script[NAME_SIZE];
    warning[0] = '\0';
    if (!chart || sf_chart_script(chart, output, err) != SF_OK)
        return NULL;
    char *svg = sf_chart_svg(output, chart->name, program, warning, size);
    snprintf(script, sizeof script, "%s.gp", chart->name);
    sf_staging_remove(output, script);
    return svg;
}
