/*
 * Start-up code for the C tests on a Cortex-M in QEMU. Newlib's semihosting prints, and ends the emulator with main's
 * result.
 */
#include <stdlib.h>

extern char bss_start[], bss_end[], stack_top[];
void initialise_monitor_handles(void);
int main(void);

static void reset(void)
{
    char *place;
    for (place = bss_start; place < bss_end; ++place)
        *place = 0;
    initialise_monitor_handles();
    exit(main());
}

__attribute__((section(".vectors"), used)) static void *const vectors[] = {stack_top, (void *)reset};
