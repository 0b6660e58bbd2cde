/* Order of the polygons of a mesh, and their rotations, in steps (`steps.h`). */
#include "graphs.h"
#include "rotation.h"

/* Polygons, a triangle that represents each of them, and the ranks of their vertices. */
typedef struct {
    const int64_t *faces;   /* (m, 3) */
    const int64_t *corners; /* of the polygons: polygon i has those from offsets[i] on */
    const int64_t *offsets, *within;
    int64_t *rank, *at; /* of each vertex, and the vertex of each rank */
    int64_t ranked;     /* how many have one */
    dm_remaining left;
    dm_rings rings;
    dm_rotations rotations;
} polygon_mesh;

static int64_t anchor_of(const polygon_mesh *m, int64_t face, int64_t rotation)
{
    return dm_anchor_corner(m->faces + 3 * face, m->rank, m->rotations.mode, rotation);
}

/* The last corner of a triangle up to a corner of its polygon, and how far that is. */
static int64_t split(const polygon_mesh *m, int64_t face, int64_t size, int64_t begin,
                     int64_t *distance)
{
    int64_t rotation = 0;
    *distance = size;
    for (int64_t j = 0; j < 3; j++) {
        const int64_t far = dm_rest(begin - m->within[3 * face + j], size);
        if (far < *distance)
            rotation = j, *distance = far;
    }
    return rotation;
}

/* Find the corners at `hub` of faces that are left and have it for an anchor. */
static int64_t find_at(const polygon_mesh *m, int64_t hub, int64_t *found)
{
    int64_t count = 0, e = m->rings.start[hub];
    for (int k = 0; k < DM_SCANNED && e >= 0 && count < DM_STEP_CANDIDATES; k++) {
        if (m->rotations.mode == DM_FIRST || anchor_of(m, e / 3, 0) == e % 3)
            found[count++] = e;
        e = m->rings.after[e];
        if (e == m->rings.start[hub])
            break;
    }
    return count;
}

/* How many corners of a face are among three vertices. */
static int64_t shared(const int64_t *face, const int64_t *others)
{
    int64_t count = 0;
    for (int j = 0; j < 3; j++)
        count += face[j] == others[0] || face[j] == others[1] || face[j] == others[2];
    return count;
}

/* 1 if ranks differ as those of an earlier face do, from some corner of it; else 0. */
static int64_t is_like(const int64_t *rank, const int64_t *others, int64_t a, int64_t b, int64_t d)
{
    for (int j = 0; j < 3; j++) {
        if (others[j] < 0)
            continue;
        const int64_t e = rank[others[j]];
        const int64_t f = rank[others[(j + 1) % 3]], g = rank[others[(j + 2) % 3]];
        if (f - e == b - a && g - e == d - a)
            return 1;
    }
    return 0;
}

/* Code which of the corners found is meant, one bit for each but the last. */
static int64_t choose(dm_coder *c, dm_steps *s, const polygon_mesh *m, const int64_t *found,
                      int64_t count, int64_t corner)
{
    const dm_rotations *const r = &m->rotations;
    for (int64_t k = 0; k < count; k++) {
        const int64_t *const face = m->faces + 3 * (found[k] / 3);
        const int64_t j = found[k] % 3, a = m->rank[face[j]];
        const int64_t b = dm_rank_of(m->rank, face[(j + 1) % 3]);
        const int64_t d = dm_rank_of(m->rank, face[(j + 2) % 3]);
        const int64_t fresh = (b > a + DM_LARGEST_RANK) + (d > a + DM_LARGEST_RANK);
        const int64_t third = (b < d) == (r->mode == DM_NEWEST) ? b : d;
        if (k < count - 1) {
            const int64_t both = shared(face, r->recent[0]), before = shared(face, r->recent[1]);
            const int64_t alike = is_like(m->rank, r->recent[0], a, b, d) +
                                  2 * is_like(m->rank, r->recent[1], a, b, d);
            const int64_t lead = third < DM_LARGEST_RANK ? dm_near(third, s->choice) : 6;
            const int64_t at[] = {
                CHOOSE + 12 * both + 3 * before + fresh,
                CHOOSE + DM_CHOOSE_SIZE + 12 * lead + 3 * both + fresh,
                CHOOSE + 2 * DM_CHOOSE_SIZE + 16 * lead + 4 * alike + dm_min(k, 3),
            };
            if (!dm_code_bit(c, found[k] == corner, DM_CHOOSE_VERTEX_MIXER, at))
                continue;
        }
        s->choice = dm_min(third, DM_LARGEST_RANK);
        return found[k];
    }
    return -1;
}

