/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/html.h"

#include "io/plain_file.h"
#include "base/text.h"
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char style[] =
    "@page{size:A4;margin:8mm 12mm 6mm 12mm}"
    "*{box-sizing:border-box}"
    "html{background:#e9ecef}"
    "body{margin:0;color:#1b2430;font:7.8pt/1.32 'Helvetica Neue',Arial,'Liberation Sans','DejaVu Sans',sans-serif;"
    "-webkit-print-color-adjust:exact;print-color-adjust:exact}"
    "main{width:210mm;max-width:100%;margin:8mm auto;padding:11mm 12mm;background:#fff;"
    "box-shadow:0 1px 6px rgba(0,0,0,.18)}"
    "h1{font-size:16pt;line-height:1.15;font-weight:600;margin:0 0 .8mm;letter-spacing:-.01em}"
    ".subtitle{margin:0 0 2mm;color:#5a6675}"
    "h2{font-size:9.6pt;line-height:1.2;font-weight:600;margin:2mm 0 .8mm;padding-bottom:.4mm;"
    "border-bottom:.35mm solid #1f4e79;color:#1f4e79;break-after:avoid}"
    "p{margin:0 0 1.2mm}.note{color:#5a6675;font-size:7pt}"
    "pre{margin:0 0 1.2mm;padding:1.2mm 2mm;background:#f3f5f7;font:6.6pt/1.35 'DejaVu Sans Mono',"
    "'Liberation Mono',Consolas,monospace;white-space:pre-wrap;overflow-wrap:anywhere}"
    "pre.prose{font-family:inherit;font-size:6.5pt;line-height:1.24}"
    ".banner{display:flex;gap:3mm;align-items:center;padding:1.4mm 3mm;margin:0 0 2mm;border-left:1.6mm solid;"
    "break-inside:avoid}"
    ".banner b{font-size:11.5pt;white-space:nowrap}"
    ".good{background:#e8f4ea;border-color:#2e7d32}.good b{color:#1b5e20}"
    ".fair{background:#fff6e0;border-color:#e09a00}.fair b{color:#8a5a00}"
    ".bad{background:#fdeaea;border-color:#c62828}.bad b{color:#a31515}"
    ".plain{background:#eef3f8;border-color:#1f4e79}.plain b{color:#1f4e79}"
    ".tiles{display:flex;gap:2.5mm;margin:0 0 1mm;break-inside:avoid}"
    ".tile{flex:1 1 0;padding:1.2mm 2.4mm;border-top:.8mm solid}"
    ".tile.good{border-color:#2e7d32}.tile.bad{border-color:#c62828}.tile.plain{border-color:#1f4e79}"
    ".tile span{display:block;font-size:7.2pt;color:#5a6675}"
    ".tile b{display:block;font-size:13.5pt;line-height:1.15;font-weight:600;white-space:nowrap}"
    ".columns{display:flex;gap:5mm;align-items:flex-start}.columns>*{flex:1 1 0;min-width:0}"
    ".columns.narrow>:first-child{flex:0 0 30%}.columns.wide>:first-child{flex:0 0 62%}"
    ".block{break-inside:avoid}"
    "table{border-collapse:collapse;width:100%;margin:0 0 1.6mm;font-variant-numeric:tabular-nums}"
    "th,td{padding:.45mm 1.2mm;text-align:left;vertical-align:top;border-bottom:.2mm solid #dfe4ea;"
    "overflow-wrap:anywhere}"
    "th:first-child,td:first-child{padding-left:0}th:last-child,td:last-child{padding-right:0}"
    "thead th{font-weight:600;color:#40505f;border-bottom:.3mm solid #8797a8;vertical-align:bottom;"
    "overflow-wrap:normal}"
    "tbody th{font-weight:400;color:#5a6675;width:30%;white-space:nowrap;overflow-wrap:normal}"
    "tr{break-inside:avoid}.r{text-align:right;overflow-wrap:normal}td.r{white-space:nowrap}tbody td:first-child{min-width:18mm}"
    ".dense{font-size:6.5pt;line-height:1.2}.dense th,.dense td{padding-top:.15mm;padding-bottom:.15mm}"
    "figure{margin:0 0 1mm;break-inside:avoid}figure svg{display:block;width:100%;height:auto}"
    "figure svg text,figure svg g{font-family:inherit}"
    "figcaption{font-size:7pt;line-height:1.25;color:#5a6675;margin-top:.4mm}"
    "figure.missing{padding:2mm 3mm;background:#fff6e0}"
    "footer{margin-top:1.2mm;padding-top:.5mm;border-top:.2mm solid #8797a8;font-size:6.8pt;color:#5a6675}"
    "@media print{html{background:#fff}main{width:auto;margin:0;padding:0;box-shadow:none;zoom:.87}"
    "figure svg{max-height:50mm}}";

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
    char *text = NULL;
    if (vasprintf(&text, format, arguments) < 0)
        return;
    sf_html_text(page, text);
    free(text);
}

