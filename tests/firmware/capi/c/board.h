#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

void say(const char *text);
void say_hex(const char *name, uint64_t value);

#endif
