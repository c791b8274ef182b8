# Untried: vcpkg can't be had where the tests run; they run this file with stand-ins for vcpkg's functions. An overlay
# port, which builds the clone that it lies in: vcpkg install libdeltarobot --overlay-ports=libdeltarobot/packaging/vcpkg
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
find_program(MAKE NAMES gmake make REQUIRED)
set(VCPKG_BUILD_TYPE release)
set(VCPKG_POLICY_SKIP_MISPLACED_CMAKE_FILES_CHECK enabled)
set(VCPKG_POLICY_SKIP_LIB_CMAKE_MERGE_CHECK enabled)
if(VCPKG_LIBRARY_LINKAGE STREQUAL static)
  set(SHARED no)
else()
  set(SHARED yes)
endif()
vcpkg_execute_required_process(
  COMMAND "${MAKE}" install "OUT=${CURRENT_BUILDTREES_DIR}/${TARGET_TRIPLET}" "PREFIX=${CURRENT_PACKAGES_DIR}"
    "SHARED=${SHARED}"
  WORKING_DIRECTORY "${SOURCE_PATH}"
  LOGNAME "install-${TARGET_TRIPLET}")
vcpkg_fixup_pkgconfig()
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE-APACHE" "${SOURCE_PATH}/LICENSE-MIT")
