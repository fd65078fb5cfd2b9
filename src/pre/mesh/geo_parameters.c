/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/geo_parameters.h"

#include <ctype.h>
#include <math.h>

#include "base/near.h"
#include "base/text.h"
#include "io/plain_file.h"
#include "pre/mesh/mesher_protocol.h"

static const char *skip_blank(const char *p) {
    return sf_blanks_pass(p, false);
}

static bool is_word(char c) {
    return isalnum((unsigned char)c) || c == '_' || c == '.';
}

/* The text of a .geo file, cut as gmsh cuts it: words (names and numbers), texts in quotes, and single marks;
 * comments vanish. */
typedef struct geo_token {
    enum { GEO_END, GEO_WORD, GEO_TEXT, GEO_MARK } kind;
    const char *begin; /* in the text; of a quoted one without its quotes */
    size_t length;
} geo_token;

/* Returns the next token and moves `*text` behind it. */
static geo_token token_next(const char **text) {
    const char *p = skip_blank(*text);
    geo_token t = {GEO_MARK, p, 1};
    if (*p == '\0') {
        t = (geo_token){GEO_END, p, 0};
    } else if (*p == '"' || *p == '\'') {
        size_t length = strcspn(p + 1, *p == '"' ? "\"" : "'");
        *text = p + 1 + length + (p[1 + length] != '\0');
        return (geo_token){GEO_TEXT, p + 1, length};
    } else if (is_word(*p)) {
        t.kind = GEO_WORD;
        while (is_word(p[t.length]))
            t.length++;
    }
    *text = p + t.length;
    return t;
}

/* True if it is that word or mark, or the content of a text in quotes. */
static bool token_is(geo_token t, const char *text) {
    return t.length == strlen(text) && strncmp(t.begin, text, t.length) == 0;
}

enum { MAX_NAMES = 256, MOST_CHOICES = 16 };

/* The constants of texts with their defaults; NaN: a default is no plain number. */
typedef struct name_list {
    int count;
    sf_geo_parameter at[MAX_NAMES];
    int choices[MAX_NAMES]; /* number of values that a constant may have, 0: any */
    double choice[MAX_NAMES][MOST_CHOICES];
    char fixed[SF_CASE_NAME_SIZE]; /* a spacing that a text sets, by no other one; "" */
    bool others;                   /* a text reads other files */
} name_list;

/* Returns the plain number behind "=" or "= {" that is all of a default; NaN: there is none. */
static double read_number(const char *text) {
    double value;
    const char *p = skip_blank(text);
    p = *p == '=' ? skip_blank(p + 1) : "";
    p = sf_decimal_read(*p == '{' ? skip_blank(p + 1) : p, &value);
    p = p ? skip_blank(p) : "";
    return *p && strchr(",}])", *p) ? value : NAN;
}

/* Reads the values in "= {1, Choices {0, 1}, ...}" or "Choices {0="no", 1="yes"}" behind a constant's name.
 * Returns their number, 0 if there are none, too many, or others than plain numbers. */
static int read_choices(const char *text, double choice[MOST_CHOICES]) {
    int count = 0;
    if (!token_is(token_next(&text), "=") || !token_is(token_next(&text), "{"))
        return 0;
    for (geo_token t = token_next(&text); !token_is(t, "Choices"); t = token_next(&text))
        if (t.kind == GEO_END || (t.kind == GEO_MARK && strchr("{}", *t.begin)))
            return 0;
    for (geo_token t = token_next(&text); token_is(t, count ? "," : "{");) {
        text = sf_decimal_read(skip_blank(text), &choice[count]);
        if (!text || ++count == MOST_CHOICES)
            return 0;
        t = token_next(&text);
        if (token_is(t, "=")) { /* the label of the value */
            token_next(&text);
            t = token_next(&text);
        }
        if (token_is(t, "}"))
            return count;
    }
    return 0;
}

