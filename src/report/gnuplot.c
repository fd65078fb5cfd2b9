/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/gnuplot.h"

#include "io/plain_file.h"
#include "io/process.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 64 };

FILE *sf_gnuplot_begin(const sf_staging *output, const char *name, int width, int height, sf_error *err) {
    char file[NAME_SIZE];
    snprintf(file, sizeof file, "%s.gp", name);
    FILE *script = sf_staging_open(output, file, err);
    if (!script)
        return NULL;
    fprintf(
        script,
        "# gnuplot %s.gp draws %s.png, gnuplot -c %s.gp svg draws %s.svg: from any folder, beside this file.\n"
        "set encoding utf8\n"
        "if (exists('ARG0')) {\n    folder = ''\n"
        "    do for [k = 1:strlen(ARG0)] { if (substr(ARG0, k, k) eq '/') { folder = substr(ARG0, 1, k) } }\n"
        "    if (folder ne '') { cd folder }\n}\n",
        name, name, name, name);
    fprintf(script,
            "svg = exists('ARG1') && ARG1 eq 'svg'\ndot = svg ? 0.5 : 1 # size of points\n"
            "if (svg) {\n"
            "    set terminal svg size %d,%d font 'Arial,11' linewidth 0.5 dashlength 2 noenhanced\n"
            "    set output '%s.svg'\n"
            "} else {\n"
            "    set terminal pngcairo size %d,%d font 'DejaVu Sans,20' noenhanced background rgb 'white'\n"
            "    set output '%s.png'\n}\n",
            9 * width / 25, 9 * height / 25, name, width, height, name);
    fputs("set datafile separator ','\n"
          "set grid back lt 1 lc rgb '#d8d8d8' lw 1\nset border 3 lw 1.5 lc rgb '#404040'\n"
          "set tics nomirror out scale 0.6\nset xlabel offset 0,0.4\n",
          script);
    return script;
}

void sf_gnuplot_key(FILE *script, int entries, int columns) {
    int rows = (entries + columns - 1) / columns;
    if (entries <= 0)
        fputs("unset key\n", script);
    else
        fprintf(
            script,
            "set bmargin %.1f\nset key at screen 0.5,0.015 center bottom horizontal maxcols %d Left reverse "
            "samplen 1.5 width (svg ? -4 : 1) spacing 1.1\n",
            3.4 + 1.2 * rows, (entries + rows - 1) / rows);
}

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

void sf_gnuplot_draw(const sf_staging *output, const char *name, char *warning, size_t size) {
    run(output, name, "png", NULL, warning, size);
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

/* What a reference to an id, or the id itself, begins with; its length there, or 0. */
static size_t id_prefix(const char *text) {
    static const char *const prefix[] = {" id=\"", " id='", "href=\"#", "href='#", "url(#"};
    for (size_t k = 0; k < sizeof prefix / sizeof prefix[0]; k++)
        if (strncmp(text, prefix[k], strlen(prefix[k])) == 0)
            return strlen(prefix[k]);
    return 0;
}

/* The length of the element <title> that begins here; 0 if none does. A browser would show gnuplot's names of
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

char *sf_gnuplot_svg(const sf_staging *output, const char *name, const char *program, char *warning,
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
