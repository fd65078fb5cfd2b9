/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an HDF5 file of a stranger may hold beside damage: claims of any size, links and data that lead to
 * other files, compressed bombs, texts that are arrays. None is followed, none is allocated. */
#include "io/h5_data.h"
#include "io/replace.h"
#include "program_fixture.h"

#include <hdf5.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { COUNT = 100 };

static const double numbers[COUNT] = {1, 2, 3};

static hid_t create(const program_place *p, const char *name) {
    hid_t file = H5Fcreate(program_path(p, name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    return file;
}

static void add_numbers(hid_t file, const char *name, hid_t creation) {
    const hsize_t extent = COUNT;
    hid_t space = H5Screate_simple(1, &extent, NULL);
    hid_t set = H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(set >= 0 && H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
    H5Dclose(set);
    H5Sclose(space);
}

/* Reads /values of the file, any extent, and expects a sentence with `part`. */
static void assert_refused(const program_place *p, const char *name, int rank, const char *part) {
    int64_t dims[4] = {-1, -1, -1, -1};
    void *data = NULL;
    sf_h5 *file = NULL;
    sf_error err = SF_ERROR_INIT, none = SF_ERROR_INIT;
    assert_int_equal(sf_h5_open(program_path(p, name), &file, &none), SF_OK);
    assert_int_equal(sf_h5_read(file, "/values", SF_H5_F64, rank, dims, &data, &err), SF_ERR_IO);
    assert_null(data);
    if (!strstr(err.text, part) || !strstr(err.text, name))
        fail_msg("\"%s\" is missing in: %s", part, err.text);
    sf_h5_close(&file, &none);
}

static void plain_data_are_read(void **state) {
    const program_place *p = *state;
    int64_t dims = -1;
    void *data = NULL;
    sf_h5 *opened = NULL;
    sf_error err = SF_ERROR_INIT;
    hid_t file = create(p, "plain.h5");
    add_numbers(file, "values", H5P_DEFAULT);
    H5Fclose(file);
    assert_int_equal(sf_h5_open(program_path(p, "plain.h5"), &opened, &err), SF_OK);
    assert_int_equal(sf_h5_read(opened, "/values", SF_H5_F64, 1, &dims, &data, &err), SF_OK);
    assert_int_equal(dims, COUNT);
    assert_memory_equal(data, numbers, sizeof numbers);
    free(data);
    sf_h5_close(&opened, &err);
}

/* A table in slabs of 1, 2, 4, 8 ... rows is the table written as a whole, and so is its copy; one with a row
 * too few or too many is an error. Of 300 rows of 1,000 numbers a copy takes more than one piece. */
static void rows_in_slabs_make_the_whole(void **state) {
    enum { ROWS = 300, COLUMNS = 1000 };
    const program_place *p = *state;
    const int64_t dims[2] = {ROWS, COLUMNS};
    const sf_h5_info whole = {"/whole", "m", "one"}, slabs = {"/group/slabs", "m", "two"},
                     cut = {"/cut", "m", "three"};
    sf_error err = SF_ERROR_INIT, few = SF_ERROR_INIT, many = SF_ERROR_INIT;
    sf_h5 *file = NULL, *copy = NULL;
    sf_h5_rows rows;
    double *data = malloc(ROWS * COLUMNS * sizeof *data);
    assert_non_null(data);
    for (int k = 0; k < ROWS * COLUMNS; k++)
        data[k] = 1 / (1.0 + k);
    sf_h5_create(program_path(p, "slabs.h5"), &file, &err);
    sf_h5_write(file, &whole, SF_H5_F64, 2, dims, data, &err);
    sf_h5_rows_begin(file, &slabs, SF_H5_F64, 2, dims, &rows, &err);
    for (int64_t first = 0, count = 1; first < ROWS; first += count, count *= 2) {
        count = count < ROWS - first ? count : ROWS - first;
        assert_int_equal(sf_h5_rows_add(&rows, count, &data[first * COLUMNS], &err), SF_OK);
    }
    assert_int_equal(sf_h5_rows_end(&rows, &err), SF_OK);

    sf_h5_rows_begin(file, &cut, SF_H5_F64, 2, dims, &rows, &few);
    assert_int_equal(sf_h5_rows_add(&rows, ROWS - 1, data, &few), SF_OK);
    assert_int_equal(sf_h5_rows_add(&rows, 2, data, &many), SF_ERR_IO);
    assert_int_equal(sf_h5_rows_end(&rows, &few), SF_ERR_IO);
    assert_non_null(strstr(few.text, "slabs.h5: /cut was given 299 of its 300 rows"));
    sf_h5_close(&file, &err);

    sf_h5_open(program_path(p, "slabs.h5"), &file, &err);
    sf_h5_create(program_path(p, "copy.h5"), &copy, &err);
    assert_int_equal(sf_h5_copy(file, "/group", copy, &err), SF_OK);
    sf_h5_close(&copy, &err);
    assert_int_equal(sf_h5_open(program_path(p, "copy.h5"), &copy, &err), SF_OK);
    const struct {
        const sf_h5 *file;
        const char *path;
    } read[] = {{file, "/whole"}, {file, "/group/slabs"}, {copy, "/group/slabs"}};
    for (size_t k = 0; k < sizeof read / sizeof read[0]; k++) {
        int64_t found[2] = {ROWS, COLUMNS};
        void *back = NULL;
        assert_int_equal(sf_h5_read(read[k].file, read[k].path, SF_H5_F64, 2, found, &back, &err), SF_OK);
        assert_memory_equal(back, data, ROWS * COLUMNS * sizeof *data);
        free(back);
    }
    sf_h5_close(&file, &err);
    sf_h5_close(&copy, &err);
    free(data);
}

static void links_are_not_followed(void **state) {
    const program_place *p = *state;
    sf_h5 *opened = NULL;
    sf_error err = SF_ERROR_INIT;
    hid_t file = create(p, "target.h5");
    add_numbers(file, "values", H5P_DEFAULT);
    H5Fclose(file);
    file = create(p, "soft.h5");
    add_numbers(file, "real", H5P_DEFAULT);
    H5Lcreate_soft("/real", file, "values", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    file = create(p, "external.h5");
    H5Lcreate_external("target.h5", "/values", file, "values", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("target.h5", "/", file, "frames", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    assert_refused(p, "soft.h5", 1, "link, which is not followed");
    assert_refused(p, "external.h5", 1, "link, which is not followed");
    assert_int_equal(sf_h5_open(program_path(p, "external.h5"), &opened, &err), SF_OK);
    assert_false(sf_h5_exists(opened, "/values"));
    assert_false(sf_h5_exists(opened, "/frames/values")); /* a group in another file */
    assert_int_equal(sf_h5_group_size(opened, "/frames"), -1);
    sf_h5_close(&opened, &err);
}

static void data_of_other_files_are_not_read(void **state) {
    const program_place *p = *state;
    const hsize_t extent = COUNT;
    program_write_file(program_path(p, "secret"), numbers, sizeof numbers);
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(1, &extent, NULL);
    H5Pset_external(creation, program_path(p, "secret"), 0, sizeof numbers);
    hid_t file = create(p, "outside.h5");
    hid_t set = H5Dcreate2(file, "values", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(set >= 0);
    H5Dclose(set);
    H5Fclose(file);
    H5Pclose(creation);
    creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_virtual(creation, space, "target.h5", "/values", space);
    file = create(p, "virtual.h5");
    set = H5Dcreate2(file, "values", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(set >= 0);
    H5Dclose(set);
    H5Fclose(file);
    H5Pclose(creation);
    H5Sclose(space);
    assert_refused(p, "outside.h5", 1, "in another file");
    assert_refused(p, "virtual.h5", 1, "in another file");
}

/* A new part.h5 of the folder of r.h5; r.h5 links to /frames/a of it. */
static hid_t create_part(const program_place *p) {
    program_shell(p, "rm -rf r.h5.run && mkdir r.h5.run");
    hid_t file = create(p, "r.h5.run/part.h5");
    hid_t group = H5Gcreate2(file, "frames", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(group >= 0);
    H5Gclose(group);
    return file;
}

static void close_part(const program_place *p, hid_t part) {
    sf_error err = SF_ERROR_INIT;
    H5Fclose(part);
    assert_int_equal(sf_seal_add(program_path(p, "r.h5.run/part.h5"), &err), SF_OK);
}

static void link_to_part(const program_place *p, const char *target) {
    hid_t file = create(p, "r.h5"), links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    assert_true(H5Lcreate_external(target, "/frames/a", file, "frames/a", links, H5P_DEFAULT) >= 0);
    H5Pclose(links);
    H5Fclose(file);
}

/* The reading functions at `path` of r.h5; the sentence of a refusal, or NULL. */
static const char *read_linked(const program_place *p, const char *path) {
    static sf_error err;
    sf_error none = SF_ERROR_INIT;
    char text[64];
    int64_t dims = -1;
    void *data = NULL;
    sf_h5 *file = NULL, *copy = NULL;
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_h5_open(program_path(p, "r.h5"), &file, &none), SF_OK);
    sf_h5_read(file, path, SF_H5_F64, 1, &dims, &data, &err);
    if (err.status == SF_OK)
        assert_memory_equal(data, numbers, sizeof numbers);
    else
        assert_null(data);
    bool found = sf_h5_exists(file, path);
    assert_true(found || err.status != SF_OK);
    if (!found) {
        sf_error other = SF_ERROR_INIT, last = SF_ERROR_INIT;
        assert_int_equal(sf_h5_group_size(file, path), -1);
        assert_int_equal(sf_h5_get_attribute(file, path, "units", text, sizeof text, &other), SF_ERR_IO);
        assert_int_equal(sf_h5_group_member(file, path, 0, text, sizeof text, &last), SF_ERR_IO);
    }
    if (err.status != SF_OK) {
        sf_error other = SF_ERROR_INIT;
        remove(program_path(p, "copy.h5"));
        assert_int_equal(sf_h5_create(program_path(p, "copy.h5"), &copy, &none), SF_OK);
        assert_int_equal(sf_h5_copy(file, path, copy, &other), SF_ERR_IO);
        sf_h5_close(&copy, &none);
    }
    free(data);
    sf_h5_close(&file, &none);
    assert_int_equal(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
    return err.status == SF_OK ? NULL : err.text;
}

static void assert_not_followed(const program_place *p, const char *path) {
    const char *said = read_linked(p, path);
    if (!said || !(strstr(said, "link, which is not followed") || strstr(said, "in another file")))
        fail_msg("%s: %s", path, said ? said : "read");
}

static void links_lead_one_deep_into_the_own_folder(void **state) {
    const program_place *p = *state;
    hid_t secret = create(p, "secret.h5");
    hid_t group = H5Gcreate2(secret, "frames", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    add_numbers(group, "a", H5P_DEFAULT);
    H5Gclose(group);
    H5Fclose(secret);

    hid_t part = create_part(p);
    add_numbers(part, "frames/a", H5P_DEFAULT);
    close_part(p, part);
    link_to_part(p, "r.h5.run/part.h5");
    assert_null(read_linked(p, "/frames/a"));
    program_shell(p, "truncate -s -1 r.h5.run/part.h5");
    assert_non_null(strstr(read_linked(p, "/frames/a"), "that holds /frames/a is damaged"));

    part = create_part(p); /* the object is a link itself */
    H5Lcreate_external("../secret.h5", "/frames/a", part, "frames/a", H5P_DEFAULT, H5P_DEFAULT);
    close_part(p, part);
    assert_not_followed(p, "/frames/a");

    part = create_part(p); /* into the folder once more: two deep */
    H5Lcreate_external("r.h5.run/part.h5", "/frames/a", part, "frames/a", H5P_DEFAULT, H5P_DEFAULT);
    close_part(p, part);
    program_shell(p, "mkdir r.h5.run/r.h5.run; cp secret.h5 r.h5.run/r.h5.run/part.h5");
    assert_not_followed(p, "/frames/a");

    part = create_part(p);
    add_numbers(part, "real", H5P_DEFAULT);
    H5Lcreate_soft("/real", part, "frames/a", H5P_DEFAULT, H5P_DEFAULT);
    close_part(p, part);
    assert_not_followed(p, "/frames/a");

    part = create_part(p); /* a member of the group */
    group = H5Gcreate2(part, "frames/a", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("../secret.h5", "/frames/a", group, "values", H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(group);
    close_part(p, part);
    assert_not_followed(p, "/frames/a/values");
}

static void names_of_links_lead_nowhere_else(void **state) {
    static const char *const targets[] = {"r.h5.run/../secret.h5", "r.h5.run/sub/secret.h5",
                                          "r.h5.run/..",           "r.h5.run/",
                                          "../secret.h5",          "secret.h5",
                                          "/r.h5.run/part.h5",     "x.h5.run/secret.h5"};
    const program_place *p = *state;
    close_part(p, create_part(p));
    program_shell(p, "mkdir -p r.h5.run/sub x.h5.run; cp secret.h5 r.h5.run/sub; cp secret.h5 x.h5.run");
    for (size_t k = 0; k < sizeof targets / sizeof targets[0]; k++) {
        link_to_part(p, targets[k]);
        assert_not_followed(p, "/frames/a");
    }
    link_to_part(p, "r.h5.run/part.h5");
    program_shell(p, "ln -sf ../secret.h5 r.h5.run/part.h5");
    assert_not_followed(p, "/frames/a");
    program_shell(p, "rm -r r.h5.run; mkdir else; cp secret.h5 else/part.h5; ln -s else r.h5.run");
    assert_not_followed(p, "/frames/a");
    /* HDF5 would look for it in the working folder and under a prefix too */
    program_shell(p, "rm r.h5.run; mkdir -p away/r.h5.run; cp secret.h5 away/r.h5.run/part.h5");
    char folder[600];
    snprintf(folder, sizeof folder, "%s/away", p->folder);
    setenv("HDF5_EXT_PREFIX", folder, 1);
    assert_non_null(strstr(read_linked(p, "/frames/a"), "has no dataset"));
    unsetenv("HDF5_EXT_PREFIX");
}

/* Raw data elsewhere and virtual data, in a file that a link has led to. */
static void data_of_a_linked_file_are_its_own(void **state) {
    const program_place *p = *state;
    const hsize_t extent = COUNT, unlimited = H5S_UNLIMITED;
    program_write_file(program_path(p, "secret"), numbers, sizeof numbers);
    for (int kind = 0; kind < 2; kind++) {
        hid_t creation = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(1, &extent, NULL);
        if (kind == 0) {
            H5Pset_external(creation, program_path(p, "secret"), 0, sizeof numbers);
        } else { /* its extent is that of the other file */
            hid_t growing = H5Screate_simple(1, &extent, &unlimited);
            const hsize_t zero = 0, one = 1;
            H5Sselect_hyperslab(growing, H5S_SELECT_SET, &zero, NULL, &unlimited, &one);
            H5Sselect_hyperslab(growing, H5S_SELECT_SET, &zero, &one, &one, &unlimited);
            assert_true(
                H5Pset_virtual(creation, growing, program_path(p, "secret.h5"), "/frames/a", growing) >= 0);
            H5Sclose(space);
            space = growing;
        }
        hid_t part = create_part(p);
        hid_t set =
            H5Dcreate2(part, "frames/a", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
        assert_true(set >= 0);
        H5Dclose(set);
        close_part(p, part);
        H5Sclose(space);
        H5Pclose(creation);
        link_to_part(p, "r.h5.run/part.h5");
        assert_not_followed(p, "/frames/a");
    }
}

static void a_file_without_a_folder_has_no_links(void **state) {
    const program_place *p = *state;
    sf_h5 *file = NULL;
    sf_error err = SF_ERROR_INIT;
    hid_t part = create_part(p);
    add_numbers(part, "frames/a", H5P_DEFAULT);
    close_part(p, part);
    link_to_part(p, "r.h5.run/part.h5");
    assert_int_equal(sf_h5_open_alone(program_path(p, "r.h5"), &file, &err), SF_OK);
    assert_false(sf_h5_exists(file, "/frames/a"));
    sf_h5_close(&file, &err);
}

/* A dataset whose header claims `extent`, of which nothing or one chunk is stored. */
static void write_claim(const program_place *p, const char *name, int rank, const hsize_t *extent,
                        bool filter) {
    const hsize_t chunk[2] = {4096, 1}, one[2] = {1, 1}, start[2] = {0, 0};
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(rank, extent, NULL);
    hid_t memory = H5Screate_simple(rank, one, NULL);
    H5Pset_chunk(creation, rank, chunk);
    if (filter)
        H5Pset_deflate(creation, 9);
    hid_t file = create(p, name);
    hid_t set = H5Dcreate2(file, "values", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, one, NULL);
    assert_true(set >= 0);
    if (rank == 1)
        assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, numbers) >= 0);
    H5Dclose(set);
    H5Fclose(file);
    H5Sclose(memory);
    H5Sclose(space);
    H5Pclose(creation);
}

static void claims_are_checked_before_anything_is_allocated(void **state) {
    const program_place *p = *state;
    const hsize_t huge[1] = {(hsize_t)1 << 40}, product[2] = {(hsize_t)1 << 33, (hsize_t)1 << 31},
                  small[1] = {4096};
    write_claim(p, "sparse.h5", 1, huge, false);
    write_claim(p, "product.h5", 2, product, false); /* 2^64 items: the product is 0 in 64 bits */
    write_claim(p, "deflated.h5", 1, small, true);
    assert_refused(p, "sparse.h5", 1, "8796093022208 bytes");
    assert_refused(p, "product.h5", 2, "(and more) bytes");
    assert_refused(p, "deflated.h5", 1, "compressed or filtered");
}

static void texts_must_be_one_string(void **state) {
    const program_place *p = *state;
    const hsize_t extent = COUNT;
    char *text = NULL, found[64];
    sf_h5 *opened = NULL;
    sf_error err = SF_ERROR_INIT, other = SF_ERROR_INIT, none = SF_ERROR_INIT;
    hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate_simple(1, &extent, NULL);
    H5Tset_size(type, 8);
    hid_t file = create(p, "texts.h5");
    hid_t set = H5Dcreate2(file, "text", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    hid_t attribute = H5Acreate2(file, "format", type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(set >= 0 && attribute >= 0);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers);
    H5Awrite(attribute, type, numbers);
    H5Aclose(attribute);
    H5Dclose(set);
    H5Fclose(file);
    H5Sclose(space);
    H5Tclose(type);
    assert_int_equal(sf_h5_open(program_path(p, "texts.h5"), &opened, &none), SF_OK);
    assert_int_equal(sf_h5_read_text(opened, "/text", &text, &err), SF_ERR_IO);
    assert_null(text);
    assert_int_equal(sf_h5_get_attribute(opened, "/", "format", found, sizeof found, &other), SF_ERR_IO);
    sf_h5_close(&opened, &none);
}

static void what_is_no_file_is_refused_at_once(void **state) {
    const program_place *p = *state;
    sf_h5 *opened = NULL;
    sf_error err = SF_ERROR_INIT;
    program_shell(p, "mkfifo pipe.h5");
    assert_int_equal(sf_h5_open(program_path(p, "pipe.h5"), &opened, &err),
                     SF_ERR_IO); /* and does not wait */
    assert_non_null(strstr(err.text, "pipe.h5 is not a plain file"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_data_are_read),
        cmocka_unit_test(rows_in_slabs_make_the_whole),
        cmocka_unit_test(links_are_not_followed),
        cmocka_unit_test(links_lead_one_deep_into_the_own_folder),
        cmocka_unit_test(names_of_links_lead_nowhere_else),
        cmocka_unit_test(data_of_a_linked_file_are_its_own),
        cmocka_unit_test(a_file_without_a_folder_has_no_links),
        cmocka_unit_test(data_of_other_files_are_not_read),
        cmocka_unit_test(claims_are_checked_before_anything_is_allocated),
        cmocka_unit_test(texts_must_be_one_string),
        cmocka_unit_test(what_is_no_file_is_refused_at_once),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
