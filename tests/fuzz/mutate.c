/* Mutations of containers: within the payload of a section, whose length is then mended, so that
   what is around it can still be read; and sections of one file in another. */
#include <string.h>

#include "fuzz.h"

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t *data, size_t size, const uint8_t *other,
                                 size_t other_size, uint8_t *out, size_t max_size,
                                 unsigned int seed);

enum { MOST = 32, ID = 4, CRC = 4, LARGEST = 1 << 16 };

/* A file in pieces: what is before the sections, and each of these. */
typedef struct {
    bytes head, ids[MOST], payloads[MOST];
    int count;
} pieces;

static uint32_t random_state;

static uint32_t any_below(uint32_t bound)
{
    random_state = random_state * 1664525 + 1013904223;
    return (uint32_t)((uint64_t)(random_state >> 8) * bound >> 24);
}

/* Return whether data are pieces in full. */
static int take_apart(pieces *p, const uint8_t *data, size_t size)
{
    bytes from = {data, data + size};
    if (setjmp(refused))
        return 0;
    p->count = 0;
    read_bytes(&from, 12);
    read_varint(&from), read_varint(&from);
    read_bytes(&from, CRC);
    p->head = (bytes){data, from.at};
    while (left_of(&from) > 0 && p->count < MOST) {
        p->ids[p->count] = read_bytes(&from, ID);
        p->payloads[p->count++] = read_bytes(&from, read_varint(&from));
        read_bytes(&from, CRC);
    }
    return left_of(&from) == 0 && p->count > 0;
}

static uint8_t *put(uint8_t *at, bytes from)
{
    memcpy(at, from.at, (size_t)left_of(&from));
    return at + left_of(&from);
}

/* Write the pieces; return how many bytes there are, 0 where there is no room. */
static size_t put_together(const pieces *p, uint8_t *out, size_t max_size)
{
    size_t needed = (size_t)left_of(&p->head);
    for (int k = 0; k < p->count; k++)
        needed += (size_t)left_of(&p->payloads[k]) + ID + CRC + 3;
    if (needed > max_size)
        return 0;
    uint8_t *at = put(out, p->head);
    for (int k = 0; k < p->count; k++) {
        at = put(at, p->ids[k]);
        size_t length = (size_t)left_of(&p->payloads[k]);
        for (; length >= 0x80; length >>= 7)
            *at++ = (uint8_t)(length | 0x80);
        *at++ = (uint8_t)length;
        at = put(at, p->payloads[k]);
        memset(at, 0, CRC);
        at += CRC;
    }
    return (size_t)(at - out);
}

/* Change a few bytes where they are: streams within a payload stay where they begin. */
static void change_bytes(uint8_t *data, size_t size)
{
    for (uint32_t left = 1 + any_below(4); left > 0 && size > 0; left--) {
        uint8_t *const at = data + any_below((uint32_t)size);
        switch (any_below(4)) {
        case 0: *at ^= (uint8_t)(1 << any_below(8)); break;
        case 1: *at = (uint8_t)any_below(256); break;
        case 2: *at = (uint8_t)(*at + any_below(9) - 4); break;
        default: *at = any_below(2) ? 0xFF : 0; break;
        }
    }
}

/* Streams end where a file has no bytes left: all but a few sections may be left out. */
static void drop_section(pieces *p)
{
    const uint32_t k = any_below((uint32_t)p->count - 1);
    p->count--;
    for (int i = (int)k; i < p->count; i++)
        p->ids[i] = p->ids[i + 1], p->payloads[i] = p->payloads[i + 1];
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed)
{
    static uint8_t out[LARGEST], payload[LARGEST];
    static pieces p;
    random_state = seed;
    if (max_size > LARGEST)
        max_size = LARGEST;
    if (any_below(50) == 0 || !take_apart(&p, data, size))
        return LLVMFuzzerMutate(data, size, max_size);
    const uint32_t what = any_below(64);
    if (what == 0 && p.count > 3) {
        drop_section(&p);
    } else if (what < 3) { /* the counts of the header */
        static uint8_t head[64];
        const size_t length = (size_t)left_of(&p.head);
        if (length > sizeof(head))
            return LLVMFuzzerMutate(data, size, max_size);
        put(head, p.head);
        change_bytes(head + 12, length - 12 - CRC);
        p.head = (bytes){head, head + length};
    } else {
        int k = (int)any_below((uint32_t)p.count);
        if (p.ids[k].at[0] == 'm' || memcmp(p.ids[k].at, "CHEK", ID) == 0)
            k = 1 % p.count; /* nothing reads these: CONN instead */
        size_t length = (size_t)left_of(&p.payloads[k]);
        if (length + 64 > LARGEST)
            return LLVMFuzzerMutate(data, size, max_size);
        put(payload, p.payloads[k]);
        if (what < 40)
            change_bytes(payload, length);
        else
            length = LLVMFuzzerMutate(payload, length, length + 64);
        p.payloads[k] = (bytes){payload, payload + length};
    }
    const size_t made = put_together(&p, out, max_size);
    if (made == 0)
        return LLVMFuzzerMutate(data, size, max_size);
    memcpy(data, out, made);
    return made;
}

/* Take a section of another file: in the place of one of that name, else before the last. */
size_t LLVMFuzzerCustomCrossOver(const uint8_t *data, size_t size, const uint8_t *other,
                                 size_t other_size, uint8_t *out, size_t max_size,
                                 unsigned int seed)
{
    static pieces p, q;
    random_state = seed;
    if (!take_apart(&p, data, size) || !take_apart(&q, other, other_size))
        return 0;
    const int from = (int)any_below((uint32_t)q.count);
    int k = 0;
    while (k < p.count && memcmp(p.ids[k].at, q.ids[from].at, ID) != 0)
        k++;
    if (k == p.count) {
        if (p.count == MOST)
            return 0;
        k = p.count - 1;
        p.ids[p.count] = p.ids[k], p.payloads[p.count] = p.payloads[k];
        p.count++;
        p.ids[k] = q.ids[from];
    }
    p.payloads[k] = q.payloads[from];
    return put_together(&p, out, max_size);
}
