/* C11: what the layouts of the headers' structs are asserted with, as src/ffi asserts them. */
#ifndef LAYOUT_H
#define LAYOUT_H

#include <stddef.h>

#define UP(value, type) (((value) + _Alignof(type) - 1) / _Alignof(type) * _Alignof(type))
#define SAME(a, b) _Static_assert((a) == (b), #a " is not " #b)
#define AT(type, field, place) SAME(offsetof(struct type, field), place)

#define LONG sizeof(unsigned long)
#define INT sizeof(int)
#define SHORT sizeof(unsigned short)
#define POINTER sizeof(void *)

#endif
