/* Region growing over a closed triangle mesh, one valence a vertex.

   Touma & Gotsman, "Triangle Mesh Compression", Graphics Interface 1998, with the choice of pivot of
   Alliez & Desbrun, "Valence-Driven Connectivity Encoding for 3D Meshes", Eurographics 2001: the
   front vertex with the fewest free edges grows next, the oldest of several, which keeps fronts
   convex and joins rare. Unlike both, joins need no stack of fronts: linking a pivot to any live
   node splits its front in two or, if the node is on another front, merges the two (a handle).

   The same functions encode and decode. Where the encoder looks at the mesh, the decoder reads. Each
   step adds one face, so that any stream ends after as many steps as there are faces. */
#include "graphs.h"
#include "halfedges.h"
#include "valence.h"

enum { DONE = -2 };

/* The mesh that is visited (nothing when decoding), and what is found. */
typedef struct {
    dm_coder *c;
    dm_front *front;
    dm_halfedge *halfedges; /* of the closed mesh: the vertex at which each starts; its opposite; the
                               node whose gate it is, or DONE in the first of a visited face */
    int64_t halfedge_count;
    dm_old_vertex *old; /* valence of each vertex; its new index, -1 before its visit */
    int64_t *faces;     /* (face_count, 3), the closed mesh in the order of the visit */
    int64_t face_count;
    dm_new_vertex *vertices;
    int64_t vertex_count;
    int64_t *starts; /* the half-edge with which each face begins; encoder only */
    int encoding;
    int64_t loop_start, loops; /* the first vertex of a loop; loops that are to come */
    dm_valence_model model;
} region;

static int is_done(const region *r, int64_t h) { return r->halfedges[h - h % 3].node == DONE; }

/* Add the face (a, b, c), which begins with the half-edge `start`. */
static void add_face(region *r, int64_t start, int64_t a, int64_t b, int64_t c)
{
    const int64_t f = r->front->face_count++;
    r->faces[3 * f] = a, r->faces[3 * f + 1] = b, r->faces[3 * f + 2] = c;
    if (r->encoding)
        r->starts[f] = start;
}

/* Link a to b across the half-edge `inner` (b to a) of the visited face. */
static void set_gate(region *r, int64_t a, int64_t b, int64_t behind, int64_t inner)
{
    int64_t gate = -1;
    if (r->encoding) {
        gate = r->halfedges[inner].opposite;
        r->halfedges[gate].node = a;
    }
    dm_link(r->front, a, b, behind, gate);
}

/* Note a vertex that was coded; return its node. There has to be room for it. */
static int64_t add_vertex(region *r, int64_t vertex, int64_t valence, int is_loop)
{
    const int64_t index = r->front->vertex_count++;
    r->vertices[index] = (dm_new_vertex){valence, -1, is_loop};
    if (r->encoding) {
        r->old[vertex].new_index = index;
        r->vertices[index].old_index = vertex;
    }
    return dm_new_node(r->front, index, dm_max(valence - 2, 0));
}

/* Code a vertex that is no loop's; return its node. */
static int64_t code_vertex(region *r, int64_t vertex, int64_t mixer)
{
    const int64_t degree = r->encoding ? r->old[vertex].degree : 0;
    return add_vertex(r, vertex, dm_code_valence(r->c, degree, &r->model, mixer), 0);
}

/* Code a vertex that closes a boundary loop; return its node. */
static int64_t code_loop(region *r, int64_t vertex)
{
    const int64_t degree = r->encoding ? r->old[vertex].degree : 1;
    return add_vertex(r, vertex, dm_code_count(r->c, degree, DM_OF_LOOP), 1);
}

/* Begin a component with a face; its three edges are the first front. */
static int begin(region *r, int64_t seed)
{
    const dm_node *const nodes = r->front->nodes;
    if (r->front->vertex_count + 3 > r->vertex_count)
        return DM_CORRUPT;
    const int64_t mixer = dm_seed_contexts(&r->model);
    int64_t n[3];
    for (int k = 0; k < 3; k++)
        n[k] = code_vertex(r, r->encoding ? r->halfedges[3 * seed + k].start : 0, mixer);
    const int64_t v[] = {nodes[n[0]].vertex, nodes[n[1]].vertex, nodes[n[2]].vertex};
    add_face(r, 3 * seed, v[0], v[1], v[2]);
    if (r->encoding)
        r->halfedges[3 * seed].node = DONE;
    set_gate(r, n[1], n[0], v[2], 3 * seed);
    set_gate(r, n[2], n[1], v[0], 3 * seed + 1);
    set_gate(r, n[0], n[2], v[1], 3 * seed + 2);
    return DM_OK;
}

