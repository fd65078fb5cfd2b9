/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an HDF5 file of a stranger may hold beside damage: claims of any size, links and data that lead to
 * other files, compressed bombs, texts that are arrays. None is followed, none is allocated. */
#include "io/h5.h"
#include "program_fixture.h"

#include <hdf5.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
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
        cmocka_unit_test(data_of_other_files_are_not_read),
        cmocka_unit_test(claims_are_checked_before_anything_is_allocated),
        cmocka_unit_test(texts_must_be_one_string),
        cmocka_unit_test(what_is_no_file_is_refused_at_once),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
