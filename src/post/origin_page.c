/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/origin_page.h"

#include "post/origin.h"
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

/* The keys of the material that the case gives, and whether it says what its data inform. */
static void put_given(sf_html_table *table, const char *parameters) {
    static const char group[] = "material.";
    sf_origin_key key;
    if (sf_origin_find(parameters, "material.informed_strain", &key) && !key.given)
        sf_html_fact(table, "informed_strain", "not given: the end of the curve is taken for it");
    while (sf_origin_next(&parameters, &key))
        if (key.given && strncmp(key.name, group, strlen(group)) == 0)
            sf_html_fact(table, key.name + strlen(group), "%s", key.value);
}

void sf_origin_put_material(FILE *page, const char *case_text, const char *parameters) {
    char *origin = sf_origin_material(case_text);
    sf_html_block_begin(page);
    sf_html_heading(page, "Material");
    sf_html_columns_begin(page, "narrow");
    sf_html_table table = sf_html_table_begin(page, "dense", NULL);
    put_given(&table, parameters);
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
