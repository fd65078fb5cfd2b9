/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/program.h"
#include "case/read.h"
#include "study/fit/drop/drop_fit.h"

#include "io/plain_file.h"
#include "material/low_density_foam.h"

/* ---- drops ---- */

static sf_status read_drops(const sf_config *config, sf_config_item *root, const char *name, bool predicted,
                            sf_fit_input *in, sf_error *err) {
    sf_config_item *list;
    bool required = !predicted && in->joint.rows == 0;
    SF_TRY(sf_config_list(config, root, name, required, SF_FIT_MAX_DROPS - in->drop_count, &list, err));
    for (int k = 0; list && k < config_setting_length(list); k++) {
        sf_config_item *group = config_setting_get_elem(list, (unsigned)k);
        int count = in->drop_count++; /* it is released with the input, read or not */
        SF_TRY(sf_drop_input_read(config, group, predicted, count, in->drop, err));
    }
    return SF_OK;
}

/* Reads the keys that the first iterations change: those of the discretisation. */
static sf_status read_coarse(const sf_config *config, sf_config_item *root, sf_fit_input *in, sf_error *err) {
    static const char *const groups[] = {"geometry.", "pad.", "solver."};
    sf_config_item *list = config_setting_get_member(root, "coarse_set");
    SF_TRY(sf_config_overrides(config, "coarse_set", SF_RUNNER_OVERRIDES - 1, in->coarse, &in->coarse_count,
                               err));
    if (in->coarse_count > 0 && in->drop_count == 0)
        return sf_config_refuse(config, list, err, "coarse_set is given, but no measured drop to simulate");
    for (int k = 0; k < in->coarse_count; k++) {
        bool allowed = false;
        for (size_t g = 0; g < sizeof groups / sizeof *groups; g++)
            allowed = allowed || strncmp(in->coarse[k], groups[g], strlen(groups[g])) == 0;
        if (!allowed)
            return sf_config_refuse(
                config, config_setting_get_elem(list, (unsigned)k), err,
                "coarse_set: \"%.80s\" is not a key of geometry, pad or solver: the first "
                "iterations have a coarser mesh, and nothing else",
                in->coarse[k]);
    }
    return SF_OK;
}

/* Reads what the accelerometer's mount and a high pass do to every record. */
static sf_status read_chain(const sf_config *config, sf_config_item *root, sf_fit_input *in, sf_error *err) {
    static const char *const sd[SF_SIGNAL_CHAIN] = {"mount_frequency_sd", "mount_damping_sd", "coupling_sd"};
    const char *mount = NULL, *coupling = NULL;
    SF_TRY(sf_config_text(config, root, "mount", false, &mount, err));
    SF_TRY(sf_config_text(config, root, "coupling", false, &coupling, err));
    if (mount)
        SF_TRY(sf_signal_parse_mount(mount, &in->chain, err));
    if (coupling)
        SF_TRY(sf_signal_parse_coupling(coupling, &in->chain, err));
    for (int k = 0; k < SF_SIGNAL_CHAIN; k++) {
        SF_TRY(sf_config_number(config, root, sd[k], false, 0, 0.5, &in->chain_sd[k], err));
        if (in->chain_sd[k] > 0 && !(k < 2 ? mount : coupling))
            return sf_config_refuse(config, config_setting_get_member(root, sd[k]), err,
                                    "%s is given without %s", sd[k], k < 2 ? "mount" : "coupling");
    }
    return SF_OK;
}

/* ---- material and parameters ---- */

/* The group that describes the model: an entry of `forms`, or the whole file. */
static sf_config_item *model_of(sf_config_item *root, const sf_fit_input *in) {
    sf_config_item *list = config_setting_get_member(root, "forms");
    return list ? config_setting_get_elem(list, (unsigned)in->model) : root;
}

/* The key of the form. */
static const char *curve_key(sf_config_item *root, sf_config_item *model) {
    return model == root ? "curve_form" : "curve";
}

/* Only this law's parameters are identified; the first case gives the input its card with its curves. */
static sf_status take_material(sf_material *material, bool first, sf_fit_input *in, sf_error *err) {
    if (material->law != &sf_low_density_foam)
        return SF_REFUSE(err, "%s is of the law %s; the parameters that drops identify are those of %s",
                         in->material_path, material->law->name, sf_low_density_foam.name);
    if (first) {
        in->form.base = *sf_foam_card_of(material);
        sf_foam_card_of(material)->curves = (sf_law_curves){0};
    }
    return SF_OK;
}

