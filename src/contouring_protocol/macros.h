#include <stdint.h>
/* Programs written for the posted header may use u_int8_t and the like. */
#if defined(__AVR__) || defined(_WIN32)
typedef uint8_t u_int8_t;
typedef uint16_t u_int16_t;
typedef uint32_t u_int32_t;
#else
#include <sys/types.h>
#endif

/* Bits of axisMask. (They were lost from the post; bit i is axisPosition[i].) */
enum
{
  CPMask_x = 1,
  CPMask_y = 2,
  CPMask_z = 4,
  CPMask_a = 8,
  CPMask_b = 16,
  CPMask_c = 32,
  CPMask_velocity = 64
};

/* Indices of axisPosition. */
enum
{
  CPAxis_x = 0,
  CPAxis_y,
  CPAxis_z,
  CPAxis_a,
  CPAxis_b,
  CPAxis_c
};
