# A firmware tree as it was built with the original: libdeltarobot/src/protocol.c among its sources. One file was added
# to the link line.
SRCS := consumer.c libdeltarobot/src/protocol.c
OBJS := $(notdir $(SRCS:.c=.o))
VPATH := $(dir $(SRCS))
CFLAGS := -std=c99 -Wall -Wextra -Wpedantic -Werror -Ilibdeltarobot/include

firmware: $(OBJS) libdeltarobot/build/libdeltarobot.a
	$(CC) -o $@ $^

# Other programs include the source textually.
textual: textual.o libdeltarobot/build/libdeltarobot.a
	$(CC) -o $@ $^
