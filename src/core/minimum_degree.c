/* Order of elimination of a symmetric system by approximate minimum degree.

   An eliminated unknown becomes an element: the unknowns that its elimination connects with each
   other. The lists of an unknown have the elements that it is in, then its neighbours by entries of
   the matrix that no element covers. Unknowns with the same lists are one from then on.

   Source: P. R. Amestoy, T. A. Davis, I. S. Duff, "An approximate minimum degree ordering
   algorithm", SIAM J. Matrix Anal. Appl. 17, 1996. */
#include <math.h>

#include "deltamesh_core.h"
#include "graphs.h"
#include "integers.h"

/* Unknowns with more neighbours than that, times the root of the count, come last. */
enum { DENSE = 10 };

typedef struct {
    int64_t n, used;
    int64_t *lists;             /* of unknowns and elements, with holes */
    int64_t *begin, *length;    /* of the list of each */
    int64_t *elements;          /* the first of an unknown's list; -1: is no unknown any more */
    int64_t *live;              /* whether an element is in use */
    int64_t *weight;            /* unknowns in one; 0: in another; negative: of the new element */
    int64_t *degree;            /* at most so many neighbours; unknowns of an element */
    int64_t *outside;           /* since `stamp`: unknowns of an element outside the new one */
    int64_t *head, *next, *previous; /* unknowns by their degree; next: in a bucket, too */
    int64_t *bucket, *seen;     /* of unknowns with one sum of their lists; marks */
    int64_t *member, *last;     /* unknowns that are in one, a chain */
    int64_t stamp, marks;
} quotient;

enum { ARRAYS = 14 };

static void insert(const quotient *q, int64_t i)
{
    const int64_t first = q->head[q->degree[i]];
    q->next[i] = first;
    q->previous[i] = -1;
    if (first >= 0)
        q->previous[first] = i;
    q->head[q->degree[i]] = i;
}

static void take_out(const quotient *q, int64_t i)
{
    if (q->next[i] >= 0)
        q->previous[q->next[i]] = q->previous[i];
    if (q->previous[i] >= 0)
        q->next[q->previous[i]] = q->next[i];
    else
        q->head[q->degree[i]] = q->next[i];
}

/* Let an unknown be in another from now on. */
static void join(const quotient *q, int64_t into, int64_t i)
{
    q->weight[i] = 0;
    q->member[q->last[into]] = i;
    q->last[into] = q->last[i];
}

/* Move all lists in use to the beginning. */
static void close_holes(quotient *q)
{
    int64_t to = 0;
    for (int64_t i = 0; i < q->n; i++) {
        if ((q->weight[i] != 0 || q->live[i]) && q->length[i] > 0) {
            const int64_t first = q->lists[q->begin[i]];
            q->lists[q->begin[i]] = -1 - i;
            q->begin[i] = first;
        }
    }
    for (int64_t at = 0; at < q->used;) {
        if (q->lists[at] >= 0) {
            at++;
            continue;
        }
        const int64_t i = -1 - q->lists[at];
        q->lists[at] = q->begin[i];
        q->begin[i] = to;
        for (int64_t k = 0; k < q->length[i]; k++)
            q->lists[to++] = q->lists[at++];
    }
    q->used = to;
}

/* Add an unknown to the new element, at the end of the lists, if it is not there yet. */
static int64_t add(quotient *q, int64_t i)
{
    const int64_t weight = q->weight[i];
    if (weight <= 0)
        return 0;
    q->weight[i] = -weight;
    q->lists[q->used++] = i;
    take_out(q, i);
    return weight;
}

/* Make an element of an unknown, which absorbs the elements that it was in. */
static void make_element(quotient *q, int64_t pivot)
{
    const int64_t old = q->begin[pivot], end = old + q->length[pivot];
    const int64_t neighbours = old + q->elements[pivot], start = q->used;
    int64_t size = 0;
    for (int64_t at = old; at < neighbours; at++) {
        const int64_t e = q->lists[at];
        if (!q->live[e])
            continue;
        for (int64_t k = q->begin[e]; k < q->begin[e] + q->length[e]; k++)
            size += add(q, q->lists[k]);
        q->live[e] = 0;
    }
    for (int64_t at = neighbours; at < end; at++)
        size += add(q, q->lists[at]);
    q->begin[pivot] = start;
    q->length[pivot] = q->used - start;
    q->live[pivot] = 1;
    q->degree[pivot] = size;
}

/* Count for each element how many of its unknowns are outside the new one. */
static void count_outside(quotient *q, int64_t pivot)
{
    q->stamp += q->n + 1;
    for (int64_t k = q->begin[pivot]; k < q->begin[pivot] + q->length[pivot]; k++) {
        const int64_t i = q->lists[k];
        for (int64_t at = q->begin[i]; at < q->begin[i] + q->elements[i]; at++) {
            const int64_t e = q->lists[at];
            if (q->outside[e] < q->stamp)
                q->outside[e] = q->stamp + q->degree[e];
            q->outside[e] += q->weight[i];
        }
    }
}

/* Shorten the list of an unknown of the new element to what is not within it, and add it; return
   the sum of the list. The unknown had the pivot or an absorbed element in it: there is room. */
