/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/provenance.h"

#include "build_info.h"
#include "io/h5_data.h"
#include <string.h>
#include <time.h>

sf_status sf_provenance_mark(sf_h5 *file, const char *format, sf_error *err) {
    SF_TRY(sf_h5_set_attribute(file, "format", format, err));
    return sf_h5_set_attribute_i64(file, "format_version", SF_FORMAT_VERSION, err);
}

sf_status sf_provenance_write(sf_h5 *file, const char *format, const sf_provenance *p, sf_error *err) {
    char created[32];
    time_t now = time(NULL);
    struct tm utc;
    gmtime_r(&now, &utc);
    strftime(created, sizeof created, "%Y-%m-%dT%H:%M:%SZ", &utc);
    const struct {
        const char *path, *text, *description;
    } item[] = {
        {"/provenance/program", p->program, "program that wrote this file"},
        {"/provenance/version", SF_VERSION, "its version"},
        {"/provenance/git_revision", SF_GIT_REVISION, "its source revision"},
        {"/provenance/compiler", SF_COMPILER, "compiler"},
        {"/provenance/compiler_flags", SF_COMPILER_FLAGS, "compiler flags"},
        {"/provenance/libraries", p->libraries, "library versions"},
        {"/provenance/command_line", p->command_line, "command"},
        {"/provenance/created", created, "time of writing, UTC"},
        {"/provenance/case_text", p->case_text, "case file as used"},
        {"/provenance/parameters", p->parameters, "every parameter as used"},
        {"/provenance/mesh_hash", p->mesh_hash, "FNV-1a of positions and cells"},
        {"/provenance/report", p->report, "report of softfall-pre: key, name and value of each line"},
        {"/provenance/geometry_files", p->geometry_files,
         "files that the geometry read, with the FNV-1a of their contents"},
        {"/provenance/model_path", p->model_path, "model file that was solved"},
        {"/provenance/model_hash", p->model_hash, "hash of all its fields"},
    };
    for (size_t k = 0; k < sizeof item / sizeof item[0]; k++) {
        sf_h5_info info = {item[k].path, "1", item[k].description};
        if (item[k].text && sf_h5_write_text(file, &info, item[k].text, err) != SF_OK)
            return err->status;
    }
    return sf_provenance_mark(file, format, err);
}

sf_status sf_provenance_check(const sf_h5 *file, const char *path, const char *format, sf_error *err) {
    char found[64];
    int64_t version = 0;
    if (sf_h5_get_attribute(file, "/", "format", found, sizeof found, SF_IGNORED) != SF_OK)
        return SF_FAIL(err, SF_ERR_IO, "%s is an HDF5 file, but not a %s file", path, format);
    if (strcmp(found, format) != 0)
        return SF_FAIL(err, SF_ERR_IO, "%s is a %s file, expected a %s file", path, found, format);
    SF_TRY(sf_h5_get_attribute_i64(file, "/", "format_version", &version, err));
    int oldest = strcmp(format, "softfall-model") == 0 ? SF_FORMAT_VERSION : 6;
    if (version > SF_FORMAT_VERSION || version < oldest)
        return SF_FAIL(err, SF_ERR_IO,
                       "%s has format version %lld; this program reads version %d: make an older file anew",
                       path, (long long)version, SF_FORMAT_VERSION);
    return SF_OK;
}

sf_status sf_provenance_copy(const sf_h5 *from, sf_h5 *to, sf_error *err) {
    int64_t count = sf_h5_group_size(from, "/provenance");
    for (int64_t k = 0; k < count; k++) {
        char name[128], source[160], target[176];
        SF_OWNED char *text = NULL;
        SF_TRY(sf_h5_group_member(from, "/provenance", k, name, sizeof name, err));
        snprintf(source, sizeof source, "/provenance/%s", name);
        snprintf(target, sizeof target, "/provenance/model/%s", name);
        SF_TRY(sf_h5_read_text(from, source, &text, err));
        SF_TRY(sf_h5_write_text(to, &(sf_h5_info){target, "1", "of the model"}, text, err));
    }
    return SF_OK;
}

/* Writes a word between single quotes, those within it as a shell reads them. */
static void put_quoted(FILE *stream, const char *word) {
    fputc('\'', stream);
    for (; *word; word++)
        fputs(*word == '\'' ? "'\\''" : (char[]){*word, '\0'}, stream);
    fputc('\'', stream);
}

char *sf_command_line(int argc, char *const *argv) {
    SF_TEXT_STREAM(stream, text, size);
    if (!stream)
        return NULL;
    for (int k = 0; k < argc; k++) {
        const char *word = k == 0 && strrchr(argv[0], '/') ? strrchr(argv[0], '/') + 1 : argv[k];
        bool quote = *word == '\0' || strpbrk(word, " \t\"'\\$`*?[]{}()<>|&;#") != NULL;
        fputs(k ? " " : "", stream);
        if (quote)
            put_quoted(stream, word);
        else
            fputs(word, stream);
    }
    fclose(stream);
    return text;
}
