/**
 * @file
 * libdeltarobot/serial.h: the serial port, on Unix. Not in libraries for bare metal.
 *
 * Generated from src/serial.rs: `make header` renews it.
 *
 * What holds for each function, unless it says otherwise (docs/api.md has all of it):
 *
 * - Pointers: NULL is answered with an error, never followed. Others point to whole objects of their type, aligned,
 *   writable where they are not const, with any contents. The objects of one call don't overlap.
 * - Threads and interrupts: a call has its objects to itself; no other thread and no interrupt touches them while it
 *   runs. Calls on different objects may come at the same time, in interrupts too. No call waits or locks.
 * - Callbacks may call the library, on the same objects too.
 *
 * ```c
 * struct dp_serial port;
 * if (dp_serial_open(&port, "/dev/ttyUSB0", DP_SERIAL_BAUD) == DP_RC_SUCCESS) {
 *     int got;
 *     dp_send(&msg, dp_serial_send, &port);
 *     while ((got = dp_serial_read(&port, in, sizeof in, 100)) > 0)
 *         dp_process(&ring, in, got);
 * }
 * if (*dp_serial_error(&port) != '\0')
 *     fprintf(stderr, "%s\n", dp_serial_error(&port));
 * dp_serial_close(&port);
 * ```
 */
#ifndef LIBDELTAROBOT_SERIAL_H
#define LIBDELTAROBOT_SERIAL_H


#include "libdeltarobot/protocol.h"

#ifdef __cplusplus
extern "C" {
#endif


/**
 * The system has reported an error: `dp_serial_error` says which.
 */
#define DP_RC_DEVICE 7

/**
 * How long `dp_serial_send` waits for room, in milliseconds.
 */
#define DP_SERIAL_SEND_MS 1000

/**
 * The speed of the deltarobot link in baud (specification, section "Serial").
 */
#define DP_SERIAL_BAUD 115200

/**
 * Bytes of a text about an error, the terminating zero among them.
 */
#define DP_SERIAL_TEXT_MAX 320

/**
 * A serial port. All zero is one that is closed.
 *
 * Its fields are private, but `fd`, while it is open, can be given to poll(2) or select(2). It is set to `O_NONBLOCK`.
 */
struct dp_serial {
  /**
   * The file descriptor.
   */
  int fd;
  int is_open;
  int has_failed;
  /**
   * The device's name, and behind it what went wrong last.
   */
  int name_length;
  char text[DP_SERIAL_TEXT_MAX];
};

/**
 * Opens and sets up a serial port or pseudo-terminal: 8 data bits, no parity, one stop bit, no flow control, bytes as
 * they are.
 *
 * baud is the speed, 0 for `DP_SERIAL_BAUD`; only standard speeds are known. It does not wait for a carrier. As long
 * as it is open, nobody else can open the device by this function or, unless as root or if it is a pseudo-terminal,
 * otherwise. What was received before is thrown away.
 *
 * device is NULL or a string. A port that is open must be closed first: else its file descriptor is lost.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when that was not possible, or `DP_RC_ERROR_GENERIC` when serial or device
 * is NULL. When it did not succeed, the port is closed: it need not be, but can be, closed.
 *
 * ```c
 * struct dp_serial port;
 * if (dp_serial_open(&port, "/dev/ttyUSB0", DP_SERIAL_BAUD) != DP_RC_SUCCESS)
 *     fprintf(stderr, "%s\n", dp_serial_error(&port));
 * ```
 */
int dp_serial_open(struct dp_serial *serial,
                   const char *device,
                   unsigned long baud);

/**
 * Reads what has come, at most cap bytes. When nothing has, waits for it up to `timeout_ms` milliseconds (for ever if
 * negative), or until a signal was handled.
 *
 * serial was opened or is all zero.
 *
 * Returns how many bytes were read, 0 when none came; -`DP_RC_DEVICE` when the device has disappeared (what it
 * received before that is read first); -`DP_RC_ERROR_GENERIC` when serial is NULL or not open, cap is negative, or buf
 * is NULL and cap is not 0.
 *
 * ```c
 * int got = dp_serial_read(&port, in, sizeof in, 100);
 * if (got > 0)
 *     dp_process(&ring, in, got);
 * ```
 */
int dp_serial_read(struct dp_serial *serial,
                   void *buf,
                   int cap,
                   long timeout_ms);

/**
 * Writes all bytes, waiting for room up to `timeout_ms` milliseconds altogether (for ever if negative). Signals don't
 * end it.
 *
 * Returns how many bytes were written, fewer than all when the time was over first; -`DP_RC_DEVICE` when the device
 * has disappeared; -`DP_RC_ERROR_GENERIC` when serial is NULL or not open, bytes is negative, or buf is NULL and bytes
 * is not 0.
 *
 * ```c
 * int written = dp_serial_write(&port, out, length, 1000);
 * if (written >= 0 && written < length)
 *     puts("nobody reads at the other end");
 * ```
 */
int dp_serial_write(struct dp_serial *serial,
                    const void *buf,
                    int bytes,
                    long timeout_ms);

/**
 * Writes all bytes, waiting for room up to `DP_SERIAL_SEND_MS`. A `send_func_t`, for which usr is the port.
 *
 * usr is the port.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared or did not take all of them in time, or
 * `DP_RC_ERROR_GENERIC` when usr is NULL or not open, bytes is negative, or buf is NULL and bytes is not 0.
 *
 * ```c
 * if (dp_send(&msg, dp_serial_send, &port) != DP_RC_SUCCESS)
 *     fprintf(stderr, "%s\n", dp_serial_error(&port));
 * ```
 */
int dp_serial_send(void *buf,
                   int bytes,
                   void *usr);

/**
 * Waits until all that was written was sent, however long that takes. Signals don't end it.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared, or `DP_RC_ERROR_GENERIC` when serial is
 * NULL or not open.
 *
 * ```c
 * dp_serial_send(out, length, &port);
 * if (dp_serial_drain(&port) == DP_RC_SUCCESS)
 *     sent_at = now_ms();
 * ```
 */
int dp_serial_drain(struct dp_serial *serial);

/**
 * Throws away what was received and not read.
 *
 * Returns what `dp_serial_drain` does.
 *
 * ```c
 * if (dp_serial_discard(&port) == DP_RC_SUCCESS)
 *     memset(&ring, 0, sizeof ring);
 * ```
 */
int dp_serial_discard(struct dp_serial *serial);

/**
 * Closes it. What was written is still sent.
 *
 * Returns `DP_RC_SUCCESS`, also when it was not open, or `DP_RC_ERROR_GENERIC` when serial is NULL.
 *
 * ```c
 * dp_serial_drain(&port);
 * dp_serial_close(&port);
 * ```
 */
int dp_serial_close(struct dp_serial *serial);

/**
 * The device's name and what went wrong with it last, such as `/dev/ttyUSB0: in use by another program`.
 *
 * Returns a string that lives and changes with the port, empty when nothing went wrong since it was opened or serial
 * is NULL.
 *
 * ```c
 * if (dp_serial_read(&port, in, sizeof in, 100) < 0)
 *     fprintf(stderr, "%s\n", dp_serial_error(&port));
 * ```
 */
const char *dp_serial_error(const struct dp_serial *serial);


#ifdef __cplusplus
}
#endif

#endif
