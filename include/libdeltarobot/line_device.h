/**
 * @file
 * libdeltarobot/line_device.h: the device's end of the Ozeki line protocol's link, for firmware: says which devices
 * are there, takes commands, has them executed, answers them, and sends events.
 *
 * A main loop around it:
 *
 *     unsigned char in[64];
 *     int got = 0, taken = 0;
 *
 *     olp_device_init(&device, &table, &uart);
 *     for (;;) {
 *         if (taken == got) {
 *             taken = 0;
 *             got = uart_read(&uart, in, sizeof in);
 *         }
 *         taken += olp_device_receive(&device, in + taken, got - taken, now_ms());
 *         olp_device_poll(&device, now_ms());
 *         if (there_is_news()) {
 *             olp_begin(&event, text, sizeof text, "heaterinfo");
 *             olp_add_float(&event, "temp", temperature, 2);
 *             olp_device_event(&device, &event, "M1F910");
 *         }
 *     }
 *
 * What it answers to what:
 *
 * - an intact command: ack if acks are in force, then `<command>_resp`
 * - its repeat: the same again; it is not executed again (see repeat_ms)
 * - linksetup: executed here; ack as newly settled, linksetup_resp; an option left out or not understood stays as it is
 * - an unknown id or command: ack, onerror with code unknownid or unknowncommand, and the command's t
 * - one refused by its function: ack, onerror refused, and the command's t
 * - one executed whose answer can't be sent: ack, onerror toolong, and the command's t
 * - a wrong checksum, a missing one when one is in force, too long or unreadable lines: onerror with code checksum,
 *   overflow or malformed; nothing is executed
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/line_device.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_LINE_DEVICE_H
#define LIBDELTAROBOT_LINE_DEVICE_H

#include "abi.h"
#include "line_protocol.h"

LIBDELTAROBOT_NOT_PACKED(line_device);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define olp_device_init OLP_SIZED_NAME(olp_device_init)
#define olp_device_restart OLP_SIZED_NAME(olp_device_restart)
#define olp_device_linksetup OLP_SIZED_NAME(olp_device_linksetup)
#define olp_device_receive OLP_SIZED_NAME(olp_device_receive)
#define olp_device_poll OLP_SIZED_NAME(olp_device_poll)
#define olp_device_event OLP_SIZED_NAME(olp_device_event)
#define olp_device_get_health OLP_SIZED_NAME(olp_device_get_health)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Length of the longest id that a device behind a link may have. */
#define OLP_ID_MAX 10
/** Words of a device, with some room to spare. */
#define OLP_DEVICE_WORDS (((OLP_WINDOW_MAX * (OLP_REPLY_MAX + 11)) / 4) + 37)

/** The device's end of a link. All zero is one that `olp_device_init` has not made yet. */
struct olp_device {
  LIBDELTAROBOT_WORD opaque[OLP_DEVICE_WORDS];
};

/** A device behind the link, as its welcome describes it. The texts end with a zero byte. */
struct olp_device_info {
  /** 1 to `OLP_ID_MAX` of `[0-9A-Za-z._-]`; the protocol asks for 6 letters and digits. No two have the same. */
  const char *id;
  /** What it is, e.g. OzekiSwitchController. */
  const char *type;
  /** Its place; 0: it is left out. */
  int pos;
  /** Its name; NULL: it has none. */
  const char *name;
  /** Its version; NULL: it has none. */
  const char *version;
};

/**
 * Executes a command: reads its parameters from command, and adds those of the answer (but for id and t, which are
 * added behind them) to answer, which is begun. Returns 0, or anything else to refuse; what was added does not matter
 * then. Both are gone when the function returns. It may use the device, which however receives nothing meanwhile.
 *
 *     int set_switch(const struct olp_message *command, struct olp_encoder *answer, void *usr)
 *     {
 *         long state;
 *         if (olp_get_int(command, "state", 0, &state) != OLP_RC_SUCCESS)
 *             return -1;
 *         olp_add_int(answer, "state", switch_to(state));
 *         return 0;
 *     }
 */
typedef int (*olp_run_func_t)(const struct olp_message *command, struct olp_encoder *answer, void *usr);

/** A command that a device executes. */
struct olp_command {
  /** The device's id; NULL: each device has it. The first command that fits is taken. */
  const char *id;
  /** The command's name, of `[A-Za-z0-9_]`. */
  const char *name;
  /** What executes it; NULL: it is refused. */
  olp_run_func_t run;
};

/**
 * Sends a line: so many bytes, the LF among them, gone when the function returns. Its result is ignored: who misses a
 * line asks again. It may use the device, which however receives nothing while a line is being answered.
 *
 *     int send_line(const void *line, int bytes, void *usr)
 *     {
 *         return uart_write((struct uart *)usr, line, bytes);
 *     }
 */
typedef int (*olp_send_func_t)(const void *line, int bytes, void *usr);

/** What is behind a link, and how to send to its other end. */
struct olp_device_table {
  /** The devices, at least one. The first stands for all of them in what the link itself sends. */
  const struct olp_device_info *devices;
  /** Their number. */
  int device_count;
  /** What they execute. linksetup is not among it: the library does that. */
  const struct olp_command *commands;
  /** Number of commands. */
  int command_count;
  /** Sends a line. */
  olp_send_func_t send;
  /**
   * For how many milliseconds after a command, or its last repeat, a repeat is recognised, at most 2^31 - 1; 0
   * stands for 5000. It has to be more than the other end waits before it repeats: later, the line is a new command.
   */
  unsigned long repeat_ms;
};

