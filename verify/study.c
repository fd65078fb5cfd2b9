/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static void put(sf_study *s, const char *text) {
    fputs(text, stdout);
    if (s->out) {
        fputs(text, s->out);
        fflush(s->out); /* long studies are read while they run */
    }
}

static void close_table(sf_study *s) {
    if (s->in_table)
        put(s, "\n");
    s->in_table = false;
}

void sf_study_begin(sf_study *s, const char *name, const char *title, int argc, char **argv) {
    *s = (sf_study){.name = name, .folder = argc > 1 ? argv[1] : NULL};
    if (s->folder) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s.md", s->folder, name);
        s->out = fopen(path, "w");
        if (!s->out) {
            fprintf(stderr, "%s cannot be written\n", path);
            exit(100);
        }
    }
    sf_study_text(s, "## %s\n\n", title);
}

void sf_study_text(sf_study *s, const char *format, ...) {
    char text[8192];
    va_list args;
    close_table(s);
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    put(s, text);
}

bool sf_study_check(sf_study *s, double value, double low, double high, const char *what, ...) {
    char name[512], bound[64], row[768];
    va_list args;
    va_start(args, what);
    vsnprintf(name, sizeof name, what, args);
    va_end(args);
    bool pass = value >= low && value <= high;
    s->checks++;
    s->failures += !pass;
    if (!s->in_table)
        put(s, "| quantity | measured | required | |\n|---|---|---|---|\n");
    s->in_table = true;
    if (isfinite(low) && isfinite(high))
        snprintf(bound, sizeof bound, "%.4g to %.4g", low, high);
    else
        snprintf(bound, sizeof bound, "%s %.4g", isfinite(low) ? "≥" : "≤", isfinite(low) ? low : high);
    snprintf(row, sizeof row, "| %s | %.4g | %s | %s |\n", name, value, bound, pass ? "pass" : "**fail**");
    put(s, row);
    return pass;
}

FILE *sf_study_file(sf_study *s, const char *suffix) {
    char path[4096];
    if (!s->folder)
        return NULL;
    snprintf(path, sizeof path, "%s/%s-%s", s->folder, s->name, suffix);
    return fopen(path, "w");
}

void sf_study_plot(sf_study *s, const char *suffix, const char *caption, const char *commands) {
    char line[4096];
    if (!s->folder)
        return;
    snprintf(line, sizeof line, "cd '%s' && gnuplot", s->folder);
    FILE *pipe = popen(line, "w");
    if (!pipe)
        return;
    fprintf(pipe, "set terminal pngcairo size 1200,750 font ',16'\nset output '%s-%s'\nset grid\n%s\n",
            s->name, suffix, commands);
    if (pclose(pipe) == 0)
        sf_study_text(s, "\n![%s](images/verification/%s-%s)\n\n", caption, s->name, suffix);
}

void sf_study_fail(sf_study *s, const sf_error *err) {
    s->checks++;
    s->failures++;
    sf_study_text(s, "**fail**: %s\n\n", err->text);
}

int sf_study_end(sf_study *s) {
    close_table(s);
    printf("%s: %d checks, %d failed\n", s->name, s->checks, s->failures);
    if (s->out)
        fclose(s->out);
    return s->failures > 100 ? 100 : s->failures;
}
