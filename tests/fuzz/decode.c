/* The sections in their order, and the target of libFuzzer. */
#include "fuzz.h"

/* Meshes of a few hundred elements reach all of the core that larger ones do, but the sums of very
   many. */
limits allowed = {.vertices = 120, .faces = 80, .streams = 8, .bits = 2000};

static void tell_nobody(const char *what, const int64_t *numbers, int64_t count)
{
    (void)what, (void)numbers, (void)count;
}

void (*tell)(const char *what, const int64_t *numbers, int64_t count) = tell_nobody;

int decode(const uint8_t *data, size_t size)
{
    static container file;
    static structure s;
    forget_all();
    reason = NULL;
    bits_left = allowed.bits;
    if (setjmp(refused))
        return 0;
    read_container(&file, data, size);
    decode_structure(&file, &s);
    const elements surface = surface_of(&s);
    decode_geometry(&file, &s, &surface);
    if (file.sections[ATTR].at)
        decode_attributes(file.sections[ATTR], &s, &surface);
    if (file.sections[PART].at)
        decode_parts(file.sections[PART], &s);
    if (file.sections[ORDR].at)
        decode_order(file.sections[ORDR], &s);
    return 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    decode(data, size);
    return 0;
}
