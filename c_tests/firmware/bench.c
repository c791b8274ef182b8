/*
 * What the library costs on the target, beside the model of the original (c_tests/deltarobot/model/) in the same image:
 * instructions on a Cortex-M in QEMU, which is told to take one nanosecond for each; cycles on a simulated AVR. Prints
 * a table on the UART, then the stack that was really used, and "done". With LONGEST_ALONE, the longest dp_recv and
 * nothing else.
 */
#include "bench.h"
#include "../deltarobot/model/model.h"

#include <libdeltarobot/protocol.h>
#include <libdeltarobot/receiver.h>

#include <string.h>

#ifndef LONGEST_ALONE
#define LONGEST_ALONE 0
#endif

/* The same model compiled for speed; model.c itself is compiled like firmware, for size. */
int fast_process(struct model_data *data, void *buf, int bytes);
int fast_recv(struct model_data *data, struct model_msg *msg);
int fast_send(struct model_msg *msg, model_send_func_t sendfunc, void *usr);

union ring {
    struct protocol_data ours;
    struct model_data models;
};

union message {
    struct protocol_msg ours;
    struct model_msg models;
};

/* The three to compare have one layout. */
struct library {
    int (*process)(void *data, void *buf, int bytes);
    int (*recv)(void *data, void *msg);
    int (*send)(void *msg, send_func_t sendfunc, void *usr);
};

static int ours_process(void *data, void *buf, int bytes) { return dp_process(data, buf, bytes); }
static int ours_recv(void *data, void *msg) { return dp_recv(data, msg); }
static int ours_send(void *msg, send_func_t sendfunc, void *usr) { return dp_send(msg, sendfunc, usr); }
static int small_process(void *data, void *buf, int bytes) { return model_process(data, buf, bytes); }
static int small_recv(void *data, void *msg) { return model_recv(data, msg); }
static int small_send(void *msg, send_func_t sendfunc, void *usr) { return model_send(msg, sendfunc, usr); }
static int quick_process(void *data, void *buf, int bytes) { return fast_process(data, buf, bytes); }
static int quick_recv(void *data, void *msg) { return fast_recv(data, msg); }
static int quick_send(void *msg, send_func_t sendfunc, void *usr) { return fast_send(msg, sendfunc, usr); }
static int none_process(void *data, void *buf, int bytes) { (void)data; (void)buf; (void)bytes; return 0; }
static int none_recv(void *data, void *msg) { (void)data; (void)msg; return 1; }
static int none_send(void *msg, send_func_t sendfunc, void *usr) { (void)msg; (void)usr; return sendfunc(0, 0, 0); }

static const struct library libraries[] = {
    {none_process, none_recv, none_send}, /* what the loops and calls cost by themselves */
    {ours_process, ours_recv, ours_send},
    {small_process, small_recv, small_send},
    {quick_process, quick_recv, quick_send},
};
#define LIBRARIES 4

#ifdef __AVR__
#define UNIT "cycles"
#define STREAM 512
#else
#define UNIT "instructions"
#define STREAM 4096
#endif

static unsigned char stream[STREAM];
static int stream_bytes;
static union ring ring;
static union message message;

static void print_tenths(uint32_t number, int width)
{
    print_number(number / 10u, width - 2);
    print(".");
    print_number(number % 10u, 1);
}

static int append(void *buf, int bytes, void *usr)
{
    (void)usr;
    if (stream_bytes + bytes > STREAM)
        return 0;
    memcpy(stream + stream_bytes, buf, (size_t)bytes);
    stream_bytes += bytes;
    return 1;
}

static int swallow(void *buf, int bytes, void *usr)
{
    (void)buf;
    (void)bytes;
    (void)usr;
    return 0;
}

static uint32_t seed;

static unsigned char any(void)
{
    seed = seed * 1103515245u + 12345u;
    return (unsigned char)(seed >> 16);
}

static void fill_message(int length)
{
    int i;

    message.ours.opcode = DP_OPCODE_MOVE;
    message.ours.data_s = length;
    for (i = 0; i < length; ++i)
        message.ours.data[i] = (char)(any() | 0x80); /* no starter in it */
}

static void fill_stream(int length)
{
    stream_bytes = 0;
    do
        fill_message(length);
    while (dp_send(&message.ours, append, 0));
}

