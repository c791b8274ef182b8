/*
 * Runs an ELF file on a simulated AVR: simavr_run MCU FILE [mute]. What stands at standard input comes in at USART0 at
 * 115200 baud, a byte every ten bits' time and not later for want of the firmware's attention; what the firmware sends
 * goes to standard output. Ends with the input, or, when it is mute and has none, with the firmware.
 */
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CLOCK_HZ 16000000u
#define CYCLES_PER_BYTE (CLOCK_HZ / 115200u * 10u)

static int uart_output;
static avr_irq_t *uart_input;
static unsigned char input[4096];
static size_t input_at, input_count;

static avr_cycle_count_t feed(struct avr_t *avr, avr_cycle_count_t when, void *param)
{
    (void)avr;
    (void)param;
    if (input_at == input_count) {
        ssize_t count = read(0, input, sizeof input);

        if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR))
            exit(0);
        input_at = 0;
        input_count = count > 0 ? (size_t)count : 0;
    }
    if (input_at < input_count)
        avr_raise_irq(uart_input, input[input_at++]);
    return when + CYCLES_PER_BYTE;
}

static void sent(struct avr_irq_t *irq, uint32_t value, void *param)
{
    unsigned char byte = (unsigned char)value;

    (void)irq;
    (void)param;
    while (write(uart_output, &byte, 1) != 1)
        if (errno != EAGAIN && errno != EINTR)
            exit(0);
}

int main(int argc, char **argv)
{
    elf_firmware_t firmware;
    uint32_t flags = 0;
    avr_t *avr;
    int state;

    if (argc != 3 && argc != 4) {
        fprintf(stderr, "usage: %s MCU FILE [mute]\n", argv[0]);
        return 2;
    }
    /* The simulator prints to the standard output too. */
    uart_output = dup(1);
    dup2(2, 1);
    memset(&firmware, 0, sizeof firmware);
    if (elf_read_firmware(argv[2], &firmware) != 0) {
        fprintf(stderr, "%s: cannot be read\n", argv[2]);
        return 2;
    }
    avr = avr_make_mcu_by_name(argv[1]);
    if (!avr) {
        fprintf(stderr, "%s: not a controller that simavr knows\n", argv[1]);
        return 2;
    }
    avr_init(avr);
    avr_load_firmware(avr, &firmware);
    avr->frequency = CLOCK_HZ;
    avr->log = LOG_ERROR;

    /* Else it writes the UART's lines to the terminal, and sleeps while the firmware polls. */
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(uint32_t)(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    uart_input = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), sent, NULL);
    if (argc == 3) {
        fcntl(0, F_SETFL, fcntl(0, F_GETFL) | O_NONBLOCK);
        avr_cycle_timer_register(avr, CYCLES_PER_BYTE, feed, NULL);
    }

    do
        state = avr_run(avr);
    while (state != cpu_Done && state != cpu_Crashed);
    return state == cpu_Crashed;
}
