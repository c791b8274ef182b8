/* What the example needs of a board: a serial line and a clock. tm4c/board.c and avr/board.c implement it. */
#ifndef BOARD_H
#define BOARD_H

void board_init(void);

/* Milliseconds since the start; wraps. */
unsigned int board_ms(void);

/* The next received byte, 0 to 255, or -1 when there is none. Built with UART_INTERRUPT it comes from the FIFO that the
   interrupt handler fills, else from the UART itself. Never waits. */
int board_uart_read(void);

/* Starts the transmission of a byte and returns 1, or returns 0 when the UART has no room for it. Never waits. */
int board_uart_write(unsigned char byte);

#endif
