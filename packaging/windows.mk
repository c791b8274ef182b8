# How the library is made for Windows, which the Makefile includes. All of it is one object, as cargo's archive has it:
# link-time optimization has made everything local but the public functions, and every program has kernel32 to link
# with. The .dll is linked from that object, with nothing of a C library and no entry point.

OBJECTS := $(STAGE)/deltarobot.o
$(OBJECTS): $(STAGE)/cargo.a packaging/windows.mk
	$(Q)cd $(@D) && member=$$($(AR) t $(<F) | grep '^deltarobot-') && $(AR) x $(<F) $$member && mv -f $$member $(@F)
	$(Q)$(OBJCOPY) -R .llvmbc -R .llvmcmd $@

$(STAGE)/deltarobot.def: $(STAGE)/cargo.a
	$(Q)printf '%s\n' 'LIBRARY deltarobot.dll' EXPORTS $(EXPORTS) >$@
$(STAGE)/deltarobot.dll: $(STAGE)/deltarobot.o $(STAGE)/deltarobot.def
	$(Q)$(CROSS_COMPILE)gcc -shared -nostdlib -o $@ $^ -lkernel32 \
	    -Wl,-e,0,--enable-auto-image-base,--out-implib,$(STAGE)/libdeltarobot.dll.a
	$(Q)$(STRIP) --strip-unneeded $@
