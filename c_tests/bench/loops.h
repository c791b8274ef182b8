/*
 * The loops that bench.c measures, once for each side: include it with SIDE and STRUCT defined. No include guard.
 */

static int SIDE(callback)(void *buf, int bytes, void *usr)
{
    (void)usr;
    taken += ((unsigned char *)buf)[bytes - 1];
    return 0;
}

static void SIDE(encode)(STRUCT(data) *ring, struct stream *stream)
{
    static STRUCT(msg) msg;
    int frame = stream->payload + WIRE_OVERHEAD;
    int at;

    (void)ring;
    msg.opcode = 'M';
    msg.data_s = stream->payload;
    memcpy(msg.data, stream->bytes + 3, (size_t)stream->payload);
    for (at = 0; at < stream->size; at += frame)
        SIDE(send)(&msg, SIDE(callback), NULL);
}

static void SIDE(bytes)(STRUCT(data) *ring, struct stream *stream)
{
    static STRUCT(msg) msg;
    int at;

    for (at = 0; at < stream->size; ++at) {
        SIDE(process)(ring, stream->bytes + at, 1);
        if (SIDE(recv)(ring, &msg) == DP_RC_SUCCESS)
            taken += msg.opcode;
    }
}

static void SIDE(chunks)(STRUCT(data) *ring, struct stream *stream)
{
    static STRUCT(msg) msg;
    int at;

    for (at = 0; at < stream->size; at += CHUNK) {
        SIDE(process)(ring, stream->bytes + at, stream->size - at < CHUNK ? stream->size - at : CHUNK);
        while (SIDE(recv)(ring, &msg) == DP_RC_SUCCESS)
            taken += msg.opcode;
    }
}

/* Not part of the measure as it is shown: only SIDE(recv) counts, see run.sh. */
static void SIDE(full_ring)(STRUCT(data) *ring, struct stream *stream)
{
    static STRUCT(msg) msg;

    ring->m_idx = DP_BUFSIZE / 2;
    ring->m_sz = 0;
    SIDE(process)(ring, stream->bytes, DP_BUFSIZE);
    SIDE(recv)(ring, &msg);
}
