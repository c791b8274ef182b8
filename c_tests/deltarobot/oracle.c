/*
 * The far side of oracle.rs: for each line of standard input, chunks of a stream in hex, it tells in one line what the
 * model of the reference and the library make of them. A chunk is processed, then the ring is drained.
 *
 *     m4:480000   the model delivered opcode 48, length 0 and no data; the frame's last byte was the stream's fourth
 *     l4:480000   so did the library by dp_process and dp_recv
 *     e:480000    so did dp_process_each, and
 *     r:2         at the end 2 bytes were left in the library's ring
 *     bad:TEXT    something that may never be
 */
#include "libdeltarobot/protocol.h"
#include "libdeltarobot/protocol_ext.h"

#include "model/model.h"

#include <stdio.h>
#include <string.h>

#define STREAM_MAX 65536

static struct protocol_data ring, ring_of_each;
static struct model_data model;
static int fed;

static void print_frame(int opcode, int data_s, const char *data)
{
    int i;
    printf("%02x%02x", (unsigned)opcode, (unsigned)data_s);
    for (i = 0; i < data_s; ++i)
        printf("%02x", (unsigned)(unsigned char)data[i]);
    putchar(' ');
}

static void check_ring(const struct protocol_data *data)
{
    if (data->m_idx < 0 || data->m_idx >= DP_BUFSIZE || data->m_sz < 0 || data->m_sz > DP_BUFSIZE)
        printf("bad:m_idx=%d,m_sz=%d ", data->m_idx, data->m_sz);
}

static void through_model(char *bytes, int count)
{
    struct model_msg msg;
    model_process(&model, bytes, count);
    while (model_recv(&model, &msg) == MODEL_SUCCESS) {
        printf("m%d:", fed + count - model.m_sz);
        print_frame(msg.opcode, msg.data_s, msg.data);
    }
}

static void through_library(char *bytes, int count)
{
    struct protocol_msg msg;
    int rc = dp_process(&ring, bytes, count);
    int guard = DP_BUFSIZE + 2;

    if (rc != DP_RC_SUCCESS)
        printf("bad:dp_process=%d ", rc);
    do {
        rc = dp_recv(&ring, &msg);
        check_ring(&ring);
        if (rc != DP_RC_SUCCESS)
            continue;
        printf("l%d:", fed + count - ring.m_sz);
        print_frame(msg.opcode, msg.data_s, msg.data);
    } while (rc != DP_RC_NO_FRAME && guard-- > 0);
    if (guard <= 0)
        printf("bad:endless ");
}

static int on_msg(const struct protocol_msg *msg, void *usr)
{
    (void)usr;
    check_ring(&ring_of_each);
    printf("e:");
    print_frame(msg->opcode, msg->data_s, msg->data);
    return 0;
}

static void through_each(const char *bytes, int count)
{
    int taken = dp_process_each(&ring_of_each, bytes, count, on_msg, NULL);
    if (taken != count)
        printf("bad:dp_process_each=%d,of=%d ", taken, count);
    check_ring(&ring_of_each);
}

static int digit(char c)
{
    return c <= '9' ? c - '0' : c - 'a' + 10;
}

/* The chunk is fed from just as many bytes, at the end of an array: a sanitizer sees a read past them. */
static void feed(const char *hex, int digits)
{
    static char bytes[STREAM_MAX];
    int count = digits / 2;
    char *chunk = bytes + STREAM_MAX - count;
    int i;

    for (i = 0; i < count; ++i)
        chunk[i] = (char)(digit(hex[2 * i]) << 4 | digit(hex[2 * i + 1]));
    through_model(chunk, count);
    through_library(chunk, count);
    through_each(chunk, count);
    fed += count;
}

int main(void)
{
    static char line[4 * STREAM_MAX];

    while (fgets(line, sizeof line, stdin)) {
        const char *at = line;
        memset(&model, 0, sizeof model);
        memset(&ring, 0, sizeof ring);
        memset(&ring_of_each, 0, sizeof ring_of_each);
        fed = 0;
        while (*(at += strspn(at, " \n"))) {
            int digits = (int)strcspn(at, " \n");
            feed(at, digits);
            at += digits;
        }
        printf("r:%d\n", ring.m_sz);
        fflush(stdout);
    }
    return 0;
}
