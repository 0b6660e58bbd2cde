/* Kernels of deltamesh: entropy coders of meshes, and inner loops on meshes, on flat arrays.

   Nothing is allocated, and there is no state but what the caller hands over. One function codes in
   both directions: an encoder reads an array that a decoder fills in. Every function that may fail
   returns a status. */
#ifndef DELTAMESH_CORE_H
#define DELTAMESH_CORE_H

#include <stdint.h>

#if defined(_WIN32)
#define DM_API __declspec(dllexport)
#elif defined(__GNUC__)
#define DM_API __attribute__((visibility("default")))
#else
#define DM_API
#endif

/* Status of a call. */
enum {
    DM_OK = 0,
    DM_CORRUPT = 1, /* a stream that no encoder has written, or an array that cannot be coded */
    DM_INVALID = 2, /* arguments that contradict each other: an error of the caller */
};

enum { DM_MAX_INPUTS = 10 };

/* Weights in 1/65536 of the inputs; how many inputs there are; the bound of the counts of their
   slots, and so of their memory; the bits that the mixer may still learn fast from. */
typedef struct {
    int64_t weights[DM_MAX_INPUTS];
    int32_t inputs, limit, youth, unused;
} dm_mixer;

/* Registers of an encoder or a decoder, and the memory that it uses.

   While encoding, low + range <= 2^33, so that at most one carry leaves `low`; it goes into
   `cache`, through the `pending` bytes of 0xFF behind it. */
typedef struct {
    uint64_t low, range, code, cache;
    int64_t pending, position, decoding;
    uint32_t *slots; /* each a probability of a one (22 bits) and a count (10 bits) */
    int64_t slot_count;
    dm_mixer *mixers;
    int64_t mixer_count;
    uint8_t *data; /* written while encoding; read, with zeros beyond its end, while decoding */
    int64_t size;
} dm_coder;

/* Mixers of one kind, one after the other. */
typedef struct {
    int32_t count, inputs, limit;
} dm_mixers;

/* The first slot of a range of contexts. */
typedef struct {
    const char *name;
    int64_t first;
} dm_range;

/* Memory of a coder for one kind of stream. */
typedef struct {
    const char *name;
    int64_t slots;
    const dm_mixers *mixers;
    int64_t mixers_count;
    const dm_range *ranges;
    int64_t ranges_count;
} dm_model;

/* A number that callers need, too. */
typedef struct {
    const char *name;
    int64_t value;
} dm_constant;

/* catalogue.c: models and constants by their names; NULL and a status for unknown ones. */
DM_API const dm_model *dm_find_model(const char *name);
DM_API int dm_find_constant(const char *name, int64_t *value);
DM_API const char *dm_sources(void); /* a digest of the sources, if the build has given one */

/* tables.c: parts of the file format. */
extern DM_API const int16_t dm_stretch[4096];
extern DM_API const int32_t dm_squash[4096];
extern DM_API const int32_t dm_rate[1024];

/* coder.c */
DM_API int dm_start(dm_coder *c, uint32_t *slots, int64_t slot_count, dm_mixer *mixers,
                    int64_t mixer_count, const dm_mixers *kinds, int64_t kinds_count,
                    uint8_t *data, int64_t size, int64_t decoding);
DM_API int64_t dm_finish(dm_coder *c);
DM_API int dm_is_finished(const dm_coder *c);
DM_API int dm_raw(dm_coder *c, int64_t value, int64_t bits, int64_t *coded);
DM_API int dm_bit(dm_coder *c, int64_t bit, int64_t mixer, const int64_t *slots, int64_t count,
                  int64_t *coded);

/* signed_integers.c */
DM_API int64_t dm_level_of(int64_t x);
DM_API int64_t dm_slot_of(int64_t number, int64_t axis, int64_t context);
DM_API int dm_signed(dm_coder *c, int64_t value, int64_t axis, const int64_t *lengths,
                     int64_t length_count, const int64_t *signs, int64_t sign_count,
                     const int64_t *candidates, const int64_t *histories, int64_t candidate_count,
                     int64_t *coded);

