/*
 * UART0 (pins PA0, PA1) and SysTick of a TM4C123 or an LM3S6965, straight from reset: both run on their internal
 * oscillator. Register names are those of the TM4C123GH6PM data sheet.
 */
#include "../board.h"
#include "../fifo.h"

#include <stdint.h>

/* The internal oscillator: 16 MHz on the TM4C123. The LM3S6965 has 12 MHz: build with -DCLOCK_HZ=12000000. */
#ifndef CLOCK_HZ
#define CLOCK_HZ 16000000u
#endif
#define BAUD 115200u

#define REGISTER(address) (*(volatile uint32_t *)(address))

#define RCGC1 REGISTER(0x400FE104u) /* clocks of UARTs and timers, of the GPIO ports: both chips have these */
#define RCGC2 REGISTER(0x400FE108u)

#define GPIOAFSEL REGISTER(0x40004420u)
#define GPIODEN REGISTER(0x4000451Cu)
#ifdef PART_TM4C
#define GPIOPCTL REGISTER(0x4000452Cu)
#endif

#define UARTDR REGISTER(0x4000C000u)
#define UARTFR REGISTER(0x4000C018u)
#define UARTFR_RXFE (1u << 4)
#define UARTFR_TXFF (1u << 5)
#define UARTIBRD REGISTER(0x4000C024u)
#define UARTFBRD REGISTER(0x4000C028u)
#define UARTLCRH REGISTER(0x4000C02Cu)
#define UARTLCRH_FEN (1u << 4)
#define UARTLCRH_8BITS (3u << 5)
#define UARTCTL REGISTER(0x4000C030u)
#define UARTCTL_UARTEN (1u << 0)
#define UARTCTL_TXE (1u << 8)
#define UARTCTL_RXE (1u << 9)
#define UARTIM REGISTER(0x4000C038u)
#define UARTICR REGISTER(0x4000C044u)
#define UART_RX (1u << 4) /* the FIFO has reached its level */
#define UART_RT (1u << 6) /* bytes below that level have been waiting */
#define UART0_IRQ 5

#define NVIC_EN0 REGISTER(0xE000E100u)
#define SYST_CSR REGISTER(0xE000E010u)
#define SYST_RVR REGISTER(0xE000E014u)
#define SYST_CVR REGISTER(0xE000E018u)

void systick_handler(void);
void uart0_handler(void);

static volatile unsigned int milliseconds;

void systick_handler(void)
{
    ++milliseconds;
}

unsigned int board_ms(void)
{
    return milliseconds;
}

void board_init(void)
{
    const uint32_t divisor = (CLOCK_HZ * 4u + BAUD / 2u) / BAUD; /* in 64ths of what 16 samples a bit take */

    RCGC1 |= 1u;
    RCGC2 |= 1u;
    (void)RCGC2; /* a port may be touched three clocks after it got one */
    (void)RCGC2;
    GPIOAFSEL |= 3u;
    GPIODEN |= 3u;
#ifdef PART_TM4C
    GPIOPCTL |= 0x11u;
#endif

    UARTCTL = 0;
    UARTIBRD = divisor / 64u;
    UARTFBRD = divisor % 64u;
    UARTLCRH = UARTLCRH_8BITS | UARTLCRH_FEN;
    UARTCTL = UARTCTL_UARTEN | UARTCTL_TXE | UARTCTL_RXE;
#ifdef UART_INTERRUPT
    UARTIM = UART_RX | UART_RT;
    NVIC_EN0 = 1u << UART0_IRQ;
#endif

    SYST_RVR = CLOCK_HZ / 1000u - 1u;
    SYST_CVR = 0;
    SYST_CSR = 7u; /* the core's clock, interrupt, on */
}

#ifdef UART_INTERRUPT

static struct fifo received;

void uart0_handler(void)
{
    UARTICR = UART_RX | UART_RT;
    while (!(UARTFR & UARTFR_RXFE))
        fifo_put(&received, (unsigned char)UARTDR);
}

int board_uart_read(void)
{
    return fifo_get(&received);
}

#else

void uart0_handler(void)
{
}

int board_uart_read(void)
{
    if (UARTFR & UARTFR_RXFE)
        return -1;
    return (int)(UARTDR & 0xFFu);
}

#endif

int board_uart_write(unsigned char byte)
{
    if (UARTFR & UARTFR_TXFF)
        return 0;
    UARTDR = byte;
    return 1;
}
