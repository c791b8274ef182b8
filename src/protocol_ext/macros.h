/** Major version of the library that this header belongs to; dp_version() returns that of the one that is linked. */
#define DP_VERSION_MAJOR @VERSION_MAJOR@
/** Its minor version. */
#define DP_VERSION_MINOR @VERSION_MINOR@
/** Its patch level. */
#define DP_VERSION_PATCH @VERSION_PATCH@
/** All of them, as dp_version() spells them. */
#define DP_VERSION_STRING "@VERSION@"
