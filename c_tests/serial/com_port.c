/* serial.h in Windows: com_port COM5, at whose other end far_end is. */
#include "libdeltarobot/serial.h"

#include "check.h"

#include <windows.h>

static struct dp_serial port;
static const char *name;

static void open_port(unsigned long baud)
{
    memset(&port, 0xA5, sizeof port);
    if (!CHECK_INT(dp_serial_open(&port, name, baud), DP_RC_SUCCESS))
        fprintf(stderr, "    %s\n", dp_serial_error(&port));
}

static void check_error(const struct dp_serial *serial, const char *what)
{
    if (!CHECK(strstr(dp_serial_error(serial), what) != NULL))
        fprintf(stderr, "    it said: %s\n", dp_serial_error(serial));
}

static HANDLE handle(void)
{
    return (HANDLE)(INT_PTR)dp_serial_handle(&port);
}

static void settings_are_those_of_the_link(void)
{
    static const unsigned long speeds[] = {0, 9600, 57600, 230400};
    size_t i;

    for (i = 0; i < sizeof speeds / sizeof *speeds; ++i) {
        DCB state;
        open_port(speeds[i]);
        memset(&state, 0, sizeof state);
        state.DCBlength = sizeof state;
        CHECK(GetCommState(handle(), &state));
        CHECK_INT(state.BaudRate, speeds[i] == 0 ? DP_SERIAL_BAUD : speeds[i]);
        CHECK_INT(state.ByteSize, 8);
        CHECK_INT(state.Parity, NOPARITY);
        CHECK_INT(state.StopBits, ONESTOPBIT);
        CHECK(state.fBinary && !state.fOutxCtsFlow && !state.fOutxDsrFlow && !state.fDsrSensitivity);
        CHECK(!state.fOutX && !state.fInX && !state.fErrorChar && !state.fNull && !state.fAbortOnError);
        CHECK_INT(dp_serial_close(&port), DP_RC_SUCCESS);
        CHECK_INT(dp_serial_close(&port), DP_RC_SUCCESS);
        CHECK_INT(dp_serial_handle(&port), -1);
    }
}

static void bytes_pass_as_they_are(void)
{
    unsigned char all[254], got[300];
    int i, count;

    open_port(0);
    for (i = 0; i < 254; ++i)
        all[i] = (unsigned char)(i < '!' ? i : i < '~' - 1 ? i + 1 : i + 2);
    CHECK_INT(dp_serial_write(&port, all, 254, 1000), 254);
    CHECK_INT(dp_serial_drain(&port), DP_RC_SUCCESS);
    for (count = 0; count < 254;) {
        int part = dp_serial_read(&port, got + count, 100, 2000);
        if (!CHECK(part > 0 && part <= 100))
            break;
        count += part;
    }
    CHECK_BYTES(got, all, 254);
    CHECK_INT(dp_serial_write(&port, all, 254, 1000), 254);
    Sleep(500);
    CHECK_INT(dp_serial_discard(&port), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_read(&port, got, 100, 50), 0);
    dp_serial_close(&port);
}

static void messages_are_sent(void)
{
    struct protocol_msg msg;
    char got[5];
    int count = 0, part;

    open_port(0);
    memset(&msg, 0, sizeof msg);
    msg.opcode = DP_OPCODE_STATUS;
    CHECK_INT(dp_send(&msg, dp_serial_send, &port), DP_RC_SUCCESS);
    while (count < 5 && (part = dp_serial_read(&port, got + count, 5 - count, 2000)) > 0)
        count += part;
    CHECK_BYTES(got, "$S\0\xB1:", 5);
    dp_serial_close(&port);
    CHECK_INT(dp_send(&msg, dp_serial_send, &port), DP_RC_ERROR_GENERIC);
}

