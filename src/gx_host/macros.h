/** Words of a struct gx_host. */
#define GX_HOST_WORDS ((240 + 32 * GX_WINDOW_MAX) / sizeof(unsigned long))
