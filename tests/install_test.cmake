# Installs the build tree BUILD below itself, and fails if anything else than the usual folders appears there.
set(prefix ${BUILD}/tests/installed)
file(REMOVE_RECURSE ${prefix})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(GLOB found RELATIVE ${prefix} ${prefix}/*)
list(REMOVE_ITEM found bin include lib lib64 libexec share)
if(found)
  message(FATAL_ERROR "cmake --install makes ${found} in ${prefix}")
endif()
