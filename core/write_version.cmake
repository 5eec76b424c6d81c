# cmake -DSOURCE=... -DVERSION=... -DTEMPLATE=... -DOUTPUT=... -P write_version.cmake: writes version.cpp anew, but
# touches it only when the version or the commit has changed. Runs in every build, so that reports name the commit that
# was built and not the one that was configured.
set(COMMIT unknown)
find_program(GIT git)
if(GIT AND EXISTS "${SOURCE}/.git")
  execute_process(COMMAND ${GIT} describe --always --dirty --exclude=* WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(COMMIT "${described}")
  endif()
endif()
configure_file("${TEMPLATE}" "${OUTPUT}" @ONLY)
