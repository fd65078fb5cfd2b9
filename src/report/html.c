/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/html.h"

#include "base/text.h"
#include "report_style.h"
#include <ctype.h>
#include <math.h>
#include <string.h>

/* The character, or what stands for it in XML. */
static void put_character(FILE *page, const unsigned char *s, int length) {
    if (length == 0 || (*s < 0x20 && !strchr("\t\n\r", *s)) || *s == 0x7f)
        fputs("\xef\xbf\xbd", page);
    else if (*s == '&')
        fputs("&amp;", page);
    else if (*s == '<')
        fputs("&lt;", page);
    else if (*s == '>')
        fputs("&gt;", page);
    else if (*s == '"')
        fputs("&quot;", page);
    else
        fwrite(s, 1, (size_t)length, page);
}

void sf_html_text(FILE *page, const char *text) {
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        int length = sf_utf8_length(s);
        put_character(page, s, length);
        s += length > 0 ? length : 1;
    }
}

/* Texts are of any length: pieces of the case stand in them. */
static void put_arguments(FILE *page, const char *format, va_list arguments) {
    SF_OWNED char *text = NULL;
    if (vasprintf(&text, format, arguments) < 0)
        return;
    sf_html_text(page, text);
}

/* Writes the arguments between the opening and the closing tag of an element. */
#define PUT_ARGUMENTS(page, open, last, close)                                                               \
    do {                                                                                                     \
        va_list arguments;                                                                                   \
        va_start(arguments, last);                                                                           \
        fputs(open, page);                                                                                   \
        put_arguments(page, last, arguments);                                                                \
        fputs(close, page);                                                                                  \
        va_end(arguments);                                                                                   \
    } while (0)

/* The escaped text between what opens and what closes an element. */
static void put_between(FILE *page, const char *open, const char *text, const char *close) {
    fputs(open, page);
    sf_html_text(page, text);
    fputs(close, page);
}

FILE *sf_html_begin(const sf_staging *output, const char *title, const char *subtitle, sf_error *err) {
    FILE *page = sf_staging_open(output, "report.html", err);
    if (!page)
        return NULL;
    fputs(
        "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n"
        "<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
        "<title>",
        page);
    put_between(page, "", title, "</title>\n<style>" SF_REPORT_STYLE "</style>\n</head>\n<body><main>\n<h1>");
    put_between(page, "", title, "</h1>\n");
    if (subtitle)
        put_between(page, "<p class=\"subtitle\">", subtitle, "</p>\n");
    return page;
}

sf_status sf_html_end(FILE *page, const char *command, const char *foot, sf_error *err) {
    if (command) {
        sf_html_heading(page, "The command that repeats this report");
        sf_html_pre(page, command);
    }
    put_between(page, "<footer>", foot, "</footer>\n</main></body>\n</html>\n");
    return sf_staging_close(page, "report.html", err);
}

void sf_html_heading(FILE *page, const char *text) {
    put_between(page, "<h2>", text, "</h2>\n");
}

void sf_html_paragraph(FILE *page, const char *format, ...) {
    PUT_ARGUMENTS(page, "<p>", format, "</p>\n");
}

void sf_html_note(FILE *page, const char *format, ...) {
    PUT_ARGUMENTS(page, "<p class=\"note\">", format, "</p>\n");
}

void sf_html_pre(FILE *page, const char *text) {
    put_between(page, "<pre>", text, "</pre>\n");
}

void sf_html_banner(FILE *page, const char *kind, const char *phrase, const char *format, ...) {
    fprintf(page, "<div class=\"banner %s\">", kind);
    put_between(page, "<b>", phrase, "</b><span>");
    PUT_ARGUMENTS(page, "", format, "</span></div>\n");
}

FILE *sf_html_block(FILE *page, const char *heading) {
    fputs("<div class=\"block\">\n", page);
    sf_html_heading(page, heading);
    return page;
}

void sf_html_division_end(FILE **page) {
    fputs("</div>\n", *page);
}

void sf_html_figure(FILE *page, const char *svg, const char *format, ...) {
    fprintf(page, "<figure%s>\n%s<figcaption>", svg ? "" : " class=\"missing\"", svg ? svg : "");
    PUT_ARGUMENTS(page, "", format, "</figcaption></figure>\n");
}

void sf_html_base64(FILE *out, const unsigned char *data, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t k = 0; k < size; k += 3) {
        size_t left = size - k;
        unsigned three = (unsigned)data[k] << 16 | (left > 1 ? (unsigned)data[k + 1] << 8 : 0) |
                         (left > 2 ? (unsigned)data[k + 2] : 0);
        putc_unlocked(digits[three >> 18], out);
        putc_unlocked(digits[three >> 12 & 63], out);
        putc_unlocked(left > 1 ? digits[three >> 6 & 63] : '=', out);
        putc_unlocked(left > 2 ? digits[three & 63] : '=', out);
    }
}

sf_html_table sf_html_table_begin(FILE *page, const char *columns) {
    sf_html_table table = {.page = page};
    fputs("<table class=\"dense\">", page);
    if (columns)
        fputs("<thead><tr>", page);
    for (int k = 0; columns; k++) {
        bool right = *columns == '>';
        columns += right;
        size_t length = strcspn(columns, "|");
        SF_PRINTED(text, 128, "%.*s", (int)length, columns);
        table.right |= (unsigned)right << k;
        put_between(page, right ? "<th class=\"r\">" : "<th>", text, "</th>");
        columns = columns[length] ? columns + length + 1 : NULL;
        if (!columns)
            fputs("</tr></thead>", page);
    }
    fputs("<tbody>\n<tr>", page);
    return table;
}

void sf_html_row(sf_html_table *table) {
    if (table->column > 0)
        fputs("</tr>\n<tr>", table->page);
    table->column = 0;
}

static void begin_cell(sf_html_table *table) {
    fputs(table->right >> table->column & 1 ? "<td class=\"r\">" : "<td>", table->page);
    table->column++;
}

void sf_html_cell(sf_html_table *table, const char *format, ...) {
    begin_cell(table);
    PUT_ARGUMENTS(table->page, "", format, "</td>");
}

void sf_html_line(sf_html_table *table, const char *first, const char *format, ...) {
    char text[1024], *rest = text, *cell;
    SF_PRINT_INTO(text, format);
    if (first) {
        sf_html_row(table);
        sf_html_cell(table, "%s", first);
    }
    while ((cell = strsep(&rest, "|"))) {
        const char *number = cell + strspn(cell, "+-");
        bool finite = (strncmp(number, "nan", 3) != 0 && strncmp(number, "inf", 3) != 0) ||
                      isalpha((unsigned char)number[3]);
        sf_html_cell(table, "%s", finite ? cell : "–");
    }
}

void sf_html_fact(sf_html_table *table, const char *title, const char *format, ...) {
    sf_html_row(table);
    put_between(table->page, "<th>", title, "</th>");
    begin_cell(table);
    PUT_ARGUMENTS(table->page, "", format, "</td>");
}

void sf_html_table_end(sf_html_table *table) {
    if (table->column == 0)
        fputs("<td></td>", table->page);
    fputs("</tr>\n</tbody></table>\n", table->page);
}
