/**
 * @file
 * libdeltarobot/serial.h: the serial port, on Unix and Windows. Not in libraries for bare metal.
 *
 *     struct dp_serial port;
 *     if (dp_serial_open(&port, "/dev/ttyUSB0", DP_SERIAL_BAUD) == DP_RC_SUCCESS) {
 *         int got;
 *         dp_send(&msg, dp_serial_send, &port);
 *         while ((got = dp_serial_read(&port, in, sizeof in, 100)) > 0)
 *             dp_process(&ring, in, got);
 *     }
 *     if (*dp_serial_error(&port) != '\0')
 *         fprintf(stderr, "%s\n", dp_serial_error(&port));
 *     dp_serial_close(&port);
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/serial.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_SERIAL_H
#define LIBDELTAROBOT_SERIAL_H

#include "abi.h"
#include "protocol.h"

LIBDELTAROBOT_NOT_PACKED(serial);

/** Words of a struct dp_serial. */
#define DP_SERIAL_WORDS (384 / sizeof(unsigned long))

#ifdef __cplusplus
extern "C" {
#endif

/** The system has reported an error: `dp_serial_error` says which. */
#define DP_RC_DEVICE 7
/** The speed of the deltarobot link in baud (specification, section "Serial"). */
#define DP_SERIAL_BAUD 115200
/** How long `dp_serial_send` waits for room, in milliseconds. */
#define DP_SERIAL_SEND_MS 1000
/** A line is asserted. */
#define DP_SERIAL_ON 1
/** A line is not asserted. */
#define DP_SERIAL_OFF -1

/** A serial port. All zero is a closed one. */
struct dp_serial {
  unsigned long opaque[DP_SERIAL_WORDS];
};

/** How a port is opened and closed. All zero is what `dp_serial_open` does. */
struct dp_serial_settings {
  /** Speed in baud, 0 for `DP_SERIAL_BAUD`. */
  unsigned long baud;
  /**
   * DTR after opening: `DP_SERIAL_ON`, `DP_SERIAL_OFF`, or 0 for what opening makes of it, on. Ignored where there is
   * no such line. Many boards reset when DTR or RTS rises. On Unix, opening raises both before they can be set to
   * off: a board that shall not be reset has to be closed with `keep_lines` the time before.
   */
  int dtr;
  /** RTS after opening, likewise. Both change at once. */
  int rts;
  /** Not 0: closing leaves DTR and RTS as they are, for later programs too (`stty -hupcl`). Windows drops them. */
  int keep_lines;
};

/**
 * Opens a serial port or pseudo-terminal: 8 data bits, no parity, one stop bit, no flow control, bytes as they are.
 *
 * device is its name, such as `/dev/ttyUSB0` or, in Windows, `COM5`. baud is the speed, any that the hardware gets
 * near to (2 %), 0 for `DP_SERIAL_BAUD`. It waits for no carrier. As long as it is open, nobody else can open the
 * device by this function or, unless as root or if it is a pseudo-terminal, otherwise. What was received before is
 * discarded. An open port must be closed first: else its file descriptor is lost.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when that was not possible, or `DP_RC_ERROR_GENERIC` when serial or device
 * is NULL. Unless it succeeded, the port is closed.
 *
 *     if (dp_serial_open(&port, "/dev/ttyUSB0", DP_SERIAL_BAUD) != DP_RC_SUCCESS)
 *         fprintf(stderr, "%s\n", dp_serial_error(&port));
 */
int dp_serial_open(struct dp_serial *serial, const char *device, unsigned long baud);

/**
 * Like `dp_serial_open`, with more settings. NULL stands for settings that are all zero.
 *
 *     struct dp_serial_settings settings = {0};
 *     settings.baud = 250000;
 *     settings.keep_lines = 1;
 *     dp_serial_open_with(&port, "/dev/ttyACM0", &settings);
 */
int dp_serial_open_with(struct dp_serial *serial, const char *device, const struct dp_serial_settings *settings);

/**
 * Reads what has come, at most cap bytes. When nothing has, waits for it up to `timeout_ms` milliseconds (for ever if
 * negative), or until a signal was handled. serial was opened or is all zero, here and below.
 *
 * Returns how many bytes were read, 0 when none came; -`DP_RC_DEVICE` when the device has disappeared (what it
 * received before that is read first); -`DP_RC_ERROR_GENERIC` when serial is NULL or closed, cap is negative, or buf
 * is NULL and cap is not 0.
 *
 *     int got = dp_serial_read(&port, in, sizeof in, 100);
 *     if (got > 0)
 *         dp_process(&ring, in, got);
 */
int dp_serial_read(struct dp_serial *serial, void *buf, int cap, long timeout_ms);

/**
 * Writes all bytes, waiting for room up to `timeout_ms` milliseconds in all, for ever if negative, signals or not.
 *
 * Returns how many bytes were written, fewer than all when the time was over first; -`DP_RC_DEVICE` when the device
 * has disappeared; -`DP_RC_ERROR_GENERIC` when serial is NULL or closed, bytes is negative, or buf is NULL and bytes
 * is not 0.
 *
 *     int written = dp_serial_write(&port, out, length, 1000);
 *     if (written >= 0 && written < length)
 *         puts("nobody reads at the other end");
 */
int dp_serial_write(struct dp_serial *serial, const void *buf, int bytes, long timeout_ms);

/**
 * Writes all bytes, waiting for room up to `DP_SERIAL_SEND_MS`. A `send_func_t`, for which usr is the port.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared or did not take all of them in time, or
 * `DP_RC_ERROR_GENERIC` when usr is NULL or closed, bytes is negative, or buf is NULL and bytes is not 0.
 *
 *     if (dp_send(&msg, dp_serial_send, &port) != DP_RC_SUCCESS)
 *         fprintf(stderr, "%s\n", dp_serial_error(&port));
 */
int dp_serial_send(void *buf, int bytes, void *usr);

/**
 * Waits until all that was written was sent, however long that takes, signals or not.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when the device has disappeared, or `DP_RC_ERROR_GENERIC` when serial is
 * NULL or closed.
 *
 *     dp_serial_send(out, length, &port);
 *     if (dp_serial_drain(&port) == DP_RC_SUCCESS)
 *         sent_at = now_ms();
 */
int dp_serial_drain(struct dp_serial *serial);

/**
 * Discards what was received and not read. Returns what `dp_serial_drain` does.
 *
 *     if (dp_serial_discard(&port) == DP_RC_SUCCESS)
 *         memset(&ring, 0, sizeof ring);
 */
int dp_serial_discard(struct dp_serial *serial);

/**
 * Sets DTR: on is `DP_SERIAL_ON` or 1, or `DP_SERIAL_OFF` or 0. An Arduino resets when it goes on.
 *
 * Returns `DP_RC_SUCCESS`, `DP_RC_DEVICE` when there is no such line, as in a pseudo-terminal, or the device has
 * disappeared, or `DP_RC_ERROR_GENERIC` when serial is NULL or closed.
 *
 *     dp_serial_set_dtr(&port, 0);
 *     dp_serial_read(&port, in, sizeof in, 100);
 *     dp_serial_set_dtr(&port, 1);
 */
int dp_serial_set_dtr(struct dp_serial *serial, int on);

/**
 * Sets RTS, as `dp_serial_set_dtr` sets DTR.
 *
 *     dp_serial_set_rts(&port, DP_SERIAL_OFF);
 */
int dp_serial_set_rts(struct dp_serial *serial, int on);

/**
 * Returns the file descriptor, which is set to `O_NONBLOCK`, for poll(2) or select(2), in Windows the `HANDLE` as an
 * int; or -1 when serial is NULL or closed.
 *
 *     int fd = dp_serial_handle(&port);
 */
int dp_serial_handle(const struct dp_serial *serial);

/**
 * Closes it, if it is open. What was written is still sent. Returns `DP_RC_SUCCESS`, or `DP_RC_ERROR_GENERIC` for NULL.
 *
 *     dp_serial_drain(&port);
 *     dp_serial_close(&port);
 */
int dp_serial_close(struct dp_serial *serial);

/**
 * Returns the device's name and what went wrong with it last, such as `/dev/ttyUSB0: in use by another program`: a
 * string that lives and changes with the port, empty when nothing did since it was opened or serial is NULL.
 *
 *     if (dp_serial_read(&port, in, sizeof in, 100) < 0)
 *         fprintf(stderr, "%s\n", dp_serial_error(&port));
 */
const char *dp_serial_error(const struct dp_serial *serial);

#ifdef __cplusplus
}
#endif

#endif
