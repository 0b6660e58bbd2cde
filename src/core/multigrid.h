/* Sizes of the multigrid solver; see `multigrid.c`. */
#ifndef DELTAMESH_MULTIGRID_H
#define DELTAMESH_MULTIGRID_H

/* Right-hand sides of a solve: three coordinates, and the barrier of the bound on the error. */
enum { DM_COORDINATES = 3, DM_LANES = DM_COORDINATES + 1 };

/* Levels, each at most half as large as the one before, and the nodes of a dense one. */
enum { DM_MAX_LEVELS = 40, DM_MAX_DENSE = 128 };

/* Rows of the finest level that are swept in turn; blocks of them may be swept at once. Smaller ones
   would take more iterations, larger ones leave threads idle. */
enum { DM_BLOCK = 1 << 15 };

#endif
