/* Vector table and reset: sets up memory for C and calls main(). */
#include <stdint.h>

extern uint32_t data_load[], data_start[], data_end[], bss_start[], bss_end[], stack_top[];

int main(void);
void reset_handler(void);
void systick_handler(void);
void uart0_handler(void);

static void stop(void)
{
    for (;;)
        ;
}

/* Without it a hard-float program faults at its first float: the unit is off after reset. */
static void enable_fpu(void)
{
#ifdef __ARM_FP
    volatile uint32_t *cpacr = (volatile uint32_t *)0xE000ED88u;

    *cpacr |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
#endif
}

void reset_handler(void)
{
    const uint32_t *from = data_load;
    uint32_t *to;

    for (to = data_start; to < data_end; ++to)
        *to = *from++;
    for (to = bss_start; to < bss_end; ++to)
        *to = 0;
    enable_fpu();
    main();
    stop();
}

typedef void (*handler_t)(void);

struct vectors {
    const void *stack;
    handler_t core[15];
    handler_t devices[6]; /* the first interrupts of the chip: UART0 is number 5 */
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    stack_top,
    {
        reset_handler, stop, stop, stop, stop, stop, 0, 0, 0, 0, stop, stop, 0, stop, systick_handler,
    },
    {stop, stop, stop, stop, stop, uart0_handler},
};
