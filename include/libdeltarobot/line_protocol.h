/**
 * @file
 * libdeltarobot/line_protocol.h: lines of the Ozeki line protocol: checksum, reading, building, receiving.
 *
 * Building a line: `olp_begin_command`, of a device `olp_begin`. Reading those received:
 *
 *     int got = uart_read(&uart, in, sizeof in);
 *     for (int taken = 0; taken < got;) {
 *         taken += olp_receive(&receiver, in + taken, got - taken, &line);
 *         if (line.kind == OLP_LINE_COMPLETE && olp_parse(line.text, line.length, &message) == OLP_RC_SUCCESS &&
 *             olp_is(&message, "c", 0, "heaterinfo") &&
 *             olp_get_float(&message, "temp", 0, &temperature) == OLP_RC_SUCCESS)
 *             show(temperature);
 *     }
 *
 * Rules for pointers, threads, callbacks and times: libdeltarobot/abi.h.
 * Generated from src/line_protocol.rs by `make header`.
 */
#ifndef LIBDELTAROBOT_LINE_PROTOCOL_H
#define LIBDELTAROBOT_LINE_PROTOCOL_H

#include "abi.h"

LIBDELTAROBOT_NOT_PACKED(line_protocol);

#ifdef LIBDELTAROBOT_SIZED_BY_MACRO
#define olp_receiver_init OLP_SIZED_NAME(olp_receiver_init)
#define olp_receive OLP_SIZED_NAME(olp_receive)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** The operation completed. */
#define OLP_RC_SUCCESS 0
/** A NULL pointer or an argument out of range: nothing was done. */
#define OLP_RC_ERROR_GENERIC 1
/** There is no room. */
#define OLP_RC_OVERFLOW 3
/** Not now: something else has to end first. */
#define OLP_RC_BUSY 5
/** Nothing has happened. */
#define OLP_RC_NO_EVENT 6
/** Text is not what it should be: an escape without its digits, a value that is no number, a line feed in a line. */
#define OLP_RC_MALFORMED 8
/** A line is longer than may be sent, or does not fit the buffer. */
#define OLP_RC_TOO_LONG 9
/** A number is beyond what its type holds. */
#define OLP_RC_RANGE 10
/** There is no such parameter. */
#define OLP_RC_NOT_FOUND 11
/** The first parameter of a line is not `c`, or there is none. */
#define OLP_RC_NO_COMMAND 12
/** A name is not of `[A-Za-z0-9_]`, or a parameter is named `s`, as the checksum is. */
#define OLP_RC_NAME 13
/** Bytes of the longest line that a PC sends, its checksum and its line feed counted: a device's serial buffer. */
#define OLP_COMMAND_MAX 64
/** Most decimals that a float is written with. */
#define OLP_DECIMALS_MAX 9
/** The line has no checksum. */
#define OLP_CHECKSUM_NONE 0
/** The line has the right checksum. */
#define OLP_CHECKSUM_RIGHT 1
/** The line has a checksum, and it is wrong: some of the line is not what was sent. */
#define OLP_CHECKSUM_WRONG 2
/** No line has ended yet. */
#define OLP_LINE_NONE 0
/** A line was received. */
#define OLP_LINE_COMPLETE 1
/** A line longer than `OLP_LINE_MAX` has ended, and is lost. */
#define OLP_LINE_OVERLONG 2
/** `unsigned long`s of a receiver, with some room to spare. */
#define OLP_RECEIVER_WORDS ((OLP_LINE_MAX / 4) + 3)

/** A receiver of lines up to `OLP_LINE_MAX` bytes. All zero is an empty one. */
struct olp_receiver {
  unsigned long opaque[OLP_RECEIVER_WORDS];
};

/** What `olp_receive` found. */
struct olp_line {
  /** One of `OLP_LINE_*`. */
  int kind;
  /** The line without its end, a zero byte behind it, in the receiver until the next call; NULL: there is none. */
  const char *text;
  /** Number of bytes of it; 0 when there is none. */
  int length;
};

/** A line that is being built. Its fields are private. */
struct olp_encoder {
  char *buf;
  int cap;
  int length;
  int error;
};