/* delta.c */
DM_API int dm_code_deltas(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                          int64_t entries, int64_t *values);
DM_API int dm_code_refinements(dm_coder *c, const int32_t *indptr, int64_t n,
                               const int32_t *indices, int64_t entries, const int64_t *deltas,
                               int64_t *values);
DM_API int dm_diffuse(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                      double *delta, const double *normals, const double *steps, double zone,
                      double pull, double weight, double tangential, double normal,
                      int64_t columns, int64_t *out);

/* points.c */
DM_API int dm_code_gaps(dm_coder *c, int64_t *indices, int64_t count, int64_t n);
DM_API int dm_code_points(dm_coder *c, int64_t *points, int64_t count, const int64_t *bits,
                          const int64_t *extra);
DM_API int dm_code_sorted_points(dm_coder *c, int64_t *points, int64_t count, const int64_t *bits);

/* parallelogram.c */
DM_API int dm_code_positions(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                             int64_t entries, const int32_t *first, const int32_t *corners,
                             int64_t count, const int32_t *within, int64_t *values,
                             int64_t *residuals);
DM_API int dm_predict(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                      const int32_t *first, const int32_t *corners, int64_t count,
                      const int32_t *within, const int64_t *values, int64_t i,
                      int64_t *predictions, int64_t *positions, int64_t *hints, int64_t *kind);

/* labels.c */
DM_API int dm_code_labels(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                          int64_t entries, int64_t *labels, int64_t *followers, int64_t *seen);

/* remaining.c */
DM_API void dm_all_of(int64_t n, int64_t *sums, int64_t *onwards);
DM_API int dm_remove(int64_t n, int64_t *sums, int64_t *onwards, int64_t index);
DM_API int dm_next_left(int64_t n, int64_t *sums, int64_t *onwards, int64_t index, int64_t *next);
DM_API int dm_count_below(int64_t n, int64_t *sums, int64_t *onwards, int64_t index,
                          int64_t *count);
DM_API int dm_select(int64_t n, int64_t *sums, int64_t *onwards, int64_t rank, int64_t *index);
DM_API int dm_rings_of(const int64_t *groups, int64_t elements, int64_t count, int64_t *after,
                       int64_t *before, int64_t *start);
DM_API int dm_leave_ring(int64_t elements, int64_t count, int64_t *after, int64_t *before,
                         int64_t *start, int64_t group, int64_t element);

/* valence.c */
DM_API int dm_below(dm_coder *c, int64_t value, int64_t bound, int64_t *coded);

/* choices.c */
DM_API int dm_code_choices(dm_coder *c, int64_t *numbers, int64_t length, int64_t count,
                           int64_t *sums, int64_t *onwards);

/* wedges.c */
DM_API int dm_fill_rings(const int64_t *opposite, const int64_t *corners, int64_t faces,
                         const int64_t *by_point, int64_t n, int64_t *ring, int64_t *spoke,
                         int64_t *closing, int64_t *first);
DM_API int dm_code_wedges(dm_coder *c, const int64_t *opposite, int64_t halfedges,
                          const int64_t *bounds, int64_t points, const int64_t *ring,
                          const int64_t *spoke, const int64_t *closing, const int64_t *like,
                          const int64_t *kind, int64_t length, int64_t *wedges, int64_t labels,
                          int64_t *seams, int64_t *met, int64_t *number, int64_t *ahead,
                          int64_t *left, int64_t *total);
DM_API int dm_code_isolated(dm_coder *c, int64_t *isolated, int64_t points, int64_t total);

/* stitching.c */
DM_API int dm_code_stitches(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                            int64_t entries, const uint8_t *boundary, int64_t *points,
                            int64_t *latest, int64_t *earlier, int64_t *beside, int64_t *count);