static void add_name(name_list *list, geo_token t, const char *text) {
    if (t.length >= SF_CASE_NAME_SIZE || list->count == MAX_NAMES)
        return;
    sf_geo_parameter *out = &list->at[list->count++];
    snprintf(out->name, sizeof out->name, "%.*s", (int)t.length, t.begin);
    out->value = read_number(text);
    list->choices[list->count - 1] = read_choices(text, list->choice[list->count - 1]);
    for (sf_geo_parameter *p = list->at; p < out; p++)
        if (strcmp(p->name, out->name) == 0 && p->value != out->value)
            p->value = out->value = NAN; /* which one holds is known to gmsh alone */
}

/* After DefineConstant: names at the outermost level of its brackets, each at the beginning of an item. */
static void read_constants(const char **text, name_list *list) {
    int depth = 0;
    bool expecting = false;
    do {
        geo_token t = token_next(text);
        if (t.kind == GEO_END)
            return;
        if (t.kind == GEO_MARK && strchr("[({", *t.begin)) {
            expecting = depth++ == 0;
        } else if (t.kind == GEO_MARK && strchr("])}", *t.begin)) {
            depth--;
        } else if (t.kind == GEO_MARK && *t.begin == ',') {
            expecting = depth == 1;
        } else if (t.kind == GEO_WORD && expecting && depth == 1) {
            add_name(list, t, *text);
            expecting = false;
        }
    } while (depth > 0);
}

static bool is_spacing(const char *name) {
    return strstr(name, "spacing") != NULL;
}

/* True if a name is assigned a value that follows no spacing of DefineConstant; `text` is behind the name. */
static bool is_set_alone(const char *text) {
    geo_token t = token_next(&text);
    if (!token_is(t, "=") || *text == '=')
        return false;
    do {
        char word[SF_CASE_NAME_SIZE];
        t = token_next(&text);
        snprintf(word, sizeof word, "%.*s", t.kind == GEO_WORD ? (int)t.length : 0, t.begin);
        if (is_spacing(word))
            return false;
    } while (t.kind != GEO_END && !token_is(t, ";"));
    return true;
}

static void scan(const char *text, name_list *list) {
    for (geo_token t = {GEO_MARK, NULL, 0}; t.kind != GEO_END;) {
        t = token_next(&text);
        SF_PRINTED(name, SF_CASE_NAME_SIZE, "%.*s", t.kind == GEO_WORD ? (int)t.length : 0, t.begin);
        list->others |= strcmp(name, "Include") == 0 || strcmp(name, "Merge") == 0;
        if (strcmp(name, "DefineConstant") == 0)
            read_constants(&text, list);
        else if (is_spacing(name) && is_set_alone(text))
            memcpy(list->fixed, name, sizeof name);
    }
}

/* Adds the names in the file of the geometry. */
static sf_status scan_file(const sf_geo_source *source, name_list *list, sf_error *err) {
    SF_OWNED char *text = NULL;
    SF_TRY(sf_plain_read(source->path, "geometry", SF_PLAIN_ANY, &text, NULL, err));
    scan(text, list);
    return SF_OK;
}

static bool has_name(int count, const sf_geo_parameter *list, const char *name) {
    for (int k = 0; k < count; k++)
        if (strcmp(list[k].name, name) == 0)
            return true;
    return false;
}

/* Refuses the first parameter that is not in the list. */
static sf_status refuse_missing(const sf_geo_source *source, const name_list *list, sf_error *err) {
    for (int k = 0; k < source->parameter_count; k++) {
        if (has_name(list->count, list->at, source->parameter[k].name))
            continue;
        char names[640] = "", meant[SF_NEAR_HINT];
        sf_near near = sf_near_begin(source->parameter[k].name);
        for (int i = 0; i < list->count; i++) {
            sf_text_add(names, sizeof names, "%s%s", i ? ", " : "", list->at[i].name);
            sf_near_offer(&near, list->at[i].name, strlen(list->at[i].name));
        }
        return SF_REFUSE(err, "%s has no parameter \"%s\"%s; its DefineConstant parameters are: %s",
                         source->path, source->parameter[k].name, sf_near_hint(&near, meant),
                         list->count ? names : "none");
    }
    return SF_OK;
}

