# Installs the build into a folder of its own, then configures, builds and runs a project that knows only that folder.
#   cmake -DBUILD=... -DSCRATCH=... -DGENERATOR=... -DCXX=... -DFLAGS=... -DTYPE=... -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/installed)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/project -B ${SCRATCH}/build -G ${GENERATOR}
  -DCMAKE_PREFIX_PATH=${SCRATCH}/installed -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_BUILD_TYPE=${TYPE})
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
run(${SCRATCH}/build/consumer)

# A program in C, with the shared library alone: by CMake, and by pkg-config.
if(EXISTS ${BUILD}/pointskin.pc)
  run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/c_project -B ${SCRATCH}/c_build -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${SCRATCH}/installed -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF -DCMAKE_C_COMPILER=${CC}
    -DCMAKE_C_FLAGS=${FLAGS})
  run(${CMAKE_COMMAND} --build ${SCRATCH}/c_build)
  run(${SCRATCH}/c_build/consumer)
  find_program(PKG_CONFIG pkg-config)
  if(PKG_CONFIG)
    file(GLOB_RECURSE pc ${SCRATCH}/installed/*/pointskin.pc)
    get_filename_component(pc_folder ${pc} DIRECTORY)
    execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_folder} ${PKG_CONFIG} --cflags --libs pointskin
      OUTPUT_VARIABLE words OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(words UNIX_COMMAND "${words}")
    get_filename_component(lib_folder ${pc_folder} DIRECTORY)
    run(${CC} ${FLAGS} ${CMAKE_CURRENT_LIST_DIR}/c_project/main.c ${words} -Wl,-rpath,${lib_folder} -o ${SCRATCH}/by_pkg_config)
    run(${SCRATCH}/by_pkg_config)
  endif()
endif()

# The package must not lean on the tree that it was built from.
file(GLOB_RECURSE package_files ${SCRATCH}/installed/*.cmake)
foreach(package_file IN LISTS package_files)
  file(STRINGS ${package_file} lines)
  foreach(line IN LISTS lines)
    string(FIND "${line}" "${BUILD}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${package_file} names the build folder: ${line}")
    endif()
  endforeach()
endforeach()
