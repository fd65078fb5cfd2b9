/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rules that join missile.freedom with other keys. Internal to src/case. */
#ifndef SF_CASE_FREEDOM_H
#define SF_CASE_FREEDOM_H

#include "case/reader.h"

sf_status sf_case_check_freedom(const sf_case_reader *reader, sf_error *err);

#endif
