/* What the benchmarks of firmware share: printing on the UART, and a clock: cycles on AVR, instructions on Cortex-M. */
#ifndef FIRMWARE_BENCH_H
#define FIRMWARE_BENCH_H

#include "../../examples/firmware/board.h"

#include <stdint.h>

static void print(const char *text)
{
    for (; *text != 0; ++text)
        while (!board_uart_write((unsigned char)*text))
            ;
}

/* At the right of so many places. */
static void print_number(uint32_t number, int width)
{
    char text[12];
    int at = sizeof text - 1;

    text[at] = 0;
    do {
        text[--at] = (char)('0' + number % 10u);
        number /= 10u;
    } while (number > 0);
    for (width -= (int)sizeof text - 1 - at; width > 0; --width)
        print(" ");
    print(text + at);
}

#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

static volatile uint16_t overflows;

ISR(TIMER1_OVF_vect)
{
    ++overflows;
}

/* Timer 1 counts, and nothing else interrupts. */
static void clock_init(void)
{
    TIMSK0 = 0;
    TCCR1A = 0;
    TCCR1B = _BV(CS10);
    TIMSK1 = _BV(TOIE1);
    sei();
}

/* Cycles, beyond the 16 bits of the timer. */
static uint32_t ticks(void)
{
    uint16_t low, high;

    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        low = TCNT1;
        high = overflows;
        if ((TIFR1 & _BV(TOV1)) && low < 0x8000u)
            ++high;
    }
    return (uint32_t)high << 16 | low;
}

/* Ends the simulation. */
static void stop(void)
{
    cli();
    for (;;)
        __asm__ volatile("sleep");
}

#else

#define REGISTER(address) (*(volatile uint32_t *)(address))

/* At 200 MHz, which this chip only has in the emulator, a tick of the timer is five nanoseconds: five instructions. */
#define TICK 5u

static void clock_init(void)
{
    REGISTER(0xE000E010u) = 0;
    REGISTER(0x400FE060u) = 1u << 22; /* RCC: system clock divided by 1 */
    REGISTER(0xE000E014u) = 0xFFFFFFu;
    REGISTER(0xE000E018u) = 0;
    REGISTER(0xE000E010u) = 5u;
}

/* Instructions, in QEMU that takes a nanosecond for each. */
static uint32_t ticks(void)
{
    static uint32_t before, sum;
    uint32_t now = 0xFFFFFFu - REGISTER(0xE000E018u);

    sum += (now - before) & 0xFFFFFFu;
    before = now;
    return sum * TICK;
}

/* Ends QEMU, by semihosting. */
static void stop(void)
{
    register uint32_t operation __asm__("r0") = 0x18;
    register uint32_t reason __asm__("r1") = 0x20026;

    __asm__ volatile("bkpt 0xAB" : : "r"(operation), "r"(reason) : "memory");
    for (;;)
        ;
}

#endif

#endif
