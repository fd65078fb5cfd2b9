/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign/material_file.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

enum { PATH_SIZE = PATH_MAX };

static const double NO_CUTOFF = 1e29; /* Pa; the case's "none" is beyond it */

/* Every line of the text as a comment. */
static void put_comment(FILE *file, const char *text) {
    while (*text) {
        size_t length = strcspn(text, "\n");
        fprintf(file, "#%s%.*s\n", length ? " " : "", (int)length, text);
        text += length + (text[length] == '\n');
    }
}

static void curve_name(const char *name, const sf_foam_card *foam, int64_t index, char *out) {
    if (foam->curve_count == 1)
        snprintf(out, PATH_SIZE, "%s.csv", name);
    else
        snprintf(out, PATH_SIZE, "%s-%lld.csv", name, (long long)index + 1);
}

static sf_status close_file(FILE *file, const char *path, sf_error *err) {
    int failed = ferror(file);
    if (fclose(file) != 0 || failed)
        return SF_FAIL(err, SF_ERR_IO, "writing %s failed (disk full?)", path);
    return SF_OK;
}

static FILE *open_file(const char *folder, const char *name, char *path, sf_error *err) {
    FILE *file = NULL;
    if (snprintf(path, PATH_SIZE, "%s/%s", folder, name) >= PATH_SIZE)
        SF_FAIL(err, SF_ERR_INPUT, "the path of %s is longer than %d characters", name, PATH_SIZE - 1);
    else if (!(file = fopen(path, "w")))
        SF_FAIL(err, SF_ERR_IO, "%s cannot be written: %s", path, strerror(errno));
    return file;
}

static sf_status write_curve(const char *folder, const char *name, const sf_foam_card *foam, int64_t index,
                             const sf_material_text *text, sf_error *err) {
    char file_name[PATH_SIZE], path[PATH_SIZE];
    curve_name(name, foam, index, file_name);
    FILE *file = open_file(folder, file_name, path, err);
    if (!file)
        return err->status;
    put_comment(file, text->title);
    fputs("# Engineering strain and nominal stress, positive in compression", file);
    if (foam->curve_count > 1)
        fprintf(file, ", at %.6g per second", foam->curve_rate[index]);
    fputs(".\nstrain,stress_kPa\n", file);
    for (int64_t k = foam->curve_ptr[index]; k < foam->curve_ptr[index + 1]; k++)
        fprintf(file, "%.12g,%.12g\n", foam->curve_strain[k], 1e-3 * foam->curve_stress[k]);
    return close_file(file, path, err);
}

static void put_curves(FILE *file, const char *name, const sf_foam_card *foam) {
    char curve[PATH_SIZE];
    if (foam->curve_count == 1) {
        curve_name(name, foam, 0, curve);
        fprintf(file, "curve = \"%s\";\n", curve);
        return;
    }
    fputs("curves = (\n", file);
    for (int64_t k = 0; k < foam->curve_count; k++) {
        curve_name(name, foam, k, curve);
        fprintf(file, "    { rate = \"%.12g 1/s\"; file = \"%s\"; }%s\n", foam->curve_rate[k], curve,
                k + 1 < foam->curve_count ? "," : "");
    }
    fprintf(file, ");\nrate_filter_time = \"%.12g ms\";\n", 1e3 * foam->rate_filter_time);
}

static void put_densification(FILE *file, const sf_foam_card *foam) {
    int second_rule = foam->densification_limit < 1;
    fprintf(file, "densification = { rule = \"%s\"; start = %.12g; exponent = %.12g; ",
            second_rule ? "H2" : "H1", foam->densification_start, foam->densification_exponent);
    if (second_rule)
        fprintf(file, "limit = %.12g; ", foam->densification_limit);
    fputs("};\n", file);
}

static void put_card(FILE *file, const char *name, const sf_foam_card *foam) {
    fprintf(file, "density = \"%.12g kg/m3\";\n", foam->density);
    fprintf(file, "E = \"%.12g MPa\";\n", 1e-6 * foam->modulus);
    put_curves(file, name, foam);
    put_densification(file, foam);
    fprintf(file, "HU = %.12g;\nSHAPE = %.12g;\nDAMP = %.12g;\n", foam->hysteresis_hu, foam->hysteresis_shape,
            foam->damp);
    if (foam->damp_length > 0)
        fprintf(file, "damp_length = \"%.12g mm\";\n", 1e3 * foam->damp_length);
    if (foam->maxwell_modulus > 0)
        fprintf(file, "ED = \"%.12g MPa\";\nBETA1 = \"%.12g 1/s\";\n", 1e-6 * foam->maxwell_modulus,
                foam->maxwell_rate);
    if (foam->kelvin_viscosity > 0)
        fprintf(file, "eta = \"%.12g Pa s\";\n", foam->kelvin_viscosity);
    if (foam->tension_cutoff < NO_CUTOFF)
        fprintf(file, "tension_cutoff = \"%.12g kPa\";\n", 1e-3 * foam->tension_cutoff);
}

sf_status sf_material_write(const char *folder, const char *name, const sf_foam_card *foam,
                            const sf_material_text *text, sf_error *err) {
    char file_name[PATH_SIZE], path[PATH_SIZE];
    for (int64_t k = 0; k < foam->curve_count; k++)
        if (write_curve(folder, name, foam, k, text, err) != SF_OK)
            return err->status;
    snprintf(file_name, sizeof file_name, "%s.cfg", name);
    FILE *file = open_file(folder, file_name, path, err);
    if (!file)
        return err->status;
    put_comment(file, text->title);
    put_comment(file, text->provenance);
    fprintf(file,
            "# For a case: the group  material: { @include \"%s.cfg\" }  or  softfall-pre --set "
            "material=@%s.cfg\n",
            name, name);
    put_card(file, name, foam);
    return close_file(file, path, err);
}
