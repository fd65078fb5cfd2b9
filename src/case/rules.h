/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_CASE_RULES_H
#define SF_CASE_RULES_H
#include "case/reader.h"

/* The rules that join missile.freedom with other keys. Internal to src/case. */

sf_status sf_case_check_freedom(const sf_case_reader *reader, sf_error *err);

/* The key missile.motion. Internal to src/case. */

/* The reader of SF_KEY_MOTION, and the rules that join the motion with mass, velocity, gravity and end time.
 */
sf_status sf_case_read_motion(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err);
sf_status sf_case_check_motion(const sf_case_reader *reader, sf_error *err);
#endif
