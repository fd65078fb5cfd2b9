/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/make.h"

#include "base/mat3.h"
#include "pre/alike.h"
#include "pre/drop_check.h"
#include "pre/mesh/gmsh_session.h"
#include "pre/mesh/refine.h"
#include "pre/mesh/section.h"
#include "pre/support.h"

/* The section of the pad of the open geometry. */
static sf_status read_section(sf_gmsh *session, const sf_case *c, const sf_pad_volumes *volumes,
                              sf_mesh *mesh, sf_error *err) {
    const char *pad = c->pad_group;
    const sf_pad_volumes one = {1, &pad, false, false, true};
    SF_TRY(sf_section_check_case(c, err));
    SF_TRY(sf_gmsh_read_layers(session, c->layer_count > 0 ? volumes : &one, c->length_unit, mesh, err));
    return sf_section_take_pad(c, mesh, err);
}

/* The pad of the open geometry. */
static sf_status read_pad(sf_gmsh *session, const sf_case *c, sf_mesh *mesh, sf_error *err) {
    const char *group[SF_CASE_MAX_LAYERS];
    for (int k = 0; k < c->layer_count; k++)
        group[k] = c->layer[k].name;
    const sf_pad_volumes volumes = {c->layer_count, group, true, c->missile.path != NULL, c->axisymmetric};
    if (c->axisymmetric)
        return read_section(session, c, &volumes, mesh, err);
    const char *pad = c->pad_group;
    const sf_pad_volumes one = {1, &pad, false, volumes.alone, false};
    return sf_gmsh_read_layers(session, c->layer_count > 0 ? &volumes : &one, c->length_unit, mesh, err);
}

static void turn_points(const double turn[9], int64_t count, double *position) {
    for (int64_t i = 0; i < count; i++)
        sf_mat3_apply(turn, &position[3 * i]);
}

/* Turns the pad's face upwards. */
static void turn_up(const double up[3], sf_mesh *mesh, sf_surface *surface) {
    double turn[9];
    if (up[2] == 1)
        return;
    sf_turn_to_z(up, turn);
    turn_points(turn, mesh->node_count, mesh->position);
    turn_points(turn, surface->node_count, surface->position);
    turn_points(turn, surface->hull_node_count, surface->hull_position);
    turn_points(turn, 1, surface->origin);
    for (int k = 0; k < mesh->support_count; k++)
        turn_points(turn, mesh->support[k].node_count, mesh->support[k].position);
}

/* Reads the surfaces of the supports; the mesh borrows them. */
static sf_status read_supports(sf_gmsh *session, const sf_case *c, sf_mesh *mesh,
                               sf_surface support[SF_SUPPORTS], sf_error *err) {
    mesh->support = support;
    for (int k = 0; k < c->support_count && err->status == SF_OK; k++) {
        const sf_case_support *s = &c->support[k];
        mesh->support_count++;
        if (!s->source.path)
            sf_support_plane(s, mesh, &support[k], err);
        else if (sf_gmsh_load(session, &s->source, err) == SF_OK)
            sf_gmsh_read_surface(session, s->group, s->source.unit, &support[k], err);
    }
    return err->status;
}

/* Pad mesh, missile surface and the supports' surfaces, each from a geometry of its own; that of the missile
 * may be the pad's. */
static sf_status read_geometry(sf_case *c, sf_mesh *mesh, sf_surface *surface,
                               sf_surface support[SF_SUPPORTS], char libraries[SF_LIBRARIES_SIZE],
                               const sf_sink *sink, sf_error *err) {
    SF_OWNED_BY(sf_gmsh_end) sf_gmsh *session = NULL;
    if (sf_gmsh_begin(&session, err) == SF_OK) {
        session->store = c->store;
        session->limits = (sf_mesher_limits){.seconds = c->mesh_time_limit, .sink = sink};
        if (c->missile.path || c->support_count > 0)
            session->limits.spare = &session->spare;
    }
    if (session && sf_gmsh_load(session, &c->pad, err) == SF_OK && read_pad(session, c, mesh, err) == SF_OK &&
        (!c->missile.path || sf_gmsh_load(session, &c->missile, err) == SF_OK)) {
        bool profile = c->axisymmetric && sf_gmsh_has_profile(session, c->surface_group);
        if ((profile ? sf_gmsh_read_profile : sf_gmsh_read_surface)(session, c->surface_group,
                                                                    c->missile.unit, surface, err) == SF_OK) {
            if (c->axisymmetric)
                sf_section_refine_edge(c, surface, mesh, err);
            else
                sf_gmsh_read_hull(session, c->surface_group, c->missile.unit, surface, err);
        }
    }
    if (err->status == SF_OK && read_supports(session, c, mesh, support, err) == SF_OK)
        turn_up(c->up, mesh, surface);
    sf_release(&c->geometry_files);
    if (err->status == SF_OK && !(c->geometry_files = strdup(session->files)))
        SF_NO_MEMORY(err, "the files of a geometry");
    if (session)
        snprintf(libraries, SF_LIBRARIES_SIZE, "gmsh %s, HDF5 %s", session->version, sf_h5_version());
    return err->status;
}

