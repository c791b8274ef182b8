/** Words of a receiver's room. */
#define DP_RECEIVER_WORDS ((DP_DATA_MAX_SIZE + 15 + sizeof(unsigned long)) / sizeof(unsigned long))
