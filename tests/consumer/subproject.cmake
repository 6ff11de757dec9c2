# Configures a project that adds this one as a subdirectory, as if the packages of tests and programs were not there.
#   cmake -DSOURCE=... -DSCRATCH=... -DGENERATOR=... -DCXX=... -P subproject.cmake
file(REMOVE_RECURSE ${SCRATCH})
set(hidden)
foreach(package IN ITEMS GTest Eigen3 benchmark CLI11 nlohmann_json Python3)
  list(APPEND hidden -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/subproject -B ${SCRATCH} -G ${GENERATOR}
  -DPOINTSKIN_SOURCE=${SOURCE} -DCMAKE_CXX_COMPILER=${CXX} -DPOINTSKIN_CUDA=OFF --no-warn-unused-cli ${hidden}
  COMMAND_ERROR_IS_FATAL ANY)
