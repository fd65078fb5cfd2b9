/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/geo_text.h"

#include <ctype.h>
#include <string.h>

static const char *skip_blank(const char *p) {
    for (;;) {
        if (isspace((unsigned char)*p)) {
            p++;
        } else if (p[0] == '/' && p[1] == '/') {
            p += strcspn(p, "\n");
        } else if (p[0] == '/' && p[1] == '*') {
            const char *end = strstr(p + 2, "*/");
            p = end ? end + 2 : p + strlen(p);
        } else {
            return p;
        }
    }
}

static bool is_word(char c) {
    return isalnum((unsigned char)c) || c == '_' || c == '.';
}

sf_geo_token sf_geo_next(const char **text) {
    const char *p = skip_blank(*text);
    sf_geo_token t = {SF_GEO_MARK, p, 1};
    if (*p == '\0') {
        t = (sf_geo_token){SF_GEO_END, p, 0};
    } else if (*p == '"' || *p == '\'') {
        size_t length = strcspn(p + 1, *p == '"' ? "\"" : "'");
        *text = p + 1 + length + (p[1 + length] != '\0');
        return (sf_geo_token){SF_GEO_TEXT, p + 1, length};
    } else if (is_word(*p)) {
        t.kind = SF_GEO_WORD;
        while (is_word(p[t.length]))
            t.length++;
    }
    *text = p + t.length;
    return t;
}

bool sf_geo_is(sf_geo_token t, const char *text) {
    return t.length == strlen(text) && strncmp(t.begin, text, t.length) == 0;
}
