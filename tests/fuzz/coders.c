/* Coders whose slots are kept from one stream to the next. */
#define NOTES_NOTHING
#include "touched.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"

enum { MODELS = 32, MIXER_KINDS = 64, TOUCHED = 1 << 22 };

/* Memory of a model, or of exact numbers of so many formats; `fresh` are slots of the first time. */
typedef struct {
    const char *name;
    int64_t formats, slot_count, mixer_count, kinds_count;
    dm_mixers kinds[MIXER_KINDS];
    uint32_t *slots, *fresh;
    dm_mixer *mixers;
} memory;

static memory memories[MODELS];
static uint32_t *touched[TOUCHED];
static int64_t touched_count;

void note_touched(uint32_t *slot)
{
    insist(touched_count < TOUCHED, "room for the slots that are touched");
    touched[touched_count++] = slot;
}

int64_t bits_left;

void count_bit(void) { require(bits_left-- > 0, "limits"); }

void insist(int good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "deltamesh: broken: %s\n", what);
    abort();
}

void check(int status, const char *kernel)
{
    insist(status != DM_INVALID, kernel);
    require(status == DM_OK, kernel);
}

static void add_model(memory *m, const char *name)
{
    const dm_model *const model = dm_find_model(name);
    insist(model != NULL && m->kinds_count + model->mixers_count <= MIXER_KINDS, name);
    m->slot_count += model->slots;
    for (int64_t k = 0; k < model->mixers_count; k++) {
        m->kinds[m->kinds_count++] = model->mixers[k];
        m->mixer_count += model->mixers[k].count;
    }
}

static memory *memory_of(const char *name, int64_t formats)
{
    memory *m = memories;
    for (; m->name; m++)
        if (strcmp(m->name, name) == 0 && m->formats == formats)
            return m;
    insist(m < memories + MODELS - 1, "room for models");
    m->name = name, m->formats = formats;
    if (strcmp(name, "exact") == 0) {
        for (int k = 0; k < 3; k++)
            add_model(m, "exact_axis");
        for (int64_t k = 0; k < formats; k++)
            add_model(m, "exact_format");
    } else {
        add_model(m, name);
    }
    m->slots = malloc((size_t)m->slot_count * sizeof(*m->slots));
    m->fresh = malloc((size_t)m->slot_count * sizeof(*m->fresh));
    m->mixers = malloc((size_t)m->mixer_count * sizeof(*m->mixers));
    insist(m->slots && m->fresh && m->mixers, "memory of a model");
    for (int64_t k = 0; k < m->slot_count; k++)
        m->slots[k] = m->fresh[k] = FRESH_SLOT;
    return m;
}

/* One decoder at a time: the next one takes its memory. */
dm_coder *decoder_of(const char *model, int64_t formats, bytes payload)
{
    static dm_coder c;
    for (; touched_count > 0; touched_count--)
        *touched[touched_count - 1] = FRESH_SLOT;
    memory *const m = memory_of(model, formats);
    const size_t size = (size_t)left_of(&payload), slots = (size_t)m->slot_count;
    if (m->slot_count <= FEW_SLOTS)
        memcpy(m->slots, m->fresh, slots * sizeof(*m->slots));
    else if (allowed.strict)
        insist(memcmp(m->slots, m->fresh, slots * sizeof(*m->slots)) == 0, "slots as new");
    uint8_t *const data = take_bytes(size); /* alone, so that what is beyond is not read */
    memcpy(data, payload.at, size);
    check(dm_start(&c, m->slots, 0, m->mixers, m->mixer_count, m->kinds, m->kinds_count, data,
                   (int64_t)size, 1), "dm_start");
    c.slot_count = m->slot_count;
    return &c;
}

void check_end(const dm_coder *c)
{
    if (!allowed.strict)
        return;
    require(c->size == 0 || c->data[c->size - 1] != 0, "a zero byte at the end of a stream");
    require(c->position >= c->size && dm_is_finished(c), "a stream that does not end");
}

/* The linker has `dm_grow` call this one instead: the same slots, without computing them anew. */
void __real_dm_set_prior(dm_coder *c);
void __wrap_dm_set_prior(dm_coder *c);
void __wrap_dm_set_prior(dm_coder *c)
{
    static uint32_t *known;
    const size_t size = (size_t)c->slot_count * sizeof(*known);
    if (known == NULL) {
        __real_dm_set_prior(c);
        known = malloc(size);
        insist(known != NULL, "memory of the prior");
        memcpy(known, c->slots, size);
    }
    memcpy(c->slots, known, size);
}
