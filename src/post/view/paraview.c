/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/paraview.h"

#include "io/plain_file.h"
#include "io/process.h"
#include "post/view/axis.h"
#include <string.h>
#include <unistd.h>

static const char STATE[] = "pad_paraview.py", PICTURE[] = "pad.png", LOG[] = "film.log";
/* The line of the template that the facts replace. */
static const char FACTS[] = "\nDROP = {}";

/* ---- the facts ---- */

/* The field that colours the pad: the first of these that all frames have. */
static const struct {
    sf_frame_field field;
    double factor;
    const char *label;
} colourings[] = {{SF_FRAME_VON_MISES, 1e-3, "von Mises stress (kPa)"},
                  {SF_FRAME_LARGEST_COMPRESSION, 1, "largest compression (strain)"}};

static void put_colouring(FILE *f, const sf_xdmf *made) {
    for (size_t k = 0; k < sizeof colourings / sizeof colourings[0]; k++) {
        sf_frame_field field = colourings[k].field;
        if (!(made->fields >> field & 1) || !(made->largest[field] > 0))
            continue;
        fprintf(f, "    \"array\": \"%s\", \"label\": \"%s\", \"factor\": %g, \"largest\": %.6g,\n",
                sf_frame_field_get(field)->array, colourings[k].label, colourings[k].factor,
                made->largest[field]);
        return;
    }
    fputs("    \"array\": None, \"label\": None, \"factor\": None, \"largest\": None,\n", f);
}

static void put_mirrors(FILE *f, const sf_results *r) {
    double place[2], axis[2];
    sf_axis_planes(r, place);
    sf_axis_find(r, axis);
    fputs("    \"mirrors\": [", f);
    for (int k = 0; k < 2; k++)
        if (isfinite(place[k]))
            fprintf(f, "[\"%c\", %.9g], ", "XY"[k], place[k]);
    fprintf(f, "], \"axis\": [%.9g, %.9g],\n", axis[0], axis[1]);
}

static void put_optional(FILE *f, const char *name, double value) {
    if (isfinite(value))
        fprintf(f, "    \"%s\": %.9g,\n", name, value);
    else
        fprintf(f, "    \"%s\": None,\n", name);
}

static void put_facts(FILE *f, const sf_results *r, const sf_xdmf *made) {
    fputs("\nDROP = {\n", f);
    if (r->driven)
        fprintf(f, "    \"title\": \"prescribed motion on %.3g mm of foam\",\n", r->thickness * 1e3);
    else
        fprintf(f, "    \"title\": \"%.3g kg at %.3g m/s on %.3g mm of foam\",\n", r->missile_mass,
                r->missile_speed, r->thickness * 1e3);
    put_mirrors(f, r);
    put_optional(f, "sphere", r->sphere_radius);
    put_optional(f, "peak", made->peak_time);
    fprintf(f, "    \"missile\": %s, \"support\": %s, \"driven\": %s,\n",
            r->surface_triangle_count > 0 ? "True" : "False",
            r->support_triangle_count > 0 ? "True" : "False", r->driven ? "True" : "False");
    put_colouring(f, made);
    fputs("}", f);
}

/* ---- the file ---- */

sf_status sf_template_read(const char *name, const char *mark, char **text, sf_error *err) {
    char path[PATH_MAX];
    SF_TRY(sf_process_find_shared(name, path, sizeof path, err));
    SF_TRY(sf_plain_read(path, NULL, SF_PLAIN_TEXT, text, NULL, err));
    if (strstr(*text, mark))
        return SF_OK;
    free(*text);
    *text = NULL;
    return SF_FAIL(err, SF_ERR_IO, "%s is not the one that comes with softfall: install it again", path);
}

sf_status sf_paraview_write(const sf_staging *output, const sf_results *r, const sf_xdmf *made, char *warning,
                            size_t size, sf_error *err) {
    SF_OWNED char *text = NULL;
    sf_error problem = SF_ERROR_INIT;
    *warning = '\0';
    if (made->frames == 0)
        return SF_OK;
    if (sf_template_read(STATE, FACTS, &text, &problem) != SF_OK) {
        snprintf(warning, size, "there is no %s: %s", STATE, problem.text);
        return SF_OK;
    }
    double place[2];
    if (!sf_axis_planes(r, place))
        snprintf(warning, size,
                 "%s shows the modelled part of the pad only, as results.h5 does not say where the symmetry "
                 "planes lie",
                 STATE);
    FILE *f = sf_staging_open(output, STATE, err);
    if (f) {
        const char *line = strstr(text, FACTS);
        fwrite(text, 1, (size_t)(line - text), f);
        put_facts(f, r, made);
        fputs(line + strlen(FACTS), f);
        sf_staging_close(f, STATE, err);
    }
    return err->status;
}

