/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/axis.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

static const double NOTHING = 1e-17; /* of the largest entry of a row: below its rounding */

/* The constraints and their matrix. */
typedef struct axis {
    const sf_model *model;
    size_t count;
    int32_t *node;    /* [count] on the axis */
    gsl_matrix *gram; /* Cholesky factor of G M^-1 G^T */
    gsl_vector *row;  /* [count] */
    double *dense;    /* [nodes] scratch: zeros between calls */
    double *phi_mass; /* [nodes] scratch likewise */
} axis;

static void free_axis(axis *a) {
    SF_FREE(a->node, a->dense, a->phi_mass);
    gsl_matrix_free(a->gram);
    gsl_vector_free(a->row);
}

static sf_status list_axis(const sf_model *m, axis *a, sf_error *err) {
    SF_ALLOC_ALL(err, "the axis", SF_ROOM(a->node, m->fixed_count), SF_ROOM(a->dense, m->node_count),
                 SF_ROOM(a->phi_mass, m->node_count));
    for (int64_t k = 0; err->status == SF_OK && k < m->fixed_count; k++)
        if (m->position[3 * (int64_t)m->fixed_node[k]] == 0)
            a->node[a->count++] = m->fixed_node[k];
    return err->status;
}

/* sum of phi_J(X_node) field_J. */
static double apply_row(const sf_model *m, int32_t node, const double *field) {
    double sum = 0;
    for (int64_t k = m->phi_ptr[node]; k < m->phi_ptr[node + 1]; k++)
        sum += m->phi_value[k] * field[m->phi_node[k]];
    return sum;
}

static sf_status build_gram(axis *a, sf_error *err) {
    const sf_model *m = a->model;
    a->gram = gsl_matrix_alloc(a->count, a->count);
    a->row = gsl_vector_alloc(a->count);
    if (!a->gram || !a->row)
        return SF_NO_MEMORY(err, "the axis");
    for (size_t i = 0; i < a->count; i++) {
        int64_t first = m->phi_ptr[a->node[i]], end = m->phi_ptr[a->node[i] + 1];
        for (int64_t k = first; k < end; k++)
            a->phi_mass[m->phi_node[k]] = m->phi_value[k] / m->mass[m->phi_node[k]];
        for (size_t j = 0; j < a->count; j++)
            gsl_matrix_set(a->gram, i, j, apply_row(m, a->node[j], a->phi_mass));
        for (int64_t k = first; k < end; k++)
            a->phi_mass[m->phi_node[k]] = 0;
    }
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    int failed = gsl_linalg_cholesky_decomp1(a->gram);
    gsl_set_error_handler(handler);
    return failed ? SF_FAIL(err, SF_ERR_MODEL,
                            "the constraints u_R = 0 of %zu nodes on the axis depend on each other", a->count)
                  : SF_OK;
}

/* b_theta P of domain l into a->dense, which holds zeros at first; returns the largest entry. */
static double project_row(const axis *a, int64_t l) {
    const sf_model *m = a->model;
    double largest = 0;
    for (int64_t k = m->domain_ptr[l]; k < m->domain_ptr[l + 1]; k++) {
        a->dense[m->domain_node[k]] = m->domain_b[3 * k + 1];
        a->phi_mass[m->domain_node[k]] = m->domain_b[3 * k + 1] / m->mass[m->domain_node[k]];
        largest = fmax(largest, fabs(m->domain_b[3 * k + 1]));
    }
    for (size_t i = 0; i < a->count; i++)
        gsl_vector_set(a->row, i, apply_row(m, a->node[i], a->phi_mass));
    for (int64_t k = m->domain_ptr[l]; k < m->domain_ptr[l + 1]; k++)
        a->phi_mass[m->domain_node[k]] = 0;
    gsl_linalg_cholesky_svx(a->gram, a->row);
    for (size_t i = 0; i < a->count; i++) {
        double y = gsl_vector_get(a->row, i);
        for (int64_t k = m->phi_ptr[a->node[i]]; k < m->phi_ptr[a->node[i] + 1]; k++)
            a->dense[m->phi_node[k]] -= y * m->phi_value[k];
    }
    return largest;
}

/* The rows of a model that grow. */
typedef struct rows {
    int64_t count, room;
    int32_t *node;
    double *b; /* [count][3] */
} rows;

/* Row l behind the others: its entries, and those that the projection has added. a->dense becomes zeros. */
static sf_status add_row(const axis *a, int64_t l, double largest, rows *out, sf_error *err) {
    const sf_model *m = a->model;
    int64_t k = m->domain_ptr[l], end = m->domain_ptr[l + 1];
    if (out->count + m->node_count > out->room) {
        out->room = 2 * (out->count + m->node_count);
        int32_t *node = realloc(out->node, (size_t)out->room * sizeof *node);
        out->node = node ? node : out->node;
        double *b = node ? realloc(out->b, 3 * (size_t)out->room * sizeof *b) : NULL;
        out->b = b ? b : out->b;
        if (!b)
            return SF_NO_MEMORY(err, "hoop rows");
    }
    for (int32_t i = 0; i < (int32_t)m->node_count; i++) {
        bool known = k < end && m->domain_node[k] == i;
        if (known || fabs(a->dense[i]) > NOTHING * largest) {
            double *b = &out->b[3 * out->count];
            out->node[out->count++] = i;
            b[0] = known ? m->domain_b[3 * k] : 0;
            b[1] = a->dense[i];
            b[2] = known ? m->domain_b[3 * k + 2] : 0;
        }
        a->dense[i] = 0;
        k += known;
    }
    return SF_OK;
}

static sf_status project_rows(const axis *a, sf_model *m, sf_error *err) {
    rows out = {0};
    SF_OWNED int64_t *ptr = sf_alloc(err, m->node_count + 1, sizeof *ptr, "hoop rows");
    for (int64_t l = 0; ptr && l < m->node_count && err->status == SF_OK; l++) {
        add_row(a, l, project_row(a, l), &out, err);
        ptr[l + 1] = out.count;
    }
    if (err->status != SF_OK) {
        SF_FREE(out.node, out.b);
        return err->status;
    }
    SF_FREE(m->domain_ptr, m->domain_node, m->domain_b);
    m->domain_ptr = ptr;
    ptr = NULL;
    m->domain_nnz = out.count;
    m->domain_node = out.node;
    m->domain_b = out.b;
    return SF_OK;
}

sf_status sf_axis_project(sf_model *m, sf_error *err) {
    SF_OWNED_BY(free_axis) axis a = {.model = m};
    SF_TRY(list_axis(m, &a, err));
    if (a.count == 0)
        return SF_OK;
    SF_TRY(build_gram(&a, err));
    return project_rows(&a, m, err);
}
