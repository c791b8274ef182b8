/**
 * @file
 * libdeltarobot/line_host.h: the PC's end of the Ozeki line protocol's link: sends commands, retransmits them,
 * reports how they ended and what the devices say.
 *
 * A session does no I/O. A loop around it:
 *
 *     struct olp_host_event event;
 *     char in[64], out[OLP_COMMAND_MAX];
 *     int got = 0, taken = 0, length;
 *
 *     olp_host_init(&host, NULL);
 *     for (;;) {
 *         while (olp_host_poll(&host, now_ms(), &event) == OLP_RC_SUCCESS)
 *             handle_event(&event);
 *         while ((length = olp_host_output(&host, out, sizeof out, now_ms())) > 0)
 *             uart_write(&uart, out, length);
 *         if (is_over())
 *             break;
 *         if (taken == got) {
 *             wait_readable(&uart, olp_host_next_deadline(&host, now_ms()));
 *             taken = 0;
 *             got = uart_read(&uart, in, sizeof in);
 *         }
 *         taken += olp_host_receive(&host, in + taken, got - taken, now_ms());
 *     }
 *
 * handle_event() calls olp_host_setup at the first OLP_HOST_WELCOME, and olp_host_send when that setup has ended as
 * OLP_HOST_ANSWERED.
 *
 * What holds for the outcome of a command, if the device recognises repeats and the settings say so:
 *
 * - acks and checksums on: ANSWERED means executed once, REFUSED not at all, all else once or not at all
 * - acks on, checksums off: the same, if no line to the device is damaged, as it executes what arrives
 * - acks off: the same, if no line is damaged and none takes longer than a timeout there and back
 * - checksums on: in any case once or not at all
 *
 * A board that does not recognise repeats, which is what is assumed, executes a command twice when its ack is lost; so
 * may a device that restarts in between. A damaged line has the right checksum once in some 65000. Answers have none:
 * one that is damaged in several places may be believed. Without acks, commands are retransmitted only when the device
 * asks for it, or the settings say that it recognises repeats, and no two of one name and id are out at a time. They
 * are executed in the order of sending while the window is 1; in a larger one, retransmitted ones fall behind.
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/line_host.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_LINE_HOST_H
#define LIBDELTAROBOT_LINE_HOST_H

#include "abi.h"
#include "line_protocol.h"

LIBDELTAROBOT_NOT_PACKED(line_host);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define olp_host_init OLP_SIZED_NAME(olp_host_init)
#define olp_host_setup OLP_SIZED_NAME(olp_host_setup)
#define olp_host_send OLP_SIZED_NAME(olp_host_send)
#define olp_host_receive OLP_SIZED_NAME(olp_host_receive)
#define olp_host_poll OLP_SIZED_NAME(olp_host_poll)
#define olp_host_output OLP_SIZED_NAME(olp_host_output)
#define olp_host_next_deadline OLP_SIZED_NAME(olp_host_next_deadline)
#define olp_host_get_link OLP_SIZED_NAME(olp_host_get_link)
#define olp_host_get_device OLP_SIZED_NAME(olp_host_get_device)
#define olp_host_get_health OLP_SIZED_NAME(olp_host_get_health)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Longest id that a device in the table may have. */
#define OLP_HOST_ID_MAX 15
/** Longest type of a device that is kept whole. */
#define OLP_HOST_TYPE_MAX 47
/** Longest name of a device that is kept whole. */
#define OLP_HOST_NAME_MAX 31
/** Longest version of a device that is kept whole. */
#define OLP_HOST_VERSION_MAX 15
/** `unsigned long`s of a session, with some room to spare. */
#define OLP_HOST_WORDS ((((OLP_LINE_MAX / 4) + (27 * OLP_WINDOW_MAX)) + (31 * OLP_DEVICES_MAX)) + 180)

/**
 * Event: a device has signed in (`message`). `device` is its place in the table, -1 when it is not there; `error` is
 * `OLP_RC_SUCCESS`, or `OLP_RC_TOO_LONG` when the id is longer than `OLP_HOST_ID_MAX` (-1) or another text was cut
 * off, `OLP_RC_OVERFLOW` when the table is full, `OLP_RC_NOT_FOUND` when it has no id.
 */
#define OLP_HOST_WELCOME 1

/** Event: what is in force on the link was reported, or has changed: `link`. */
#define OLP_HOST_LINKSETUP 2
/** Event: the device has acknowledged the command `handle`. Once for each. */
#define OLP_HOST_ACKED 3
/** Event: the command `handle` has ended as `outcome` says. Exactly once for each. */
#define OLP_HOST_ENDED 4
/** Event: another line came from the device: `message`. */
#define OLP_HOST_LINE 5

