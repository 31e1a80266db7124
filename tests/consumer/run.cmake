# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DWAY= -DBUILD= -DROOT= -DWORK= -DGENERATOR= -DCOMPILER= -DLAUNCHER= -P run.cmake
# Builds the consumer and runs it. WAY says how it gets the library: `installed` by the build folder BUILD, or from the
# sources in ROOT, `fetched` as a part of the consumer's project or built as the `port` of packaging/vcpkg builds it.
file(REMOVE_RECURSE ${WORK})
function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif()
endfunction()
function(configure source build)
  step(${CMAKE_COMMAND} -S ${source} -B ${build} -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
       -DCMAKE_CXX_COMPILER=${COMPILER} ${ARGN})
endfunction()
set(ENV{CMAKE_CXX_COMPILER_LAUNCHER} "${LAUNCHER}")

# What the library's project does by itself as a part of another one.
function(check_defaults)
  foreach(part BENCHMARKS INSTALL PYTHON TESTS WERROR)
    file(STRINGS ${WORK}/build/CMakeCache.txt line REGEX "^DAPPLE_${part}:")
    if(NOT line STREQUAL "DAPPLE_${part}:BOOL=OFF")
      message(FATAL_ERROR "as a part of another project: '${line}'")
    endif()
  endforeach()
endfunction()

# The options that a portfile gives to CMake.
function(port_options file result)
  file(READ ${file} text)
  string(REGEX MATCHALL "-DDAPPLE_[A-Z]+=(ON|OFF)" options "${text}")
  if(NOT options)
    message(FATAL_ERROR "${file} names no options")
  endif()
  set(${result} ${options} PARENT_SCOPE)
endfunction()

if(WAY STREQUAL "fetched")
  # The program and one source of the library show that both compile there. All sources would take minutes, and the
  # library that they make is linked and run in the other ways.
  configure(${ROOT}/tests/consumer ${WORK}/build -DDAPPLE_SOURCE=${ROOT})
  check_defaults()
  if(GENERATOR STREQUAL "Ninja")
    step(${CMAKE_COMMAND} --build ${WORK}/build --target ${ROOT}/tests/consumer/main.cpp^
         ${ROOT}/native/src/base/validate.cpp^)
    return()
  endif()
else()
  if(WAY STREQUAL "installed")
    step(${CMAKE_COMMAND} --install ${BUILD} --component library --prefix ${WORK}/prefix)
  else()
    # The port's options leave the library itself as it is in BUILD: it is not compiled a second time.
    port_options(${ROOT}/packaging/vcpkg/dapple/portfile.cmake options)
    configure(${ROOT} ${WORK}/port ${options} -DCMAKE_INSTALL_PREFIX=${WORK}/prefix)
    file(COPY ${BUILD}/native/libdapple.a DESTINATION ${WORK}/port/native)
    step(${CMAKE_COMMAND} --install ${WORK}/port)
  endif()
  configure(${ROOT}/tests/consumer ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix)
endif()
step(${CMAKE_COMMAND} --build ${WORK}/build --target consumer)
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
