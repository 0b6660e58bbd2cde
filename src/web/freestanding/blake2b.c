/* BLAKE2b with a digest of 8 bytes and no key (RFC 7693) of numbers of 64 bits: the digest of what a
   file decodes to. Where deltamesh runs under Python, hashlib has it. */
#include <stdint.h>

#include "string.h"

enum { WORDS = 16, ROUNDS = 12, DIGEST_SIZE = 8 };

/* State; the block that is being filled, and how much of it is; how many bytes came before. */
typedef struct {
    uint64_t state[8], block[WORDS];
    uint64_t bytes;
    int64_t filled;
} dm_blake2b;

static const uint64_t START[8] = {
    0x6a09e667f3bcc908, 0xbb67ae8584caa73b, 0x3c6ef372fe94f82b, 0xa54ff53a5f1d36f1,
    0x510e527fade682d1, 0x9b05688c2b3e6c1f, 0x1f83d9abfb41bd6b, 0x5be0cd19137e2179,
};

static const uint8_t ORDER[10][WORDS] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3},
    {11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4},
    {7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8},
    {9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13},
    {2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9},
    {12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11},
    {13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10},
    {6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5},
    {10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0},
};

static uint64_t turned(uint64_t x, int bits)
{
    return x >> bits | x << (64 - bits);
}

static void mix(uint64_t *v, int a, int b, int c, int d, uint64_t x, uint64_t y)
{
    v[a] += v[b] + x;
    v[d] = turned(v[d] ^ v[a], 32);
    v[c] += v[d];
    v[b] = turned(v[b] ^ v[c], 24);
    v[a] += v[b] + y;
    v[d] = turned(v[d] ^ v[a], 16);
    v[c] += v[d];
    v[b] = turned(v[b] ^ v[c], 63);
}

static void compress(dm_blake2b *h, uint64_t last)
{
    uint64_t v[WORDS];
    for (int i = 0; i < 8; i++) {
        v[i] = h->state[i];
        v[8 + i] = START[i];
    }
    v[12] ^= h->bytes;
    v[14] ^= last;
    for (int round = 0; round < ROUNDS; round++) {
        const uint8_t *order = ORDER[round % 10];
        for (int i = 0; i < 4; i++)
            mix(v, i, 4 + i, 8 + i, 12 + i, h->block[order[2 * i]], h->block[order[2 * i + 1]]);
        for (int i = 0; i < 4; i++)
            mix(v, i, 4 + (i + 1) % 4, 8 + (i + 2) % 4, 12 + (i + 3) % 4,
                h->block[order[8 + 2 * i]], h->block[order[9 + 2 * i]]);
    }
    for (int i = 0; i < 8; i++)
        h->state[i] ^= v[i] ^ v[8 + i];
    h->filled = 0;
}

/* Begin a digest. */
__attribute__((visibility("default"))) int dm_begin_digest(dm_blake2b *h)
{
    memset(h, 0, sizeof(*h));
    memcpy(h->state, START, sizeof(START));
    h->state[0] ^= 0x01010000 ^ DIGEST_SIZE;
    return 0;
}

/* Take numbers. */
__attribute__((visibility("default"))) int dm_take_numbers(dm_blake2b *h, const uint64_t *numbers,
                                                           int64_t count)
{
    for (int64_t i = 0; i < count; i++) {
        if (h->filled == WORDS)
            compress(h, 0);
        h->block[h->filled++] = numbers[i];
        h->bytes += sizeof(*numbers);
    }
    return 0;
}

/* End a digest, which is returned. */
__attribute__((visibility("default"))) int dm_end_digest(dm_blake2b *h, uint64_t *digest)
{
    while (h->filled < WORDS)
        h->block[h->filled++] = 0;
    compress(h, ~(uint64_t)0);
    *digest = h->state[0];
    return 0;
}
