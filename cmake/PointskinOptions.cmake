# Options of the build, and the flags that every target of the project shares.

set(POINTSKIN_CUDA AUTO CACHE STRING "Build the GPU path: AUTO (if nvcc is found), ON or OFF")
set_property(CACHE POINTSKIN_CUDA PROPERTY STRINGS AUTO ON OFF)
# As a part of another project (add_subdirectory) only the library is there unless that project asks for more: its tests,
# programs and packages are its own.
option(POINTSKIN_BUILD_APPS "Build the command line program" ${PROJECT_IS_TOP_LEVEL})
option(POINTSKIN_BUILD_BENCH "Build the benchmarks and generators" ${PROJECT_IS_TOP_LEVEL})
set(POINTSKIN_STUDIO AUTO CACHE STRING
  "Build the command `studio`: AUTO (where Node 18, npm, Boost and meshoptimizer are found), ON or OFF")
set_property(CACHE POINTSKIN_STUDIO PROPERTY STRINGS AUTO ON OFF)
option(POINTSKIN_MPI "Build modules for Open MPI and MPICH, where they are found, with which several hosts work together" ${PROJECT_IS_TOP_LEVEL})
option(POINTSKIN_INSTALL "Install the library and what is built with it" ${PROJECT_IS_TOP_LEVEL})
option(POINTSKIN_SHARED "Build the shared library, with the C interface, beside the archive" ${PROJECT_IS_TOP_LEVEL})
if(PROJECT_IS_TOP_LEVEL)
  option(BUILD_TESTING "Build the tests and the examples" ON)
else()
  option(POINTSKIN_BUILD_TESTS "Build the tests and the examples of Pointskin" OFF)
  set(BUILD_TESTING ${POINTSKIN_BUILD_TESTS})  # of this folder and those below; the other project keeps its own
endif()
option(POINTSKIN_STD_THREAD "Run CPU work on std::thread instead of oneTBB (ThreadSanitizer cannot see into oneTBB)" OFF)
option(POINTSKIN_FUZZ "Build the fuzz programs under tests/fuzz (needs clang; see the preset `fuzz`)" OFF)
set(POINTSKIN_SANITIZE "" CACHE STRING "Sanitizers to build with: address, undefined, thread, or a comma-separated list")

option(POINTSKIN_CUDA_BY_FOLDER "Compile a folder's steps for CUDA at once: sooner done, where little is optimised" OFF)
option(POINTSKIN_HARDEN "Stop the process at overruns: stack protector, fortified calls, RELRO, BIND_NOW, PIE" ON)
option(POINTSKIN_ASSERTIONS "Check what containers of the C++ library are asked for (_GLIBCXX_ASSERTIONS)" OFF)

# Where CMAKE_UNITY_BUILD is on, the files of a folder compile as one: most of the time of a build that hardly optimises goes
# into reading the same headers, file by file. A release of the library is built without it, and so are its tests.
# pointskin_unite_folders(<target> [<files>]): so many files compile as one in every build. For programs, whose headers (of the
# command line, JSON, the studio) take longer to read than the files to optimise.
function(pointskin_unite_folders target)
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  set(number 0)
  foreach(source IN LISTS sources)
    get_filename_component(group ${source} DIRECTORY)
    if(group MATCHES "^io")  # of a format, which the first word of their names tells: each has helpers of the same names
      string(REGEX REPLACE "_[^/]*$" "" group ${source})
    endif()
    if(ARGC GREATER 1 AND NOT CMAKE_UNITY_BUILD)
      math(EXPR part "${number} / ${ARGV1}")
      math(EXPR number "${number} + 1")
      set(group ${part})
    endif()
    string(MAKE_C_IDENTIFIER "in_${group}" group)
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  if(ARGC GREATER 1)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
  endif()
endfunction()

set(POINTSKIN_HAS_CUDA OFF)
if(NOT POINTSKIN_CUDA STREQUAL "OFF")
  include(CheckLanguage)
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER)
    if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
      execute_process(COMMAND nvidia-smi -L RESULT_VARIABLE no_gpu OUTPUT_QUIET ERROR_QUIET)
      set(CMAKE_CUDA_ARCHITECTURES "native")
      if(no_gpu)
        set(CMAKE_CUDA_ARCHITECTURES "all-major")
      endif()
    endif()
    enable_language(CUDA)
    find_package(CUDAToolkit 12.8 REQUIRED GLOBAL)
    set(POINTSKIN_HAS_CUDA ON)
  elseif(POINTSKIN_CUDA STREQUAL "ON")
    message(FATAL_ERROR "POINTSKIN_CUDA is ON, but no CUDA compiler was found; set CMAKE_CUDA_COMPILER or CUDACXX")
  endif()
endif()

# Arithmetic must not depend on who compiles it: without fused multiply-adds the CPU and the GPU compute the same bits
# (docs/determinism.md).
# -Wno-psabi: no function that passes a vector of 32 bytes is left as a call (src/core/float8.hpp).
add_library(pointskin_flags INTERFACE)
target_compile_options(pointskin_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wno-psabi -ffp-contract=off>
  # CMake 3.25 does not know nvcc 13's C++20 mode, so it is asked for by hand.
  $<$<COMPILE_LANGUAGE:CUDA>:-std=c++20 --fmad=false --expt-relaxed-constexpr -Xcompiler=-Wall,-Wextra,-ffp-contract=off>)
# GCC 12 forgets to round to float in between where it packs sums of a vector's coordinates, such as
# float(double(float(a + b * c)) + d), into registers: other bytes than every other compiler and the GPU
# (docs/decisions/0058-no-packing-by-gcc.md).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(pointskin_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fno-tree-slp-vectorize> $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-fno-tree-slp-vectorize>)
endif()
if(POINTSKIN_SANITIZE)
  target_compile_definitions(pointskin_flags INTERFACE POINTSKIN_PLAIN)  # scalar bodies only (src/core/float8.hpp)
  target_compile_options(pointskin_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${POINTSKIN_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all>)
  target_link_options(pointskin_flags INTERFACE -fsanitize=${POINTSKIN_SANITIZE})
endif()
if(POINTSKIN_HARDEN)
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)  # CMAKE_POSITION_INDEPENDENT_CODE then counts for linking programs, too
  target_compile_options(pointskin_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fstack-protector-strong> $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-fstack-protector-strong>)
  target_link_options(pointskin_flags INTERFACE LINKER:-z,relro,-z,now)
  if(NOT POINTSKIN_SANITIZE)  # the sanitizers know the plain calls, and nothing is fortified without optimisation
    set(optimised $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
    target_compile_options(pointskin_flags INTERFACE
      $<$<AND:$<COMPILE_LANGUAGE:CXX>,${optimised}>:-U_FORTIFY_SOURCE$<SEMICOLON>-D_FORTIFY_SOURCE=3>)
  endif()
endif()
if(POINTSKIN_ASSERTIONS)
  target_compile_definitions(pointskin_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:_GLIBCXX_ASSERTIONS>)
endif()
