# CPack runs this script between installing the components into its folder and making packages of them: manual pages are
# packed, and every package gets its copyright and changelog, as Debian's policy asks (12.5, 12.7, 12.1).
find_program(POINTSKIN_GZIP gzip REQUIRED)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(name ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(share ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr/share)
  file(GLOB pages ${share}/man/man1/*.1)
  if(pages)
    execute_process(COMMAND ${POINTSKIN_GZIP} -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
  endif()
  file(REMOVE_RECURSE ${share}/doc/pointskin)  # the license, which copyright repeats
  set(documents ${share}/doc/${name})
  file(MAKE_DIRECTORY ${documents})
  file(COPY_FILE ${CPACK_POINTSKIN_COPYRIGHT} ${documents}/copyright)
  file(COPY_FILE ${CPACK_POINTSKIN_CHANGELOG} ${documents}/changelog)
  execute_process(COMMAND ${POINTSKIN_GZIP} -9n ${documents}/changelog COMMAND_ERROR_IS_FATAL ANY)
  file(CHMOD ${documents}/copyright ${documents}/changelog.gz PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  file(CHMOD_RECURSE ${share}/doc DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endforeach()