static void waiting_ends_in_time(void)
{
    static const long waits[] = {0, 1, 150};
    static char bytes[1 << 20];
    DWORD began;
    char byte;
    size_t i;
    int written;

    open_port(0);
    for (i = 0; i < sizeof waits / sizeof *waits; ++i) {
        long took;
        began = GetTickCount();
        CHECK_INT(dp_serial_read(&port, &byte, 1, waits[i]), 0);
        took = (long)(GetTickCount() - began);
        if (!CHECK(took >= waits[i] - 20 && took < waits[i] + 5000))
            fprintf(stderr, "    %ld instead of %ld\n", took, waits[i]);
    }
    CHECK_INT(dp_serial_write(&port, "x", 1, 1000), 1);
    CHECK_INT(dp_serial_read(&port, &byte, 1, -1), 1);
    CHECK_INT(byte, 'x');
    CHECK_INT(dp_serial_read(&port, &byte, 0, -1), 0);

    CHECK_INT(dp_serial_write(&port, "!", 1, 1000), 1);
    began = GetTickCount();
    written = dp_serial_write(&port, bytes, sizeof bytes, 150);
    CHECK(written >= 0 && written < (int)sizeof bytes);
    if (!CHECK(GetTickCount() - began < 5000))
        fprintf(stderr, "    %lu\n", (unsigned long)(GetTickCount() - began));
    dp_serial_close(&port);
}

static void the_port_is_exclusive(void)
{
    struct dp_serial second;
    char prefixed[32] = "\\\\.\\";

    /* Wine lets others in. */
    if (GetProcAddress(GetModuleHandleA("ntdll.dll"), "wine_get_version") == NULL) {
        open_port(0);
        CHECK_INT(dp_serial_open(&second, name, 9600), DP_RC_DEVICE);
        check_error(&second, ": in use by another program");
        CHECK_INT(dp_serial_close(&port), DP_RC_SUCCESS);
    }
    strcat(prefixed, name);
    CHECK_INT(dp_serial_open(&second, prefixed, 9600), DP_RC_SUCCESS);
    CHECK_INT(dp_serial_close(&second), DP_RC_SUCCESS);
}

static void what_is_no_serial_port(void)
{
    struct dp_serial_settings settings;
    char long_name[2000];
    char byte = 0;

    memset(&settings, 0, sizeof settings);
    CHECK_INT(dp_serial_open(&port, "COM77", 0), DP_RC_DEVICE);
    CHECK(strncmp(dp_serial_error(&port), "COM77: ", 7) == 0 && strlen(dp_serial_error(&port)) > 10);
    CHECK_INT(dp_serial_open_with(&port, "NUL", &settings), DP_RC_DEVICE);
    check_error(&port, "NUL: not a serial port");
    memset(long_name, 'x', sizeof long_name);
    long_name[sizeof long_name - 1] = '\0';
    CHECK_INT(dp_serial_open(&port, long_name, 0), DP_RC_DEVICE);
    check_error(&port, "xxx: ");

    CHECK_INT(dp_serial_open(NULL, name, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_open(&port, NULL, 0), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_read(&port, &byte, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_write(NULL, &byte, 1, 0), -DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_set_dtr(&port, 1), DP_RC_ERROR_GENERIC);
    CHECK_INT(dp_serial_close(NULL), DP_RC_ERROR_GENERIC);
    CHECK(dp_serial_error(NULL)[0] == '\0');
}

static void a_device_that_disappears_is_an_error(void)
{
    char bytes[64];
    DWORD began = GetTickCount();
    int rc = 0;

    open_port(0);
    CHECK_INT(dp_serial_write(&port, "~", 1, 1000), 1);
    while (rc >= 0 && GetTickCount() - began < 10000)
        rc = dp_serial_read(&port, bytes, sizeof bytes, 100);
    CHECK_INT(rc, -DP_RC_DEVICE);
    check_error(&port, ": disconnected");
    CHECK_INT(dp_serial_read(&port, bytes, 10, -1), -DP_RC_DEVICE);
    CHECK_INT(dp_serial_send(bytes, 10, &port), DP_RC_DEVICE);
    check_error(&port, ": disconnected");
    CHECK_INT(dp_serial_close(&port), DP_RC_SUCCESS);
}

int main(int argc, char **argv)
{
    name = argc > 1 ? argv[1] : "COM5";
    settings_are_those_of_the_link();
    bytes_pass_as_they_are();
    messages_are_sent();
    waiting_ends_in_time();
    the_port_is_exclusive();
    what_is_no_serial_port();
    a_device_that_disappears_is_an_error();
    return check_summary("com_port");
}
