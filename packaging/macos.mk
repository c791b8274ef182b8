# How the library is made for macOS, which the Makefile includes. All of it is one object, as cargo's archive has it:
# link-time optimization has made everything local but the public functions. MACOS_LDFLAGS is for those who cross-compile.

OBJECTS := $(STAGE)/deltarobot.o
$(OBJECTS): $(STAGE)/cargo.a packaging/macos.mk
	$(Q)cd $(@D) && member=$$($(AR) t $(<F) | grep '^deltarobot-') && $(AR) x $(<F) $$member && mv -f $$member $(@F)

$(STAGE)/exports: $(STAGE)/cargo.a
	$(Q)printf '_%s\n' $(EXPORTS) >$@
$(STAGE)/libdeltarobot.$(VERSION).dylib: $(STAGE)/deltarobot.o $(STAGE)/exports
	$(Q)$(CC) -dynamiclib -o $@ $< -Wl,-exported_symbols_list,$(STAGE)/exports -Wl,-dead_strip \
	    -install_name @rpath/libdeltarobot.$(MAJOR).dylib -compatibility_version $(MAJOR) -current_version $(VERSION) \
	    $(MACOS_LDFLAGS)
