/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit drop|compression: the foam from tests. */
#include "build_info.h"
#include "fit/drop_command.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>

static const char usage[] = "usage: softfall-fit drop FIT.cfg -o DIR\n"
                            "       softfall-fit drop --help\n";

int main(int argc, char **argv) {
    argp_program_version = "softfall-fit " SF_VERSION " (" SF_GIT_REVISION ")";
    if (argc > 1 && strcmp(argv[1], "drop") == 0)
        return sf_fit_drop_main(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "--version") == 0)
        return puts(argp_program_version) < 0;
    if (argc > 1 && strcmp(argv[1], "--help") == 0)
        return fputs(usage, stdout) < 0;
    fputs(usage, stderr);
    return 2;
}