/** A line that was read: a view of the text that `olp_parse` was given, which must stay where it is meanwhile. */
struct olp_message {
  /** The line. */
  const char *line;
  /** Number of bytes of it, without its end. */
  int length;
  /** Number of parameters, the command and a checksum counted. */
  int count;
  /** One of `OLP_CHECKSUM_*`. */
  int checksum;
  /** The Fletcher-16 of the bytes before `&s=`, or of all of them without a checksum: what an ack repeats. */
  unsigned int sum;
};

/** A parameter: a view of the line that it stands in. Neither text ends with a zero byte. */
struct olp_param {
  /** The name. */
  const char *name;
  /** Number of bytes of it. */
  int name_length;
  /** The value as it was received, encoded: `olp_value_string` decodes it. */
  const char *value;
  /** Number of bytes of it. */
  int value_length;
};

/**
 * Makes a receiver empty, as it is when all zero. Returns `OLP_RC_SUCCESS`, or `OLP_RC_ERROR_GENERIC` for NULL.
 *
 *     olp_receiver_init(&receiver);
 */
int olp_receiver_init(struct olp_receiver *receiver) OLP_SIZED(olp_receiver_init);

/**
 * Takes received bytes up to the end of the next line, and reports in line what they were. Lines end with LF or CR LF;
 * empty ones are passed over. One longer than `OLP_LINE_MAX` is lost: `OLP_LINE_OVERLONG` when its end has come.
 *
 * Returns how many bytes were taken: when fewer than there are, it is to be called again with the rest; or
 * -`OLP_RC_ERROR_GENERIC` when receiver or line is NULL, bytes negative, or buf NULL and bytes not 0.
 *
 *     for (int taken = 0; taken < length;) {
 *         taken += olp_receive(&receiver, in + taken, length - taken, &line);
 *         if (line.kind == OLP_LINE_COMPLETE)
 *             puts(line.text);
 *     }
 */
int olp_receive(struct olp_receiver *receiver, const void *buf, int bytes, struct olp_line *line)
    OLP_SIZED(olp_receive);

/**
 * Begins a line that may be as long as the buffer, its line feed counted: one that a device sends. buf stays there
 * until the line is finished; command is NULL or a string.
 *
 * `olp_add_*` go on with it and `olp_finish` ends it. After the first of them that fails, the others do nothing and
 * return the same, so that it is enough to ask `olp_finish`. In between, buf holds the line so far.
 *
 * Returns `OLP_RC_SUCCESS`; `OLP_RC_NAME` when command is empty or has other bytes than `[A-Za-z0-9_]`,
 * `OLP_RC_TOO_LONG` when it does not fit; or `OLP_RC_ERROR_GENERIC` when a pointer is NULL or cap negative.
 *
 *     olp_begin(&encoder, text, sizeof text, "heaterinfo");
 *     olp_add_float(&encoder, "temp", 21.5f, 2);
 *     length = olp_finish(&encoder, 1);
 */
int olp_begin(struct olp_encoder *encoder, char *buf, int cap, const char *command);

/**
 * Like `olp_begin`, for a line that a PC sends: of at most `OLP_COMMAND_MAX` bytes, checksum and line feed counted,
 * and no more than the buffer. If it is too long, leave out parameters that the device does not need.
 *
 *     char text[OLP_COMMAND_MAX];
 *     struct olp_encoder encoder;
 *     olp_begin_command(&encoder, text, sizeof text, "setswitch");
 *     olp_add_int(&encoder, "state", 1);
 *     olp_add_string(&encoder, "id", "9o5qzg");
 *     if ((length = olp_finish(&encoder, 1)) > 0)
 *         uart_write(&uart, text, length);
 */
int olp_begin_command(struct olp_encoder *encoder, char *buf, int cap, const char *command);

/**
 * Adds a text, a string, encoded: all bytes but `[A-Za-z0-9._-]` as `%` and two hexadecimal digits. encoder was made
 * by `olp_begin` or `olp_begin_command` and its buffer is still there, or is all zero.
 *
 * Returns `OLP_RC_SUCCESS`; `OLP_RC_NAME` when name is empty, `s`, or has other bytes than `[A-Za-z0-9_]`,
 * `OLP_RC_TOO_LONG` when the line does not fit; `OLP_RC_ERROR_GENERIC` when a pointer is NULL; or what an earlier call
 * for this line returned.
 *
 *     olp_add_string(&encoder, "name", "Kitchen lamp");
 */
int olp_add_string(struct olp_encoder *encoder, const char *name, const char *text);

