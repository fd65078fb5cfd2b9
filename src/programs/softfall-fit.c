/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit WORD ...: material parameters from measurements. The first word names the kind of
 * measurement. */
#include "build_info.h"
#include "base/near.h"
#include "base/program.h"
#include "study/fit/compression/compression_command.h"
static const struct {
    const char *word;
    int (*run)(int argc, char **argv);
    const char *meaning;
} commands[] = {
    {"compression", sf_fit_compression_main, "from compression tests of a foam cube to a material file"},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void print_usage(FILE *file) {
    fputs("Usage: softfall-fit WORD [OPTION...] FIT.cfg -o DIR\n"
          "Material parameters from measurements (docs/identification.md).\n\n",
          file);
    for (int k = 0; k < COMMANDS; k++)
        fprintf(file, "  %-14s %s\n", commands[k].word, commands[k].meaning);
    fputs("\nsoftfall-fit WORD --help lists the options.\n", file);
}

int main(int argc, char **argv) {
    const char *word = argc > 1 ? argv[1] : "";
    sf_error err = SF_ERROR_INIT;
    if (sf_program_begin(argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-fit");
    static const char version[] = "softfall-fit " SF_VERSION " (" SF_GIT_REVISION ")";
    for (int k = 0; k < COMMANDS; k++)
        if (strcmp(word, commands[k].word) == 0)
            return commands[k].run(argc - 1, argv + 1);
    if (strcmp(word, "drop") == 0) {
        fputs("softfall-fit: measured drops are fitted by another program: softfall fit FIT.cfg -o DIR\n", stderr);
        return 2;
    }
    if (strcmp(word, "--help") == 0 || strcmp(word, "-?") == 0) {
        print_usage(stdout);
        return 0;
    }
    if (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0) {
        puts(version);
        return 0;
    }
    char meant[SF_NEAR_HINT];
    sf_near near = sf_near_begin(word);
    for (int k = 0; k < COMMANDS; k++)
        sf_near_offer(&near, commands[k].word, strlen(commands[k].word));
    if (argc > 1)
        fprintf(stderr, "softfall-fit: unknown command '%s'%s\n", word, sf_near_hint(&near, meant));
    print_usage(stderr);
    return 2;
}