/* Refuses the first parameter that is none of its choices. */
static sf_status refuse_unchosen(const sf_geo_source *source, const name_list *list, sf_error *err) {
    for (int k = 0; k < source->parameter_count; k++)
        for (int i = 0; i < list->count; i++) {
            char names[320] = "";
            bool chosen = list->choices[i] == 0 || strcmp(list->at[i].name, source->parameter[k].name) != 0;
            for (int c = 0; c < list->choices[i]; c++) {
                chosen = chosen || list->choice[i][c] == source->parameter[k].value;
                sf_text_add(names, sizeof names, "%s%g", c ? ", " : "", list->choice[i][c]);
            }
            if (!chosen)
                return SF_REFUSE(err, "%s: %s = %g is none of its choices: %s", source->path,
                                 list->at[i].name, source->parameter[k].value, names);
        }
    return SF_OK;
}

static bool is_scaled(const sf_geo_source *source) {
    return source->spacing_factor > 0 && source->spacing_factor != 1;
}

/* Refuses a factor that a spacing of the list does not follow, or that has none. */
static sf_status refuse_unscaled(const sf_geo_source *source, const name_list *list, sf_error *err) {
    const char *open = *list->fixed ? list->fixed : NULL;
    bool any = false;
    for (int k = 0; k < list->count && !open; k++) {
        const char *name = list->at[k].name;
        any |= is_spacing(name);
        if (is_spacing(name) && !has_name(source->parameter_count, source->parameter, name))
            open = name;
    }
    if (!is_scaled(source) || (any && !open))
        return SF_OK;
    return SF_REFUSE(err,
                     "%s: geometry.spacing_factor needs a number, in geometry.parameters or in a "
                     "DefineConstant of this file, for %s",
                     source->path, open ? open : "a parameter with \"spacing\" in its name");
}

static bool is_geo(const sf_geo_source *source) {
    return source->path && sf_mesher_has_suffix(source->path, ".geo");
}

sf_status sf_geo_parameters_scale(const sf_geo_source *source, sf_geo_source *scaled, sf_error *err) {
    *scaled = *source;
    if (!is_geo(source) || !is_scaled(source))
        return SF_OK; /* only a .geo file has parameters */
    SF_OWN(name_list, list, 1, "parameter names", err);
    SF_TRY(scan_file(source, list, err));
    for (int k = 0; k < list->count && scaled->parameter_count < SF_CASE_MAX_PARAMETERS; k++)
        if (is_spacing(list->at[k].name) && isfinite(list->at[k].value) &&
            !has_name(scaled->parameter_count, scaled->parameter, list->at[k].name))
            scaled->parameter[scaled->parameter_count++] = list->at[k];
    for (int k = 0; k < scaled->parameter_count; k++)
        if (is_spacing(scaled->parameter[k].name))
            scaled->parameter[k].value *= source->spacing_factor;
    return SF_OK;
}

sf_status sf_geo_parameters_check(const sf_geo_source *source, const sf_broker *read, bool complete,
                                  sf_error *err) {
    sf_geo_source scaled;
    if (is_scaled(source) && !is_geo(source))
        return SF_REFUSE(err, "%s: geometry.spacing_factor multiplies spacings of a .geo file only",
                         source->path);
    if ((source->parameter_count == 0 && !is_scaled(source)) || (!read && !is_geo(source)))
        return SF_OK;
    SF_OWN(name_list, list, 1, "parameter names", err);
    for (size_t k = 0; complete && k < read->count; k++)
        if (read->file[k].is_text)
            scan(read->file[k].text, list);
    if (!complete)
        SF_TRY(scan_file(source, list, err));
    if (!read && list->others)
        return SF_OK;
    SF_TRY(sf_geo_parameters_scale(source, &scaled, err));
    SF_TRY(refuse_missing(&scaled, list, err));
    SF_TRY(refuse_unchosen(&scaled, list, err));
    return refuse_unscaled(&scaled, list, err);
}
