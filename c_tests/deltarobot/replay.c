/*
 * Replays recordings of the reference library (traces/README.md): replay FILE...
 * Compiled with -DUSE_MODEL it replays them against the model of the reference instead, which has to agree everywhere.
 */
#ifdef USE_MODEL
#include "model/model.h"
#define protocol_data model_data
#define protocol_msg model_msg
#define dp_process model_process
#define dp_recv model_recv
#define dp_send model_send
#define DP_RC_SUCCESS MODEL_SUCCESS
#define EXACT_ALWAYS 1
#else
#include "libdeltarobot/protocol.h"
#define EXACT_ALWAYS 0
#endif

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_MAX_CHARS 65536
#define TRACE_FRAMES_MAX 4096
#define NOISE_SUBSEQUENCE_PERCENT 95
#define MISMATCHES_SHOWN_MAX 20

struct frame {
    int opcode;
    int data_s;
    unsigned char data[DP_DATA_MAX_SIZE];
};

struct frames {
    struct frame at[TRACE_FRAMES_MAX];
    int count;
};

enum kind { CLEAN, TRICKY, NOISE, OVERFLOW_KIND, KINDS };
static const char *const KIND_NAMES[KINDS] = {"clean", "tricky", "noise", "overflow"};

static const char *file_name;
static int line_number;
static enum kind kind;
static int mismatches;

static struct protocol_data ring;
static struct protocol_msg message;
static struct frames theirs, ours;
static char trace_name[64];

static struct {
    int traces, calls, recorded, delivered, subsequences;
} totals;

static int mismatch(void)
{
    ++mismatches;
    if (mismatches > MISMATCHES_SHOWN_MAX)
        return 0;
    fprintf(stderr, "%s:%d: ", file_name, line_number);
    return 1;
}

static void malformed(const char *what)
{
    fprintf(stderr, "%s:%d: malformed recording: %s\n", file_name, line_number, what);
    exit(2);
}

static int is_exact(void)
{
    return EXACT_ALWAYS || kind == CLEAN || kind == TRICKY;
}

static void expect(const char *what, long want, long got)
{
    if (want != got && mismatch())
        fprintf(stderr, "%s: %s: expected %ld, got %ld\n", trace_name, what, want, got);
}

static void expect_bytes(const char *what, const unsigned char *want, const void *got, int count)
{
    const unsigned char *bytes = got;
    int i;

    if (memcmp(want, bytes, (size_t)count) == 0 || !mismatch())
        return;
    fprintf(stderr, "%s: %s: expected ", trace_name, what);
    for (i = 0; i < count; ++i)
        fprintf(stderr, "%02x", want[i]);
    fprintf(stderr, ", got ");
    for (i = 0; i < count; ++i)
        fprintf(stderr, "%02x", bytes[i]);
    fputc('\n', stderr);
}

/* The next word of the line, or NULL at its end. */
static char *word(char **rest)
{
    char *start = *rest;
    if (*start == '\0')
        return NULL;
    *rest += strcspn(start, " ");
    if (**rest == ' ')
        *(*rest)++ = '\0';
    return start;
}

static long number(char **rest, int base)
{
    char *text = word(rest);
    char *end;
    long value;
    if (text == NULL)
        malformed("a number is missing");
    value = strtol(text, &end, base);
    if (end == text || *end != '\0')
        malformed("not a number");
    return value;
}

static int nibble(char c)
{
    const char *digits = "0123456789abcdef";
    const char *at = c ? strchr(digits, c) : NULL;
    if (at == NULL)
        malformed("not hexadecimal");
    return (int)(at - digits);
}

/* Decodes a word of hex bytes into `bytes` and gives their number. */
static int hex(char **rest, unsigned char *bytes, int capacity)
{
    char *text = word(rest);
    int count = 0;
    if (text == NULL)
        malformed("bytes are missing");
    if (strcmp(text, "-") == 0)
        return 0;
    for (; *text; text += 2) {
        if (count == capacity)
            malformed("more bytes than there is room for");
        bytes[count++] = (unsigned char)(nibble(text[0]) << 4 | nibble(text[1]));
    }
    return count;
}

static void add(struct frames *frames, const struct frame *frame)
{
    if (frames->count == TRACE_FRAMES_MAX)
        malformed("more frames in a trace than there is room for");
    frames->at[frames->count++] = *frame;
}

