/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes from this process what a hostile geometry could do harm with. Irrevocable. */
#pragma once
#include <stdint.h>

/* Limits of memory (bytes beyond what is mapped now; 0: none; none in builds with a sanitizer, whose shadow
 * takes terabytes), of processor time (seconds; 0: none), no core file, no file that grows, few open files;
 * first to be ended when the machine has no memory; ends with its parent. */
void sf_confine_resources(uint64_t bytes, uint64_t seconds);

/* Makes the kernel refuse every system call that is not on a list (EPERM): no program, file name, socket,
 * signal to others, new executable memory. A file can only be opened by the parent, at the other end of
 * the socket SF_MESHER_CONTROL (mesher_protocol.h): open() sends its path there and receives the file. An
 * attempt to start a program is told to the parent. Returns 0, or an errno value if the kernel cannot do
 * this; then nothing is confined. */
int sf_confine_calls(void);
