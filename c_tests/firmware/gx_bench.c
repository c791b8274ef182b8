/*
 * What gx_motion.h costs on an AVR, byte by byte as they come from a UART: cycles a byte of receive and poll, of the
 * whole loop (with fetching and ending the moves, and what is sent), and of the most expensive single byte. The streams
 * are moves of a session, as hosts send them, text, and bytes that mean nothing. Prints a table on the UART, then "done".
 */
#include "bench.h"

#include <libdeltarobot/gx_motion.h>

#include <string.h>

enum { SHORTS, LONGS, TEXT, NOISE, STREAMS, COMMANDS = 24 };

static struct gx_motion motion;
static unsigned char stream[COMMANDS * 24];
static uint16_t size, number;
static uint32_t seed = 1;

static uint16_t random_below(uint16_t limit)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint16_t)(seed >> 16) % limit;
}

static void fill(uint8_t what)
{
    uint8_t i, axis;

    size = 0;
    for (i = 0; i < COMMANDS; ++i) {
        struct gx_vector vector;
        struct gx_number its_number;
        memset(&vector, 0, sizeof vector);
        vector.mask = 3;
        for (axis = 0; axis < 2; ++axis)
            vector.axes[axis] = what == SHORTS ? (int32_t)random_below(127) - 63 : (int32_t)random_below(60000) * 100;
        number = (number + 1) & GX_NUMBER_MAX;
        its_number.value = number;
        its_number.format = what == TEXT ? GX_ASCII : GX_BINARY;
        if (what == NOISE) {
            static const char ALPHABET[] = "!*#~%xyzV0123456789\n\x81\x83\x85\xFF\x80\x80\x80";
            while (size < (i + 1) * 12u)
                stream[size++] = (unsigned char)ALPHABET[random_below(sizeof ALPHABET - 1)];
        } else if (what == SHORTS) {
            size += (uint16_t)gx_write_step(&its_number, &vector, stream + size, 24);
        } else {
            size += (uint16_t)gx_write_move(what == TEXT ? GX_ASCII : GX_BINARY, &its_number, &vector, stream + size, 24);
        }
    }
}

static void begin(void)
{
    static const int32_t ORIGIN[GX_AXES] = {0, 0, 0, 0, 0, 0};
    static const struct gx_motion_settings SETTINGS = {0, 0, 0, 1};
    struct gx_motion_event event;
    char out[GX_ENCODED_MAX];

    gx_motion_init(&motion, &SETTINGS);
    gx_motion_set_position(&motion, ORIGIN);
    gx_motion_receive(&motion, "#0R0\n", 5, 0);
    gx_motion_poll(&motion, 0, &event);
    gx_motion_output(&motion, out, sizeof out, 0);
    number = 0;
}

static void measure(const char *name, uint8_t what)
{
    struct gx_motion_event event;
    struct gx_vector target;
    char out[GX_ENCODED_MAX];
    uint32_t receiving = 0, all = 0, longest = 0, empty;
    uint16_t at;

    begin();
    fill(what);
    empty = ticks();
    empty = ticks() - empty;
    for (at = 0; at < size; ++at) {
        uint32_t start = ticks(), taken, end;
        while (gx_motion_receive(&motion, stream + at, 1, 0) == 0) {
            gx_motion_poll(&motion, 0, &event);
            gx_motion_output(&motion, out, sizeof out, 0);
        }
        while (gx_motion_poll(&motion, 0, &event) == GX_RC_SUCCESS)
            ;
        taken = ticks();
        if (gx_motion_next(&motion, &target, 0) == GX_RC_SUCCESS)
            gx_motion_done(&motion);
        gx_motion_output(&motion, out, sizeof out, 0);
        end = ticks();
        receiving += taken - start - empty;
        all += end - start - 2 * empty;
        if (end - start - 2 * empty > longest)
            longest = end - start - 2 * empty;
    }
    print(name);
    print_number(receiving / size, 8);
    print_number(all / size, 8);
    print_number(longest, 8);
    print("\n");
}

int main(void)
{
    board_init();
    clock_init();
    print("gx_motion, cycles a byte  receive    loop longest\n");
    measure("short moves             ", SHORTS);
    measure("long moves              ", LONGS);
    measure("text                    ", TEXT);
    measure("noise                   ", NOISE);
    print("done\n");
    stop();
}
