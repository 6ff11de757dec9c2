# The example in C makes a watertight mesh of the points of a cube, and says what is wrong with a file that is not there.
set(points)
foreach(i RANGE 1 19 2)
  foreach(j RANGE 1 19 2)
    string(APPEND points "${i} ${j} 0 0 0 -1\n${i} ${j} 20 0 0 1\n" "${i} 0 ${j} 0 -1 0\n${i} 20 ${j} 0 1 0\n"
      "0 ${i} ${j} -1 0 0\n20 ${i} ${j} 1 0 0\n")
  endforeach()
endforeach()
file(WRITE ${SCRATCH}/cube.xyz "${points}")
execute_process(COMMAND ${EXAMPLE} ${SCRATCH}/cube.xyz ${SCRATCH}/cube.ply 6
  RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE progress)
if(NOT code EQUAL 0 OR NOT said MATCHES "^600 points on .*: [0-9]+ triangles, watertight, volume (7[5-9]|8[0-4])[0-9][0-9]")
  message(FATAL_ERROR "the cube: code ${code}: ${said}${progress}")
endif()
if(NOT progress MATCHES "% solve")
  message(FATAL_ERROR "no progress was told: ${progress}")
endif()
execute_process(COMMAND ${EXAMPLE} ${SCRATCH}/no_such_file.ply ${SCRATCH}/out.ply
  RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE story)
if(NOT code EQUAL 3 OR NOT story MATCHES "^reconstruct: .*no_such_file.ply: cannot be read")
  message(FATAL_ERROR "a missing file: code ${code}: ${said}${story}")
endif()
