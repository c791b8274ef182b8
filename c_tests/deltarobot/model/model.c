#include "model.h"

#include <string.h>

#define OPCODES "ANHSMChsme"

/* Where the scanner stands in a frame: the part it expects next. */
enum part { STARTER, OPCODE, LENGTH, DATA, CHECKSUM, TERMINATOR };

static char byte_at(const struct model_data *data, int pos)
{
    return data->m_buf[(data->m_idx + pos) % DP_BUFSIZE];
}

static int valid_opcode(unsigned char c)
{
    return c != 0 && strchr(OPCODES, c) != NULL;
}

static unsigned char checksum(const struct model_msg *msg)
{
    unsigned char sum = '$' + ':';
    int i;

    sum = (unsigned char)(sum + msg->opcode);
    sum = (unsigned char)(sum + msg->data_s);
    for (i = 0; i < msg->data_s; ++i)
        sum = (unsigned char)(sum + (unsigned char)msg->data[i]);
    return sum;
}

int model_process(struct model_data *data, void *buf, int bytes)
{
    const char *from = buf;
    int rc = MODEL_SUCCESS;
    int i, lost;

    if (bytes > DP_BUFSIZE) {
        bytes = DP_BUFSIZE;
        rc = MODEL_OVERFLOW;
    }
    lost = data->m_sz + bytes - DP_BUFSIZE;
    if (lost > 0) {
        data->m_idx = (data->m_idx + lost) % DP_BUFSIZE;
        data->m_sz -= lost;
        rc = MODEL_OVERFLOW;
    }
    for (i = 0; i < bytes; ++i)
        data->m_buf[(data->m_idx + data->m_sz + i) % DP_BUFSIZE] = from[i];
    data->m_sz += bytes;
    return rc;
}

/*
 * Every call scans from the ring's start and, when a candidate fails, goes on behind the byte that failed. Only a whole
 * frame moves the ring on. Only bytes skipped between candidates are garbage; those of a failed candidate are not.
 */
int model_recv(struct model_data *data, struct model_msg *msg)
{
    enum part part = STARTER;
    int skipped = 0, filled = 0;
    int pos;

    for (pos = 0; pos < data->m_sz; ++pos) {
        unsigned char c = (unsigned char)byte_at(data, pos);

        switch (part) {
        case STARTER:
            if (c == '$')
                part = OPCODE;
            else
                skipped = 1;
            break;
        case OPCODE:
            msg->opcode = c;
            part = valid_opcode(c) ? LENGTH : STARTER;
            break;
        case LENGTH:
            msg->data_s = c;
            filled = 0;
            part = c > 0 ? DATA : CHECKSUM;
            break;
        case DATA:
            /* The reference wrote (or read) out of bounds from here on: undefined, so the model keeps nothing. */
            if (filled < DP_DATA_MAX_SIZE)
                msg->data[filled] = (char)c;
            if (++filled == msg->data_s)
                part = CHECKSUM;
            break;
        case CHECKSUM:
            msg->checksum_ok = msg->data_s <= DP_DATA_MAX_SIZE && checksum(msg) == c;
            part = msg->checksum_ok ? TERMINATOR : STARTER;
            break;
        case TERMINATOR:
            if (c == ':') {
                data->m_idx = (data->m_idx + pos + 1) % DP_BUFSIZE;
                data->m_sz -= pos + 1;
                return MODEL_SUCCESS;
            }
            part = STARTER;
            break;
        }
    }
    return skipped ? MODEL_GARBAGE : MODEL_NO_FRAME;
}

int model_send(struct model_msg *msg, model_send_func_t sendfunc, void *usr)
{
    char frame[DP_DATA_MAX_SIZE + 5];
    int at = 0;
    int i;

    frame[at++] = '$';
    frame[at++] = (char)msg->opcode;
    frame[at++] = (char)msg->data_s;
    for (i = 0; i < msg->data_s; ++i)
        frame[at++] = msg->data[i];
    frame[at++] = (char)checksum(msg);
    frame[at++] = ':';
    return sendfunc(frame, at, usr);
}
