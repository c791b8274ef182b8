#include <stdint.h>


/* Bits of a vector's mask: 1 << i flags axes[i], which are x, y, z, a, b, c. */
#define GX_MASK_AXES 0x3F
#define GX_MASK_VELOCITY 0x40

/* Positions in steps: 28 bits. */
#define GX_POSITION_MIN (-134217728)
#define GX_POSITION_MAX 134217727
