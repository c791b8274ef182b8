#include <stdint.h>

/* Bits of a vector's mask: 1 << i flags axes[i], which are x, y, z, a, b, c. */
#define GX_MASK_AXES 0x3F
#define GX_MASK_VELOCITY 0x40

/* Positions in steps: 28 bits. */
#define GX_POSITION_MIN (-134217728)
#define GX_POSITION_MAX 134217727

/** Words of a struct gx_commands and a struct gx_notices. */
#define GX_RECEIVER_WORDS (48 / sizeof(unsigned long))
/** Words of a struct gx_contour. */
#define GX_CONTOUR_WORDS (64 / sizeof(unsigned long))