DM_API int dm_code_reversed(dm_coder *c, const int64_t *opposite, int64_t faces,
                            uint8_t *reversed);
DM_API int dm_code_repeats(dm_coder *c, const int64_t *opposite, int64_t faces, int64_t *repeats,
                           int64_t total);
DM_API int dm_code_degenerate(dm_coder *c, const int32_t *indptr, int64_t used,
                              const int32_t *indices, int64_t entries, int64_t *pairs,
                              int64_t count, int64_t n);

/* hidden_edges.c */
DM_API int dm_code_hidden(dm_coder *c, const int64_t *corners, int64_t faces, int64_t vertices,
                          const int64_t *candidate, int64_t *merged, int64_t *parent,
                          int64_t *size, int64_t least, int64_t most, int64_t more,
                          int64_t *edges, int64_t *open_pairs, int64_t *counts);

/* merged_pairs.c */
DM_API int dm_code_explicit_pairs(dm_coder *c, const int64_t *candidate, int64_t faces,
                                  const int64_t *pairs, int64_t *merged, int64_t *parent,
                                  int64_t *size, int64_t most, int64_t total,
                                  const int64_t *order, const int64_t *group,
                                  const int64_t *across, const int64_t *bounds, int64_t groups,
                                  int64_t *first, int64_t *after, int64_t *before);

/* front.c: nodes of the fronts of a region, see front.h. */
typedef struct {
    int64_t vertex, free;
    int64_t successor, predecessor; /* on the front */
    int64_t behind; /* vertex of the visited face at the gate that is not on the gate */
    int64_t gate;   /* half-edge of the unvisited face at the gate; encoder only */
    int64_t older, newer; /* in the bucket */
    int64_t index;        /* in `live` */
} dm_node;
enum { DM_BUCKETS = 64 };
typedef struct {
    dm_node *nodes;
    int64_t *live; /* the nodes that are on a front, in no order */
    int64_t capacity;
    int64_t node_count, vertex_count, face_count, join_count; /* so far */
    int64_t live_count, lowest; /* on a front now; a lower bound of the lowest bucket in use */
    int64_t oldest[DM_BUCKETS], newest[DM_BUCKETS]; /* nodes of each bucket, -1: none */
} dm_front;
DM_API void dm_start_front(dm_front *front, dm_node *nodes, int64_t *live, int64_t capacity);
DM_API int dm_add_node(dm_front *front, int64_t vertex, int64_t free, int64_t *node);
DM_API int dm_remove_node(dm_front *front, int64_t node);
DM_API int dm_set_free(dm_front *front, int64_t node, int64_t free);
DM_API int64_t dm_choose_pivot(dm_front *front);

/* connectivity.c */
typedef struct {
    int64_t start, opposite, node;
} dm_halfedge;
typedef struct {
    int64_t degree, new_index;
} dm_old_vertex;
typedef struct {
    int64_t valence, old_index, is_loop;
} dm_new_vertex;
DM_API int dm_grow(dm_coder *c, dm_front *front, dm_halfedge *halfedges, int64_t halfedge_count,
                   dm_old_vertex *old, int64_t old_count, int64_t *faces, int64_t face_count,
                   dm_new_vertex *vertices, int64_t vertex_count, int64_t *starts,
                   int64_t loops, int64_t loop_start);

/* vertex_order.c, face_order.c */
DM_API int dm_code_vertices(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                            int64_t entries, const int64_t *mirror, int64_t newest,
                            int64_t *order, int64_t margin, int64_t stop, int64_t *sums,
                            int64_t *onwards, int64_t *after, int64_t *before, int64_t *start,
                            int64_t *around);
DM_API int dm_code_faces(dm_coder *c, const int64_t *faces, int64_t m, const int64_t *corners,
                         int64_t corner_count, const int64_t *offsets, const int64_t *within,
                         int64_t *rank, int64_t n, int64_t ranked, int64_t mode, int64_t *order,
                         int64_t *rotations, int64_t margin, int64_t stop, int64_t *at,
                         int64_t *sums, int64_t *onwards, int64_t *after, int64_t *before,
                         int64_t *start);

