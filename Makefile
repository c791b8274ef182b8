# libdeltarobot. `make` builds the library, `make test` tests it; README.md tells the rest.

VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml)
MAJOR   := $(firstword $(subst ., ,$(VERSION)))

# Sizes, fixed at build time: bytes of a ring, and of the longest payload (1 to 255).
DP_BUFSIZE       ?= 128
DP_DATA_MAX_SIZE ?= 32
export DP_BUFSIZE DP_DATA_MAX_SIZE

# Where the library, its symbolic links and its headers go.
OUT ?= target/release

CARGO   ?= cargo
OBJCOPY ?= objcopy

CARGO_DIR := $(OUT)/.cargo
SONAME    := libdeltarobot.so.$(MAJOR)
EXPORTS    = $(shell sed 's/@SIZES@/$(DP_BUFSIZE)_$(DP_DATA_MAX_SIZE)/' src/ffi/exports.txt)

.PHONY: all lib header
all: lib

# What is shipped: no std, no libc; in the .a one object with nothing but the public functions global.
lib:
	@mkdir -p $(OUT)/include/libdeltarobot
	DP_HEADER_DIR=$(abspath $(OUT))/include/libdeltarobot $(CARGO) rustc --quiet --lib --release \
	    --no-default-features --features panic-handler --crate-type staticlib,cdylib --target-dir $(CARGO_DIR) \
	    -- -C link-arg=-Wl,-soname,$(SONAME) -C link-arg=-nostdlib
	$(LD) -r --gc-sections $(EXPORTS:%=-u %) -o $(OUT)/.deltarobot.o $(CARGO_DIR)/release/libdeltarobot.a
	$(OBJCOPY) --strip-debug --strip-unneeded $(EXPORTS:%=--keep-global-symbol=%) $(OUT)/.deltarobot.o
	@rm -f $(OUT)/libdeltarobot.a
	$(AR) rcsD $(OUT)/libdeltarobot.a $(OUT)/.deltarobot.o
	@install -m 755 $(CARGO_DIR)/release/libdeltarobot.so $(OUT)/libdeltarobot.so.$(VERSION)
	@strip --strip-unneeded $(OUT)/libdeltarobot.so.$(VERSION)
	@ln -sf libdeltarobot.so.$(VERSION) $(OUT)/$(SONAME)
	@ln -sf $(SONAME) $(OUT)/libdeltarobot.so

# Renews the headers that are checked in, which are those of the default sizes.
header:
	DP_BUFSIZE=128 DP_DATA_MAX_SIZE=32 DP_HEADER_DIR=$(CURDIR)/include/libdeltarobot $(CARGO) check --quiet --target-dir target/header