/* ---- the film ---- */

/* Without a virtual display; one that DISPLAY names may be gone, or refuse this user. */
static bool uses_display(void) {
    const char *display = getenv("DISPLAY");
    return display && *display && !sf_process_is_in_path("xvfb-run");
}

sf_status sf_paraview_check_film(const char *kind, const char **film, sf_error *err) {
    static const struct {
        const char *program, *package, *use;
    } needed[] = {
        {"pvbatch", "the package paraview", "draws its pictures"},
        {"ffmpeg", "the package ffmpeg", "puts them together"},
        {"xvfb-run", "the packages xvfb and xauth", "stands in for a display, as there is none here"}};
    *film = NULL;
    if (!kind || strcmp(kind, "mp4") == 0)
        *film = "pad.mp4";
    else if (strcmp(kind, "gif") == 0)
        *film = "pad.gif";
    else
        return SF_REFUSE(err, "--film=%s: a film is mp4 or gif", kind);
    for (size_t k = 0; k < sizeof needed / sizeof needed[0]; k++)
        if (!(k == 2 && uses_display()) && !sf_process_is_in_path(needed[k].program))
            return SF_REFUSE(err, "--film needs %s, which %s: install %s of Debian", needed[k].program,
                             needed[k].use, needed[k].package);
    return SF_OK;
}

/* Takes out the sequences that colour a terminal. */
static void strip_colours(char *line) {
    char *to = line;
    for (const char *c = line; *c; c++)
        if (c[0] == '\033' && c[1] == '[') {
            c += 1 + strcspn(c + 1, "@ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz");
            if (!*c)
                break;
        } else {
            *to++ = *c;
        }
    *to = '\0';
}

/* The last line of what the programs printed that says something; "" if there is none. */
static void read_reason(const sf_staging *output, char *line, size_t size) {
    sf_error ignored = SF_ERROR_INIT;
    char *rest = NULL;
    SF_OWNED char *text = NULL, *path = sf_staging_path(output, LOG, &ignored);
    *line = '\0';
    if (path && sf_plain_read(path, NULL, SF_PLAIN_TEXT, &text, NULL, &ignored) == SF_OK)
        for (char *k = strtok_r(text, "\n", &rest); k; k = strtok_r(NULL, "\n", &rest))
            if (!*line || strncmp(k, "pad_paraview: ", 14) == 0)
                snprintf(line, size, "%s", k);
    strip_colours(line);
    sf_error_clean(line);
}

sf_status sf_paraview_film(const sf_staging *output, const char *film, sf_error *err) {
    enum { OF_XVFB = 6 };
    char display[16]; /* from here on xvfb-run looks for a free one: others look too, and two may find the
                         same */
    /* -noreset: ParaView opens the display, closes it and opens it again; a server that resets between the
     * two may refuse the second */
    const char *words[] = {"xvfb-run", "-a",
                           "-n",       display,
                           "-s",       "-noreset -screen 0 1280x1024x24",
                           "pvbatch",  "--force-offscreen-rendering",
                           STATE,      "--film",
                           film,       "--picture",
                           PICTURE,    NULL};
    SF_OWNED char *log = sf_staging_path(output, LOG, err);
    char reason[256];
    int code = 0;
    if (!log)
        return err->status;
    snprintf(display, sizeof display, "%d", 1000 + (int)(getpid() % 30000));
    const sf_process process = {.arguments = uses_display() ? words + OF_XVFB : words,
                                .folder = output->aside,
                                .log = LOG,
                                .stoppable = true,
                                .apart = true};
    sf_process_handle_signals(); /* else its programs would outlive this one */
    int problem = sf_staging_has(output, STATE) ? sf_process_run(&process, &code) : 0;
    if (!sf_staging_has(output, STATE))
        SF_REFUSE(err, "there are no frames or no %s to make a film of", STATE);
    else if (sf_process_stopped())
        SF_FAIL(err, SF_INTERRUPTED, "interrupted while the film was made; nothing was written");
    else if (problem != 0)
        SF_FAIL(err, SF_ERR_IO, "the film was not made, as pvbatch cannot be run: %s", strerror(problem));
    else if (code != 0 || !sf_staging_has(output, film) || !sf_staging_has(output, PICTURE)) {
        read_reason(output, reason, sizeof reason);
        SF_FAIL(err, SF_ERR_LIBRARY, "the film was not made: pvbatch ended with code %d%s%s", code,
                *reason ? ": " : "", reason);
    }
    sf_staging_remove(output, LOG);
    return err->status;
}
