# libdeltarobot. `make` builds the library, `make help` lists the other targets, README.md tells the rest.

include src/sizes.mk
ALL_SIZES := $(shell sed -n 's/ ?= .*//p' src/sizes.mk)
export $(ALL_SIZES)
# Where the library, its symbolic links and its headers go: a path without spaces. Any number of sizes can be built
# there one after the other.
OUT ?= target/release

# Rust's name of the machine to build for, when it is another one, and the prefix of its GNU binutils:
# `make OUT=build/m0 DP_TARGET=thumbv6m-none-eabi CROSS_COMPILE=arm-none-eabi-`.
DP_TARGET     ?= $(CARGO_BUILD_TARGET)
CROSS_COMPILE ?=
# What kind of system that is: elf, windows or macos. The shared library differs, and with it what makes it.
BUILDS_FOR := $(or $(DP_TARGET),$(shell uname -s))
SYSTEM := $(if $(findstring windows,$(BUILDS_FOR))$(filter MINGW% MSYS%,$(BUILDS_FOR)),windows,$(if \
    $(findstring apple,$(BUILDS_FOR))$(filter Darwin,$(BUILDS_FOR)),macos,elf))
# Whether to build the shared library too. Bare metal has none.
SHARED        ?= $(if $(findstring -none,$(DP_TARGET)),no,yes)
# Whether to build serial.h's part too, which needs Unix and its libc, or Windows.
SERIAL        ?= $(if $(findstring -none,$(DP_TARGET)),no,yes)

PREFIX     ?= /usr/local
LIBDIR     ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
BINDIR     ?= $(PREFIX)/bin
DATADIR    ?= $(PREFIX)/share

CARGO  ?= cargo
CFLAGS ?= -O2
ifeq ($(origin LD),default)
LD := $(CROSS_COMPILE)ld
endif
ifeq ($(origin AR),default)
AR := $(CROSS_COMPILE)ar
endif
NM      ?= $(CROSS_COMPILE)nm
OBJCOPY ?= $(CROSS_COMPILE)objcopy
STRIP   ?= $(CROSS_COMPILE)strip

# `make V=1` shows the commands.
ifneq ($(V),1)
Q     := @
QUIET := --quiet
endif

VERSION := $(shell sed -n '/^version = /{s/.*"\(.*\)"/\1/p;q;}' Cargo.toml)
MAJOR   := $(firstword $(subst ., ,$(VERSION)))
SONAME  := libdeltarobot.so.$(MAJOR)
# The files of the shared library: it, and its links, each to the one before it. In Windows also what programs link with,
# and the list of exports, of which `lib /def:` makes that for MSVC.
SHARED_FILES.elf     := libdeltarobot.so.$(VERSION) $(SONAME) libdeltarobot.so
SHARED_FILES.macos   := libdeltarobot.$(VERSION).dylib libdeltarobot.$(MAJOR).dylib libdeltarobot.dylib
SHARED_FILES.windows := deltarobot.dll libdeltarobot.dll.a deltarobot.def
SHARED_FILES         := $(SHARED_FILES.$(SYSTEM))
# What the library exports, of which the serial port is a part that can be left out.
WITH_SERIAL := $(filter yes,$(SERIAL))
EXPORTS      = $(filter-out $(if $(WITH_SERIAL),,dp_serial_%),$(shell cat $(GENERATED)/exports.txt))

# Cargo's files (several OUTs can share them, one after the other), and the finished ones before they are put into
# $(OUT): a plain `cargo build --release` writes its own libdeltarobot.a and .so into target/release.
CARGO_DIR ?= $(OUT)/.cargo
STAGE     := $(OUT)/.stage
BUILT     := $(CARGO_DIR)/$(DP_TARGET)/release
# sizes.h and the list of symbols are generated into a directory of these sizes, so that none of other sizes can be
# mistaken for them.
GENERATED := $(CARGO_DIR)/include/$(subst $(subst ,, ),_,$(foreach size,$(ALL_SIZES),$($(size))))

# $(call renew,FILE,COPY): the copy keeps its time when nothing changed, so that what depends on it is not made again.
# It is replaced, never written to: it may be a hard link of cargo's.
renew = if ! cmp -s $(1) $(2); then cp $(1) $(2).new && mv -f $(2).new $(2); fi

