/*
 * A plain C model of the reference library's algorithm, written from what it was seen to do (traces/). It is the
 * oracle of the randomised tests and the baseline of the benchmark, and is never shipped.
 *
 * Sizes come from the command line (-DDP_BUFSIZE=128 -DDP_DATA_MAX_SIZE=32) or from a header included before this one.
 */
#ifndef MODEL_H
#define MODEL_H

#if !defined(DP_BUFSIZE) || !defined(DP_DATA_MAX_SIZE)
#error "the model's sizes are given with -DDP_BUFSIZE=... -DDP_DATA_MAX_SIZE=..."
#endif

#define MODEL_SUCCESS 0
#define MODEL_ERROR_GENERIC 1
#define MODEL_NO_FRAME 2
#define MODEL_OVERFLOW 3
#define MODEL_GARBAGE 4

struct model_msg {
    unsigned char opcode;
    int data_s;
    char data[DP_DATA_MAX_SIZE];
    int checksum_ok;
};

struct model_data {
    char m_buf[DP_BUFSIZE];
    int m_idx;
    int m_sz;
};

typedef int (*model_send_func_t)(void *buf, int bytes, void *usr);

#ifdef __cplusplus
extern "C" {
#endif

int model_process(struct model_data *data, void *buf, int bytes);
int model_recv(struct model_data *data, struct model_msg *msg);
int model_send(struct model_msg *msg, model_send_func_t sendfunc, void *usr);

#ifdef __cplusplus
}
#endif

#endif
