/** Words of a struct dp_serial. */
#define DP_SERIAL_WORDS (384 / sizeof(unsigned long))
