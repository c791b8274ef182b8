/* An object file that was compiled with the original's header knows the functions by their plain names. */
#include "check.h"

#include <stddef.h>

struct protocol_msg {
    unsigned char opcode;
    int data_s;
    char data[32];
    int checksum_ok;
};
struct protocol_data {
    char m_buf[128];
    int m_idx;
    int m_sz;
};
typedef int (*send_func_t)(void *buf, int bytes, void *usr);
int dp_process(struct protocol_data *data, void *buf, int bytes);
int dp_recv(struct protocol_data *data, struct protocol_msg *msg);
int dp_send(struct protocol_msg *msg, send_func_t sendfunc, void *usr);

static int loop_back(void *buf, int bytes, void *usr)
{
    return dp_process((struct protocol_data *)usr, buf, bytes);
}

int main(void)
{
    static struct protocol_data ring;
    static struct protocol_msg message;

    message.opcode = 'M';
    message.data_s = 32;
    message.data[31] = 1;
    CHECK_INT(dp_send(&message, loop_back, &ring), 0);
    memset(&message, 0, sizeof message);
    CHECK_INT(dp_recv(&ring, &message), 0);
    CHECK_INT(message.opcode, 'M');
    CHECK_INT(message.data_s, 32);
    CHECK_INT(message.data[31], 1);
    return check_summary("relinked");
}