/* Take a polygon away that begins at a corner, and give ranks to the vertices that it uses first. */
static void take(polygon_mesh *m, int64_t face, int64_t begin)
{
    const int64_t first = m->offsets[face], size = m->offsets[face + 1] - first;
    int64_t(*const recent)[3] = m->rotations.recent;
    dm_take_away(&m->left, face);
    for (int64_t j = 0; j < 3; j++) {
        recent[1][j] = recent[0][j];
        dm_take_off(&m->rings, m->faces[3 * face + j], 3 * face + j);
    }
    for (int64_t j = 0; j < size; j++) {
        const int64_t v = m->corners[first + (begin + j) % size];
        if (j < 3)
            recent[0][j] = v;
        if (m->rank[v] < 0) {
            m->rank[v] = m->ranked;
            m->at[m->ranked++] = v;
        }
    }
}

static int are_polygons(const polygon_mesh *m, int64_t count, int64_t corner_count, int64_t n)
{
    int good = dm_are_bounds(m->offsets, count, corner_count) &&
               dm_all_in(m->corners, corner_count, 0, n) && dm_all_in(m->faces, 3 * count, 0, n) &&
               dm_all_in(m->rank, n, -1, n);
    for (int64_t i = 0; good && i < count; i++) {
        const int64_t size = m->offsets[i + 1] - m->offsets[i];
        good = size >= 3 && dm_all_in(m->within + 3 * i, 3, 0, size);
        for (int j = 0; good && j < 3; j++)
            good = m->corners[m->offsets[i] + m->within[3 * i + j]] == m->faces[3 * i + j];
    }
    return good;
}

/* Note the vertex of each rank; return whether all ranks below `ranked`, and no others, are there. */
static int are_ranks(const polygon_mesh *m, int64_t n)
{
    int64_t count = 0;
    for (int64_t k = 0; k < n; k++)
        m->at[k] = -1;
    for (int64_t v = 0; v < n; v++) {
        if (m->rank[v] < 0)
            continue;
        if (m->rank[v] >= m->ranked || m->at[m->rank[v]] >= 0)
            return 0;
        m->at[m->rank[v]] = v;
        count++;
    }
    return count == m->ranked;
}

/* Code which polygon comes when, `order` (m,), and at which corner it begins, `rotations` (m,).

   Both are filled in when decoding. The vertices of polygon i are corners[offsets[i]] to
   corners[offsets[i + 1]]; a triangle represents it, `faces` (m, 3), at whose corners are those by
   `within` (m, 3). `rank` (n,) has the ranks of the vertices, -1 without one; `ranked` have one, and
   the others get the next ones as polygons come to use them. The anchor of a polygon is its FIRST
   vertex, or the OLDEST or NEWEST of those with a rank. At most `stop` polygons are coded. Scratch:
   at (n,); sums, onwards (m + 1,); after, before (3 m,); start (n,). */