/* ---- sections beside the model ---- */

void sf_sections_free(sf_sections *s) {
    for (int k = 0; k < SF_SECTIONS; k++) {
        sf_mesh_free(&s->mesh[k]);
        sf_surface_free(&s->missile[k]);
    }
    s->alike = false;
}

static sf_status copy_sections(const sf_mesh *mesh, const sf_surface *missile, sf_sections *s,
                               sf_error *err) {
    SF_TRY(sf_section_refine(mesh, NULL, &s->mesh[SF_SECTION_FINE], err));
    SF_TRY(sf_surface_copy(missile, &s->missile[SF_SECTION_FINE], err));
    return s->mesh[SF_SECTION_EQUAL].node_count > 0
               ? sf_surface_copy(missile, &s->missile[SF_SECTION_EQUAL], err)
               : SF_OK;
}

/* A square pad is as good as a round one where its sides are that far from the contact. */
static bool is_wide(const sf_mesh *section, const sf_model *m, const sf_contact_zone *zone) {
    double low[3], high[3];
    sf_box3(section->node_count, section->position, low, high);
    return high[0] >= zone->half_width + m->thickness;
}

/* The section of the drop itself; none where there is no such. */
static void cut_section(const sf_case *c, const sf_mesh *mesh, const sf_surface *missile, sf_sections *s) {
    sf_mesh *equal = &s->mesh[SF_SECTION_EQUAL];
    sf_error none = SF_ERROR_INIT;
    if (c->motion_count > 0 || sf_section_check_case(c, &none) != SF_OK ||
        (!c->axisymmetric && sf_section_cut(c, mesh, equal, &none) != SF_OK))
        return;
    const sf_mesh *section = c->axisymmetric ? mesh : equal;
    if (section->node_count > SF_SECTIONS_MOST || copy_sections(section, missile, s, &none) != SF_OK)
        sf_sections_free(s);
}

/* Fills the sections by a drop that is like the model's, if it has none of its own. */
static void make_alike(const sf_case *c, const sf_model *m, const sf_contact_zone *zone, sf_sections *s) {
    sf_mesh *equal = &s->mesh[SF_SECTION_EQUAL];
    SF_OWNED_BY(sf_surface_free) sf_surface missile = {0};
    sf_error none = SF_ERROR_INIT;
    if (s->mesh[SF_SECTION_FINE].node_count > 0) {
        if (m->axisymmetric || is_wide(equal, m, zone))
            return;
        sf_sections_free(s);
    }
    if (m->axisymmetric)
        return;
    s->alike = true;
    if (sf_alike_make(c, m, zone, equal, &missile, &none) == SF_OK &&
        copy_sections(equal, &missile, s, &none) != SF_OK)
        sf_sections_free(s);
}

sf_status sf_sections_build(sf_sections *s, int which, sf_case *c, sf_model *model, sf_error *err) {
    sf_build_report report;
    if (s->alike)
        sf_alike_case(c);
    c->axisymmetric = 1;
    c->mesh_error_limit = INFINITY;
    c->drops = 1;
    return sf_model_build(c, &s->mesh[which], &s->missile[which], model, &report, NULL, err);
}

sf_status sf_model_make(sf_case *c, sf_model *model, sf_build_report *report,
                        char libraries[SF_LIBRARIES_SIZE], sf_sections *sections, const sf_sink *sink,
                        sf_error *err) {
    sf_surface surface = {0}, support[SF_SUPPORTS] = {0};
    sf_mesh mesh = {0};
    memset(model, 0, sizeof *model);
    if (sections)
        sections->store = c->store;
    if (read_geometry(c, &mesh, &surface, support, libraries, sink, err) == SF_OK && sections)
        cut_section(c, &mesh, &surface, sections);
    if (err->status == SF_OK && sf_model_build(c, &mesh, &surface, model, report, sink, err) == SF_OK) {
        if (sf_hold_check(&report->hold, c->separate, model, err) == SF_OK && report->contact_held)
            SF_REFUSE(err,
                      "pad.contact: every node of the group \"%s\" is held along z by pad.fixed or "
                      "pad.sliding",
                      c->contact_group);
        if (err->status != SF_OK)
            sf_model_free(model);
        else if (sections)
            make_alike(c, model, &report->zone, sections);
        if (err->status == SF_OK && (!sections || sections->mesh[SF_SECTION_FINE].node_count == 0))
            sf_drop_warn_mesh(model, &report->zone, sink);
    }
    sf_surface_free(&surface);
    for (int k = 0; k < SF_SUPPORTS; k++)
        sf_surface_free(&support[k]);
    sf_mesh_free(&mesh);
    return err->status;
}