/* Which drop of the case's series it is. The columns of a later one are those of the drops before it, and
 * have their speed. */
static sf_status take_series(const sf_case *c, sf_fit_drop *drop, sf_error *err) {
    const char *wrong = drop->number > 0 && c->drops == 1 ? "the case has no series: leave out its key drop"
                        : drop->number > c->drops ? "its key drop, the number in the series, is larger"
                        : c->drops > 1 && drop->number == 0
                            ? "say which of them it is by its number, such as drop = 2"
                        : c->drops > 1 && sf_foam_memory(&c->material)->set > 0
                            ? "the columns know no permanent set: leave out memory.set"
                        : c->drops > 1 && drop->speed_sd > 0 ? "speed_sd is for single drops only"
                                                             : NULL;
    for (int k = 0; k < drop->number && !wrong; k++) {
        if (k > 0)
            drop->pause[k - 1] = c->drop[k].interval;
        if (c->drop[k].own)
            wrong = "softfall-fit drop takes a series whose drops have one missile, speed and place";
    }
    if (wrong)
        return SF_REFUSE(err, "the drop \"%s\": %s: series.drops = %g: %s", drop->name, drop->case_path,
                         c->drops, wrong);
    drop->number = c->drops > 1 ? drop->number : 0;
    return SF_OK;
}

static sf_status read_case(sf_fit_drop *drop, const char *material, bool first, sf_fit_input *in,
                           sf_error *err) {
    const sf_sink sink = sf_program_sink("softfall-fit");
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    SF_TRY(sf_case_read(drop->case_path, 1, &material, &sink, &c, err));
    SF_TRY(take_series(&c, drop, err));
    drop->speed = c.missile_card.speed;
    if (c.temperature_acts)
        return SF_REFUSE(err,
                         "the drop \"%s\": %s: softfall-fit drop fits a foam at one temperature: give its "
                         "material the curve of that temperature as `curve`, and leave out pad.temperature",
                         drop->name, drop->case_path);
    return take_material(&c.material, first, in, err);
}

