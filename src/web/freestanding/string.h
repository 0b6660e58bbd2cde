/* What the core asks of <string.h>, where there is no library. */
#ifndef DELTAMESH_FREESTANDING_STRING_H
#define DELTAMESH_FREESTANDING_STRING_H

#include <stddef.h>

void *memcpy(void *target, const void *source, size_t size);
void *memset(void *target, int byte, size_t size);
int strcmp(const char *a, const char *b);

#endif