int dm_code_faces(dm_coder *c, const int64_t *faces, int64_t m, const int64_t *corners,
                  int64_t corner_count, const int64_t *offsets, const int64_t *within,
                  int64_t *rank, int64_t n, int64_t ranked, int64_t mode, int64_t *order,
                  int64_t *rotations, int64_t margin, int64_t stop, int64_t *at, int64_t *sums,
                  int64_t *onwards, int64_t *after, int64_t *before, int64_t *start)
{
    polygon_mesh mesh = {
        .faces = faces,
        .corners = corners,
        .offsets = offsets,
        .within = within,
        .rank = rank,
        .at = at,
        .ranked = ranked,
        .left = {m, sums, onwards},
        .rings = {after, before, start},
        .rotations = {.rank = rank, .mode = mode, .recent = {{-1, -1, -1}, {-1, -1, -1}}},
    };
    if (!dm_has_memory(c, STEPS_SLOTS, DM_STEPS_MIXERS) || mode < DM_FIRST || mode > DM_NEWEST ||
        !are_polygons(&mesh, m, corner_count, n) || !are_ranks(&mesh, n))
        return DM_INVALID;
    dm_all_of(m, sums, onwards);
    dm_rings_of(faces, 3 * m, n, after, before, start);
    dm_steps s = {0};
    int64_t found[DM_STEP_CANDIDATES], previous = -1;
    for (int64_t i = 0; i < dm_min(m, stop); i++) {
        int64_t face = -1, rotation = 0, skipped = 0, corner = 0, anchor = 0;
        int64_t step = DM_STEP_NEXT, trail = -1;
        const int64_t following = dm_first_left(&mesh.left, previous + 1);
        if (!c->decoding) {
            face = order[i];
            if (face < 0 || face >= m || onwards[face] != face)
                return DM_INVALID;
            const int64_t size = offsets[face + 1] - offsets[face];
            rotation = split(&mesh, face, size, rotations[i], &skipped);
            corner = anchor_of(&mesh, face, rotation);
            anchor = rank[faces[3 * face + corner]];
        }
        if (!c->decoding && face != following) {
            step = DM_STEP_ANY;
            trail = anchor >= 0 ? dm_trail_of(&s, anchor, m - i, margin) : -1;
            if (trail >= 0) {
                const int64_t count = find_at(&mesh, at[anchor], found);
                if (dm_index_of(found, count, 3 * face + corner) >= 0)
                    step = DM_STEP_NEAR;
            }
        }
        const int64_t follows = shared(faces + 3 * following, mesh.rotations.recent[0]);
        step = dm_code_step(c, step, &s, follows, mesh.ranked > 0);
        if (step == DM_STEP_NEXT) {
            face = following;
        } else if (step == DM_STEP_NEAR) {
            anchor = dm_code_anchor(c, anchor, trail, &s);
            if (anchor < 0 || anchor >= mesh.ranked)
                return DM_CORRUPT;
            const int64_t count = find_at(&mesh, at[anchor], found);
            if (count == 0)
                return DM_CORRUPT;
            const int64_t chosen = choose(c, &s, &mesh, found, count, 3 * face + corner);
            face = chosen / 3;
            if (mode == DM_FIRST)
                rotation = chosen % 3;
        } else {
            face = dm_code_any(c, &mesh.left, face, m - i);
        }
        const int64_t *const vertices = faces + 3 * face;
        if (step != DM_STEP_NEAR || mode != DM_FIRST)
            rotation = dm_code_rotation(c, &mesh.rotations, vertices, rotation);
        const int64_t size = offsets[face + 1] - offsets[face];
        const int64_t *const places = within + 3 * face;
        int64_t begin = places[rotation];
        const int64_t gap = dm_rest(places[(rotation + 1) % 3] - begin, size);
        if (gap > 1)
            begin += dm_code_skipped(c, &mesh.rotations, corners + offsets[face], size, begin, gap,
                                     skipped);
        order[i] = face, rotations[i] = begin % size;
        take(&mesh, face, begin);
        dm_follow(&s, rank[vertices[anchor_of(&mesh, face, rotation)]]);
        previous = face;
    }
    return DM_OK;
}
