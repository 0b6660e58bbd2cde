/* Section PART: its divisions, without the words; see `src/deltamesh/_parts.py`. */
#include <zlib.h>

#include "fuzz.h"

enum { KINDS = 5, KIND = 7, PARTLY = 8, MOVED = 16, MOST_TEXT = 1 << 16, MATRIX = 128 };

static bytes inflated(bytes from, int64_t size)
{
    uint8_t *const text = take_bytes((size_t)size);
    z_stream z = {.next_in = (Bytef *)from.at, .avail_in = (uInt)left_of(&from),
                  .next_out = text, .avail_out = (uInt)size};
    require(inflateInit2(&z, -15) == Z_OK, "inflateInit2");
    const int status = inflate(&z, Z_FINISH);
    const int whole = status == Z_STREAM_END && z.avail_in == 0 && z.avail_out == 0;
    inflateEnd(&z);
    require(whole, "a deflate stream");
    return (bytes){text, text + size};
}

/* What a block holds, of at most so many bytes. */
static bytes unpacked(bytes *payload, int64_t most)
{
    const int deflated = read_byte(payload);
    const int64_t size = read_varint(payload);
    /* Zstandard, which has been fuzzed by others, is not linked. */
    require(deflated != 2, "a block of Zstandard");
    require(deflated <= 1 && size <= most, "a block");
    if (!deflated)
        return read_bytes(payload, size);
    const int64_t length = read_varint(payload);
    require(length < size, "a block that deflating has not made smaller");
    return inflated(read_bytes(payload, length), size);
}

static int64_t skip_strings(bytes *text)
{
    const int64_t count = read_varint(text);
    for (int64_t k = 0; k < count; k++)
        read_bytes(text, read_varint(text));
    return count;
}

static void decode_division(bytes *payload, const structure *s, int flags, int64_t names)
{
    const bytes stream = read_bytes(payload, read_varint(payload));
    int64_t labels = s->polygons > 0; /* an empty stream has one */
    if (left_of(&stream) > 0)
        decode_labels(stream, polygons_of(s).near, &labels);
    const bytes order = read_bytes(payload, read_varint(payload));
    const int64_t count = names + (flags & PARTLY ? 1 : 0);
    require(labels <= count, "labels of parts");
    int64_t *const numbers = take_zeros(labels);
    dm_coder *const c = decoder_of("choices", 0, order);
    check(dm_code_choices(c, numbers, labels, count, take_numbers(count + 1),
                          take_numbers(count + 1)), "dm_code_choices");
    check_end(c);
    tell("PART", numbers, labels);
    if (flags & MOVED)
        unpacked(payload, (names + 7) / 8 + names * MATRIX);
}

void decode_parts(bytes payload, const structure *s)
{
    bytes text = unpacked(&payload, MOST_TEXT);
    const int64_t count = read_varint(&text);
    int flags[KINDS], known[KIND + 1] = {0};
    int64_t names[KINDS];
    require(count <= KINDS, "divisions");
    for (int64_t k = 0; k < count; k++) {
        flags[k] = read_byte(&text);
        require((flags[k] & KIND) < KINDS && flags[k] < 2 * MOVED && !known[flags[k] & KIND]++,
                "a division");
        names[k] = skip_strings(&text);
    }
    for (int64_t left = read_varint(&text); left > 0; left--) { /* metadata */
        read_bytes(&text, read_varint(&text));
        skip_strings(&text);
    }
    skip_strings(&text); /* losses */
    require(left_of(&text) == 0, "bytes after the text");
    for (int64_t k = 0; k < count; k++)
        decode_division(&payload, s, flags[k], names[k]);
    require(left_of(&payload) == 0 || !allowed.strict, "bytes after the last parts");
}