/* Add the one face left at a node without free edges. */
static int close(region *r, int64_t node)
{
    dm_front *const front = r->front;
    const dm_node *const nodes = front->nodes;
    const int64_t before = nodes[node].predecessor, after = nodes[node].successor;
    const int64_t gate = nodes[before].gate;
    add_face(r, gate, nodes[before].vertex, nodes[node].vertex, nodes[after].vertex);
    if (r->encoding)
        r->halfedges[gate - gate % 3].node = DONE;
    dm_drop_node(front, node);
    if (nodes[after].successor == before) { /* the last face of a front */
        dm_drop_node(front, before);
        dm_drop_node(front, after);
        return nodes[before].free == 0 && nodes[after].free == 0 ? DM_OK : DM_CORRUPT;
    }
    if (nodes[before].free == 0 || nodes[after].free == 0)
        return DM_CORRUPT;
    dm_change_free(front, before, nodes[before].free - 1);
    dm_change_free(front, after, nodes[after].free - 1);
    set_gate(r, before, after, nodes[node].vertex, dm_previous(gate));
    return DM_OK;
}

/* Find the node of the vertex across a gate, and its free edges on the pivot's side.

   Walk around the vertex both ways at once, so that a vertex of high valence that is joined often
   costs the shorter way each time. */
static int find_target(const region *r, int64_t gate, int64_t *target, int64_t *side)
{
    const dm_halfedge *const halfedges = r->halfedges;
    int64_t left = dm_previous(gate), right = dm_next(gate);
    for (int64_t steps = 0; steps < r->halfedge_count; steps++) {
        left = dm_next(halfedges[left].opposite); /* leaves the vertex */
        if (is_done(r, halfedges[left].opposite)) {
            *target = halfedges[left].node, *side = steps;
            return *target >= 0 ? DM_OK : DM_INVALID;
        }
        right = dm_previous(halfedges[right].opposite); /* enters the vertex */
        if (is_done(r, halfedges[right].opposite)) {
            if (halfedges[right].node < 0)
                return DM_INVALID;
            *target = r->front->nodes[halfedges[right].node].successor;
            *side = r->front->nodes[*target].free - 2 - steps;
            return DM_OK;
        }
    }
    return DM_INVALID;
}

/* Add a face whose third vertex is on a front: split the node there in two, and relink. */
static int join(region *r, int64_t pivot, int64_t gate)
{
    dm_front *const front = r->front;
    const dm_node *const nodes = front->nodes;
    /* Of the nodes, as many as there are vertices are kept for these. */
    if (front->join_count >= front->capacity - r->vertex_count)
        return DM_CORRUPT;
    front->join_count++;
    const int64_t after = nodes[pivot].successor;
    int64_t target = -1, side = 0;
    if (r->encoding && find_target(r, gate, &target, &side) != DM_OK)
        return DM_INVALID;
    target = dm_code_target(r->c, front, pivot, target);
    if (target < 0 || target == pivot || target == after || target == nodes[pivot].predecessor ||
        target == nodes[after].successor)
        return DM_CORRUPT;
    const int64_t rest = nodes[target].free - 2;
    side = rest >= 0 ? dm_code_side(r->c, rest, side) : 0;
    if (side < 0 || rest < side)
        return DM_CORRUPT;
    add_face(r, gate, nodes[pivot].vertex, nodes[after].vertex, nodes[target].vertex);
    const int64_t second = dm_new_node(front, nodes[target].vertex, rest - side);
    dm_change_free(front, target, side);
    dm_change_free(front, pivot, nodes[pivot].free - 1);
    dm_change_free(front, after, nodes[after].free - 1);
    const int64_t before = nodes[target].predecessor;
    dm_link(front, before, second, nodes[before].behind, nodes[before].gate);
    set_gate(r, pivot, target, nodes[after].vertex, dm_previous(gate));
    set_gate(r, second, after, nodes[pivot].vertex, dm_next(gate));
    return DM_OK;
}

