# SPDX-License-Identifier: GPL-3.0-or-later
# Install the library into an empty prefix, build the consumer against it, run it.
file(REMOVE_RECURSE ${WORK})
function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif()
endfunction()
step(${CMAKE_COMMAND} --install ${BUILD} --component library --prefix ${WORK}/prefix)
step(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
     -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${WORK}/prefix)
step(${CMAKE_COMMAND} --build ${WORK}/build)
file(WRITE ${WORK}/octahedron.off "OFF
6 8 0
1 0 0
0 1 0
0 0 1
-1 0 0
0 -1 0
0 0 -1
3 0 1 2
3 1 3 2
3 3 4 2
3 4 0 2
3 1 0 5
3 3 1 5
3 4 3 5
3 0 4 5
")
step(${WORK}/build/consumer ${WORK}/octahedron.off ${WORK}/points.obj)
file(STRINGS ${WORK}/points.obj points REGEX "^v ")
list(LENGTH points count)
if(NOT count EQUAL 500)
  message(FATAL_ERROR "points.obj has ${count} points, not 500")
endif()
