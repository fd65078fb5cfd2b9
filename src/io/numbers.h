/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of numbers, X(type, name, array size, units, meaning), that declare the members of a struct;
 * io/h5_members.h writes and reads them by the list. */
#ifndef SF_CORE_NUMBERS_H
#define SF_CORE_NUMBERS_H

#define SF_DECLARE(type, name, size, units, meaning) type name size;

#endif