/* Add the face at the gate of a pivot. */
static int expand(region *r, int64_t pivot)
{
    dm_front *const front = r->front;
    const dm_node *const nodes = front->nodes;
    const int64_t after = nodes[pivot].successor;
    int64_t gate = 0, vertex = 0;
    if (nodes[after].free == 0)
        return DM_CORRUPT;
    if (r->encoding) {
        gate = nodes[pivot].gate;
        vertex = r->halfedges[dm_previous(gate)].start;
        r->halfedges[gate - gate % 3].node = DONE;
    }
    if (dm_code_join_flag(r->c, front, pivot, r->encoding && r->old[vertex].new_index >= 0))
        return join(r, pivot, gate);
    if (front->vertex_count == r->vertex_count)
        return DM_CORRUPT;
    const int64_t behind_pivot = nodes[after].vertex, behind_after = nodes[pivot].vertex;
    int64_t node;
    if (r->loops > 0 && dm_code_loop_flag(r->c, r->encoding && vertex >= r->loop_start)) {
        r->loops--;
        node = code_loop(r, vertex);
    } else {
        node = code_vertex(r, vertex, dm_gate_contexts(front, pivot, r->vertices, &r->model));
        r->model.recent[1] = r->model.recent[0];
        r->model.recent[0] = dm_min(r->vertices[nodes[node].vertex].valence, DM_VALENCE_CAP);
    }
    add_face(r, gate, nodes[pivot].vertex, nodes[after].vertex, nodes[node].vertex);
    dm_change_free(front, pivot, nodes[pivot].free - 1);
    dm_change_free(front, after, nodes[after].free - 1);
    set_gate(r, pivot, node, behind_pivot, dm_previous(gate));
    set_gate(r, node, after, behind_after, dm_next(gate));
    return DM_OK;
}

static int is_closed_mesh(const region *r, int64_t old_count)
{
    if (r->halfedge_count != 3 * r->face_count)
        return 0;
    for (int64_t h = 0; h < r->halfedge_count; h++) {
        const dm_halfedge *const one = &r->halfedges[h];
        if (one->start < 0 || one->start >= old_count || one->opposite < 0 ||
            one->opposite >= r->halfedge_count)
            return 0;
    }
    return 1;
}

/* Visit all faces.

   The half-edges and the old vertices are ignored when decoding. `front` is empty, with room for as
   many nodes as there are vertices, and joins. Vertices from `loop_start` on close boundary loops,
   of which there are `loops`. */
int dm_grow(dm_coder *c, dm_front *front, dm_halfedge *halfedges, int64_t halfedge_count,
            dm_old_vertex *old, int64_t old_count, int64_t *faces, int64_t face_count,
            dm_new_vertex *vertices, int64_t vertex_count, int64_t *starts, int64_t loops,
            int64_t loop_start)
{
    region r = {.c = c,
                .front = front,
                .halfedges = halfedges,
                .halfedge_count = halfedge_count,
                .old = old,
                .faces = faces,
                .face_count = face_count,
                .vertices = vertices,
                .vertex_count = vertex_count,
                .starts = starts,
                .encoding = !c->decoding,
                .loop_start = loop_start,
                .loops = loops};
    if (!dm_has_memory(c, VALENCE_SLOTS, DM_VALENCE_MIXERS) || front->node_count != 0 ||
        front->capacity < vertex_count || (r.encoding && !is_closed_mesh(&r, old_count)))
        return DM_INVALID;
    dm_set_prior(c);
    int64_t seed = 0;
    while (front->face_count < face_count) {
        const int64_t pivot = dm_pivot_of(front);
        int status;
        if (pivot < 0) {
            while (r.encoding && seed < face_count && halfedges[3 * seed].node == DONE)
                seed++;
            status = begin(&r, dm_min(seed, face_count - 1));
        } else if (front->nodes[pivot].free == 0) {
            status = close(&r, pivot);
        } else {
            status = expand(&r, pivot);
        }
        if (status != DM_OK)
            return status;
    }
    const int complete = dm_pivot_of(front) < 0 && front->vertex_count == vertex_count;
    return complete && r.loops == 0 ? DM_OK : DM_CORRUPT;
}
