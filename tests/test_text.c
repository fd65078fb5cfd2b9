/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts and numbers as a user writes them (base/text.h), and every character in a JSON text. */
#include "base/hash.h"
#include "base/text.h"
#include "report/row.h"

#include "program_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void a_cut_text_is_as_long_as_it_may_be_and_whole(void **state) {
    static const char text[] = "a\xc3\xa9\xe2\x82\xac z"; /* 1, 2, 3, 1 and 1 bytes */
    static const int lengths[] = {0, 1, 1, 3, 3, 3, 6, 7, 8, 8};
    (void)state;
    for (int size = 0; size < (int)(sizeof lengths / sizeof lengths[0]); size++)
        assert_int_equal(sf_utf8_cut(text, size), lengths[size]);
}

/* Doubles of few digits have zeros in all but their highest 16 bits. A hash over words moves their difference
 * upwards only, so that 16 bits are all that tells them apart, and a second number may cancel the first. That
 * of an identity changes about half of the lowest 32 bits as well. */
static void numbers_of_few_digits_change_all_bits_of_an_identity(void **state) {
    (void)state;
    int changed = 0, pairs = 0;
    for (double mass = 1; mass < 9; mass += 0.5)
        for (double other = 1; other < mass; other += 0.5, pairs++) {
            uint64_t damage = sf_hash(SF_HASH_START, &mass, 8) ^ sf_hash(SF_HASH_START, &other, 8);
            uint64_t identity =
                sf_hash_identity(SF_HASH_START, &mass, 8) ^ sf_hash_identity(SF_HASH_START, &other, 8);
            uint64_t next = sf_hash_identity(sf_hash_identity(SF_HASH_START, &mass, 8), "", 1) ^
                            sf_hash_identity(sf_hash_identity(SF_HASH_START, &other, 8), "", 1);
            assert_true(damage << 16 == 0 && identity != 0);
            changed += __builtin_popcountll(next & 0xffffffff);
        }
    assert_in_range(changed, 14 * pairs, 18 * pairs);
}

static void numbers_are_taken_whole_or_not_at_all(void **state) {
    static const struct {
        const char *text;
        bool decimal, whole; /* whole: from 1 to 20 */
        double value;
    } rows[] = {{"1", true, true, 1},       {"20", true, true, 20},         {"21", true, false, 21},
                {"0", true, false, 0},      {"-1.5e3", true, false, -1500}, {".5", true, false, 0.5},
                {"1 ", false, false, 0},    {"0x10", false, false, 0},      {"nan", false, false, 0},
                {"1e999", false, false, 0}, {"", false, false, 0},          {"+", false, false, 0}};
    (void)state;
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        double value = NAN;
        int whole = -1;
        if (sf_decimal_is(rows[k].text, &value) != rows[k].decimal ||
            (rows[k].decimal && value != rows[k].value))
            fail_msg("\"%s\" is taken for %g", rows[k].text, value);
        if (sf_whole_is(rows[k].text, 1, 20, &whole) != rows[k].whole ||
            (rows[k].whole && whole != (int)rows[k].value))
            fail_msg("\"%s\" is taken for %d", rows[k].text, whole);
    }
}

static void words_and_lines_are_taken_whole(void **state) {
    (void)state;
    static const char *const words[] = {"low", "lower", "high", "hig", "", "low|lower"};
    static const int places[] = {0, 1, 2, -1, -1, -1};
    char text[] = "name one\nnames two\nname three", *rest = text;
    int length = 0;
    for (size_t k = 0; k < sizeof words / sizeof words[0]; k++)
        assert_int_equal(sf_word_find("low|lower|high", words[k]), places[k]);
    for (int k = 0; k < 5; k++) {
        const char *word = sf_word_at("low|lower|high", k, &length), *expected = words[k < 2 ? k : 2];
        assert_true((size_t)length == strlen(expected) && strncmp(word, expected, strlen(expected)) == 0);
    }
    assert_string_equal(sf_line_take(&rest, "name", ' '), "one");
    assert_null(sf_line_take(&rest, "name", ' '));
    assert_string_equal(sf_line_take(&rest, "name", ' '), "three");
    assert_null(sf_line_take(&rest, "name", ' '));
}

/* Python reads back each character, and for a byte that is no UTF-8 the mark of one. */
static void json_keeps_every_character(void **state) {
    const program_place *p = *state;
    char text[140] = "";
    for (int c = 1; c < 128; c++)
        text[c - 1] = (char)c;
    strcpy(text + 127, "\xc3\xa9\xff");
    FILE *file = fopen(program_path(p, "text.json"), "w");
    assert_non_null(file);
    sf_json json = {.file = file, .empty = true};
    sf_json_open(&json, NULL, '{');
    sf_json_text(&json, text, text);
    sf_json_number(&json, "nan", NAN);
    sf_json_close(&json);
    assert_int_equal(fclose(file), 0);
    program_result r =
        program_shell(p, "python3 -c 'import json; d = json.load(open(\"text.json\", encoding=\"utf-8\"))\n"
                         "t = \"\".join(map(chr, range(1, 128))) + \"\\u00e9\\ufffd\"\n"
                         "assert d == {t: t, \"nan\": None}, d'");
    if (r.code != 0)
        fail_msg("%s", r.err);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cut_text_is_as_long_as_it_may_be_and_whole),
        cmocka_unit_test(numbers_of_few_digits_change_all_bits_of_an_identity),
        cmocka_unit_test(numbers_are_taken_whole_or_not_at_all),
        cmocka_unit_test(words_and_lines_are_taken_whole),
        cmocka_unit_test(json_keeps_every_character),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