/**
 * Like `olp_add_string`, for length bytes, zero bytes among them; `OLP_RC_ERROR_GENERIC` also when length is negative.
 *
 *     olp_add_bytes(&encoder, "serial", in, 4);
 */
int olp_add_bytes(struct olp_encoder *encoder, const char *name, const void *text, int length);

/**
 * Adds a value that is encoded already, such as one of a received line: unchanged. Returns what `olp_add_bytes` does;
 * `OLP_RC_MALFORMED` when the value has an `&`, a CR or an LF in it, or a `%` without its two digits.
 *
 *     olp_add_raw(&encoder, "t", param.value, param.value_length);
 */
int olp_add_raw(struct olp_encoder *encoder, const char *name, const char *value, int length);

/**
 * Adds an integer, in decimal. Returns what `olp_add_string` does.
 *
 *     olp_add_int(&encoder, "state", 1);
 */
int olp_add_int(struct olp_encoder *encoder, const char *name, long value);

/**
 * Adds a float as `printf("%.*f", decimals, value)` writes it, a tie rounded to the even digit. Returns what
 * `olp_add_string` does; `OLP_RC_RANGE` when value is not finite, or decimals not 0 to `OLP_DECIMALS_MAX`.
 *
 *     olp_add_float(&encoder, "temp", 21.5f, 2);
 */
int olp_add_float(struct olp_encoder *encoder, const char *name, float value, int decimals);

/**
 * Adds the lower 16 bits of value as four hexadecimal digits in lower case. Returns what `olp_add_string` does.
 *
 *     olp_add_hex(&encoder, "checksum", message.sum);
 */
int olp_add_hex(struct olp_encoder *encoder, const char *name, unsigned int value);

/**
 * Ends a line: with its checksum, `&s=` and four hexadecimal digits, unless checksum is 0, and with a line feed. A
 * zero byte stands behind it where the buffer has room for one.
 *
 * Returns the length of the line, its line feed counted; minus what the first call for this line returned that failed,
 * or -`OLP_RC_TOO_LONG` when checksum and line feed do not fit: the first byte of the buffer, if it has one, is zero
 * then; or -`OLP_RC_ERROR_GENERIC` when encoder is NULL or its line was ended already.
 *
 *     length = olp_finish(&encoder, 1);
 */
int olp_finish(struct olp_encoder *encoder, int checksum);

/**
 * The checksum of the protocol, Fletcher-16 in ones' complement: the second sum in bits 8 to 15, the first in bits 0
 * to 7. Both begin at 255, and neither is ever 0: of no bytes it is 0xFFFF, of a NULL pointer or a negative length
 * too.
 *
 *     printf("%04x\n", olp_fletcher16(line.text, line.length));
 */
unsigned int olp_fletcher16(const void *bytes, int length);

/**
 * The checksum of bytes whose beginning has the checksum sum, as far as that has 16 bits: 0xFFFF when there is none.
 * It is sum itself when bytes is NULL or length not positive.
 *
 *     printf("%04x\n", olp_fletcher16_more(olp_fletcher16("c=go&", 5), "x=34", 4));
 */
unsigned int olp_fletcher16_more(unsigned int sum, const void *bytes, int length);

/**
 * Reads a line, with or without its end (LF or CR LF), and describes it in message. Names may be any; a parameter
 * without `=` has an empty value; nothing between two `&` is no parameter. A wrong checksum is no error: see
 * `message->checksum`.
 *
 * Returns `OLP_RC_SUCCESS`; `OLP_RC_NO_COMMAND` when the first parameter is not `c`, `OLP_RC_MALFORMED` when a `%`
 * lacks its two hexadecimal digits or a line feed stands within the line; or `OLP_RC_ERROR_GENERIC` when a pointer is
 * NULL or length negative. Unless it succeeds, message is empty.
 *
 *     if (olp_parse(line.text, line.length, &message) == OLP_RC_SUCCESS && message.checksum != OLP_CHECKSUM_WRONG)
 *         handle_message(&message);
 */
int olp_parse(const char *line, int length, struct olp_message *message);

