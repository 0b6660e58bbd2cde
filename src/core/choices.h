/* Model of sequences of different numbers. */
#ifndef DELTAMESH_CHOICES_H
#define DELTAMESH_CHOICES_H

#include "models.h"

#define CHOICES_RANGES(R) R(CHOICES_BY_HISTORY, 8)
enum { CHOICES_RANGES(DM_RANGE) CHOICES_SLOTS };

#endif
