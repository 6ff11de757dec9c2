# Installs the library, its headers and the files that find_package(pointskin) reads.
include(CMakePackageConfigHelpers)

set(pointskin_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pointskin)

install(TARGETS pointskin EXPORT pointskin-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/pointskin DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(EXPORT pointskin-targets NAMESPACE pointskin:: DESTINATION ${pointskin_package_dir})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/pointskin-config.cmake.in
  ${PROJECT_BINARY_DIR}/pointskin-config.cmake INSTALL_DESTINATION ${pointskin_package_dir})
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pointskin-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pointskin-config.cmake ${PROJECT_BINARY_DIR}/pointskin-config-version.cmake
  DESTINATION ${pointskin_package_dir})

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
