# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DPATCHELF= -DNM= -DMODULE= -DEMBREE= -DPRIVATE= -P isolate_embree.cmake
# Copies EMBREE to PRIVATE and renames every function that it exports (rtcX to dapple_rtcX), there and in MODULE.
function(run)
  execute_process(COMMAND ${ARGV} OUTPUT_VARIABLE output ERROR_VARIABLE error RESULT_VARIABLE code)
  if(code)
    message(FATAL_ERROR "${ARGV}\n${output}${error}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

get_filename_component(name ${PRIVATE} NAME)
get_filename_component(folder ${PRIVATE} DIRECTORY)
file(REAL_PATH ${EMBREE} embree)
file(COPY_FILE ${embree} ${PRIVATE})
file(CHMOD ${PRIVATE} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
run(${PATCHELF} --print-soname ${PRIVATE})
string(STRIP "${output}" soname)

run(${NM} -D --defined-only --without-symbol-versions ${PRIVATE})
string(REGEX MATCHALL "rtc[A-Za-z0-9_]+" symbols "${output}")
if(NOT symbols)
  message(FATAL_ERROR "${embree} exports no rtc functions")
endif()
list(TRANSFORM symbols REPLACE "(.+)" "\\1 dapple_\\1")
list(JOIN symbols "\n" map)
file(WRITE ${folder}/../embree_symbols.txt "${map}\n")

run(${PATCHELF} --set-soname ${name} ${PRIVATE})
run(${PATCHELF} --rename-dynamic-symbols ${folder}/../embree_symbols.txt ${PRIVATE})
run(${PATCHELF} --replace-needed ${soname} ${name} ${MODULE})
run(${PATCHELF} --rename-dynamic-symbols ${folder}/../embree_symbols.txt ${MODULE})