/* Checks the coarse drop as the runner will make it: the material, then the keys. */
static sf_status check_coarse(sf_fit_drop *drop, const char *material, const sf_fit_input *in,
                              sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    const char *overrides[1 + SF_RUNNER_OVERRIDES] = {material};
    memcpy(&overrides[1], in->coarse, sizeof in->coarse);
    if (sf_case_read(drop->case_path, 1 + in->coarse_count, overrides, NULL, &c, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "coarse_set: %.800s", inner.text);
    return take_series(&c, drop, err);
}

/* The start material, read as the first drop's case would. */
static sf_status read_material(const sf_config *config, sf_config_item *root, sf_fit_input *in,
                               sf_error *err) {
    const char *form = "gas", *name = "material", *title = "Identified foam";
    sf_config_item *model = model_of(root, in);
    SF_TRY(sf_config_text(config, model, curve_key(root, model), model != root, &form, err));
    SF_TRY(sf_config_text(config, root, "name", false, &name, err));
    SF_TRY(sf_config_text(config, root, "title", false, &title, err));
    SF_TRY(sf_config_file(config, root, "material", true, &in->material_path, err));
    in->form.curve = sf_curve_form_find(form);
    if (!in->form.curve)
        return sf_config_refuse(config, config_setting_get_member(model, curve_key(root, model)), err,
                                "%s is \"%.80s\"; expected one of %s", curve_key(root, model), form,
                                sf_curve_form_words());
    if (strpbrk(name, "/\"'\\\n\r") || strncmp(name, "fit", 3) == 0)
        return sf_config_refuse(
            config, config_setting_get_member(root, "name"), err,
            "the name \"%s\" names files: no slashes or quotes, and not fit..., which other files are called",
            name);
    if (strlen(name) >= sizeof in->material_name || strlen(title) >= sizeof in->title)
        return sf_config_refuse(config, root, err, "name or title is longer than %zu and %zu characters",
                                sizeof in->material_name - 1, sizeof in->title - 1);
    snprintf(in->material_name, sizeof in->material_name, "%s", name);
    snprintf(in->title, sizeof in->title, "%s", title);
    SF_PRINTED(override, 4096, "material=@%s", in->material_path);
    if (in->drop_count == 0) {
        SF_OWNED_BY(sf_material_free) sf_material material = {0};
        SF_TRY(sf_case_read_material(in->material_path, 0, &material, NULL, err));
        SF_TRY(take_material(&material, true, in, err));
    }
    for (int k = 0; k < in->drop_count; k++) { /* every case is checked before the first simulation */
        SF_TRY(read_case(&in->drop[k], override, k == 0, in, err));
        if (in->coarse_count > 0 && !in->drop[k].predicted)
            SF_TRY(check_coarse(&in->drop[k], override, in, err));
    }
    SF_TRY(sf_foam_form_read_solid(config, root, &in->form, err));
    sf_foam_form_start(&in->form, in->start);
    /* of a material without a rate factor the slowest compression test: below it the law has no effect */
    double *reference = &in->start[SF_PARAMETER_RATE_REFERENCE];
    for (int t = 0; t < in->joint.test_count && !(in->form.base.rate_factor > 0); t++)
        *reference = fmin(*reference, in->joint.test[t].rate);
    return SF_OK;
}

/* By the model, or, of a start of all models, by one of them. An unknown form is refused by its model. */
static bool is_used(sf_config_item *root, sf_config_item *holder, const sf_fit_input *in,
                    sf_foam_parameter p) {
    sf_config_item *list = config_setting_get_member(root, "forms");
    bool used = sf_curve_form_uses(in->form.curve, p);
    for (int m = 0; list && holder == root && m < in->model_count; m++) {
        const char *name = NULL;
        config_setting_lookup_string(config_setting_get_elem(list, (unsigned)m), "curve", &name);
        const sf_curve_form *form = name ? sf_curve_form_find(name) : NULL;
        used = used || !form || sf_curve_form_uses(form, p);
    }
    return used;
}

static sf_status check_used(const sf_config *config, sf_config_item *holder, sf_config_item *item,
                            const sf_fit_input *in, sf_foam_parameter p, sf_error *err) {
    sf_config_item *root = config_root_setting(&config->config),
                   *list = config_setting_get_member(root, "forms");
    const char *name = sf_parameter_get(p)->name;
    if (is_used(root, holder, in, p))
        return SF_OK;
    if (list && holder == root)
        return sf_config_refuse(config, item, err, "start: %s is a parameter of none of the forms", name);
    return sf_config_refuse(config, item, err, "start: %s is not a parameter of %s = \"%s\"", name,
                            list ? "curve" : "curve_form", in->form.curve->name);
}

static sf_status read_start(const sf_config *config, sf_config_item *holder, sf_fit_input *in,
                            sf_error *err) {
    sf_config_item *group = config_setting_get_member(holder, "start");
    if (!group)
        return SF_OK;
    if (!config_setting_is_group(group))
        return sf_config_refuse(config, group, err, "start must be a group: start: { p0 = \"101 kPa\"; }");
    for (int k = 0; k < config_setting_length(group); k++) {
        sf_config_item *item = config_setting_get_elem(group, (unsigned)k);
        sf_foam_parameter p = sf_parameter_find(config_setting_name(item));
        if (p == SF_PARAMETER_COUNT)
            return sf_config_refuse(config, item, err, "unknown parameter \"%.80s\" of the foam",
                                    config_setting_name(item));
        SF_TRY(check_used(config, holder, item, in, p, err));
        SF_TRY(sf_parameter_read(config, group, p, &in->start[p], err));
    }
    return SF_OK;
}

/* The start must make a curve. */
static sf_status check_start(const sf_config *config, sf_config_item *root, const sf_fit_input *in,
                             sf_error *err) {
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    sf_error inner = SF_ERROR_INIT;
    sf_config_item *group = config_setting_get_member(root, "start");
    if (sf_foam_form_card(&in->form, in->start, &card, &inner) != SF_OK)
        return sf_config_refuse(config, group ? group : root, err, "start: %s", inner.text);
    return SF_OK;
}

/* ---- rate terms ---- */

/* A parameter of a term that the model's `rate` does not name has no effect. `what`: "start: ED". */
static sf_status check_term(const sf_config *config, sf_config_item *item, sf_config_item *model,
                            sf_foam_parameter p, const char *what, sf_error *err) {
    int rate = -1, term = (int)sf_form_rate_of(p);
    if (sf_config_choice(config, model, "rate", SF_FORM_RATE_WORDS, &rate, err) != SF_OK || rate < 0 ||
        (rate & term) == term)
        return err->status;
    return sf_config_refuse(
        config, item, err, "%s is of the %s, which a model with rate = \"%s\" does not have", what,
        term == SF_FORM_RATE_FACTOR ? "rate factor" : "Maxwell branch", sf_form_rate_names[rate]);
}

/* The start values of the model alone; those of all models may be for other models. */
static sf_status check_terms(const sf_config *config, sf_config_item *model, sf_error *err) {
    sf_config_item *group = config_setting_get_member(model, "start");
    for (int k = 0; group && k < config_setting_length(group); k++) {
        sf_config_item *item = config_setting_get_elem(group, (unsigned)k);
        SF_PRINTED(what, 64, "start: %s", config_setting_name(item));
        SF_TRY(check_term(config, item, model, sf_parameter_find(config_setting_name(item)), what, err));
    }
    return SF_OK;
}

/* ---- unknowns ---- */

/* One more unknown, with its usual prior; SF_ERR_INPUT names `where` if there are too many. */
static sf_status put_unknown(const sf_config *config, sf_config_item *where, sf_fit_input *in,
                             sf_foam_parameter p, sf_error *err) {
    int k = in->unknown_count;
    if (k == SF_FIT_MAX_UNKNOWNS)
        return sf_config_refuse(config, where, err, "%s would be unknown number %d" SF_AT_MOST("%d"),
                                sf_parameter_get(p)->name, k + 1, SF_FIT_MAX_UNKNOWNS);
    const sf_parameter_info *about = sf_parameter_get(p);
    if (!(in->start[p] >= about->low && in->start[p] <= about->high))
        return sf_config_refuse(config, where, err,
                                "%s is unknown, and starts at %g%s%s; it can be sought from %g to %g",
                                about->name, in->start[p] / about->per_unit, *about->unit ? " " : "",
                                about->unit, about->low / about->per_unit, about->high / about->per_unit);
    in->unknown[k] = p;
    in->prior[k] = in->start[p];
    in->prior_sd[k] = sf_foam_form_prior_sd(&in->form, p);
    in->unknown_count++;
    return SF_OK;
}

static sf_status read_unknown(const sf_config *config, sf_config_item *entry, sf_fit_input *in,
                              sf_error *err) {
    const char *name = NULL;
    SF_TRY(sf_config_names(config, entry, "name|prior_sd", err));
    SF_TRY(sf_config_text(config, entry, "name", true, &name, err));
    sf_foam_parameter p = sf_parameter_find(name);
    if (p == SF_PARAMETER_COUNT)
        return sf_config_refuse(config, entry, err, "unknown parameter \"%.80s\" of the foam", name);
    if (!sf_curve_form_uses(in->form.curve, p))
        return sf_config_refuse(config, entry, err, "%s is not a parameter of curve_form = \"%s\"", name,
                                in->form.curve->name);
    for (int k = 0; k < in->unknown_count; k++)
        if (in->unknown[k] == p)
            return sf_config_refuse(config, entry, err, "unknown: %s is given twice", name);
    SF_TRY(check_term(config, entry, model_of(config_root_setting(&config->config), in), p, name, err));
    if (p == SF_PARAMETER_RATE_FACTOR)
        sf_foam_form_start_rate(in->start);
    if (p == SF_PARAMETER_LOCKED)
        sf_foam_form_start_lock(in->start);
    if (!(in->start[p] > 0))
        return sf_config_refuse(config, entry, err,
                                "%s is 0 in the start material: give a start value, start: { %s = ...; }",
                                name, name);
    SF_TRY(put_unknown(config, entry, in, p, err));
    return sf_config_number(config, entry, "prior_sd", false, 1e-3, 10, &in->prior_sd[in->unknown_count - 1],
                            err);
}

static sf_status read_list(const sf_config *config, sf_config_item *holder, sf_fit_input *in, bool *given,
                           sf_error *err) {
    sf_config_item *list;
    SF_TRY(sf_config_list(config, holder, "unknown", false, SF_FIT_MAX_UNKNOWNS, &list, err));
    *given = list;
    for (int k = 0; list && k < config_setting_length(list) && err->status == SF_OK; k++)
        read_unknown(config, config_setting_get_elem(list, (unsigned)k), in, err);
    return err->status;
}

static sf_status add_unknown(const sf_config *config, sf_config_item *model, sf_fit_input *in,
                             sf_foam_parameter p, sf_error *err) {
    for (int k = 0; k < in->unknown_count; k++)
        if (in->unknown[k] == p)
            return SF_OK;
    if (!(in->start[p] > 0)) /* a material without the branch */
        return SF_OK;
    return put_unknown(config, model, in, p, err);
}

/* Without a list: those that are usual for the form, and ED. */
static sf_status add_usual(const sf_config *config, sf_config_item *model, sf_fit_input *in, sf_error *err) {
    const sf_curve_form *form = in->form.curve;
    for (int k = 0; k < form->entry_count; k++)
        if (form->entry[k].usual)
            SF_TRY(add_unknown(config, model, in, form->entry[k].parameter, err));
    return add_unknown(config, model, in, SF_PARAMETER_ED, err);
}

/* The rate terms of an entry of `forms`: those that it names are unknown, the others are not there. */
static sf_status read_rate(const sf_config *config, sf_config_item *model, sf_fit_input *in, sf_error *err) {
    int rate = -1;
    if (sf_config_choice(config, model, "rate", SF_FORM_RATE_WORDS, &rate, err) != SF_OK || rate < 0 ||
        check_terms(config, model, err) != SF_OK)
        return err->status;
    if (rate & SF_FORM_RATE_MAXWELL && !(in->start[SF_PARAMETER_ED] > 0 && in->start[SF_PARAMETER_BETA1] > 0))
        return sf_config_refuse(config, model, err,
                                "a Maxwell branch needs ED and BETA1 in the start material or in start");
    if (rate & SF_FORM_RATE_FACTOR)
        sf_foam_form_start_rate(in->start);
    else
        in->start[SF_PARAMETER_RATE_FACTOR] = 0;
    if (!(rate & SF_FORM_RATE_MAXWELL))
        in->start[SF_PARAMETER_ED] = 0;
    return SF_OK;
}

/* The law refuses it too, but only when the material is simulated. */
static sf_status check_rate_factor(const sf_config *config, sf_config_item *model, const sf_fit_input *in,
                                   sf_error *err) {
    if (in->start[SF_PARAMETER_RATE_FACTOR] > 0 && !in->form.curve->stress && in->form.base.curve_count > 1)
        return sf_config_refuse(config, model, err,
                                "a rate factor cannot act on the form \"table\" of %s, which has %lld "
                                "curves at several rates; a foam has one or the other",
                                in->material_path, (long long)in->form.base.curve_count);
    return SF_OK;
}

/* The simulations refuse it too, but only when they begin. */
static sf_status check_memory(const sf_config *config, sf_config_item *model, const sf_fit_input *in,
                              sf_error *err) {
    bool remembers = in->start[SF_PARAMETER_RELOAD] > 0 || in->start[SF_PARAMETER_RECOVERY] > 0;
    for (int k = 0; k < in->drop_count; k++)
        if (in->drop[k].number > 0 && !remembers)
            return sf_config_refuse(
                config, model, err,
                "the drop \"%s\" is of a series, but the foam of %s remembers nothing: give "
                "it material.memory, or start: { reload = 0.4; }",
                in->drop[k].name, in->material_path);
    if (in->start[SF_PARAMETER_HU] == 1 && remembers)
        return sf_config_refuse(config, model, err,
                                "HU is 1, but a foam without hysteresis has nothing to remember: give it "
                                "HU, SHAPE and ALPHA of the unloading, or leave out reload and recovery");
    if (in->start[SF_PARAMETER_DRIFT] > 0 && !(in->start[SF_PARAMETER_RELOAD] > 0))
        return sf_config_refuse(config, model, err,
                                "drift is the fall of reload from loading to loading: give start: { reload = "
                                "0.4; }, or leave out drift");
    return SF_OK;
}

/* Reads the unknowns of an entry of `forms`: those that the file lists for all models, and its own or
 * those usual for the form, with the rate terms that it names. */
static sf_status read_unknowns(const sf_config *config, sf_config_item *root, sf_fit_input *in,
                               sf_error *err) {
    sf_config_item *model = model_of(root, in);
    bool common = false, own = false;
    if (read_list(config, root, in, &common, err) != SF_OK ||
        (model != root && read_list(config, model, in, &own, err) != SF_OK))
        return err->status;
    if (model == root ? !common : !own)
        SF_TRY(add_usual(config, model, in, err));
    if (config_setting_get_member(model, "rate")) {
        SF_TRY(add_unknown(config, model, in, SF_PARAMETER_ED, err));
        SF_TRY(add_unknown(config, model, in, SF_PARAMETER_RATE_FACTOR, err));
    }
    SF_TRY(check_rate_factor(config, model, in, err));
    SF_TRY(check_memory(config, model, in, err));
    return sf_foam_form_check_fraction(config, root, model, curve_key(root, model), &in->form,
                                       in->unknown_count, in->unknown, err);
}

static sf_status read_options(const sf_config *config, sf_config_item *root, sf_fit_input *in,
                              sf_error *err) {
    double seed = 1;
    sf_config_item *list;
    in->posterior = true;
    SF_TRY(sf_config_number(config, root, "seed", false, 0, 1e9, &seed, err));
    SF_TRY(sf_config_flag(config, root, "posterior", &in->posterior, err));
    SF_TRY(sf_config_list(config, root, "forms", false, SF_FIT_MAX_MODELS, &list, err));
    in->seed = (uint64_t)seed;
    in->model_count = list ? config_setting_length(list) : 1;
    if (list && config_setting_get_member(root, "curve_form"))
        return sf_config_refuse(config, list, err, "give either forms or curve_form");
    if (in->model_count > 1 && !in->posterior)
        return sf_config_refuse(config, list, err,
                                "several forms are compared by their posteriors: posterior must be true");
    for (int k = 0; k < in->model_count && list && err->status == SF_OK; k++)
        sf_config_names(config, config_setting_get_elem(list, (unsigned)k), "curve|rate|start|unknown", err);
    return err->status;
}

/* Start values of all models, then the model's own. The curve's medians follow the modulus and the solid
 * fraction, so where these are given the others are read again. */
static sf_status read_starts(const sf_config *config, sf_config_item *root, sf_fit_input *in, sf_error *err) {
    sf_config_item *model = model_of(root, in);
    for (int pass = 0; pass < 2; pass++) {
        if (pass == 1)
            in->form.curve->start(in->start);
        SF_TRY(read_start(config, root, in, err));
        if (model != root)
            SF_TRY(read_start(config, model, in, err));
    }
    if (model != root)
        SF_TRY(read_rate(config, model, in, err));
    return check_start(config, model, in, err);
}

static void put_label(sf_fit_input *in) {
    bool maxwell = in->start[SF_PARAMETER_ED] > 0, factor = in->start[SF_PARAMETER_RATE_FACTOR] > 0;
    for (int k = 0; k < in->unknown_count; k++) {
        maxwell = maxwell || in->unknown[k] == SF_PARAMETER_ED;
        factor = factor || in->unknown[k] == SF_PARAMETER_RATE_FACTOR;
    }
    snprintf(in->label, sizeof in->label, "%s%s%s", in->form.curve->name, factor ? ", rate factor" : "",
             maxwell ? ", Maxwell branch" : "");
}

sf_status sf_fit_input_read(const char *path, int model, sf_fit_input *in, sf_error *err) {
    SF_OWNED_BY(sf_config_close) sf_config config = {0};
    *in = (sf_fit_input){.model = model};
    SF_TRY(sf_config_open(path, &config, err));
    SF_TRY(sf_plain_read(path, NULL, SF_PLAIN_TEXT, &in->text, NULL, err));
    sf_config_item *root = config_root_setting(&config.config);
    SF_TRY(sf_config_names(&config, root,
                           "name|title|material|curve_form|solid_density|start|unknown|drops|predict|forms|"
                           "seed|posterior|compressions|cushions|coarse_set|mount|mount_frequency_sd|"
                           "mount_damping_sd|coupling|coupling_sd",
                           err));
    SF_TRY(read_options(&config, root, in, err));
    SF_TRY(sf_joint_read(&config, root, &in->joint, err));
    SF_TRY(read_drops(&config, root, "drops", false, in, err));
    SF_TRY(read_coarse(&config, root, in, err));
    SF_TRY(read_chain(&config, root, in, err));
    SF_TRY(read_drops(&config, root, "predict", true, in, err));
    SF_TRY(read_material(&config, root, in, err));
    SF_TRY(read_starts(&config, root, in, err));
    SF_TRY(read_unknowns(&config, root, in, err));
    put_label(in);
    return SF_OK;
}

void sf_fit_input_free(sf_fit_input *in) {
    for (int k = 0; k < in->drop_count; k++)
        sf_drop_input_free(&in->drop[k]);
    sf_free_all((size_t)in->coarse_count, in->coarse);
    sf_foam_card_free(&in->form.base);
    SF_CLEAR(in, in->material_path, in->text);
}
