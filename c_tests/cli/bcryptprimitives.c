/* bcryptprimitives.dll for wine 8, which has none: what Rust's std takes from it. */
#include <stddef.h>

/* RtlGenRandom */
__declspec(dllimport) unsigned char __stdcall SystemFunction036(void *out, unsigned long count);

__declspec(dllexport) int ProcessPrng(unsigned char *out, size_t count);

int ProcessPrng(unsigned char *out, size_t count)
{
    return SystemFunction036(out, (unsigned long)count);
}
