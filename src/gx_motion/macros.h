/** Words of a struct gx_motion. A queued move takes fewer bytes on AVR, where structs have no padding. */
#ifdef __AVR__
#define GX_MOTION_WORDS ((175 + 30 * GX_QUEUE_MAX) / sizeof(unsigned long))
#else
#define GX_MOTION_WORDS ((192 + 32 * GX_QUEUE_MAX) / sizeof(unsigned long))
#endif
