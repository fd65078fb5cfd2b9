/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/utf8.h"

#include <stddef.h>
#include <string.h>

int sf_utf8_length(const unsigned char *s) {
    static const struct {
        unsigned char first_low, first_high, second_low, second_high;
        int length;
    } forms[] = {
        {0x00, 0x7f, 0, 0, 1},       {0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
        {0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3}, {0xee, 0xef, 0x80, 0xbf, 3},
        {0xf0, 0xf0, 0x90, 0xbf, 4}, {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4},
    };
    for (size_t k = 0; k < sizeof forms / sizeof forms[0]; k++) {
        if (s[0] < forms[k].first_low || s[0] > forms[k].first_high)
            continue;
        if (forms[k].length > 1 && (s[1] < forms[k].second_low || s[1] > forms[k].second_high))
            return 0;
        for (int j = 2; j < forms[k].length; j++)
            if ((s[j] & 0xc0) != 0x80)
                return 0;
        return forms[k].length;
    }
    return 0;
}

int sf_utf8_cut(const char *text, int size) {
    int length = (int)strnlen(text, (size_t)size + 1);
    if (length <= size)
        return length;
    for (length = size; length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80;)
        length--;
    return length;
}