/**
 * Event: the gap in the numbers of the device's messages says that `lost` are missing before this line. An estimate: a
 * damaged number makes a gap too.
 */
#define OLP_HOST_LOST 6

/** Event: the device reports an error: `message`, about the command `handle`, or 0 when that is not known. */
#define OLP_HOST_ERROR 7
/** Event: a line was lost: `error` is `OLP_RC_TOO_LONG` or `OLP_RC_MALFORMED`. */
#define OLP_HOST_DROPPED 8

/**
 * Outcome: the device has executed the command, and answered: `message`, or an `onerror` with the code `toolong` when
 * its answer is too long for it.
 */
#define OLP_HOST_ANSWERED 1

/** Outcome: the device did not execute it, and says so: `message`, an `onerror`. */
#define OLP_HOST_REFUSED 2

/**
 * Outcome: what was to come back did not. Whether the command was executed is not known; if it was acknowledged, the
 * device has it.
 */
#define OLP_HOST_TIMED_OUT 3

/** Outcome: the device has restarted. Whether the command was executed before that is not known. */
#define OLP_HOST_RESTARTED 4
/** Outcome: it was never sent, as checksums came into force after it was queued, with which it is too long. */
#define OLP_HOST_NOT_SENT 5

/** A host session. All zero is a new one with default settings. */
struct olp_host {
  unsigned long opaque[OLP_HOST_WORDS];
};

/** Settings of a host session: 0 stands for the default everywhere. Times are in milliseconds, at most 2^31 - 1. */
struct olp_host_settings {
  /** Least time to wait for an ack; 0: 500. Timeouts follow measured round trips, and double when nothing comes. */
  unsigned long timeout_ms;
  /** The same for an answer; 0: as long as for an ack. */
  unsigned long answer_ms;
  /**
   * How long after a command was sent first it may still be retransmitted; 0: 4000. A device has to remember it for
   * longer than that and a line's way (`olp_device`: 5000 by default). Timeouts double up to half of it.
   */
  unsigned long repeat_ms;
  /** How often a command may be retransmitted; 0: 3; below 0: never. */
  int repeats;
  /**
   * Not 0: the device recognises repeated commands (`olp_device` does, no other board is known to): they are
   * retransmitted without acks, after their ack, and as soon as the device reports damage.
   */
  int recognises;
  /** The line's speed in baud, for when a line has left and how long a reply takes; 0: it is not known. */
  unsigned long baud;
  /**
   * Bytes that the device's receive buffer takes: no more are sent before it has read them. 0: 63, as an Arduino's;
   * below 0: any number.
   */
  int receive_room;
};

/** What is in force on a link, as the host knows it. At first, 0 and a window of 1 (section "Link Setup command"). */
struct olp_host_link {
  /** 1: the device acknowledges commands; else 0. */
  int ack;
  /** 1: commands have a Fletcher-16 checksum; else 0. */
  int checksum;
  /** Number of commands that may be unanswered, 1 to 65535. No more than `OLP_WINDOW_MAX` ever are. */
  unsigned int windowsize;
};

/** Something that happened. */
struct olp_host_event {
  /** What: one of `OLP_HOST_WELCOME` to `OLP_HOST_DROPPED`. */
  int kind;
  /** Of `OLP_HOST_ACKED`, `OLP_HOST_ENDED` and `OLP_HOST_ERROR`, the command's; 0 of others. */
  int handle;
  /** Of `OLP_HOST_ENDED`, one of `OLP_HOST_ANSWERED` to `OLP_HOST_NOT_SENT`; 0 of others. */
  int outcome;
  /** Of `OLP_HOST_WELCOME`, the place in the table; -1 of others. */
  int device;
  /** Of `OLP_HOST_WELCOME` and `OLP_HOST_DROPPED`, one of `OLP_RC_*`; 0 of others. */
  int error;
  /** Of `OLP_HOST_LOST`, the number of messages, 1 to 127; 0 of others. */
  int lost;
  /** What is in force on the link. */
  struct olp_host_link link;
  /** The line, where it lies in the session until its next call that is not of `const`; empty if there is none. */
  struct olp_message message;
};

