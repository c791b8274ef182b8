/** Words of a struct gx_host. */
#define GX_HOST_WORDS ((272 + 32 * GX_WINDOW_MAX) / sizeof(unsigned long))