static uint32_t encode(const struct library *library, int length)
{
    uint32_t before;
    int i;

    fill_message(length);
    before = ticks();
    for (i = 0; i < 64; ++i)
        library->send(&message, swallow, 0);
    return (ticks() - before) * 10u / (uint32_t)(64 * (length + 5));
}

static uint32_t decode(const struct library *library, int piece)
{
    uint32_t before;
    int at;

    memset(&ring, 0, sizeof ring);
    before = ticks();
    for (at = 0; at + piece <= stream_bytes; at += piece) {
        library->process(&ring, stream + at, piece);
        while (library->recv(&ring, &message) == DP_RC_SUCCESS)
            ;
    }
    return (ticks() - before) * 10u / (uint32_t)at;
}

/* The pair and the receiver as firmware calls them, with the loop that does: tenths of an instruction or a cycle a byte. */
static uint32_t pair_in_a_loop(void)
{
    uint32_t before;
    int at;

    memset(&ring, 0, sizeof ring);
    before = ticks();
    for (at = 0; at < stream_bytes; ++at) {
        dp_process(&ring.ours, stream + at, 1);
        while (dp_recv(&ring.ours, &message.ours) == DP_RC_SUCCESS)
            ;
    }
    return (ticks() - before) * 10u / (uint32_t)stream_bytes;
}

static struct dp_receiver receiver;

static uint32_t receiver_in_a_loop(void)
{
    uint32_t before;
    int at;

    dp_receiver_init(&receiver);
    before = ticks();
    for (at = 0; at < stream_bytes; ++at)
        if (dp_receiver_byte(&receiver, stream[at]))
            while (dp_receiver_next(&receiver, &message.ours) == DP_RC_SUCCESS)
                ;
    return (ticks() - before) * 10u / (uint32_t)stream_bytes;
}

static void loop_row(const char *name)
{
    int pad;

    print(name);
    for (pad = (int)strlen(name); pad < 36; ++pad)
        print(" ");
    print_tenths(pair_in_a_loop(), 10);
    print_tenths(receiver_in_a_loop(), 10);
    print("\n");
}

static void loop_rows(void)
{
    static const int lengths[] = {0, 1, 12, 16, 32};
    int i;

    print("with the loop of the caller               pair  receiver\n");
    for (i = 0; i < 5 && lengths[i] <= DP_DATA_MAX_SIZE; ++i) {
        char name[] = "payload of   ";

        name[11] = (char)('0' + lengths[i] / 10);
        name[12] = (char)('0' + lengths[i] % 10);
        fill_stream(lengths[i]);
        loop_row(name);
    }
    for (stream_bytes = 0; stream_bytes < STREAM; ++stream_bytes)
        stream[stream_bytes] = any();
    loop_row("noise");
    memset(stream, '$', STREAM);
    loop_row("nothing but $");
    for (i = 0; i < STREAM; ++i)
        stream[i] = (unsigned char)"$A\037:"[i % 4];
    loop_row("false frames");
}

static void row(const char *name, uint32_t (*measure)(const struct library *library, int parameter), int parameter)
{
    uint32_t empty = 0;
    int i, pad;

    print(name);
    for (pad = (int)strlen(name); pad < 36; ++pad)
        print(" ");
    for (i = 0; i < LIBRARIES; ++i) {
        uint32_t tenths = measure(&libraries[i], parameter);

        if (i == 0)
            empty = tenths;
        else
            print_tenths(tenths > empty ? tenths - empty : 0, 10);
    }
    print("\n");
}

/*
 * The most that one dp_recv can take: a ring full of candidates that are all given up only at their checksum. "$A", a
 * length and ':' over and over is such one when the place of the terminator falls on a ':'.
 */
static uint32_t worst_recv(const struct library *library, int unused)
{
    static const char patterns[][5] = {"$$$$", "$A$A", "$M \n", "xxxx", "$A::"};
    uint32_t most = 0;
    int k, i, start;

    (void)unused;
    for (k = 0; k < 5 + DP_DATA_MAX_SIZE + 1; ++k)
        for (start = 0; start < DP_BUFSIZE; start += DP_BUFSIZE / 4 - 1) {
            uint32_t before;

            for (i = 0; i < DP_BUFSIZE; ++i) {
                const char *pattern = k < 5 ? patterns[k] : "$A?:";

                ring.ours.m_buf[(start + i) % DP_BUFSIZE] = k >= 5 && i % 4 == 2 ? (char)(k - 5) : pattern[i % 4];
            }
            ring.ours.m_idx = start;
            ring.ours.m_sz = DP_BUFSIZE;
            before = ticks();
            library->recv(&ring, &message);
            before = ticks() - before;
            if (before > most)
                most = before;
        }
    return most * 10u;
}