/** A device. Its texts are decoded and end with a 0; those it did not give are empty. */
struct olp_host_device {
  /** What it is called in messages. */
  char id[OLP_HOST_ID_MAX + 1];
  /** What it is, e.g. `OzekiSwitchController`. */
  char type[OLP_HOST_TYPE_MAX + 1];
  /** What its user calls it. */
  char name[OLP_HOST_NAME_MAX + 1];
  /** Its version. */
  char version[OLP_HOST_VERSION_MAX + 1];
  /** Its place among the devices behind the microcontroller; 0 when it did not give one. */
  int pos;
  /** Not 0: its type, name or version is longer than there is room, and was cut off. */
  int cut;
};

/** Counters of a host session since it began; they wrap at 2^32. */
struct olp_host_health {
  /** Lines received that can be read. */
  unsigned long lines;
  /** Of these, acks, answers and refusals that nothing was waiting for. */
  unsigned long strays;
  /** Lines that can't be read. */
  unsigned long malformed;
  /** Lines that were too long. */
  unsigned long overlong;
  /** Messages that the device has sent, as the gaps in their numbers show, and that were not received. */
  unsigned long lost;
  /** Errors that the device has reported. */
  unsigned long errors;
  /** Times that the device restarted. */
  unsigned long restarts;
  /** Calls of `olp_host_receive` that did not take all bytes, because events were to be fetched first. */
  unsigned long overflows;
  /** Acks and answers that did not come in time. */
  unsigned long timeouts;
  /** Commands that were retransmitted, because of that or because the device has asked for it. */
  unsigned long repeats;
  /** Number of round trips measured, in milliseconds: from a command sent once to what came back first. */
  unsigned long rtt_count;
  /** The last round-trip time. */
  unsigned long rtt_last;
  /** The shortest round-trip time. */
  unsigned long rtt_min;
  /** The longest round-trip time. */
  unsigned long rtt_max;
  /** Sum of the round-trip times: divided by `rtt_count`, their average. */
  unsigned long rtt_sum;
};

/**
 * Begins a session; settings are copied, NULL stands for the defaults. All zero is a session with these, too. Returns
 * `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when host is NULL.
 *
 *     struct olp_host_settings settings = {0};
 *     settings.recognises = 1;
 *     olp_host_init(&host, &settings);
 */
int olp_host_init(struct olp_host *host, const struct olp_host_settings *settings) OLP_SIZED(olp_host_init);

/**
 * Queues a `linksetup`, which says what shall be in force on the link (section "Link Setup command"). Any device takes
 * it; the page names the one of type `OzekiIDManager`. Returns what `olp_host_send` does.
 *
 * ack and checksum are 0 (off), 1 (on), or below 0 to leave the parameter out, as windowsize, of 0 to 65535. What is
 * left out stays as it is. All three together make a line that is too long: call this twice, for ack and checksum
 * first. What is in force comes as the event `OLP_HOST_LINKSETUP`, and may be less than was asked for. A window that
 * the answer does not report is 1; of one that it does, no more is used than was asked for last and `OLP_WINDOW_MAX`.
 *
 * It travels alone: it is sent when all commands before it have ended, and those behind it when it has. It should be a
 * session's first command: a device that remembers an earlier session's, to recognise repeats, forgets them.
 *
 *     struct olp_host_device device;
 *     if (olp_host_get_device(&host, 0, &device) == OLP_RC_SUCCESS)
 *         olp_host_setup(&host, device.id, 1, 1, -1);
 */
int olp_host_setup(struct olp_host *host, const char *id, int ack, int checksum, long windowsize)
    OLP_SIZED(olp_host_setup);

/**
 * Queues a command for the device id, a string that is encoded as needed. `OLP_WINDOW_MAX` are kept, sent or not.
 *
 * command is the beginning of its line, e.g. "c=setswitch&state=1", as `olp_begin_command` and `olp_add_*` build it:
 * length bytes (before `olp_finish`, those are `encoder.length`) of printable ASCII, without parameters named `s`, `t`
 * or `id`: the session adds these. They have to fit into the `OLP_COMMAND_MAX` bytes of a line, line feed included,
 * with a `t` of two digits (a longer line is never given a number of three). With an id of 6 characters, command may
 * have 48 bytes, 41 where checksums are in force.
 *
 * Returns the command's handle, 1 to 32767, which `OLP_HOST_ACKED` and `OLP_HOST_ENDED` will carry; or -`OLP_RC_BUSY`
 * when as many are kept (fetch events), -`OLP_RC_TOO_LONG`, -`OLP_RC_MALFORMED` when it is no such line or id is
 * empty, or -`OLP_RC_ERROR_GENERIC` when a pointer is NULL or length is negative. Nothing is queued then.
 *
 *     int handle = olp_host_send(&host, "c=setswitch&state=1", 19, "9o5qzg");
 */
