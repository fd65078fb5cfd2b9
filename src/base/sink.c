/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/sink.h"

#include "base/error.h"
#include <stdarg.h>
#include <stdio.h>

void sf_sink_tell(const sf_sink *sink, sf_severity severity, const char *format, ...) {
    char sentence[1024];
    va_list args;
    if (!sink || !sink->tell)
        return;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    sf_error_clean(sentence);
    sink->tell(sink->user, severity, sentence);
}
