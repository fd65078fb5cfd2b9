/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/material_file.h"

#include "io/plain_file.h"
#include "base/text.h"
#include "case/read.h"
#include "io/replace.h"
#include <unistd.h>

enum { PATH_SIZE = PATH_MAX };

/* Every line of the text as a comment. */
static void put_comment(FILE *file, const char *text) {
    while (*text) {
        size_t length = strcspn(text, "\n");
        fprintf(file, "#%s%.*s\n", length ? " " : "", (int)length, text);
        text += length + (text[length] == '\n');
    }
}

static void curve_name(const char *name, const sf_law_curves *curves, int64_t index, char *out) {
    if (curves->curve_count == 1)
        snprintf(out, PATH_SIZE, "%s.csv", name);
    else
        snprintf(out, PATH_SIZE, "%s-%lld.csv", name, (long long)index + 1);
}

static FILE *open_file(const char *folder, const char *name, sf_replacement *out, sf_error *err) {
    char path[PATH_SIZE];
    return sf_path_print(path, PATH_SIZE, err, "%s/%s", folder, name) == SF_OK
               ? sf_replace_open(path, out, err)
               : NULL;
}

static sf_status write_curve(const char *folder, const char *name, const sf_law_curves *curves, int64_t index,
                             const sf_material_text *text, sf_error *err) {
    char file_name[PATH_SIZE];
    sf_replacement out;
    curve_name(name, curves, index, file_name);
    FILE *file = open_file(folder, file_name, &out, err);
    SF_TRY(err->status);
    put_comment(file, text->title);
    fputs("# Engineering strain and nominal stress, positive in compression", file);
    if (curves->curve_count > 1)
        fprintf(file, text->temperatures ? ", at %.6g K" : ", at %.6g per second", curves->curve_rate[index]);
    fputs(".\nstrain,stress_kPa\n", file);
    for (int64_t k = curves->curve_ptr[index]; k < curves->curve_ptr[index + 1]; k++)
        fprintf(file, "%.12g,%.12g\n", curves->curve_strain[k], 1e-3 * curves->curve_stress[k]);
    return sf_replace_close(&out, err);
}

static void put_curves(FILE *file, const char *name, bool thermal, const sf_law_curves *curves) {
    char curve[PATH_SIZE];
    if (curves->curve_count == 1) {
        curve_name(name, curves, 0, curve);
        fprintf(file, "curve = \"%s\";\n", curve);
        return;
    }
    fputs("curves = (\n", file);
    for (int64_t k = 0; k < curves->curve_count; k++) {
        curve_name(name, curves, k, curve);
        fprintf(file, "    { %s = \"%.12g %s\"; file = \"%s\"; }%s\n", thermal ? "temperature" : "rate",
                curves->curve_rate[k], thermal ? "K" : "1/s", curve, k + 1 < curves->curve_count ? "," : "");
    }
    fputs(");\n", file);
}

static void put_choice(FILE *file, const sf_parameter *p, int64_t index) {
    int length;
    const char *word = sf_word_at(p->words, (int)index, &length);
    fprintf(file, "%s = \"%.*s\";", p->key, length, word);
}

static void put_value(FILE *file, const sf_parameter *p, double value) {
    bool quantity = p->kind == SF_PARAMETER_QUANTITY;
    if (quantity && p->words && value == p->word_value)
        fprintf(file, "%s = \"%s\";", p->key, p->words);
    else if (quantity)
        fprintf(file, "%s = \"%.12g %s\";", p->key, p->unit ? value / p->unit_size : value,
                p->unit ? p->unit : sf_quantity_unit(p->quantity));
    else
        fprintf(file, "%s = %.12g;", p->key, value);
}

/* One key of a group per line, those of a sub-group on one. */
static void put_card(FILE *file, const char *name, bool thermal, const sf_material *m) {
    const char *open = "material";
    fprintf(file, "law = \"%s\";\n", m->law->name);
    for (int k = 0; k < m->law->parameter_count; k++) {
        const sf_parameter *p = &m->law->parameter[k];
        const void *at = (const char *)m->card + p->offset;
        const char *sub = strchr(p->group, '.');
        if (p->kind == SF_PARAMETER_CURVES || !sf_parameter_acts(p, m->card))
            continue;
        if (strcmp(open, p->group) != 0) {
            fputs(strchr(open, '.') ? "};\n" : "", file);
            if (sub)
                fprintf(file, "%s = { ", sub + 1);
            open = p->group;
        }
        if (p->kind == SF_PARAMETER_CURVE)
            put_curves(file, name, thermal, sf_material_curves(m));
        else if (p->kind == SF_PARAMETER_CHOICE)
            put_choice(file, p, *(const int64_t *)at);
        else
            put_value(file, p, *(const double *)at);
        if (p->kind != SF_PARAMETER_CURVE)
            fputs(sub ? " " : "\n", file);
    }
    fputs(strchr(open, '.') ? "};\n" : "", file);
}

/* The numbers that are given, a line each. */
static void put_response_error(FILE *file, const sf_response_error *error) {
    fputs(
        "# Errors of ln(number) of a drop beside the foam: one that all drops share, and the standard deviation of "
        "each drop's own.\nresponse_error = {\n",
        file);
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        if (error->given[kind])
            fprintf(file, "    %s = %.12g; %s = %.12g;\n", sf_drop_kind_get(kind)->error_key,
                    error->shared[kind], sf_drop_kind_get(kind)->sd_key, error->own_sd[kind]);
    fputs("};\n", file);
}

static sf_status write_material(const char *folder, const char *name, const sf_material *material,
                                const sf_material_text *text, sf_error *err) {
    sf_replacement out;
    const sf_law_curves *curves = sf_material_curves(material);
    for (int64_t k = 0; curves && k < curves->curve_count; k++)
        SF_TRY(write_curve(folder, name, curves, k, text, err));
    SF_PRINTED(file_name, PATH_SIZE, "%s.cfg", name);
    FILE *file = open_file(folder, file_name, &out, err);
    SF_TRY(err->status);
    put_comment(file, text->title);
    put_comment(file, text->provenance);
    fprintf(file,
            "# For a case: @include \"%s.cfg\" on a line of its own in the group material, or softfall-pre "
            "--set material=@%s.cfg\n",
            name, name);
    put_card(file, name, text->temperatures, material);
    if (text->response_error)
        put_response_error(file, text->response_error);
    return sf_replace_close(&out, err);
}

sf_status sf_material_write_checked(const char *folder, const char *name, const sf_material *material,
                                    const sf_material_text *text, sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    SF_TRY(write_material(folder, name, material, text, err));
    SF_PRINTED(path, PATH_SIZE, "%s/%s.cfg", folder, name);
    const sf_law_curves *curves = sf_material_curves(material);
    for (int64_t k = 1; k < (text->temperatures ? curves->curve_count : 2) && inner.status == SF_OK; k++)
        sf_case_check_material(
            path, text->temperatures ? 0.5 * (curves->curve_rate[k - 1] + curves->curve_rate[k]) : 0, &inner);
    if (inner.status == SF_OK)
        return SF_OK;
    remove(path);
    size_t skip = strlen(folder);
    bool inside = strncmp(inner.text, folder, skip) == 0 && inner.text[skip] == '/';
    return SF_FAIL(err, SF_ERR_MODEL, "no material is written, because softfall-pre would refuse it: %s",
                   inner.text + (inside ? skip + 1 : 0));
}