static void add_message(void)
{
    struct frame frame;
    memset(&frame, 0, sizeof frame);
    frame.opcode = message.opcode;
    frame.data_s = message.data_s;
    if (message.data_s < 0 || message.data_s > DP_DATA_MAX_SIZE) {
        if (mismatch())
            fprintf(stderr, "%s: data_s out of range: %d\n", trace_name, message.data_s);
        return;
    }
    memcpy(frame.data, message.data, (size_t)message.data_s);
    add(&ours, &frame);
}

static int same_frame(const struct frame *a, const struct frame *b)
{
    return a->opcode == b->opcode && a->data_s == b->data_s && memcmp(a->data, b->data, (size_t)a->data_s) == 0;
}

static int is_subsequence(const struct frames *part, const struct frames *whole)
{
    int found = 0, i;
    for (i = 0; i < whole->count && found < part->count; ++i)
        if (same_frame(&part->at[found], &whole->at[i]))
            ++found;
    return found == part->count;
}

static void finish_trace(void)
{
    int guard = DP_BUFSIZE;

    if (trace_name[0] == '\0')
        return;
    while (guard-- > 0 && dp_recv(&ring, &message) == DP_RC_SUCCESS)
        add_message();
    if (kind == OVERFLOW_KIND && ours.count < theirs.count && mismatch())
        fprintf(stderr, "%s: expected at least %d frames, got %d\n", trace_name, theirs.count, ours.count);
    ++totals.traces;
    totals.recorded += theirs.count;
    totals.delivered += ours.count;
    totals.subsequences += is_subsequence(&theirs, &ours);
}

static void start_trace(const char *name)
{
    finish_trace();
    snprintf(trace_name, sizeof trace_name, "%.60s", name);
    memset(&ring, 0, sizeof ring);
    memset(&message, 0, sizeof message);
    theirs.count = 0;
    ours.count = 0;
}

static void expect_ring(char **rest)
{
    expect("m_idx", number(rest, 10), ring.m_idx);
    expect("m_sz", number(rest, 10), ring.m_sz);
}

static void replay_process(char *rest)
{
    static unsigned char bytes[LINE_MAX_CHARS];
    int count = hex(&rest, bytes, LINE_MAX_CHARS);
    int rc = dp_process(&ring, bytes, count);

    if (!is_exact())
        return;
    expect("dp_process", number(&rest, 10), rc);
    expect_ring(&rest);
}

static void replay_recv(char *rest)
{
    long recorded_rc = number(&rest, 10);
    int rc = dp_recv(&ring, &message);
    struct frame frame;

    if (is_exact()) {
        expect("dp_recv", recorded_rc, rc);
        expect_ring(&rest);
    } else {
        word(&rest);
        word(&rest);
    }
    if (rc == DP_RC_SUCCESS)
        add_message();
    if (recorded_rc != DP_RC_SUCCESS)
        return;
    memset(&frame, 0, sizeof frame);
    frame.opcode = (int)number(&rest, 16);
    frame.data_s = (int)number(&rest, 10);
    if (hex(&rest, frame.data, DP_DATA_MAX_SIZE) != frame.data_s)
        malformed("data_s is not the number of data bytes");
    add(&theirs, &frame);
    if (!is_exact())
        return;
    expect("opcode", frame.opcode, message.opcode);
    expect("data_s", frame.data_s, message.data_s);
    expect_bytes("data", frame.data, message.data, frame.data_s);
    expect("checksum_ok", number(&rest, 10), message.checksum_ok);
}

struct sent {
    unsigned char wire[DP_DATA_MAX_SIZE + 5];
    int bytes, calls, answer;
};

static int take_sent(void *buf, int bytes, void *usr)
{
    struct sent *sent = usr;
    ++sent->calls;
    sent->bytes = bytes;
    if (bytes >= 0 && bytes <= (int)sizeof sent->wire)
        memcpy(sent->wire, buf, (size_t)bytes);
    return sent->answer;
}

