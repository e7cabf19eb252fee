/* The logger of FMI 2.0 gets its message in printf form with variable arguments. Rust can't define
 * such a function; this one writes the message out and hands it on. */

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Longest message, with its end. */
#define TEXT_MAX 65536

/* The beginning of the importer's log, to which the environment points. */
struct octant_log {
    void (*take)(const struct octant_log *log, int status, const char *category, const char *text);
};

/* 1 if a conversion of the format writes to memory (%n): that is never needed, and never safe. */
static int writes_memory(const char *format) {
    while ((format = strchr(format, '%')) != NULL) {
        format++;
        format += strspn(format, "0123456789+-# '.*hlLqjzt$");
        if (*format == 'n') {
            return 1;
        }
        if (*format != '\0') {
            format++;
        }
    }
    return 0;
}

void octant_fmi2_logger(void *environment, const char *instance, int status, const char *category,
                        const char *message, ...) {
    const struct octant_log *log = environment;
    char small[1024];
    char *large = NULL;
    va_list arguments;
    int length;
    (void)instance;

    /* Without its environment the message belongs to nobody. */
    if (log == NULL || message == NULL) {
        return;
    }
    if (strchr(message, '%') == NULL || writes_memory(message)) {
        log->take(log, status, category, message);
        return;
    }
    va_start(arguments, message);
    length = vsnprintf(small, sizeof small, message, arguments);
    va_end(arguments);
    if (length < 0) {
        log->take(log, status, category, message);
        return;
    }
    if ((size_t)length >= sizeof small) {
        size_t size = length < TEXT_MAX ? (size_t)length + 1 : TEXT_MAX;
        large = malloc(size);
        if (large != NULL) {
            va_start(arguments, message);
            vsnprintf(large, size, message, arguments);
            va_end(arguments);
        }
    }
    log->take(log, status, category, large != NULL ? large : small);
    free(large);
}
