# The sizes that are fixed when the library is built, with their defaults. The Makefile includes this file, and build.rs
# makes constants of it, for Rust and for C, with these comments as their documentation. The sizes of one prefix, in
# this order, are part of the names of the symbols that rest on them.

# Bytes that a ring holds.
DP_BUFSIZE ?= 128
# Longest payload of a frame in bytes, 1 to 255.
DP_DATA_MAX_SIZE ?= 32

# Longest line that is received, in bytes without its end: 63, a command, or more; a host needs 80.
OLP_LINE_MAX ?= 255
# Most commands unanswered at a time: the host keeps them to repeat them, a device keeps its answers.
OLP_WINDOW_MAX ?= 8
# Longest line that a device sends, in bytes with its end: 64 to 255.
OLP_REPLY_MAX ?= 128
# Devices that a host knows at a time.
OLP_DEVICES_MAX ?= 16

# Moves that the motion side queues.
GX_QUEUE_MAX ?= 16
# Most moves of a host that may be unfinished at a time.
GX_WINDOW_MAX ?= 16