static void replay_send(char *rest)
{
    unsigned char data[DP_DATA_MAX_SIZE], wire[DP_DATA_MAX_SIZE + 5];
    struct sent sent;
    int count, rc;

    memset(&sent, 0, sizeof sent);
    memset(&message, 0, sizeof message);
    message.opcode = (unsigned char)number(&rest, 16);
    message.data_s = (int)number(&rest, 10);
    count = hex(&rest, data, DP_DATA_MAX_SIZE);
    memcpy(message.data, data, (size_t)count);
    sent.answer = (int)number(&rest, 10);
    rc = dp_send(&message, take_sent, &sent);
    expect("dp_send", number(&rest, 10), rc);
    expect("callback calls", 1, sent.calls);
    count = hex(&rest, wire, sizeof wire);
    expect("wire length", count, sent.bytes);
    if (count == sent.bytes)
        expect_bytes("wire", wire, sent.wire, count);
    ++totals.calls;
}

/* Reads the file's first line; a trace of other sizes than this program was compiled for can't be replayed. */
static void read_header(const char *line)
{
    char name[16];
    int bufsize, data_max, i;

    if (strncmp(line, "# dp-send 1:", 12) == 0) {
        if (DP_DATA_MAX_SIZE < 32) {
            fprintf(stderr, "%s: has 32 data bytes, compiled for %d\n", file_name, DP_DATA_MAX_SIZE);
            exit(2);
        }
        return;
    }
    if (sscanf(line, "# dp-trace 1 kind=%15s bufsize=%d data_max=%d", name, &bufsize, &data_max) != 3)
        malformed("not a trace");
    if (bufsize != DP_BUFSIZE || data_max != DP_DATA_MAX_SIZE) {
        fprintf(stderr, "%s: recorded for %d/%d, compiled for %d/%d\n", file_name, bufsize, data_max, DP_BUFSIZE,
                DP_DATA_MAX_SIZE);
        exit(2);
    }
    for (i = 0; i < KINDS && strcmp(name, KIND_NAMES[i]) != 0; ++i)
        continue;
    if (i == KINDS)
        malformed("unknown kind");
    kind = (enum kind)i;
}

static void check_totals(void)
{
    if (totals.traces == 0)
        return;
    if (totals.delivered < totals.recorded && mismatch())
        fprintf(stderr, "whole file: expected at least %d frames, got %d\n", totals.recorded, totals.delivered);
    if (is_exact() || kind == OVERFLOW_KIND)
        return;
    if (totals.subsequences * 100 < totals.traces * NOISE_SUBSEQUENCE_PERCENT && mismatch())
        fprintf(stderr, "the recorded frames are a subsequence in %d of %d traces, expected %d %%\n",
                totals.subsequences, totals.traces, NOISE_SUBSEQUENCE_PERCENT);
}

static void replay_line(char *line)
{
    char *rest = line + 2;

    switch (line[0]) {
    case 'T':
        start_trace(rest);
        break;
    case 'P':
        ++totals.calls;
        replay_process(rest);
        break;
    case 'R':
        ++totals.calls;
        replay_recv(rest);
        break;
    case 'S':
        replay_send(rest);
        break;
    default:
        malformed("unknown record");
    }
}

static void replay_file(const char *path)
{
    static char line[LINE_MAX_CHARS];
    FILE *file = fopen(path, "r");
    int before = mismatches;

    if (file == NULL) {
        perror(path);
        exit(2);
    }
    file_name = path;
    line_number = 0;
    memset(&totals, 0, sizeof totals);
    trace_name[0] = '\0';
    while (fgets(line, sizeof line, file)) {
        ++line_number;
        line[strcspn(line, "\n")] = '\0';
        if (line_number == 1)
            read_header(line);
        else if (strlen(line) > 2)
            replay_line(line);
        else
            malformed("too short");
    }
    fclose(file);
    finish_trace();
    check_totals();
    printf("replay: %s: %d traces, %d calls, %d frames recorded, %d delivered, subsequence in %d, %d mismatches\n",
           path, totals.traces, totals.calls, totals.recorded, totals.delivered, totals.subsequences,
           mismatches - before);
}

int main(int argc, char **argv)
{
    int i;

    if (argc < 2) {
        fprintf(stderr, "usage: replay TRACE...\n");
        return 2;
    }
    for (i = 1; i < argc; ++i)
        replay_file(argv[i]);
    return mismatches ? 1 : 0;
}