/* grid.c */
DM_API int dm_index_at(const int64_t *format, int64_t point, int64_t *index, int64_t *unit);
DM_API int dm_point_of(const int64_t *format, int64_t index, int64_t *point);
DM_API int dm_in_units(const int64_t *format, int64_t unit, int64_t size, int64_t *units);

/* exact.c */
DM_API int dm_code_exact(dm_coder *c, const int32_t *indptr, int64_t n, const int32_t *indices,
                         int64_t entries, const int32_t *first, const int32_t *corners,
                         int64_t count, const int64_t *axes, const int64_t *formats,
                         int64_t format_count, int64_t width, int64_t *choices, int64_t *values,
                         int64_t *grid, int64_t *errors);

/* closest.c */
DM_API double dm_squared_to_triangle(const double *p, const double *a, const double *b,
                                     const double *c);
DM_API int dm_fill_boxes(const double *triangles, int64_t count, double *low, double *high,
                         int64_t nodes);
DM_API int dm_largest_squared_distance(const double *points, const double *bounds, int64_t count,
                                       const double *triangles, int64_t triangle_count,
                                       const double *low, const double *high, int64_t nodes,
                                       double *largest);

/* correspondence.c */
DM_API int dm_assign(int64_t source, int64_t target, int64_t *mapping, int64_t n, int64_t *inverse,
                     int64_t other_n, int64_t *log, int64_t *count);
DM_API int dm_propagate(const int64_t *corners, const int64_t *opposite, int64_t faces,
                        const int64_t *colours, int64_t n, const int64_t *other_corners,
                        const int64_t *other_opposite, int64_t other_faces,
                        const int64_t *other_colours, int64_t other_n, int64_t half_edge,
                        int64_t other_half_edge, int64_t *vertices, int64_t *inverse_vertices,
                        int64_t *half_edges, int64_t *inverse_half_edges, int64_t *vertex_log,
                        int64_t *face_log);

/* cutting.c */
DM_API int dm_orient(const int64_t *first, const int64_t *second, const uint8_t *twisted,
                     int64_t pairs, int64_t *parent, uint8_t *reversed, int64_t faces,
                     int64_t *size, int64_t *against);
DM_API int dm_pair_up(const int64_t *order, int64_t length, const int64_t *bounds, int64_t edges,
                      const uint8_t *forward, const int64_t *component, int64_t *opposite,
                      int64_t faces, int64_t *waiting);
DM_API int dm_label_fans(const int64_t *opposite, int64_t halfedges, int64_t *label,
                         int64_t *count);
DM_API int dm_break_slits(int64_t *opposite, int64_t halfedges, int64_t *label, int64_t count,
                          int64_t *seen, uint8_t *done);

/* diagonals.c */
DM_API int dm_choose_diagonals(const int64_t *start, int64_t quads, const int64_t *near,
                               const int64_t *unlike, int64_t entries, int64_t *cut,
                               int64_t *votes, uint8_t *queued, int64_t *queue);

/* differences.c */
DM_API int dm_distances(const double *points, const double *others, int64_t n, double unit,
                        double *distances);
DM_API int dm_face_normals(const double *points, int64_t n, const int64_t *faces, int64_t m,
                           double unit, double *normals, double *areas);
DM_API int dm_face_changes(const double *normals, const double *areas,
                           const double *other_normals, const double *other_areas, int64_t m,
                           double least, double most, double *angles, uint8_t *lost,
                           uint8_t *turned);
DM_API int dm_dihedral_angles(const double *points, int64_t n, const double *normals,
                              const int64_t *faces, int64_t m, const int32_t *pairs,
                              int64_t count, double *angles);

/* distance.c */
DM_API int dm_farthest_points(const int32_t *indptr, int64_t n, const int32_t *indices,
                              int64_t entries, const int64_t *first, int64_t first_count,
                              int64_t *anchors, int64_t count, int64_t *distance, int64_t *queue);