# A build in the tree's own directory, for other sizes than the default ones: include/libdeltarobot/sizes.h prefers this
# file, which git ignores, so that programs that include the headers where they lie get those that fit.
IN_PLACE       ?= $(if $(filter target/release target/firmware/%,$(OUT)),yes)
IN_PLACE_SIZES := include/libdeltarobot/sizes_in_place.h

HEADERS := $(patsubst include/%,%,$(filter-out $(IN_PLACE_SIZES),$(wildcard include/*.h include/libdeltarobot/*.h)))
HEADERS := $(filter-out $(if $(WITH_SERIAL),,%/serial.h),$(HEADERS))
SHIPPED := $(STAGE)/libdeltarobot.a
ifeq ($(SHARED),yes)
SHIPPED += $(STAGE)/$(firstword $(SHARED_FILES))
endif

.PHONY: all lib header doc test check-artifact install uninstall cli install-cli uninstall-cli serve \
    install-serve uninstall-serve convert install-convert uninstall-convert load load-broker \
    faults faults-outside demo demo-line demo-gx wheel deb bench coverage mutants figures fuzz clean help FORCE
.DELETE_ON_ERROR:

all: lib

lib: $(SHIPPED) ## builds the library (default)
	$(Q)mkdir -p $(OUT)/include/libdeltarobot
	$(Q)for header in $(HEADERS); do \
	    case $$header in */sizes.h) from=$(GENERATED)/sizes.h ;; *) from=include/$$header ;; esac; \
	    $(call renew,$$from,$(OUT)/include/$$header) || exit; \
	done
	$(Q)$(call renew,$(STAGE)/libdeltarobot.a,$(OUT)/libdeltarobot.a)
	$(Q)rm -f $(if $(filter-out yes,$(SHARED)),$(SHARED_FILES:%=$(OUT)/%))
ifeq ($(SHARED),yes)
	$(Q)from=; for file in $(SHARED_FILES); do \
	    if [ -z "$$from" ] || [ $(SYSTEM) = windows ]; then $(call renew,$(STAGE)/$$file,$(OUT)/$$file); \
	    else ln -sf $$from $(OUT)/$$file; fi && from=$$file || exit; \
	done
endif
ifeq ($(IN_PLACE),yes)
	$(Q)if cmp -s $(GENERATED)/sizes.h include/libdeltarobot/sizes.h; then rm -f $(IN_PLACE_SIZES); \
	else $(call renew,$(GENERATED)/sizes.h,$(IN_PLACE_SIZES)); fi
endif
	@echo "lib: libdeltarobot $(VERSION) for $(DP_BUFSIZE)/$(DP_DATA_MAX_SIZE) bytes is in $(OUT)"

# Only cargo knows what has changed, so it is always asked; but the steps behind it look at what it made.
# No std in it; of other libraries the .so needs libc, and that only for the serial port. Firmware may have no memcpy, so
# copy loops must not become calls of it. (`#![no_builtins]` would say so too, but keeps a crate out of the link-time
# optimization that makes one piece of the C ABI and the core.)
CDYLIB := $(if $(filter elf,$(SYSTEM)),$(filter yes,$(SHARED)))
# Rust's targets for Thumb keep a frame pointer in each function, three instructions of a short one, which no option of
# rustc's drops. This switch of LLVM's does, in the public functions.
NO_FRAME_POINTERS := $(if $(filter thumb%,$(DP_TARGET)),-C llvm-args=-forceattrs-csv-path=$(GENERATED)/no_frame_pointers.csv)
$(STAGE)/cargo.a: FORCE
	$(Q)mkdir -p $(STAGE)
	+$(Q)DP_SIZES_DIR='$(GENERATED)' RUSTFLAGS='$(RUSTFLAGS) -C llvm-args=-disable-loop-idiom-all' \
	    $(CARGO) rustc $(QUIET) --lib --release --no-default-features \
	    --features panic-handler$(if $(WITH_SERIAL),$(,)serial) \
	    --crate-type staticlib$(if $(filter yes,$(CDYLIB)),$(,)cdylib) \
	    --target-dir $(CARGO_DIR) $(if $(DP_TARGET),--target $(DP_TARGET)) \
	    -- $(NO_FRAME_POINTERS) $(if $(CDYLIB),-C link-arg=-Wl$(,)-soname$(,)$(SONAME) -C link-arg=-nostdlib \
	    $(if $(CROSS_COMPILE),-C linker=$(CROSS_COMPILE)gcc))
	$(Q)$(call renew,$(BUILT)/libdeltarobot.a,$@)
ifeq ($(CDYLIB),yes)
	$(Q)$(call renew,$(BUILT)/libdeltarobot.so,$(STAGE)/cargo.so)
endif
$(STAGE)/cargo.so: $(STAGE)/cargo.a ;
, := ,

# Cargo's archive holds all of Rust's core library. Out of it comes one object with what the public functions need, in
# which only they are global: nothing that a program's own functions, or another Rust library, could clash with. What
# goes besides: Rust's bitcode, as some binutils read that instead of the code and fail; unwind tables, which would only
# say "can't"; and on bare metal the note about the stack, because linkers would miss it in the firmware's own objects.
# On hosts, where linkers are seldom told to drop what is not called, each part is an object of its own. The serial port
# is one everywhere: only programs that use it need what it needs.
# HELPERS is what firmware/build.sh has to add.
HELPERS :=
BARE    := $(findstring -none,$(DP_TARGET))
ifeq ($(SYSTEM),elf)
PARTS   := $(if $(BARE),,receiver payload sessions line gx kinematics) $(if $(WITH_SERIAL),serial)
receiver   := dp_receiver_%
payload    := dp_build% dp_read% dp_msg% dp_opcode_name%
sessions   := dp_host_% dp_controller_%
line       := olp_%
gx         := gx_% PackCP% UnpackCP%
kinematics := dp_kinematics_%
serial     := dp_serial_%
OBJECTS := $(STAGE)/deltarobot.o $(PARTS:%=$(STAGE)/%.o)
$(STAGE)/deltarobot.o: OF_OBJECT = $(filter-out $(foreach part,$(PARTS),$($(part))),$(EXPORTS))
$(PARTS:%=$(STAGE)/%.o): OF_OBJECT = $(filter $($(basename $(@F))),$(EXPORTS))
$(OBJECTS): $(STAGE)/cargo.a Makefile
	$(Q)$(LD) -r --gc-sections $(OF_OBJECT:%=--require-defined=%) -o $@ $< $(HELPERS)
	$(Q)$(OBJCOPY) -w -R .llvmbc -R .llvmcmd -R '.ARM.exidx*' $(if $(BARE),-R '.note*' -R '.eh_frame*') \
	    --strip-unneeded --keep-symbol='_[ZR]*' $(OF_OBJECT:%=--keep-global-symbol=%) $@
$(STAGE)/libdeltarobot.so.$(VERSION): $(STAGE)/cargo.so Makefile
	$(Q)$(STRIP) --strip-unneeded -o $@ $<
else
include packaging/$(SYSTEM).mk
endif
$(STAGE)/libdeltarobot.a: $(OBJECTS)
	$(Q)rm -f $@ && $(AR) rcs$(if $(filter macos,$(SYSTEM)),,D) $@ $^

# The sizes into a new directory each time: cargo then runs the build script even if it sees no need to.
header: ## renews include/, which holds the headers of the default sizes
	+$(Q)rm -rf target/header/sizes.* && new=target/header/sizes.$$$$ && \
	env $(ALL_SIZES:%=-u %) DP_SIZES_DIR=$$new $(CARGO) check $(QUIET) --lib --target-dir target/header && \
	$(call renew,$$new/sizes.h,include/libdeltarobot/sizes.h)
	+$(Q)$(CARGO) run $(QUIET) -p deltarobot-headers -- include
	@echo "header: include is up to date"

doc: ## builds the documentation, of the crate and of the C API, in target/doc; needs doxygen
	+$(Q)env $(ALL_SIZES:%=-u %) RUSTDOCFLAGS='-D warnings' $(CARGO) doc $(QUIET) --no-deps --workspace --exclude deltarobot-cli --exclude deltarobot-records --exclude deltarobot-serve --features serial \
	    --target-dir target
	$(Q)mkdir -p target/doc/c && doxygen docs/Doxyfile
	@echo "doc: target/doc/deltarobot/index.html for Rust, target/doc/c/html/index.html for C"

# The tests call `make` themselves: they shall not take this one's options for theirs.
test: ## runs all tests; TESTFLAGS go to `cargo test`
	$(Q)MAKEFLAGS= MFLAGS= $(CARGO) test $(QUIET) --workspace --exclude deltarobot-serve --features serial $(TESTFLAGS)
	$(Q)MAKEFLAGS= MFLAGS= $(CARGO) test $(QUIET) -p deltarobot-serve $(TESTFLAGS)
	@echo "test: passed"

check-artifact: lib ## proves that the library exports what it should, and needs and holds nothing else
	$(Q)NM='$(NM)' READELF='$(CROSS_COMPILE)readelf' SIZE='$(CROSS_COMPILE)size' SHARED='$(SHARED)' SERIAL='$(SERIAL)' \
	    BARE='$(BARE)' OBJECTS='$(notdir $(OBJECTS))' packaging/check-artifact.sh $(OUT) $(STAGE) $(VERSION) $(EXPORTS)

# `sudo make install` often finds no cargo: then what was built before is installed, if it has these sizes.
install: $(if $(shell command -v $(CARGO)),lib) ## installs below PREFIX; also DESTDIR, LIBDIR, INCLUDEDIR
install uninstall:
	$(Q)DESTDIR='$(DESTDIR)' PREFIX='$(PREFIX)' LIBDIR='$(LIBDIR)' INCLUDEDIR='$(INCLUDEDIR)' \
	    BINDIR='$(BINDIR)' SHARED_FILES='$(SHARED_FILES)' OUT='$(OUT)' VERSION='$(VERSION)' HEADERS='$(HEADERS)' \
	    SIZES='$(foreach size,$(ALL_SIZES),$(size)=$(strip $($(size))))' \
	    packaging/install.sh $@
uninstall: ## removes what install put there, given the same directories

# Not part of `all`: it needs crates that take longer to compile than the library, and most users none of it. Its sizes
# are always the default ones. In a directory of its own: cargo would take its library and the shipped one, of other
# features, for the same file, and compile both again each time.
CLI_DIR := $(CARGO_DIR)/cli
# Compiled on all cores, unlike the library, for which each byte counts; and a panic removes links.
CLI_PROFILE := CARGO_PROFILE_RELEASE_LTO=false CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 CARGO_PROFILE_RELEASE_PANIC=unwind
# $(call program,NAME,PACKAGE)
define program
	+$(Q)mkdir -p $(OUT) && env $(ALL_SIZES:%=-u %) $(CLI_PROFILE) $(CARGO) build $(QUIET) --release -p $(2) \
	    --target-dir $(CLI_DIR) $(if $(DP_TARGET),--target $(DP_TARGET))
	$(Q)$(call renew,$(CLI_DIR)/$(DP_TARGET)/release/$(1),$(OUT)/$(1))
	@echo "$@: $(OUT)/$(1)"
endef
cli: ## builds the program `deltarobot`
	$(call program,deltarobot,deltarobot-cli)

# A program of its own, since what it is made of takes minutes to compile.
serve: ## builds `deltarobot serve` and `deltarobot ui`
	$(call program,deltarobot-serve,deltarobot-serve)
	$(Q)$(call renew,$(CLI_DIR)/$(DP_TARGET)/release/deltarobot-ui,$(OUT)/deltarobot-ui)

# So is this one: its MCAP adds a third to what `cli` takes.
convert: ## builds `deltarobot convert`, which `record` into MCAP takes too
	$(call program,deltarobot-convert,deltarobot-records)

# Where shells look for completions, and what `deltarobot completions` calls the shells.
COMPLETIONS := bash:bash-completion/completions/deltarobot zsh:zsh/site-functions/_deltarobot \
    fish:fish/vendor_completions.d/deltarobot.fish

# The program itself writes its manual pages and completions: not when it was built for another machine.
install-cli: $(if $(shell command -v $(CARGO)),cli) ## installs the program in BINDIR, its manual and completions in DATADIR, below PREFIX
	$(Q)mkdir -p '$(DESTDIR)$(BINDIR)' && install -m 755 $(OUT)/deltarobot '$(DESTDIR)$(BINDIR)/deltarobot'
	$(Q)if $(OUT)/deltarobot --version >/dev/null 2>&1; then \
	    $(OUT)/deltarobot man '$(DESTDIR)$(DATADIR)/man/man1' && \
	    for shell in $(COMPLETIONS); do \
	        file='$(DESTDIR)$(DATADIR)'/$${shell#*:} && mkdir -p "$${file%/*}" && \
	        $(OUT)/deltarobot completions $${shell%%:*} >"$$file" || exit; \
	    done; \
	fi
	@echo "install-cli: deltarobot is in $(DESTDIR)$(BINDIR)"
uninstall-cli: ## removes the program from there
	$(Q)rm -f '$(DESTDIR)$(BINDIR)/deltarobot' '$(DESTDIR)$(DATADIR)'/man/man1/deltarobot.1 \
	    '$(DESTDIR)$(DATADIR)'/man/man1/deltarobot-*.1
	$(Q)for shell in $(COMPLETIONS); do rm -f '$(DESTDIR)$(DATADIR)'/$${shell#*:}; done
	@echo "uninstall-cli: deltarobot is gone from $(DESTDIR)$(BINDIR)"

install-serve: $(if $(shell command -v $(CARGO)),serve) ## installs them in BINDIR, below PREFIX
	$(Q)mkdir -p '$(DESTDIR)$(BINDIR)' && install -m 755 $(OUT)/deltarobot-serve $(OUT)/deltarobot-ui '$(DESTDIR)$(BINDIR)'
	@echo "install-serve: deltarobot-serve and deltarobot-ui are in $(DESTDIR)$(BINDIR)"
uninstall-serve: ## removes it from there
	$(Q)rm -f '$(DESTDIR)$(BINDIR)/deltarobot-serve' '$(DESTDIR)$(BINDIR)/deltarobot-ui'
	@echo "uninstall-serve: they are gone from $(DESTDIR)$(BINDIR)"

install-convert: $(if $(shell command -v $(CARGO)),convert) ## installs `deltarobot convert` in BINDIR, below PREFIX
	$(Q)mkdir -p '$(DESTDIR)$(BINDIR)' && \
	    install -m 755 $(OUT)/deltarobot-convert '$(DESTDIR)$(BINDIR)/deltarobot-convert'
	@echo "install-convert: deltarobot-convert is in $(DESTDIR)$(BINDIR)"
uninstall-convert: ## removes it from there
	$(Q)rm -f '$(DESTDIR)$(BINDIR)/deltarobot-convert'
	@echo "uninstall-convert: deltarobot-convert is gone from $(DESTDIR)$(BINDIR)"

# Library and program are built side by side: much of both keeps one processor busy.
demo: ## has a host program in C talk to a simulated robot
	+$(Q)$(MAKE) --no-print-directory $(if $(filter -j%,$(MAKEFLAGS)),,-j2) \
	    cli $(STAGE)/demo/demo $(STAGE)/demo/deltarobot-host
	$(Q)$(STAGE)/demo/demo $(STAGE)/demo/deltarobot-host $(OUT)/deltarobot sim

demo-line: $(addprefix $(STAGE)/demo/,demo line-pc line-device) ## the same with a PC and devices of the line protocol
	$(Q)$(STAGE)/demo/demo --line $(STAGE)/demo/line-pc $(STAGE)/demo/line-device

demo-gx: $(addprefix $(STAGE)/demo/,demo gx-host gx-motion) ## the same with a host and a machine that speak GX
	$(Q)$(STAGE)/demo/demo --line $(STAGE)/demo/gx-host $(STAGE)/demo/gx-motion 4

# Examples of a protocol, or what runs a pair of them.
define example
$(STAGE)/demo/$(2): examples/$(1) $(STAGE)/libdeltarobot.a | lib
	$$(Q)mkdir -p $$(@D)
	$$(Q)$$(CC) $$(CPPFLAGS) $$(CFLAGS) -I$$(OUT)/include -o $$@ $$< $$(LDFLAGS) $$(OUT)/libdeltarobot.a
endef
$(foreach source,demo.c $(addsuffix .c,deltarobot/host line/pc line/device gx/host gx/motion), \
    $(eval $(call example,$(source),$(subst /,-,$(basename $(source))))))

# The library in it is another one, without the serial port.
wheel: ## builds a Python package in OUT; needs Python with pip
	+$(Q)mkdir -p $(OUT) && PYTHON_BUILD='$(abspath $(OUT))/.wheel' DP_TARGET='$(DP_TARGET)' CROSS_COMPILE='$(CROSS_COMPILE)' \
	    MAKEFLAGS= MFLAGS= $(PYTHON) -m pip --disable-pip-version-check wheel $(QUIET) --no-deps -w $(OUT) packaging/python
	@echo "wheel: $$(ls -t $(OUT)/deltarobot-$(VERSION)-*.whl | head -n 1)"
PYTHON ?= python3

deb: ## builds Debian's packages in OUT; DEB_FLAGS go to dpkg-buildpackage, -d where cargo is not Debian's
	$(Q)packaging/debian.sh $(abspath $(OUT)) $(VERSION) $(DEB_FLAGS)

bench: lib ## measures the library beside a model of the original
	$(Q)c_tests/bench/run.sh $(OUT) $(STAGE)/bench $(DP_BUFSIZE) $(DP_DATA_MAX_SIZE)

coverage: ## prints how much of the code the tests run; needs llvm's tools
	$(Q)env $(ALL_SIZES:%=-u %) c_tests/coverage.sh target/coverage 95

load: serve ## measures what serving takes; ROBOTS, WATCHERS, STALLED and SECONDS say how much
	+$(Q)env $(ALL_SIZES:%=-u %) $(CLI_PROFILE) $(CARGO) bench $(QUIET) -p deltarobot-serve --bench load --profile release \
	    --target-dir $(CLI_DIR) -- $(abspath $(OUT))/deltarobot-serve

faults: ## has what goes wrong with robots and connections happen 20 times in a row
	$(Q)DP_ROUNDS=20 $(CARGO) test $(QUIET) -p deltarobot-serve --test serve faults
	@echo "faults: passed"

load: load-broker
load-broker: serve ## measures what a broker gets of PROGRAMS programs with ROBOTS robots each, for SECONDS; needs mosquitto
	+$(Q)env $(ALL_SIZES:%=-u %) $(CLI_PROFILE) $(CARGO) bench $(QUIET) -p deltarobot-serve --bench broker --profile release \
	    --target-dir $(CLI_DIR) -- $(abspath $(OUT))/deltarobot-serve

faults: faults-outside
faults-outside: ## kills the broker, the program and recorders, and fills the disk, 20 times in a row; needs mosquitto
	$(Q)DP_ROUNDS=20 $(CARGO) test $(QUIET) -p deltarobot-serve --test outside faults
	$(Q)DP_ROUNDS=20 $(CARGO) test $(QUIET) -p deltarobot-records --test records killed

mutants: ## changes MUTANTS places of the code, one at a time, and tells which the tests miss; needs cargo-mutants
	$(Q)env $(ALL_SIZES:%=-u %) MAKEFLAGS= MFLAGS= c_tests/mutants.sh $(MUTANTS) $(SEED) target/mutants
MUTANTS ?= 20
SEED    ?= $(shell date +%s)

# Into a page that people read; what is on it is never typed.
figures: lib firmware-all ## measures everything again and writes docs/figures.md
	$(Q)FIRMWARE_TARGETS='$(FIRMWARE_TARGETS)' \
	    c_tests/bench/figures.sh $(OUT) $(STAGE)/bench $(DP_BUFSIZE) $(DP_DATA_MAX_SIZE) >$(STAGE)/figures.md
	$(Q)mv $(STAGE)/figures.md docs/figures.md
	@echo "figures: docs/figures.md is up to date"

# Sanitizers are a feature of nightly compilers, which release compilers have behind this switch.
fuzz: ## runs each fuzz target for FUZZ_SECONDS; needs cargo-fuzz
	$(Q)for fuzzed in $(basename $(notdir $(wildcard fuzz/fuzz_targets/*.rs))); do \
	    mkdir -p target/fuzz/corpus/$$fuzzed && RUSTC_BOOTSTRAP=1 $(CARGO) fuzz run --target-dir target/fuzz $$fuzzed \
	        target/fuzz/corpus/$$fuzzed -- -max_total_time=$(FUZZ_SECONDS) -max_len=1024 -timeout=10 \
	        -verbosity=0 -print_final_stats=1 || exit; \
	done
	@echo "fuzz: nothing found"
FUZZ_SECONDS ?= 600

clean: ## removes what was built
	$(Q)rm -rf target $(IN_PLACE_SIZES) $(CARGO_DIR) $(STAGE) $(HEADERS:%=$(OUT)/include/%) \
	    $(OUT)/libdeltarobot.* $(OUT)/deltarobot $(OUT)/deltarobot-serve $(OUT)/deltarobot-ui $(OUT)/deltarobot-convert $(OUT)/deltarobot.d*
	@echo "clean: removed target and the library in $(OUT)"

help:
	@sed -n 's/^\([a-z-]*\):.*## /  \1|/p' $(MAKEFILE_LIST) | awk -F'|' '{ printf "%-17s %s\n", $$1, $$2 }'
	@echo "Sizes: $(ALL_SIZES)"
	@echo "Others: OUT DP_TARGET CROSS_COMPILE SHARED SERIAL PREFIX LIBDIR INCLUDEDIR BINDIR DATADIR DESTDIR CARGO CC CFLAGS V=1"

include firmware/firmware.mk
