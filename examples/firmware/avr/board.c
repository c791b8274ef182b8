/* USART0 and timer 0 of an ATmega (2560, 328P and their relatives) with a crystal of 16 MHz. */
#include "../board.h"
#include "../fifo.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#ifndef F_CPU
#define F_CPU 16000000UL
#endif
#define BAUD 115200UL

static volatile unsigned int milliseconds;

ISR(TIMER0_COMPA_vect)
{
    ++milliseconds;
}

unsigned int board_ms(void)
{
    unsigned int now;

    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        now = milliseconds;
    }
    return now;
}

void board_init(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = (F_CPU + 4u * BAUD) / (8u * BAUD) - 1u;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0);
#ifdef UART_INTERRUPT
    UCSR0B |= _BV(RXCIE0);
#endif

    TCCR0A = _BV(WGM01);
    TCCR0B = _BV(CS01) | _BV(CS00); /* F_CPU / 64 */
    OCR0A = F_CPU / 64u / 1000u - 1u;
    TIMSK0 = _BV(OCIE0A);
    sei();
}

#ifdef UART_INTERRUPT

static struct fifo received;

#ifdef USART0_RX_vect
ISR(USART0_RX_vect)
#else
ISR(USART_RX_vect)
#endif
{
    fifo_put(&received, UDR0);
}

int board_uart_read(void)
{
    return fifo_get(&received);
}

#else

int board_uart_read(void)
{
    if (!(UCSR0A & _BV(RXC0)))
        return -1;
    return UDR0;
}

#endif

int board_uart_write(unsigned char byte)
{
    if (!(UCSR0A & _BV(UDRE0)))
        return 0;
    UDR0 = byte;
    return 1;
}
