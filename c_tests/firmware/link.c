/* A firmware that uses a part of the library. It must keep functions of its own, which the library must not use. */
#ifdef OLD_HEADER
/* As compiled with the original's header, whose names tell no sizes. */
struct protocol_msg {
    unsigned char opcode;
    int data_s;
    char data[DP_DATA_MAX_SIZE];
    int checksum_ok;
};
struct protocol_data {
    char m_buf[DP_BUFSIZE];
    int m_idx, m_sz;
};
typedef int (*send_func_t)(void *buf, int bytes, void *usr);
int dp_process(struct protocol_data *data, void *buf, int bytes);
int dp_recv(struct protocol_data *data, struct protocol_msg *msg);
int dp_send(struct protocol_msg *msg, send_func_t sendfunc, void *usr);
#else
#include <libdeltarobot/protocol.h>
#include <libdeltarobot/protocol_ext.h>
#endif

#ifdef OWN_FUNCTIONS
typedef __SIZE_TYPE__ size;

void *memcpy(void *to, const void *from, size count);
void *memset(void *to, int value, size count);
int __mulsi3(int a, int b);
void *memcpy(void *to, const void *from, size count)
{
    volatile char *out = to;
    const char *in = from;

    while (count-- > 0)
        *out++ = *in++;
    return to;
}
void *memset(void *to, int value, size count)
{
    volatile char *out = to;

    while (count-- > 0)
        *out++ = (char)value;
    return to;
}
int __mulsi3(int a, int b) { return a ^ b; }
int __aeabi_memcpy(void);
int __aeabi_memcpy(void) { return 1; }
int __aeabi_memclr4(void);
int __aeabi_memclr4(void) { return 1; }
int rust_begin_unwind(void);
int rust_begin_unwind(void) { return 1; }
#endif

struct protocol_data ring;
struct protocol_msg msg;
volatile int sink;

static int put(void *buf, int bytes, void *usr)
{
    sink = *(char *)buf + bytes + (usr != 0);
    return 0;
}

int main(void)
{
#ifdef ONLY_SEND
    return dp_send(&msg, put, 0);
#else
    char byte = (char)sink;

    dp_process(&ring, &byte, 1);
    if (dp_recv(&ring, &msg) == 0)
        dp_send(&msg, put, 0);
#ifdef EVERYTHING
    sink = dp_init(&ring) + dp_recv_idle(&ring, &msg) + dp_process_each(&ring, &byte, 1, 0, 0) + *dp_version();
#endif
    return 0;
#endif
}
