/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drop.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *key;
    size_t offset;
} keys[] = {
#define KEY(name)                                                                                            \
    { "\"" #name "\":", offsetof(sf_drop, name) }
    KEY(a_max_g),
    KEY(a_max_raw_g),
    KEY(hic),
    KEY(hic_t1_ms),
    KEY(hic_t2_ms),
    KEY(v_rebound_m_s),
    KEY(max_indentation_mm),
    KEY(max_local_strain),
    KEY(local_collapse),
    KEY(energy_error),
    KEY(momentum_error),
    KEY(stabilisation_energy_fraction),
    KEY(contact_energy_fraction),
    KEY(constraint_residual_m_s),
    KEY(nodes),
    KEY(steps),
    KEY(wall_s),
#undef KEY
};

static sf_status read_summary(const char *path, sf_drop *out, sf_error *err) {
    char text[65536];
    FILE *file = fopen(path, "r");
    if (!file)
        return SF_FAIL(err, SF_ERR_IO, "%s is missing", path);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
        const char *at = strstr(text, keys[k].key);
        double value = NAN;
        if (at)
            sscanf(at + strlen(keys[k].key), "%lf", &value);
        *(double *)((char *)out + keys[k].offset) = value;
    }
    return SF_OK;
}

static sf_status run(const char *command, sf_error *err) {
    int code = system(command); /* the studies own every part of the command */
    if (code != 0)
        return SF_FAIL(err, SF_ERR_NUMERIC, "code %d from: %s", code, command);
    return SF_OK;
}

sf_status sf_drop_run(const char *example, const char *const *overrides, int threads, const char *keep,
                      sf_drop *out, sf_error *err) {
    const char *bin = getenv("SF_BIN_DIR"), *source = getenv("SF_SOURCE_DIR"), *temporary = getenv("TMPDIR");
    char folder[512], file[1024], command[8192];
    size_t length = strlen(example);
    bool is_file = length > 4 && strcmp(example + length - 4, ".cfg") == 0;
    if (!bin || !source)
        return SF_FAIL(err, SF_ERR_INPUT, "SF_BIN_DIR and SF_SOURCE_DIR must be set");
    snprintf(folder, sizeof folder, "%s/softfall-drop-XXXXXX", temporary && *temporary ? temporary : "/tmp");
    if (!mkdtemp(folder))
        return SF_FAIL(err, SF_ERR_IO, "no temporary folder %s", folder);
    if (is_file)
        snprintf(file, sizeof file, "%s", example);
    else
        snprintf(file, sizeof file, "%s/examples/%s/case.cfg", source, example);
    int used = snprintf(command, sizeof command, "'%s/softfall-pre' '%s' -o '%s/m.h5'", bin, file, folder);
    if (!is_file)
        used += snprintf(command + used, sizeof command - (size_t)used,
                         " --set 'material=@%s/verify/materials/eva_like.cfg'", source);
    for (int k = 0; overrides && overrides[k]; k++)
        used += snprintf(command + used, sizeof command - (size_t)used, " --set '%s'", overrides[k]);
    snprintf(command + used, sizeof command - (size_t)used, " > '%s/log' 2>&1", folder);
    if (run(command, err) == SF_OK) {
        snprintf(command, sizeof command,
                 "'%s/softfall-solve' '%s/m.h5' -o '%s/r.h5' -t %d >> '%s/log' 2>&1 && "
                 "'%s/softfall-post' '%s/r.h5' -o '%s/out' >> '%s/log' 2>&1",
                 bin, folder, folder, threads, folder, bin, folder, folder, folder);
        run(command, err);
    }
    if (err->status == SF_OK) {
        snprintf(file, sizeof file, "%s/out/summary.json", folder);
        read_summary(file, out, err);
    }
    if (err->status == SF_OK && keep) {
        snprintf(command, sizeof command, "mv '%s/r.h5' '%s'", folder, keep);
        run(command, err);
    }
    sf_error ignored = SF_ERROR_INIT;
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    run(command, &ignored);
    return err->status;
}
