/* Functions of <string.h> where there is no library; of blocks, WebAssembly has instructions. */
#include "string.h"

void *memcpy(void *target, const void *source, size_t size)
{
    return __builtin_memcpy(target, source, size);
}

void *memset(void *target, int byte, size_t size)
{
    return __builtin_memset(target, byte, size);
}

int strcmp(const char *a, const char *b)
{
    for (; *a && *a == *b; a++)
        b++;
    return (unsigned char)*a - (unsigned char)*b;
}
