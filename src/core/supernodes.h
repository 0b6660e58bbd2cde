/* Order and tree of an elimination. */
#ifndef DELTAMESH_SUPERNODES_H
#define DELTAMESH_SUPERNODES_H

#include <stdint.h>

/* Most columns of a supernode: the panel of a wider one would not stay in the nearest memory. */
enum { DM_WIDEST = 32 };

/* Rows and columns of a product that are computed at once; panels have as many entries more. */
enum { DM_TILE = 4 };

/* Set the place of each unknown in an order (n,); return whether that is a permutation. */
int dm_fill_ranks(const int64_t *order, int64_t n, int64_t *rank);

/* Set the elimination tree: the parent of each place in the order, or -1. Scratch: ancestor. */
void dm_eliminate(const int64_t *indptr, int64_t n, const int64_t *indices, const int64_t *order,
                  const int64_t *rank, int64_t *parent, int64_t *ancestor);

#endif