static int64_t shorten(const quotient *q, int64_t i, int64_t pivot)
{
    const int64_t begin = q->begin[i], middle = begin + q->elements[i];
    const int64_t end = begin + q->length[i];
    int64_t to = begin, degree = 0;
    uint64_t sum = 0;
    for (int64_t at = begin; at < middle; at++) {
        const int64_t e = q->lists[at], outside = q->outside[e] - q->stamp;
        if (!q->live[e])
            continue;
        if (outside == 0) {
            q->live[e] = 0;
            continue;
        }
        degree += outside;
        sum += (uint64_t)e;
        q->lists[to++] = e;
    }
    const int64_t elements = to - begin;
    for (int64_t at = middle; at < end; at++) {
        const int64_t j = q->lists[at];
        if (q->weight[j] > 0) {
            degree += q->weight[j];
            sum += (uint64_t)j;
            q->lists[to++] = j;
        }
    }
    q->lists[to] = q->lists[begin + elements];
    q->lists[begin + elements] = pivot;
    q->elements[i] = elements + 1;
    q->length[i] = to + 1 - begin;
    q->degree[i] = dm_min(q->degree[i], degree);
    return (int64_t)(sum % (uint64_t)q->n);
}

static int are_alike(const quotient *q, int64_t i, int64_t j)
{
    if (q->length[i] != q->length[j] || q->elements[i] != q->elements[j])
        return 0;
    for (int64_t at = q->begin[j]; at < q->begin[j] + q->length[j]; at++)
        if (q->seen[q->lists[at]] != q->marks)
            return 0;
    return 1;
}

/* Join the unknowns of a bucket that have the same lists, and empty it. */
static void join_alike(quotient *q, int64_t bucket)
{
    for (int64_t i = q->bucket[bucket]; i >= 0; i = q->next[i]) {
        if (q->weight[i] == 0)
            continue;
        q->marks++;
        for (int64_t at = q->begin[i]; at < q->begin[i] + q->length[i]; at++)
            q->seen[q->lists[at]] = q->marks;
        for (int64_t j = q->next[i]; j >= 0; j = q->next[j]) {
            if (q->weight[j] != 0 && are_alike(q, i, j)) {
                q->weight[i] += q->weight[j];
                join(q, i, j);
            }
        }
    }
    q->bucket[bucket] = -1;
}

/* Eliminate an unknown; return how many it stands for. */
static int64_t eliminate(quotient *q, int64_t pivot, int64_t left, int64_t *least)
{
    int64_t weight = q->weight[pivot];
    q->weight[pivot] = -weight;
    make_element(q, pivot);
    count_outside(q, pivot);
    const int64_t start = q->begin[pivot], end = start + q->length[pivot];
    for (int64_t k = start; k < end; k++) {
        const int64_t i = q->lists[k], sum = shorten(q, i, pivot);
        if (q->length[i] == 1) { /* it is nowhere else, and can go at once */
            weight -= q->weight[i];
            q->degree[pivot] += q->weight[i];
            join(q, pivot, i);
        } else {
            q->previous[i] = sum;
            q->next[i] = q->bucket[sum];
            q->bucket[sum] = i;
        }
    }
    for (int64_t k = start; k < end; k++)
        if (q->weight[q->lists[k]] != 0)
            join_alike(q, q->previous[q->lists[k]]);
    q->used = start;
    for (int64_t k = start; k < end; k++) {
        const int64_t i = q->lists[k], own = -q->weight[i];
        if (own == 0)
            continue;
        q->weight[i] = own;
        q->degree[i] = dm_min(q->degree[i] + q->degree[pivot] - own, left - weight - own);
        insert(q, i);
        *least = dm_min(*least, q->degree[i]);
        q->lists[q->used++] = i;
    }
    q->length[pivot] = q->used - start;
    q->weight[pivot] = 0;
    return weight;
}

/* Fill in an order of elimination (n,) of a symmetric matrix, whose rows name no column twice.

   Scratch: lists (entries + n,), memory (14, n + 1). */
int dm_minimum_degree(const int64_t *indptr, int64_t n, const int64_t *indices, int64_t entries,
                      int64_t *order, int64_t *lists, int64_t *memory)
{
    if (!dm_is_matrix(indptr, n, indices, entries))
        return DM_INVALID;
    int64_t *arrays[ARRAYS];
    for (int64_t k = 0; k < ARRAYS; k++)
        arrays[k] = memory + k * (n + 1);
    quotient q = {
        n,         0,         lists,      arrays[0],  arrays[1],  arrays[2],  arrays[3],
        arrays[4], arrays[5], arrays[6],  arrays[7],  arrays[8],  arrays[9],  arrays[10],
        arrays[11], arrays[12], arrays[13], 0,          0,
    };
    const double root = DENSE * sqrt((double)n), dense = root > 100.0 ? root : 100.0;
    int64_t left = 0, least = 0, placed = 0, last = n;
    for (int64_t i = 0; i < n; i++) {
        const int is_dense = (double)(indptr[i + 1] - indptr[i]) > dense;
        q.weight[i] = is_dense ? 0 : 1;
        left += q.weight[i];
        q.outside[i] = q.seen[i] = q.head[i] = q.bucket[i] = q.member[i] = -1;
        q.last[i] = i;
        q.live[i] = q.elements[i] = q.length[i] = 0;
        if (is_dense)
            order[--last] = i;
    }
    for (int64_t i = 0; i < n; i++) {
        q.begin[i] = q.used;
        for (int64_t at = indptr[i]; at < indptr[i + 1] && q.weight[i] > 0; at++)
            if (indices[at] != i && q.weight[indices[at]] > 0)
                lists[q.used++] = indices[at];
        q.length[i] = q.degree[i] = q.used - q.begin[i];
        if (q.weight[i] > 0)
            insert(&q, i);
    }
    while (left > 0) {
        while (q.head[least] < 0)
            least++;
        const int64_t pivot = q.head[least];
        take_out(&q, pivot);
        if (q.used > entries)
            close_holes(&q);
        left -= eliminate(&q, pivot, left, &least);
        for (int64_t i = pivot; i >= 0; i = q.member[i])
            order[placed++] = i;
    }
    return DM_OK;
}
