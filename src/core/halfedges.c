/* Half-edges of triangles, for those who do not compile `halfedges.h` themselves. */
#include "halfedges.h"

#include "deltamesh_core.h"

int64_t dm_halfedge_after(int64_t h) { return dm_next(h); }

int64_t dm_halfedge_before(int64_t h) { return dm_previous(h); }