/*
 * The stack that a call really takes: what lies below main's is painted before and looked through afterwards. Both are
 * done in main itself, without a call, and nothing interrupts.
 */
#define PAINTED (DP_DATA_MAX_SIZE + 256)

#ifdef __AVR__
#define stack_pointer() ((unsigned char *)SP + 1)
#else
static inline unsigned char *stack_pointer(void)
{
    unsigned char *sp;

    __asm__ volatile("mov %0, sp" : "=r"(sp));
    return sp;
}
#endif

static inline __attribute__((always_inline)) void paint(void)
{
    volatile unsigned char *end = stack_pointer();
    int i;

    for (i = 1; i <= PAINTED; ++i)
        end[-i] = 0xA5;
}

static inline __attribute__((always_inline)) int used(void)
{
    const volatile unsigned char *end = stack_pointer();
    int i = PAINTED;

    while (i > 0 && end[-i] == 0xA5)
        --i;
    return i;
}

int main(void)
{
    static const int lengths[] = {0, 1, 12, 16, 32};
    int stacks[3];
    size_t i;

    board_init();
    clock_init();
    if (LONGEST_ALONE) {
        row("longest dp_recv, 512/255, whole", worst_recv, 0);
        print("done\n");
        stop();
    }

    print(UNIT);
    for (i = sizeof UNIT - 1; i < 36; ++i)
        print(" ");
    print("   library model -Os model -O2\n");
    for (i = 0; i < sizeof lengths / sizeof lengths[0]; ++i)
        if (lengths[i] <= DP_DATA_MAX_SIZE) {
            char name[] = "encode a byte, payload of   ";

            name[26] = (char)('0' + lengths[i] / 10);
            name[27] = (char)('0' + lengths[i] % 10);
            row(name, encode, lengths[i]);
        }
    for (i = 0; i < sizeof lengths / sizeof lengths[0]; ++i)
        if (lengths[i] <= DP_DATA_MAX_SIZE) {
            char name[] = "byte by byte, payload of   ";

            name[25] = (char)('0' + lengths[i] / 10);
            name[26] = (char)('0' + lengths[i] % 10);
            fill_stream(lengths[i]);
            row(name, decode, 1);
        }
    fill_stream(16 < DP_DATA_MAX_SIZE ? 16 : DP_DATA_MAX_SIZE);
    row("64 at a time, payload of 16", decode, 64);
    for (stream_bytes = 0; stream_bytes < STREAM; ++stream_bytes)
        stream[stream_bytes] = any();
    row("noise, byte by byte", decode, 1);
    memset(stream, '$', STREAM);
    row("nothing but $, byte by byte", decode, 1);
    for (i = 0; i < STREAM; ++i)
        stream[i] = (unsigned char)"$A\037:"[i % 4];
    row("false frames, byte by byte", decode, 1);
    row("longest dp_recv, whole", worst_recv, 0);
    loop_rows();

    /* With the callback's own part, which is next to nothing. */
#ifdef __AVR__
    cli();
#endif
    fill_message(DP_DATA_MAX_SIZE);
    paint();
    dp_send(&message.ours, swallow, 0);
    stacks[0] = used();
    fill_stream(DP_DATA_MAX_SIZE);
    memset(&ring, 0, sizeof ring);
    paint();
    dp_process(&ring.ours, stream, DP_BUFSIZE);
    stacks[1] = used();
    paint();
    dp_recv(&ring.ours, &message.ours);
    stacks[2] = used();
    print("bytes of stack: dp_send ");
    print_number((uint32_t)stacks[0], 0);
    print(", dp_process ");
    print_number((uint32_t)stacks[1], 0);
    print(", dp_recv ");
    print_number((uint32_t)stacks[2], 0);
    print("\ndone\n");
    stop();
    return 0;
}
