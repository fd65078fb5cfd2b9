/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/origin_page.h"

#include "post/results/origin.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Without the brackets and quotes of the case's syntax. */
static void tidy(char *value) {
    char *to = value, *end;
    for (const char *from = value; *from; from++)
        if (!strchr("{}[]\"", *from) && (to > value || *from != ' '))
            *to++ = *from;
    for (end = to; end > value && strchr(" ;", end[-1]); end--)
        ;
    *end = '\0';
}

void sf_origin_put_key(sf_html_table *table, const char *parameters, const char *name, const char *title) {
    sf_origin_key key;
    if (!sf_origin_find(parameters, name, &key) || strcmp(key.value, "(absent)") == 0)
        return;
    tidy(key.value);
    if (*key.value)
        sf_html_fact(table, title, "%s", key.value);
}

/* The keys of the material that the case gives, and whether it says what its data inform. `group`: with its
 * point at the end. */
static void put_given(sf_html_table *table, const char *parameters, const char *group) {
    sf_origin_key key;
    char informed[SF_ORIGIN_NAME_SIZE + 32];
    snprintf(informed, sizeof informed, "%sinformed_strain", group);
    if (sf_origin_find(parameters, informed, &key) && !key.given)
        sf_html_fact(table, "informed_strain", "not given: the end of the curve is taken for it");
    while (sf_origin_next(&parameters, &key))
        if (key.given && strncmp(key.name, group, strlen(group)) == 0)
            sf_html_fact(table, key.name + strlen(group), "%s", key.value);
}

/* `layer` NULL: of a pad of one material. */
static void put_material(FILE *page, const char *case_text, const char *parameters, const char *layer) {
    char *origin = sf_origin_material(case_text, layer), heading[SF_ORIGIN_NAME_SIZE + 32],
         group[SF_ORIGIN_NAME_SIZE + 16];
    snprintf(heading, sizeof heading, "Material%s%s", layer ? " of the layer " : "", layer ? layer : "");
    snprintf(group, sizeof group, "material%s%s.", layer ? "s." : "", layer ? layer : "");
    sf_html_block_begin(page);
    sf_html_heading(page, heading);
    sf_html_columns_begin(page, "narrow");
    sf_html_table table = sf_html_table_begin(page, "dense", NULL);
    put_given(&table, parameters, group);
    sf_html_table_end(&table);
    sf_html_block_begin(page);
    sf_html_note(
        page, "Origin, and the range that its data inform, as its file says. Keys not listed have defaults.");
    sf_html_prose(page,
                  origin && *origin ? origin : "The case says nothing about the origin of the material.");
    sf_html_block_end(page);
    sf_html_columns_end(page);
    sf_html_block_end(page);
    free(origin);
}

void sf_origin_put_material(FILE *page, const char *case_text, const char *parameters) {
    static const char group[] = "materials.";
    char last[SF_ORIGIN_NAME_SIZE] = "";
    const char *rest = parameters;
    sf_origin_key key;
    while (sf_origin_next(&rest, &key)) {
        if (strncmp(key.name, group, strlen(group)) != 0)
            continue;
        char *name = key.name + strlen(group);
        name[strcspn(name, ".")] = '\0';
        if (strcmp(name, last) == 0)
            continue;
        snprintf(last, sizeof last, "%.*s", (int)sizeof last - 1, name);
        put_material(page, case_text, parameters, name);
    }
    if (!*last)
        put_material(page, case_text, parameters, NULL);
}
