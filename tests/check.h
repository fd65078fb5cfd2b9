/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests that need a means of the machine: a program, a display, a right of root; tests that take long.
 *
 * A test without its means prints the reason and is skipped. Under SF_NO_SKIP=1, which .ci/run sets, it
 * fails, so that no check disappears unseen where packages.txt is installed. Three means may be absent there
 * too, because no installation provides them; check_skip_refused names them at the call:
 *  - a right that the kernel or the container refuses to root: mounts, tracing, /proc of the process;
 *  - a checkout that other users may enter;
 *  - a build without sanitizers, which take address space and stack of their own. */
#ifndef SF_TESTS_CHECK_H
#define SF_TESTS_CHECK_H

#include <stdbool.h>

/* Skips the running test because a program, display or package is missing; fails it under SF_NO_SKIP=1. */
void check_skip_missing(const char *reason);
/* Skips the running test, under SF_NO_SKIP=1 too: `reason` is one of the three kinds above. */
void check_skip_refused(const char *reason);
/* Skips the running test, as check_skip_missing, unless all of these programs are found: names between
 * blanks. */
void check_programs(const char *names);

/* True under SF_SLOW=1, which tests/CMakeLists.txt sets for the entry NAME_slow of a test: only its long
 * tests run. */
bool check_slow(void);

#endif
