/* Model of labels. */
#ifndef DELTAMESH_LABELS_H
#define DELTAMESH_LABELS_H

#include "models.h"

enum {
    DM_LABEL_SLOTS = 1 << 18,
    DM_FOLLOWERS = 1 << 16,
    DM_LABEL_DIGITS = 40, /* of a number: more labels than elements there may be */
    DM_LABEL_LIMIT = 255,
    /* Inputs of the mixers of candidates, of a new label, of digits. */
    DM_CANDIDATE_INPUTS = 7,
    DM_NEW_INPUTS = 3,
    DM_DIGIT_INPUTS = 3,
};

/* Mixers: of candidates, by their rank, at most 2; of the bit for a new label; of digits. */
enum { DM_CANDIDATE_MIXER = 0, DM_NEW_MIXER = 3, DM_DIGIT_MIXER = 4 };

#endif
