# Installs the library, its headers and the files that find_package(pointskin) and pkg-config read. The components are
# `program`, `lib` (what programs load), `dev` (what compilers read) and `python`.
include(CMakePackageConfigHelpers)

set(pointskin_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pointskin)

install(TARGETS pointskin EXPORT pointskin-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(EXPORT pointskin-targets NAMESPACE pointskin:: DESTINATION ${pointskin_package_dir} COMPONENT dev)
if(POINTSKIN_SHARED)
  install(TARGETS pointskin_shared EXPORT pointskin-shared-targets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT lib NAMELINK_COMPONENT dev)
  install(EXPORT pointskin-shared-targets NAMESPACE pointskin:: DESTINATION ${pointskin_package_dir} COMPONENT dev)
  file(RELATIVE_PATH pointskin_prefix_of_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)  # so that the tree may be moved
  string(REGEX REPLACE "/$" "" pointskin_prefix_of_pc ${pointskin_prefix_of_pc})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/pointskin.pc.in ${PROJECT_BINARY_DIR}/pointskin.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/pointskin.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/pointskin
    DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL
    PATTERN __pycache__ EXCLUDE)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/pointskin DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev
  FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/pointskin-config.cmake.in
  ${PROJECT_BINARY_DIR}/pointskin-config.cmake INSTALL_DESTINATION ${pointskin_package_dir})
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pointskin-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/Findminizip.cmake ${PROJECT_BINARY_DIR}/pointskin-config.cmake
  ${PROJECT_BINARY_DIR}/pointskin-config-version.cmake DESTINATION ${pointskin_package_dir} COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