#define PUT_ARGUMENTS(page, last)                                                                            \
    do {                                                                                                     \
        va_list arguments;                                                                                   \
        va_start(arguments, last);                                                                           \
        put_arguments(page, last, arguments);                                                                \
        va_end(arguments);                                                                                   \
    } while (0)

void sf_html_format(FILE *page, const char *format, ...) {
    PUT_ARGUMENTS(page, format);
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
    sf_html_text(page, title);
    fprintf(page, "</title>\n<style>%s</style>\n</head>\n<body><main>\n<h1>", style);
    sf_html_text(page, title);
    fputs("</h1>\n", page);
    if (subtitle) {
        fputs("<p class=\"subtitle\">", page);
        sf_html_text(page, subtitle);
        fputs("</p>\n", page);
    }
    return page;
}

sf_status sf_html_end(FILE *page, const char *foot, sf_error *err) {
    fputs("<footer>", page);
    sf_html_text(page, foot);
    fputs("</footer>\n</main></body>\n</html>\n", page);
    return sf_staging_close(page, "report.html", err);
}

void sf_html_heading(FILE *page, const char *text) {
    fputs("<h2>", page);
    sf_html_text(page, text);
    fputs("</h2>\n", page);
}

void sf_html_paragraph(FILE *page, const char *format, ...) {
    fputs("<p>", page);
    PUT_ARGUMENTS(page, format);
    fputs("</p>\n", page);
}

void sf_html_note(FILE *page, const char *format, ...) {
    fputs("<p class=\"note\">", page);
    PUT_ARGUMENTS(page, format);
    fputs("</p>\n", page);
}

void sf_html_pre(FILE *page, const char *text) {
    fputs("<pre>", page);
    sf_html_text(page, text);
    fputs("</pre>\n", page);
}

void sf_html_prose(FILE *page, const char *text) {
    fputs("<pre class=\"prose\">", page);
    sf_html_text(page, text);
    fputs("</pre>\n", page);
}

void sf_html_banner(FILE *page, const char *kind, const char *phrase, const char *format, ...) {
    fprintf(page, "<div class=\"banner %s\"><b>", kind);
    sf_html_text(page, phrase);
    fputs("</b><span>", page);
    PUT_ARGUMENTS(page, format);
    fputs("</span></div>\n", page);
}

void sf_html_tiles_begin(FILE *page) {
    fputs("<div class=\"tiles\">\n", page);
}

void sf_html_tile(FILE *page, const char *kind, const char *title, const char *value, const char *remark) {
    fprintf(page, "<div class=\"tile %s\"><span>", kind);
    sf_html_text(page, title);
    fputs("</span><b>", page);
    sf_html_text(page, value);
    fputs("</b><span>", page);
    sf_html_text(page, remark);
    fputs("</span></div>\n", page);
}

void sf_html_tiles_end(FILE *page) {
    fputs("</div>\n", page);
}

void sf_html_columns_begin(FILE *page, const char *kind) {
    fprintf(page, "<div class=\"columns %s\">\n", kind);
}

void sf_html_columns_end(FILE *page) {
    fputs("</div>\n", page);
}

