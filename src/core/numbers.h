/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of numbers, X(type, name, array size, units, meaning), that declare the members of a struct and drive their way to
 * and from a file (io/members.h). */
#ifndef SF_CORE_NUMBERS_H
#define SF_CORE_NUMBERS_H

#define SF_DECLARE(type, name, size, units, meaning) type name size;

#endif
