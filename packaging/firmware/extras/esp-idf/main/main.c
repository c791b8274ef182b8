/* Untried, see idf_component.yml. Answers each request on UART1 with a status report. */
#include "driver/uart.h"
#include "libdeltarobot.h"

static int write_frame(void *buf, int bytes, void *usr)
{
    (void)usr;
    return uart_write_bytes(UART_NUM_1, buf, bytes) == bytes ? 0 : -1;
}

void app_main(void)
{
    static struct dp_receiver receiver;
    const struct protocol_msg_status_report report = {1, 2, 3, DP_STATUS_IDLE};
    const uart_config_t config = {
        .baud_rate = 115200, .data_bits = UART_DATA_8_BITS, .parity = UART_PARITY_DISABLE, .stop_bits = UART_STOP_BITS_1
    };
    struct protocol_msg msg;
    unsigned char byte;

    uart_param_config(UART_NUM_1, &config);
    uart_driver_install(UART_NUM_1, 256, 0, 0, NULL, 0);
    for (;;)
        if (uart_read_bytes(UART_NUM_1, &byte, 1, portMAX_DELAY) == 1 && dp_receiver_byte(&receiver, byte))
            while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS) {
                dp_build_status_report(&msg, &report, DP_LAYOUT_FIRMWARE);
                dp_send(&msg, write_frame, NULL);
            }
}
