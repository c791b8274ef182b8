/* What the examples in the headers use: the program around them. Included behind the header they stand in. */
#ifndef EXAMPLES_PRELUDE_H
#define EXAMPLES_PRELUDE_H

#include <stdio.h>
#include <string.h>

#ifdef __cplusplus
#include <iostream>
extern "C" {
#endif

/* A serial port. Reading doesn't wait; it returns how many bytes had come, writing how many went. */
struct uart {
    int number;
};
extern struct uart uart;
int uart_read(struct uart *uart, void *buf, int cap);
int uart_write(struct uart *uart, const void *buf, int bytes);
int is_over(void);
int uart_send(void *buf, int bytes, void *usr);
void wait_readable(struct uart *uart, long timeout_ms);

/* A clock, when bytes came last, when the robot was asked last, and when something was sent. */
unsigned long now_ms(void);
extern unsigned long heard_at, asked_at, sent_at;

/* Bytes received, bytes to send and how many these are. */
extern unsigned char in[64], out[128];
extern int length;

extern int losses;

/* The machine. */
int motors_home(void);
int motors_move(float a, float b, float c);
int motors_stop(void);
int motors_state(void);
int motors_made_a_step(void);
void motors_where(float *a, float *b, float *c);
int stop_a_is_pressed(void);
int stop_is_pressed(void);
int was_reconnected(void);
int there_is_news(void);
void show(float temperature);
long switch_to(long state);
extern float temperature;

#ifdef LIBDELTAROBOT_PROTOCOL_H
extern struct protocol_data ring;
extern struct protocol_msg msg;
extern int is_idle;
void handle(const struct protocol_msg *msg);
int on_msg(const struct protocol_msg *msg, void *usr);
#endif

#ifdef LIBDELTAROBOT_HOST_H
extern struct dp_host host;
void handle_event(const struct dp_host_event *event);
void handle_events(struct dp_host *host);
#endif

#ifdef LIBDELTAROBOT_RECEIVER_H
extern struct dp_receiver receiver;
extern unsigned char byte;
extern int fetch;
#endif

#ifdef LIBDELTAROBOT_CONTROLLER_H
extern struct dp_controller controller;
int start_homing(void *usr);
int start_move(const struct protocol_msg_position *target, void *usr);
int stop(void *usr);
void read_status(struct protocol_msg_status_report *report, void *usr);
#endif

#ifdef LIBDELTAROBOT_KINEMATICS_H
extern struct dp_robot_configuration configuration;
#endif

#ifdef LIBDELTAROBOT_SERIAL_H
extern struct dp_serial port;
#endif

#ifdef LIBDELTAROBOT_LINE_PROTOCOL_H
extern struct olp_receiver receiver;
extern struct olp_line line;
extern struct olp_message message;
extern struct olp_param param;
extern struct olp_encoder encoder, event;
extern char text[OLP_REPLY_MAX];
void handle_message(const struct olp_message *message);
#endif

#ifdef LIBDELTAROBOT_LINE_DEVICE_H
extern struct olp_device device;
extern const struct olp_device_table table;
int set_switch(const struct olp_message *command, struct olp_encoder *answer, void *usr);
int send_line(const void *line, int bytes, void *usr);
#endif

#ifdef LIBDELTAROBOT_LINE_HOST_H
extern struct olp_host host;
void handle_event(const struct olp_host_event *event);
void handle_events(struct olp_host *host);
#endif

#ifdef LIBDELTAROBOT_GX_H
extern struct gx_commands commands;
extern struct gx_notices notices;
extern struct gx_item item;
extern struct gx_vector position, target;
extern struct gx_contour contour;
extern int32_t path[100][GX_AXES], steps[GX_AXES];
extern int path_length;
void handle_item(const struct gx_item *item);
void motors_start(int axes, const int32_t *target, int velocity);
void motors_count(int32_t *steps);
int motors_have_arrived(void);
#endif

#ifdef LIBDELTAROBOT_GX_HOST_H
extern struct gx_host host;
void handle_event(const struct gx_host_event *event);
void handle_events(struct gx_host *host);
int path_goes_on(void);
const int32_t *next_position(void);
void go_on(void);
#endif

#ifdef LIBDELTAROBOT_GX_MOTION_H
extern struct gx_motion motion;
extern int taken, got;
void serve(struct gx_motion *motion);
#endif

#ifdef CONTOURINGPROTOCOL_H
extern CPVectorCommand command;
extern CPPackedVectorCommandBuffer buffer;
#endif

#ifdef __cplusplus
}
#endif

#endif