DM_API int dm_nearest(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                      const int64_t *sources, int64_t count, int64_t *nearest, int64_t *queue);
DM_API int dm_local_maxima(const int32_t *indptr, int64_t n, const int32_t *indices,
                           int64_t entries, const double *value, uint8_t *is_maximum);
DM_API int dm_subtract_product(double *block, int64_t n, int64_t width, const double *W,
                               int64_t row, int64_t count, const int64_t *rows, double *columns);

/* elimination.c */
DM_API int dm_breadth(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
                      int64_t *part, int64_t *level, int64_t *queue, double *breadth);
DM_API int dm_dissect(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
                      int64_t *order, int64_t *part, int64_t *level, int64_t *queue, int64_t *old,
                      int64_t *begins, int64_t *ends);
DM_API int dm_factor_entries(const int64_t *indptr, int64_t n, const int64_t *indices,
                             int64_t entries, const int64_t *order, int64_t most, int64_t *rank,
                             int64_t *parent, int64_t *ancestor, int64_t *seen, int64_t *count);
DM_API int dm_product_entries(const int64_t *rows, int64_t m, const int64_t *row_indices,
                              int64_t entries, const int64_t *columns, int64_t n,
                              const int64_t *column_indices, int64_t most, int64_t *seen,
                              int64_t *count);

/* laplacian.c */
DM_API int dm_apply_laplacian(const int32_t *indptr, int64_t n, const int32_t *indices,
                              int64_t entries, const double *x, int64_t columns, double *out);
DM_API int dm_smooth(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                     double *x, int64_t columns, int64_t rounds, double *shares);
DM_API int dm_normal_bounds(const int32_t *indptr, int64_t n, const int32_t *indices,
                            int64_t entries, int64_t *bounds, int64_t *seen);
DM_API int dm_normal_matrix(const int32_t *indptr, int64_t n, const int32_t *indices,
                            int64_t entries, const int64_t *anchors, const double *weights,
                            int64_t anchor_count, const int64_t *bounds, int64_t *columns,
                            double *values, int64_t filled, int64_t *place);

/* multigrid.c */
DM_API int dm_choose_block(const int32_t *indptr, int64_t n, const int32_t *indices,
                           int64_t entries, int64_t *block);
DM_API int dm_aggregate(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                        const float *inverse, int64_t block, int32_t *aggregate, int64_t *count);
DM_API int dm_coarsen(const int32_t *indptr, int64_t n, const int32_t *indices, int64_t entries,
                      const float *weights, const float *diagonal, const int32_t *aggregate,
                      int64_t m, int32_t *coarse_indptr, int32_t *coarse_indices,
                      float *coarse_weights, float *coarse_diagonal, int64_t *coarse_entries,
                      int32_t *members, int32_t *starts, int32_t *place);
DM_API int dm_factor_dense(double *factor, int64_t n);

/* poisson.c */
DM_API int dm_solve_block(const void *of, int64_t index);
DM_API int dm_solve_poisson(const int64_t *sizes, const int64_t *entries, int64_t levels,
                            const int32_t *near, const int32_t *neighbours,
                            const int32_t *indptr, const int32_t *indices, const float *weights,
                            const float *diagonal, const float *inverse, const int32_t *aggregate,
                            const double *factor, int64_t dense, const double *b, double *x,
                            double tolerance, int64_t most, double *barrier, double *bound,
                            int64_t *iterations, int64_t block, int (*each)(void *, int64_t),
                            double *sums, double *w, double *r, double *p, double *q,
                            float *cycle_b, float *cycle_x, uint8_t *border);

/* supernodes.c */
DM_API int dm_plan(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
                   int64_t *order, int64_t most, int64_t *parent, int64_t *starts, int64_t *of,
                   int64_t *row_bounds, int64_t *panel_bounds, int64_t *sizes, int64_t *rank,
                   int64_t *counts, int64_t *seen, int64_t *old);