/**
 * Finds a parameter by its place in the line: 0 is the command, `message->count` - 1 the last. message was filled in
 * by `olp_parse` and its line is still there, or is all zero.
 *
 * Returns `OLP_RC_SUCCESS`, `OLP_RC_NOT_FOUND` when there is none, or `OLP_RC_ERROR_GENERIC` when a pointer is NULL.
 * Unless it succeeds, param is left as it was.
 *
 *     for (int i = 0; olp_param_at(&message, i, &param) == OLP_RC_SUCCESS; ++i)
 *         printf("%.*s\n", param.name_length, param.name);
 */
int olp_param_at(const struct olp_message *message, int index, struct olp_param *param);

/**
 * Finds a parameter by its name, a string. Names repeat: occurrence selects one of that name, 0 the first. The command
 * is the first `c`. Returns what `olp_param_at` does.
 *
 *     if (olp_find(&message, "id", 0, &param) == OLP_RC_SUCCESS)
 *         printf("from %.*s\n", param.value_length, param.value);
 */
int olp_find(const struct olp_message *message, const char *name, int occurrence, struct olp_param *param);

/**
 * Reads a parameter's value as an integer: an optional sign and decimal digits, perhaps spaces around them. param was
 * filled in by `olp_param_at` or `olp_find` and its line is still there, or is all zero.
 *
 * Returns `OLP_RC_SUCCESS`, `OLP_RC_MALFORMED` when the value is none, `OLP_RC_RANGE` when a long does not hold it, or
 * `OLP_RC_ERROR_GENERIC` when a pointer is NULL. Unless it succeeds, value is left as it was.
 *
 *     long state;
 *     if (olp_value_int(&param, &state) == OLP_RC_SUCCESS)
 *         switch_to(state);
 */
int olp_value_int(const struct olp_param *param, long *value);

/**
 * Reads a parameter's value as a decimal number, such as `-1000.00` or `1e3`, perhaps with spaces around it: the
 * nearest float, no infinity or NaN. Returns what `olp_value_int` does; `OLP_RC_RANGE` beyond the largest float.
 *
 *     if (olp_value_float(&param, &temperature) == OLP_RC_SUCCESS)
 *         show(temperature);
 */
int olp_value_float(const struct olp_param *param, float *value);

/**
 * Decodes a parameter's value to buf, and writes a zero byte behind it. There may be others in it.
 *
 * Returns the number of bytes, the last zero byte not counted; -`OLP_RC_TOO_LONG` when they do not fit, buf being then
 * an empty string if cap is not 0; or -`OLP_RC_ERROR_GENERIC` when a pointer is NULL or cap negative (buf may be NULL
 * when cap is 0).
 *
 *     if (olp_value_string(&param, text, sizeof text) >= 0)
 *         puts(text);
 */
int olp_value_string(const struct olp_param *param, char *buf, int cap);

/**
 * Returns 1 if a parameter's decoded value is that text, a string; else, and when a pointer is NULL, 0.
 *
 *     int has_started = olp_value_is(&param, "welcome");
 */
int olp_value_is(const struct olp_param *param, const char *text);

/**
 * `olp_find` and `olp_value_int` in one: returns what they do.
 *
 *     long state;
 *     if (olp_get_int(&message, "state", 0, &state) == OLP_RC_SUCCESS)
 *         switch_to(state);
 */
int olp_get_int(const struct olp_message *message, const char *name, int occurrence, long *value);

/**
 * `olp_find` and `olp_value_float` in one: returns what they do.
 *
 *     if (olp_get_float(&message, "temp", 0, &temperature) == OLP_RC_SUCCESS)
 *         show(temperature);
 */
int olp_get_float(const struct olp_message *message, const char *name, int occurrence, float *value);

/**
 * `olp_find` and `olp_value_string` in one: returns what they do; if -`OLP_RC_NOT_FOUND`, buf is left as it was.
 *
 *     if (olp_get_string(&message, "name", 0, text, sizeof text) >= 0)
 *         puts(text);
 */
int olp_get_string(const struct olp_message *message, const char *name, int occurrence, char *buf, int cap);

/**
 * `olp_find` and `olp_value_is` in one. Returns 1 or 0; 0 when there is no such parameter or a pointer is NULL.
 *
 *     if (olp_is(&message, "c", 0, "heaterinfo") && olp_is(&message, "id", 0, "M1F910"))
 *         handle_message(&message);
 */
int olp_is(const struct olp_message *message, const char *name, int occurrence, const char *text);

#ifdef __cplusplus
}
#endif

#endif
