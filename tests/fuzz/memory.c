/* Memory of one execution: pieces of one block, with gaps that AddressSanitizer watches. */
#include <sanitizer/asan_interface.h>
#include <string.h>

#include "fuzz.h"

enum { BLOCK = 1 << 26, GAP = 32 };

static _Alignas(GAP) uint8_t block[BLOCK];
static size_t used = BLOCK; /* as if all were to be forgotten */

jmp_buf refused;
const char *reason;

void refuse(const char *why)
{
    reason = why;
    longjmp(refused, 1);
}

void require(int good, const char *why)
{
    if (!good)
        refuse(why);
}

void *take_bytes(size_t size)
{
    const size_t start = (used + 2 * GAP - 1) / GAP * GAP;
    require(size <= BLOCK && start <= BLOCK - GAP - size, "too large for this harness");
    ASAN_UNPOISON_MEMORY_REGION(block + start, size);
    memset(block + start, 0xAA, size); /* no kernel may count on what it has not written */
    used = start + size;
    return block + start;
}

int64_t *take_numbers(int64_t count)
{
    require(count >= 0 && count < BLOCK / 8, "too large for this harness");
    return take_bytes((size_t)count * sizeof(int64_t));
}

int64_t *take_zeros(int64_t count)
{
    int64_t *const numbers = take_numbers(count);
    memset(numbers, 0, (size_t)count * sizeof(int64_t));
    return numbers;
}

int64_t *joined(const int64_t *a, int64_t count, const int64_t *b, int64_t other)
{
    int64_t *const numbers = take_numbers(count + other);
    memcpy(numbers, a, (size_t)count * sizeof(int64_t));
    memcpy(numbers + count, b, (size_t)other * sizeof(int64_t));
    return numbers;
}

int32_t *take_shorts(int64_t count)
{
    require(count >= 0 && count < BLOCK / 4, "too large for this harness");
    return take_bytes((size_t)count * sizeof(int32_t));
}

int32_t *shorts_of(const int64_t *numbers, int64_t count)
{
    int32_t *const shorts = take_shorts(count);
    for (int64_t i = 0; i < count; i++)
        shorts[i] = (int32_t)numbers[i];
    return shorts;
}

int64_t *copy_of(const int64_t *numbers, int64_t count) { return joined(numbers, count, numbers, 0); }

void forget_all(void)
{
    ASAN_POISON_MEMORY_REGION(block, used);
    used = 0;
}
