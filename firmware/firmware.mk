# The library on bare metal: `make firmware TARGET=...`. The Makefile includes this file.

FIRMWARE_TARGETS := thumbv6m-none-eabi thumbv7m-none-eabi thumbv7em-none-eabi thumbv7em-none-eabihf \
                    riscv32imc-unknown-none-elf avr-none

# For avr-none: the controller. Any that both rustc and avr-gcc know.
MCU ?= atmega2560
export MCU

.PHONY: firmware firmware-all firmware-size firmware-test firmware-bench firmware-package

firmware: ## builds the library for bare metal, TARGET=thumbv7em-none-eabihf for example
	$(Q)test -n '$(TARGET)' || { echo "firmware: say which: TARGET=$(firstword $(FIRMWARE_TARGETS)), or one of" \
	    "$(wordlist 2,9,$(FIRMWARE_TARGETS))" >&2; exit 2; }
	+$(Q)MAKE='$(MAKE)' firmware/build.sh $(TARGET) target/firmware/$(TARGET)

# With FIRMWARE_STRICT=1 a target that can't be built is an error.
firmware-all: ## the same for all targets for which there is a toolchain
	+$(Q)for target in $(FIRMWARE_TARGETS); do \
	    if firmware/build.sh $$target; then \
	        MAKE='$(MAKE)' firmware/build.sh $$target target/firmware/$$target || exit; \
	    elif [ '$(FIRMWARE_STRICT)' = 1 ]; then exit 1; fi; \
	done

firmware-size: firmware-all ## prints flash and stack that each function takes on each target, and a whole sketch on AVR
	$(Q)for target in $(FIRMWARE_TARGETS); do \
	    if firmware/build.sh $$target 2>/dev/null >&2; then \
	        firmware/size.sh $$target target/firmware/$$target || exit; \
	    fi; \
	done
	$(Q)if firmware/build.sh avr-none 2>/dev/null >&2; then \
	    c_tests/firmware/line.sh size target/firmware/avr-none target/firmware/test; \
	fi

firmware-test: lib firmware-all ## runs examples/firmware in emulators against a host program
	$(Q)HOST_LIB='$(OUT)' c_tests/firmware/run.sh test

firmware-bench: lib firmware-all ## counts instructions and cycles on the targets
	$(Q)HOST_LIB='$(OUT)' c_tests/firmware/run.sh bench

# With the archives of more targets than those that are measured.
firmware-package: ## packs a library for Arduino, PlatformIO, ESP-IDF, Zephyr and CMake; FIRMWARE_MCUS are the AVRs
	+$(Q)FIRMWARE_MCUS='$(FIRMWARE_MCUS)' packaging/firmware/pack.sh target/firmware $(VERSION)
FIRMWARE_MCUS ?= atmega328p atmega32u4 atmega2560
