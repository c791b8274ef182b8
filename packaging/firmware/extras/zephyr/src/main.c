/* Untried, see zephyr/module.yml. Answers each request on the console's UART with a status report. */
#include <libdeltarobot.h>
#include <zephyr/device.h>
#include <zephyr/drivers/uart.h>

static const struct device *const uart = DEVICE_DT_GET(DT_CHOSEN(zephyr_console));

static int write_frame(void *buf, int bytes, void *usr)
{
    (void)usr;
    for (int i = 0; i < bytes; ++i)
        uart_poll_out(uart, ((unsigned char *)buf)[i]);
    return 0;
}

int main(void)
{
    static struct dp_receiver receiver;
    const struct protocol_msg_status_report report = {1, 2, 3, DP_STATUS_IDLE};
    struct protocol_msg msg;
    unsigned char byte;

    for (;;)
        if (uart_poll_in(uart, &byte) == 0 && dp_receiver_byte(&receiver, byte))
            while (dp_receiver_next(&receiver, &msg) == DP_RC_SUCCESS) {
                dp_build_status_report(&msg, &report, DP_LAYOUT_FIRMWARE);
                dp_send(&msg, write_frame, NULL);
            }
}
