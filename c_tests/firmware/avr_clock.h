/* Cycles since timer 1 was started, beyond its 16 bits. */
#ifndef AVR_CLOCK_H
#define AVR_CLOCK_H

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdint.h>
#include <util/atomic.h>

static volatile uint16_t overflows;

ISR(TIMER1_OVF_vect)
{
    ++overflows;
}

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

#endif