void sf_html_block_begin(FILE *page) {
    fputs("<div class=\"block\">\n", page);
}

void sf_html_block_end(FILE *page) {
    fputs("</div>\n", page);
}

void sf_html_figure(FILE *page, const char *svg, const char *format, ...) {
    fprintf(page, "<figure%s>\n%s<figcaption>", svg ? "" : " class=\"missing\"", svg ? svg : "");
    PUT_ARGUMENTS(page, format);
    fputs("</figcaption></figure>\n", page);
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

/* Four bytes of a PNG's header, which begins with signature, length and name of its first part. */
static unsigned png_number(const unsigned char *at) {
    return (unsigned)at[0] << 24 | (unsigned)at[1] << 16 | (unsigned)at[2] << 8 | (unsigned)at[3];
}

static char *png_element(const unsigned char *data, size_t size) {
    enum { WIDTH = 16, HEIGHT = 20, HEADER = 24 };
    char *element = NULL;
    size_t length = 0;
    FILE *out = size > HEADER ? open_memstream(&element, &length) : NULL;
    if (!out)
        return NULL;
    unsigned width = png_number(data + WIDTH), height = png_number(data + HEIGHT);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %u %u\"><image width=\"%u\" "
            "height=\"%u\" href=\"data:image/png;base64,",
            width, height, width, height);
    sf_html_base64(out, data, size);
    fputs("\"/></svg>\n", out);
    if (fclose(out) == 0)
        return element;
    free(element);
    return NULL;
}

char *sf_html_png(const sf_staging *output, const char *name) {
    sf_error ignored = SF_ERROR_INIT;
    char *data = NULL, *element = NULL, *path = sf_staging_path(output, name, &ignored);
    size_t size = 0;
    if (path && sf_staging_has(output, name) &&
        sf_plain_read(path, NULL, SF_PLAIN_TEXT, &data, &size, &ignored) == SF_OK)
        element = png_element((const unsigned char *)data, size);
    free(data);
    free(path);
    return element;
}

sf_html_table sf_html_table_begin(FILE *page, const char *kind, const char *columns) {
    sf_html_table table = {.page = page};
    fprintf(page, *kind ? "<table class=\"%s\">" : "<table>", kind);
    if (columns)
        fputs("<thead><tr>", page);
    for (int k = 0; columns; k++) {
        char text[128];
        bool right = *columns == '>';
        columns += right;
        size_t length = strcspn(columns, "|");
        snprintf(text, sizeof text, "%.*s", (int)length, columns);
        table.right |= (unsigned)right << k;
        fputs(right ? "<th class=\"r\">" : "<th>", page);
        sf_html_text(page, text);
        fputs("</th>", page);
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

void sf_html_hint(sf_html_table *table, const char *text) {
    table->hint = text;
}

static void begin_cell(sf_html_table *table) {
    fputs(table->right >> table->column & 1 ? "<td class=\"r\"" : "<td", table->page);
    if (table->hint) {
        fputs(" title=\"", table->page);
        sf_html_text(table->page, table->hint);
        fputc('"', table->page);
    }
    fputc('>', table->page);
    table->hint = NULL;
    table->column++;
}

void sf_html_cell(sf_html_table *table, const char *format, ...) {
    begin_cell(table);
    PUT_ARGUMENTS(table->page, format);
    fputs("</td>", table->page);
}

void sf_html_number(sf_html_table *table, int digits, double value) {
    if (isfinite(value))
        sf_html_cell(table, "%.*f", digits, value);
    else
        sf_html_cell(table, "–");
}

void sf_html_line(sf_html_table *table, const char *first, const char *format, ...) {
    char text[1024], *rest = text, *cell;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
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
    fputs("<th>", table->page);
    sf_html_text(table->page, title);
    fputs("</th>", table->page);
    begin_cell(table);
    PUT_ARGUMENTS(table->page, format);
    fputs("</td>", table->page);
}

void sf_html_table_end(sf_html_table *table) {
    if (table->column == 0)
        fputs("<td></td>", table->page);
    fputs("</tr>\n</tbody></table>\n", table->page);
}
