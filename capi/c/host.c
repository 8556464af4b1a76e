/* `check BLOB VECTORS` as a process: the files as the board has them in memory. */

#include <stdio.h>
#include <stdlib.h>

#include "check.h"

#define SLOT_SIZE 4096

void say(const char *text)
{
    fputs(text, stdout);
}

/* The file at the front of at least `least` bytes; NULL if it cannot be read. */
static uint8_t *read_all(const char *path, size_t least)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        long end = ftell(file);
        size_t size = end > 0 ? (size_t)end : 0;
        bytes = calloc(size > least ? size : least, 1);
        rewind(file);
        if (bytes && fread(bytes, 1, size, file) != size) {
            free(bytes);
            bytes = NULL;
        }
    }
    if (file)
        fclose(file);
    if (!bytes)
        fprintf(stderr, "FAILED: cannot read %s\n", path);
    return bytes;
}

int main(int count, char **arguments)
{
    if (count != 3) {
        fputs("usage: check BLOB VECTORS\n", stderr);
        return 2;
    }
    uint8_t *slot = read_all(arguments[1], SLOT_SIZE);
    uint8_t *vectors = read_all(arguments[2], 0);
    int failed = slot && vectors ? check(slot, SLOT_SIZE, vectors) : 1;
    free(slot);
    free(vectors);
    return failed;
}
