/* The sample communication of the page "Ozeki Line Protocol": each line received, read, and built again. */
#include "libdeltarobot/line_protocol.h"

#include "check.h"
#include "sample.h"

#include <ctype.h>
#include <stdlib.h>

/* The other lines of that page. */
static const char *const OTHERS[] = {
    "c=ack&checksum=d293&t=255&id=M1F910",
    "c=ack&checksum=null&t=255&id=M1F910",
    ">c=linksetup&ack=on&checksum=fletcher16&t=2&id=sf6z34",
    "c=ack&checksum=d293&t=2&id=sf6z34",
    "c=linksetup_resp&ack=on&checksum=fletcher16&id=sf6z34&t=3",
    "c=linksetup&windowsize=1&ack=on&checksum=fletcher16&t=2&id=sf6z34",
};
enum { LINES = SAMPLE_LINES + sizeof OTHERS / sizeof *OTHERS };

static const char *line_at(int at)
{
    return at < SAMPLE_LINES ? SAMPLE[at] : OTHERS[at - SAMPLE_LINES];
}

/* A line as it was sent, perhaps with its checksum. */
static int as_sent(char *out, int at, int checksum, const char *end)
{
    int length = sprintf(out, "%s", line_at(at) + (*line_at(at) == '>'));
    if (checksum)
        length += sprintf(out + length, "&s=%04x", olp_fletcher16(out, length));
    return length + sprintf(out + length, "%s", end);
}

static void begin(struct olp_encoder *encoder, char *out, int is_command, const struct olp_message *message)
{
    char command[64];

    CHECK(olp_get_string(message, "c", 0, command, (int)sizeof command) > 0);
    if (is_command)
        CHECK_INT(olp_begin_command(encoder, out, 256, command), OLP_RC_SUCCESS);
    else
        CHECK_INT(olp_begin(encoder, out, 256, command), OLP_RC_SUCCESS);
}

/* Each value as it stands in the line. */
static void add_raw(struct olp_encoder *encoder, const char *name, const struct olp_param *param)
{
    CHECK_INT(olp_add_raw(encoder, name, param->value, param->value_length), OLP_RC_SUCCESS);
}

/* Each value as what it means: a number with as many decimals as it was sent with, or text. */
static void add_meaning(struct olp_encoder *encoder, const char *name, const struct olp_param *param)
{
    char text[64];
    long integer;
    float real;
    const char *point;

    CHECK_INT(olp_value_string(param, text, (int)sizeof text), param->value_length);
    point = strchr(text, '.');
    if (isdigit((unsigned char)text[0]) && olp_value_int(param, &integer) == OLP_RC_SUCCESS)
        CHECK_INT(olp_add_int(encoder, name, integer), OLP_RC_SUCCESS);
    else if (olp_value_float(param, &real) == OLP_RC_SUCCESS)
        CHECK_INT(olp_add_float(encoder, name, real, (int)strlen(point + 1)), OLP_RC_SUCCESS);
    else if (strcmp(name, "checksum") == 0 && strlen(text) == 4 && isxdigit((unsigned char)text[0]))
        CHECK_INT(olp_add_hex(encoder, name, (unsigned)strtoul(text, NULL, 16)), OLP_RC_SUCCESS);
    else
        CHECK_INT(olp_add_string(encoder, name, text), OLP_RC_SUCCESS);
}

static void rebuild(int at, const struct olp_message *message, int checksum,
                    void (*add)(struct olp_encoder *, const char *, const struct olp_param *))
{
    struct olp_encoder encoder;
    struct olp_param param;
    char out[256], expected[256], name[64];
    int index, length;

    begin(&encoder, out, *line_at(at) == '>', message);
    for (index = 1; olp_param_at(message, index, &param) == OLP_RC_SUCCESS; ++index) {
        memcpy(name, param.name, (size_t)param.name_length);
        name[param.name_length] = '\0';
        if (strcmp(name, "s") != 0)
            add(&encoder, name, &param);
    }
    CHECK_INT(index, message->count);
    length = as_sent(expected, at, checksum, "\n");
    if (CHECK_INT(olp_finish(&encoder, checksum), length))
        CHECK_BYTES(out, expected, length);
}

/* All lines from one side, as one stream in chunks of a size. */
static void conversation(const char *end, int checksum, int chunk)
{
    static char stream[16384];
    struct olp_receiver receiver;
    struct olp_line line;
    struct olp_message message;
    char text[256];
    int total = 0, done = 0, at = 0, size, taken;

    for (at = 0; at < LINES; ++at)
        total += as_sent(stream + total, at, checksum, end);
    CHECK_INT(olp_receiver_init(&receiver), OLP_RC_SUCCESS);
    for (at = 0; done < total; done += taken) {
        size = chunk < total - done ? chunk : total - done;
        taken = olp_receive(&receiver, stream + done, size, &line);
        if (!CHECK(taken > 0 && taken <= size))
            return;
        if (line.kind == OLP_LINE_NONE) {
            CHECK_INT(taken, size);
            continue;
        }
        if (as_sent(text, at, checksum, "") > OLP_LINE_MAX) {
            CHECK_INT(line.kind, OLP_LINE_OVERLONG);
            ++at;
            continue;
        }
        CHECK_INT(line.kind, OLP_LINE_COMPLETE);
        CHECK_INT(olp_parse(line.text, line.length, &message), OLP_RC_SUCCESS);
        CHECK_INT(message.checksum, checksum ? OLP_CHECKSUM_RIGHT : OLP_CHECKSUM_NONE);
        CHECK_INT(line.length, strlen(text));
        CHECK_BYTES(line.text, text, line.length + 1);
        rebuild(at, &message, checksum, add_raw);
        rebuild(at, &message, checksum, add_meaning);
        ++at;
    }
    CHECK_INT(at, LINES);
}

int main(void)
{
    static const int CHUNKS[] = {1, 2, 7, 64, 16384};
    size_t i;

    for (i = 0; i < sizeof CHUNKS / sizeof *CHUNKS; ++i) {
        conversation("\n", 0, CHUNKS[i]);
        conversation("\r\n", 0, CHUNKS[i]);
        conversation("\n", 1, CHUNKS[i]);
    }
    return check_summary("line_conversation");
}
