/* A third reading of the file format, for fuzzers: in C alone, in the order of
   `src/deltamesh/_sections/table.py`, as far as kernels of the core are called. Floating point and
   whatever no kernel is given is left out, and so are checksums and the digest: it is as if each
   were repaired. */
#ifndef DELTAMESH_FUZZ_H
#define DELTAMESH_FUZZ_H

#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>

#include "deltamesh_core.h"

/* Bounds of what is decoded, so that an execution stays short. */
typedef struct {
    int64_t vertices, faces, streams, bits; /* the third of attributes, the last coded in models */
    int strict; /* whether streams have to end where they should; a fuzzer would not get beyond one */
} limits;
extern limits allowed;
extern int64_t bits_left;

/* Leave the file that is being decoded: a decoder refuses it, for this reason. */
extern jmp_buf refused;
extern const char *reason;
_Noreturn void refuse(const char *why);
void require(int good, const char *why);
/* End the process: the core says that its caller is wrong, or an invariant is broken. */
void insist(int good, const char *what);
/* Refuse a file for which a kernel returns DM_CORRUPT. */
void check(int status, const char *kernel);

/* memory.c: memory of one execution, each piece on its own, of any value at first. */
void *take_bytes(size_t size);
int64_t *take_numbers(int64_t count);
int64_t *take_zeros(int64_t count);
int64_t *copy_of(const int64_t *numbers, int64_t count);
int32_t *take_shorts(int64_t count);
int32_t *shorts_of(const int64_t *numbers, int64_t count);
int64_t *joined(const int64_t *a, int64_t count, const int64_t *b, int64_t other);
void forget_all(void);

/* bytes.c: a part of a payload that is read from the front. */
typedef struct {
    const uint8_t *at, *end;
} bytes;
bytes read_bytes(bytes *from, int64_t size);
uint8_t read_byte(bytes *from);
int64_t read_varint(bytes *from);
int64_t read_little(bytes *from, int size);
int64_t left_of(const bytes *from);

/* coders.c */
dm_coder *decoder_of(const char *model, int64_t formats, bytes payload);
void check_end(const dm_coder *c);

/* Sections of a container, by their ids; `at` is NULL for those that are not there. */
enum {
    PARM, CONN, STCH, COPY, POLY, STEP, ANCH, DELT, NORM, CART, EXAC, CELL, FIXS, ATTR, PART, ORDR,
    POSE, FILL, FRAM, META, CHEK, SECTIONS
};
extern const char SECTION_IDS[SECTIONS][5];
typedef struct {
    int64_t vertices, triangles;
    bytes sections[SECTIONS];
    /* Of PARM: */
    int64_t method, anchor_method, anchor_count, isolated;
    uint64_t seed;
    int has_step, interpolated;
} container;
void read_container(container *file, const uint8_t *data, size_t size);

/* sorting.c */
int64_t *order_of(const int64_t *keys, int64_t count); /* stable */
int64_t *inverse_of(const int64_t *order, int64_t count);
int64_t largest_of(const int64_t *numbers, int64_t count); /* -1 of none */
int64_t *starts_of(const int64_t *groups, int64_t count, int64_t n); /* (n + 1,) */

/* graphs.c */
typedef struct {
    int64_t n, entries, *indptr, *indices;
} graph;
/* The arguments of the core that a graph is, and that parallelograms are. */
#define ROWS_OF(g)                                                                                 \
    shorts_of((g).indptr, (g).n + 1), (g).n, shorts_of((g).indices, (g).entries), (g).entries
#define PARALLELOGRAMS_OF(e)                                                                       \
    shorts_of((e)->first, (e)->near.n + 1), shorts_of((e)->corners, 3 * (e)->count), (e)->count
typedef struct {
    graph near;
    int64_t count; /* of the parallelograms */
    int64_t *first, *corners, *within;
} elements;
int64_t after_in_face(int64_t h);
graph graph_of_pairs(const int64_t *a, const int64_t *b, int64_t count, int64_t n);
graph graph_of_faces(const int64_t *faces, int64_t m, int64_t n);
int64_t *opposite_of(const int64_t *faces, int64_t m);
elements elements_of(graph near, const int64_t *faces, int64_t m, const int64_t *quads,
                     int64_t quad_count, const int64_t *opposite);
elements without_parallelograms(graph near);
elements among(elements all, const int64_t *keep);

/* structure.c, wedges.c, polygons.c */
typedef struct {
    int64_t count, isolated, used; /* of points */
    int64_t n, m, *faces, *opposite; /* of the manifold */
    int64_t *points; /* of its vertices */
    uint8_t *reversed;
    int64_t repeats, *repeated, *against, degenerates, *degenerate;
    int trivial;
    int64_t triangles, *of_points; /* the complex: triangles over points */
    int64_t vertices, *triangle, *point; /* triangles over vertices; the point of each vertex */
    int has_split;
    int64_t *merged; /* NULL without POLY */
    int64_t polygons, corner_count, *corners, *offsets, *of_corners;
} structure;
typedef struct {
    int64_t length, *rank, *of, *bounds, *ring, *spoke, *closing, *like, *kind;
} corner_rings;
void decode_structure(const container *file, structure *s);
corner_rings corners_of(const structure *s);
int64_t decode_wedges(dm_coder *c, const structure *s, const corner_rings *r, int64_t *wedges);
void decode_polygons(bytes payload, structure *s);
void find_outlines(structure *s);
elements surface_of(const structure *s);
elements vertices_of(const structure *s, const elements *surface);
elements polygons_of(const structure *s);

/* streams.c */
int64_t *decode_labels(bytes payload, graph near, int64_t *count);
int64_t *decode_vectors(bytes payload, graph near);
int64_t *decode_three(bytes payload, const elements *e);
int64_t *decode_exact(bytes payload, const elements *e, int *width);

/* geometry.c, attributes.c, parts.c, order.c, poses.c */
void decode_geometry(const container *file, const structure *s, const elements *surface);
void decode_attributes(bytes payload, const structure *s, const elements *surface);
void decode_parts(bytes payload, const structure *s);
void decode_order(bytes payload, const structure *s);
void decode_poses(bytes payload, graph near, const int64_t *anchors, int64_t k);

/* decode.c: whether a file is decoded to its end; else `reason` says why it is not. */
int decode(const uint8_t *data, size_t size);

/* What is told of decoded integers, nothing by default: see `replay.c`. */
extern void (*tell)(const char *what, const int64_t *numbers, int64_t count);

#endif
