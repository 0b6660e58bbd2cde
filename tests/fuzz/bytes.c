/* Bytes of a container and of its sections. */
#include <string.h>

#include "fuzz.h"

const char SECTION_IDS[SECTIONS][5] = {"PARM", "CONN", "STCH", "COPY", "POLY", "STEP",
                                       "ANCH", "DELT", "NORM", "CART", "EXAC", "CELL",
                                       "FIXS", "ATTR", "PART", "ORDR", "POSE", "FILL",
                                       "FRAM", "meta", "CHEK"};

int64_t left_of(const bytes *from) { return from->end - from->at; }

bytes read_bytes(bytes *from, int64_t size)
{
    require(size >= 0 && size <= left_of(from), "truncated");
    const bytes found = {from->at, from->at + size};
    from->at = found.end;
    return found;
}

uint8_t read_byte(bytes *from) { return *read_bytes(from, 1).at; }

int64_t read_varint(bytes *from)
{
    uint64_t value = 0;
    for (int i = 0; i < 9; i++) {
        const uint8_t byte = read_byte(from);
        value |= (uint64_t)(byte & 0x7F) << 7 * i;
        if (byte < 0x80) {
            require(byte > 0 || i == 0, "a varint that is longer than it needs to be");
            return (int64_t)value;
        }
    }
    refuse("a varint of more than 9 bytes");
}

/* A number of up to eight bytes without a sign; the highest bit of eight is that of a sign. */
int64_t read_little(bytes *from, int size)
{
    const bytes found = read_bytes(from, size);
    uint64_t value = 0;
    for (int i = 0; i < size; i++)
        value |= (uint64_t)found.at[i] << 8 * i;
    return (int64_t)value;
}

static void read_parameters(container *file)
{
    bytes p = file->sections[PARM];
    file->method = read_byte(&p);
    file->interpolated = (read_byte(&p) & 4) != 0;
    file->anchor_method = read_byte(&p);
    const uint8_t bits = read_byte(&p);
    const int64_t step = read_little(&p, 8); /* the bits of a double */
    read_bytes(&p, 4 * 8 + 4 + 2);
    file->anchor_count = read_varint(&p);
    file->isolated = read_varint(&p);
    file->seed = file->anchor_method == 1 ? (uint64_t)read_little(&p, 8) : 0;
    const int anchored = file->method == 0 || file->method == 2;
    require(left_of(&p) == 0 && file->method <= 3, "PARM");
    require(anchored ? file->anchor_method <= 2 : file->anchor_method == 255, "anchor method");
    require(file->anchor_count <= file->vertices && file->isolated <= file->vertices, "counts");
    require(anchored || file->anchor_count == 0, "anchors without a method");
    file->has_step = step != 0;
    const int stepless = file->method == 3 || (file->method == 0 && bits == 0);
    require(file->has_step == !stepless && step >= 0, "step");
    require(!file->interpolated || (anchored && !stepless), "interpolated anchors without deltas");
}

void read_container(container *file, const uint8_t *data, size_t size)
{
    static const uint8_t HEAD[] = {0x89, 'D', 'M', 'S', '\r', '\n', 0x1A, '\n', 4, 0, 0, 0};
    bytes from = {data, data + size};
    memset(file, 0, sizeof(*file));
    require(memcmp(read_bytes(&from, sizeof(HEAD)).at, HEAD, sizeof(HEAD)) == 0, "signature");
    file->vertices = read_varint(&from);
    file->triangles = read_varint(&from);
    require(file->vertices <= allowed.vertices && file->triangles <= allowed.faces, "limits");
    require(file->triangles > 0, "a mesh of 0 triangles");
    read_bytes(&from, 4); /* a checksum, whatever it is; so are those below */
    while (!file->sections[CHEK].at) {
        const bytes id = read_bytes(&from, 4);
        int k = 0;
        while (k < SECTIONS && memcmp(SECTION_IDS[k], id.at, 4) != 0)
            k++;
        const bytes payload = read_bytes(&from, read_varint(&from));
        read_bytes(&from, 4);
        if (k == SECTIONS) {
            require(id.at[0] >= 'a' && id.at[0] <= 'z', "an unknown section");
            continue;
        }
        require(!file->sections[k].at, "a section that comes a second time");
        file->sections[k] = payload;
    }
    require(left_of(&from) == 0, "bytes after the last section");
    require(file->sections[PARM].at && file->sections[CONN].at, "a section is missing");
    read_parameters(file);
}
