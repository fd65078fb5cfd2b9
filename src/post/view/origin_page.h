/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The material and the case in a report, from their texts (post/results/origin.h). */
#ifndef SF_POST_ORIGIN_PAGE_H
#define SF_POST_ORIGIN_PAGE_H

#include "report/html.h"

/* The section Material: the keys that the case gives, and the comments of the material. */
void sf_origin_put_material(FILE *page, const char *case_text, const char *parameters);

/* A row with the value of a key, without the brackets of the case's syntax; none if the key is absent. */
void sf_origin_put_key(sf_html_table *table, const char *parameters, const char *name, const char *title);

#endif
