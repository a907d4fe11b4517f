# Writes version.cpp with the version and, in a Git checkout of this project, the commit; leaves it alone if it is unchanged.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git rev-parse --show-toplevel WORKING_DIRECTORY ${SOURCE}
  OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
set(commit "")
file(REAL_PATH ${SOURCE} source)
if(NOT failed AND top STREQUAL source)  # a tarball may be unpacked inside another project's checkout
  execute_process(COMMAND git describe --always --dirty=+ --exclude=* --abbrev=10 WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(commit)
  set(commit " (${commit})")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT
"#include \"pipeline/stage/version.h\"

std::string patchlight::patchlight_version() {
  return \"patchlight @VERSION@@commit@\";
}
")