int olp_host_send(struct olp_host *host, const char *command, int length, const char *id) OLP_SIZED(olp_host_send);

/**
 * Takes received bytes, up to the end of a line; `now_ms` is when they came. Behind that end, none are taken until
 * `olp_host_poll` has said that there are no more events of the line: fetch these, and give it the rest.
 *
 * Returns how many bytes were taken, or -`OLP_RC_ERROR_GENERIC` when host is NULL, bytes is negative, or buf is NULL
 * and bytes is not 0.
 *
 *     for (int taken = 0; taken < length; handle_events(&host))
 *         taken += olp_host_receive(&host, in + taken, length - taken, now_ms());
 */
int olp_host_receive(struct olp_host *host, const void *buf, int bytes, unsigned long now_ms)
    OLP_SIZED(olp_host_receive);

/**
 * Fetches the next event. To be called after receiving, and at the latest when `olp_host_next_deadline` says, until
 * there is none; `olp_host_output` comes after that. The events of a line come in this order: lost, dropped, error,
 * linksetup, acked, ended, welcome, line.
 *
 * Returns `OLP_RC_SUCCESS` and the event, `OLP_RC_NO_EVENT` when there is none (`kind` is 0 then), or
 * `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct olp_host_event event;
 *     while (olp_host_poll(&host, now_ms(), &event) == OLP_RC_SUCCESS)
 *         handle_event(&event);
 */
int olp_host_poll(struct olp_host *host, unsigned long now_ms, struct olp_host_event *event) OLP_SIZED(olp_host_poll);

/**
 * Fetches the bytes to send: whole lines; `now_ms` is when they leave. To be called after `olp_host_poll`, with room
 * for at least `OLP_COMMAND_MAX` bytes; with more, it writes as many lines as there are and fit.
 *
 * Returns how many bytes were written, 0 when there is nothing to send or no room for the next line, or
 * -`OLP_RC_ERROR_GENERIC` when host is NULL, cap is negative, or buf is NULL and cap is not 0.
 *
 *     if ((length = olp_host_output(&host, out, sizeof out, now_ms())) > 0)
 *         uart_write(&uart, out, length);
 */
int olp_host_output(struct olp_host *host, void *buf, int cap, unsigned long now_ms) OLP_SIZED(olp_host_output);

/**
 * Returns for how many milliseconds `olp_host_poll` and `olp_host_output` have nothing to do if nothing is received or
 * queued, as poll(2) takes it; -1 when they need not be called at all or host is NULL. Ask when there are no events
 * left and the output was fetched.
 *
 *     wait_readable(&uart, olp_host_next_deadline(&host, now_ms()));
 */
long olp_host_next_deadline(const struct olp_host *host, unsigned long now_ms) OLP_SIZED(olp_host_next_deadline);

/**
 * Copies what is in force on the link, as far as is known: at first, and after the device has restarted, neither acks
 * nor checksums, and a window of 1. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct olp_host_link link;
 *     if (olp_host_get_link(&host, &link) == OLP_RC_SUCCESS && link.checksum)
 *         puts("lines have checksums");
 */
int olp_host_get_link(const struct olp_host *host, struct olp_host_link *link) OLP_SIZED(olp_host_get_link);

/**
 * Copies what is known of a device that has signed in; index is its place in the table, from 0 up, which it keeps.
 * Returns `OLP_RC_SUCCESS`, `OLP_RC_NOT_FOUND`, device being left alone, or `OLP_RC_ERROR_GENERIC` when a pointer is
 * NULL.
 *
 *     struct olp_host_device device;
 *     for (int i = 0; olp_host_get_device(&host, i, &device) == OLP_RC_SUCCESS; ++i)
 *         printf("%s: %s\n", device.id, device.type);
 */
int olp_host_get_device(const struct olp_host *host, int index, struct olp_host_device *device)
    OLP_SIZED(olp_host_get_device);

/**
 * Copies how the link does. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
 *
 *     struct olp_host_health health;
 *     if (olp_host_get_health(&host, &health) == OLP_RC_SUCCESS && health.rtt_count > 0)
 *         printf("round trip: %lu ms on average\n", health.rtt_sum / health.rtt_count);
 */
int olp_host_get_health(const struct olp_host *host, struct olp_host_health *health) OLP_SIZED(olp_host_get_health);

#ifdef __cplusplus
}
#endif

#endif