/** How the link does. The counters wrap at 2^32. */
struct olp_device_health {
  /** Commands that were received intact, repeats among them. */
  unsigned long commands;
  /** Commands that came again and were only answered again. */
  unsigned long repeats;
  /** Lines whose checksum was wrong or missing. */
  unsigned long checksums;
  /** Lines that could not be read. */
  unsigned long malformed;
  /** Lines that were too long. */
  unsigned long overflows;
  /** Commands that were refused: by their function, or because nobody knows their id or name. */
  unsigned long refused;
};

/**
 * Makes the device's end of a link of any memory. The first calls of `olp_device_poll` will send the welcomes.
 *
 * table's counts, texts and functions are what it says, and its functions can be called with usr; it stays there,
 * unchanged, as long as the device is used.
 *
 * Returns `OLP_RC_SUCCESS`; `OLP_RC_TOO_LONG` when a welcome is longer than `OLP_REPLY_MAX`; `OLP_RC_ERROR_GENERIC`
 * when device or table is NULL, or the table has no device, no `send`, an id that can't be or that two devices have,
 * or NULL where a text or an array has to be.
 *
 *     static const struct olp_device_info devices[] = {{"9o5qzg", "OzekiSwitchController", 0, 0, 0}};
 *     static const struct olp_command commands[] = {{0, "setswitch", set_switch}};
 *     static const struct olp_device_table table = {devices, 1, commands, 1, send_line, 0};
 *     olp_device_init(&device, &table, &uart);
 */
int olp_device_init(struct olp_device *device, const struct olp_device_table *table, void *usr)
    OLP_SIZED(olp_device_init);

/**
 * Starts again, as after `olp_device_init`: to be called when another connection is made. Returns `OLP_RC_SUCCESS`, or
 * `OLP_RC_ERROR_GENERIC` when device is NULL or was not made by `olp_device_init`.
 *
 *     olp_device_restart(&device);
 */
int olp_device_restart(struct olp_device *device) OLP_SIZED(olp_device_restart);

/**
 * Has the device set up the link by a linksetup event, in force when the next calls of `olp_device_poll` have sent it
 * (behind the welcomes). ack and checksum: 0 off, else on. window: how many commands may be unanswered, 1 to
 * `OLP_WINDOW_MAX`. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when window is out of range, or device NULL or
 * not made by `olp_device_init`.
 *
 *     olp_device_linksetup(&device, 1, 1, OLP_WINDOW_MAX);
 */
int olp_device_linksetup(struct olp_device *device, int ack, int checksum, int window) OLP_SIZED(olp_device_linksetup);

/**
 * Takes received bytes, up to the end of a line. Until `olp_device_poll` has answered that line, no more are taken.
 * `now_ms` makes no difference, as `olp_device_poll` has the time. Not for interrupts that may come during another
 * call on the same device.
 *
 * Returns how many bytes were taken, the rest being for after the next `olp_device_poll`; -`OLP_RC_ERROR_GENERIC` when
 * device is NULL or was not made by `olp_device_init`, bytes is negative, or buf is NULL and bytes is not 0.
 *
 *     for (int taken = 0; taken < length; olp_device_poll(&device, now_ms()))
 *         taken += olp_device_receive(&device, in + taken, length - taken, now_ms());
 */
int olp_device_receive(struct olp_device *device, const void *buf, int bytes, unsigned long now_ms)
    OLP_SIZED(olp_device_receive);

/**
 * Does one thing in the firmware's main loop: sends a welcome or the linksetup event, or answers a received line.
 *
 * Returns `OLP_RC_SUCCESS` when something was done; `OLP_RC_NO_EVENT` when there was nothing to do; `OLP_RC_BUSY` when
 * called by a function that it called itself; `OLP_RC_ERROR_GENERIC` when device is NULL or was not made by
 * `olp_device_init`; and when a command was executed but the answer can't be sent, `OLP_RC_TOO_LONG` or what else
 * `olp_finish` may say.
 *
 *     while (olp_device_poll(&device, now_ms()) == OLP_RC_SUCCESS)
 *         ;
 */
int olp_device_poll(struct olp_device *device, unsigned long now_ms) OLP_SIZED(olp_device_poll);

/**
 * Sends an event of the device of that id, a string: event was begun, by `olp_begin`, and has its parameters; id and t
 * are added here. Its buffer is the caller's, has room for the whole line, and is still there.
 *
 * Returns `OLP_RC_SUCCESS`; `OLP_RC_BUSY` as long as there are welcomes to send, which come first;
 * `OLP_RC_ERROR_GENERIC` when a pointer is NULL, device was not made by `olp_device_init`, or it has no such id; or,
 * when the event can't be sent, what is wrong with it: `OLP_RC_TOO_LONG` or what else `olp_finish` may say.
 *
 *     olp_begin(&event, text, sizeof text, "heaterinfo");
 *     olp_add_float(&event, "temp", 21.5f, 2);
 *     olp_device_event(&device, &event, "M1F910");
 */
int olp_device_event(struct olp_device *device, struct olp_encoder *event, const char *id) OLP_SIZED(olp_device_event);

/**
 * Copies how the link does. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct olp_device_health health;
 *     if (olp_device_get_health(&device, &health) == OLP_RC_SUCCESS)
 *         printf("%lu commands, %lu of them repeated\n", health.commands, health.repeats);
 */
int olp_device_get_health(const struct olp_device *device, struct olp_device_health *health)
    OLP_SIZED(olp_device_get_health);

#ifdef __cplusplus
}
#endif

#endif