/* factor.c */
typedef struct {
    int64_t n, supernodes, row_count, entries, tallest;
    const int64_t *order, *starts, *row_bounds, *panel_bounds; /* see dm_plan */
    int64_t *rows;  /* of each panel, ascending: its own columns, then those below */
    double *panels; /* by columns: L below the diagonal, D on it */
} dm_factor_plan;
DM_API int dm_factor(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
                     const double *values, const dm_factor_plan *plan, const int64_t *parent,
                     const int64_t *of, int64_t *rank, int64_t *place, int64_t *from,
                     int64_t *next, int64_t *first, double *block, double *packed,
                     int64_t *pivot);
DM_API int dm_solve_factored(const dm_factor_plan *plan, double *x, int64_t columns,
                             double *ordered, double *sums);

/* minimum_degree.c */
DM_API int dm_minimum_degree(const int64_t *indptr, int64_t n, const int64_t *indices,
                             int64_t entries, int64_t *order, int64_t *lists, int64_t *memory);

/* neighbours.c */
DM_API int dm_gather_neighbours(const int64_t *a, const int64_t *b, int64_t count, int64_t n,
                                int32_t *indptr, int32_t *indices, int64_t *entries,
                                int32_t *rows, int32_t *place);
DM_API int dm_label_components(const int32_t *indptr, int64_t n, const int32_t *indices,
                               int64_t entries, int64_t *label, int64_t *queue, int64_t *count);

/* motions.c */
DM_API int dm_span(const int64_t *a, const int64_t *b, int64_t count, int64_t n, uint8_t *kept,
                   int64_t *root);
DM_API int dm_walk_forest(const int32_t *indptr, int64_t n, const int32_t *indices,
                          int64_t entries, int64_t *order, int64_t *parent);
DM_API int dm_carry_motions(const int64_t *order, const int64_t *parent, int64_t n,
                            const double *rest, double step, double unit, int64_t measuring,
                            int64_t *numbers, double *positions, double *quaternions);

/* normals.c */
DM_API int dm_vertex_normals(const double *points, int64_t n, const int64_t *faces, int64_t m,
                             const double *steps, int64_t step_count, double most, double fade,
                             double *normals, double *areas);

/* rotations.c */
DM_API int dm_fit_rotations(const int32_t *indptr, int64_t n, const int32_t *indices,
                            int64_t entries, const double *from, const double *to, int64_t rings,
                            double *turns, double *moments, double *wider);
DM_API int dm_nearest_rotations(const double *matrices, int64_t n, double *turns);
DM_API int dm_turned_deltas(const int32_t *indptr, int64_t n, const int32_t *indices,
                            int64_t entries, const double *points, const double *turns,
                            double *out);

/* parallelograms.c */
DM_API int dm_count_parallelograms(const int64_t *faces, int64_t m, int64_t n,
                                   const int64_t *opposite, const int64_t *quads,
                                   int64_t quad_count, int32_t *first, int32_t *within);
DM_API int dm_list_parallelograms(const int64_t *faces, int64_t m, int64_t n,
                                  const int64_t *opposite, const int64_t *quads,
                                  int64_t quad_count, const int32_t *first, int64_t count,
                                  int32_t *corners, int32_t *place);

/* outlines.c */
DM_API int dm_walk_outlines(const int64_t *merged, int64_t faces, int64_t *corners,
                            int64_t corner_count, int64_t *offsets, int64_t polygons,
                            int64_t *of_corners);

/* halfedges.c */
DM_API int64_t dm_halfedge_after(int64_t h);
DM_API int64_t dm_halfedge_before(int64_t h);
DM_API int dm_group_by_edge(const int64_t *start, const int64_t *end, int64_t count, int64_t n,
                            int64_t *order, int64_t *bounds, int64_t *edges, int32_t *by_higher,
                            int64_t *place);

#endif
