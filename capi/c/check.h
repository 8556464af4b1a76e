/* The program and what it runs on: `board.c` under QEMU, `host.c` as a process. */
#ifndef CHECK_H
#define CHECK_H

#include <stddef.h>
#include <stdint.h>

void say(const char *text);
void say_hex(const char *name, uint64_t value);

/* Holds the library against a blob in its slot and the vector file for it, which
 * is aligned to 4 bytes. 0 if nothing is wrong. */
int check(const uint8_t *slot, size_t size, const uint8_t *vectors);

#endif
