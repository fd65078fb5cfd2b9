/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_IO_UTF8_H
#define SF_IO_UTF8_H

/* Length of the well-formed UTF-8 sequence at `s`, 0 if there is none (RFC 3629). */
int sf_utf8_length(const unsigned char *s);

/* Length of `text`, or at most `size`, cut before a sequence that does not end there. */
int sf_utf8_cut(const char *text, int size);

#endif
