/* What the harness makes of files: `replay FILE...` prints a line of each array that it decodes, its
   name and its numbers, then why the file is refused, if it is. The sizes of files have no bounds
   here, and every stream has to end where it should. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz.h"

static void print(const char *what, const int64_t *numbers, int64_t count)
{
    printf("%s", what);
    for (int64_t i = 0; i < count; i++)
        printf(" %" PRId64, numbers[i]);
    printf("\n");
}

int main(int count, char **names)
{
    allowed = (limits){.vertices = 1 << 16, .faces = 1 << 16, .streams = 1 << 10, .bits = INT64_MAX, .strict = 1};
    tell = print;
    for (int i = 1; i < count; i++) {
        static uint8_t data[1 << 20];
        FILE *const file = fopen(names[i], "rb");
        if (file == NULL) {
            perror(names[i]);
            return 1;
        }
        const size_t size = fread(data, 1, sizeof(data), file);
        fclose(file);
        printf("FILE %s\n", names[i]);
        if (!decode(data, size))
            printf("REFUSED %s\n", reason);
    }
    return 0;
}
