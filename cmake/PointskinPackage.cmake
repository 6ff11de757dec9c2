# Debian packages by CPack, one a component: pointskin, libpointskin0, libpointskin-dev, python3-pointskin, and for each MPI
# that was found pointskin-openmpi and pointskin-mpich; with CUDA the first two end in -cuda and take the place of the others.
set(suffix)
if(POINTSKIN_HAS_CUDA)
  set(suffix -cuda)
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pointskin)
set(CPACK_PACKAGE_VENDOR "The Pointskin authors")
set(CPACK_PACKAGE_CONTACT "The Pointskin authors <pointskin@localhost>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program lib dev python ${POINTSKIN_MPIS})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Documents that Debian wants in every package; the dates are those of the commit, so that the bytes are the same.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE license)
string(REGEX MATCH "Copyright [^\n]*" holder "${license}")
string(REGEX REPLACE "^Copyright *(\\(c\\) *)?" "" holder "${holder}")
string(REGEX REPLACE "^.*\n\n(Permission)" "\\1" license "${license}")
string(STRIP "${license}" license)
string(REGEX REPLACE "\n\n" "\n.\n" license "${license}")
string(REPLACE "\n" "\n " license "${license}")
set(CPACK_POINTSKIN_COPYRIGHT ${PROJECT_BINARY_DIR}/packaging/copyright)
file(WRITE ${CPACK_POINTSKIN_COPYRIGHT}
  "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: Pointskin\n\n"
  "Files: *\nCopyright: ${holder}\nLicense: Expat\n ${license}\n")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH where that is set
set(CPACK_POINTSKIN_CHANGELOG ${PROJECT_BINARY_DIR}/packaging/changelog)
file(WRITE ${CPACK_POINTSKIN_CHANGELOG}
  "pointskin (${PROJECT_VERSION}) unstable; urgency=medium\n\n  * See CHANGELOG.md of the sources.\n\n"
  " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/PointskinDebianFiles.cmake)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME pointskin${suffix})
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "The program pointskin: surface reconstruction, editing in a browser, Boolean
 operations, deformation and fluids, on any number of CPU threads.")

set(CPACK_DEBIAN_LIB_PACKAGE_NAME libpointskin0${suffix})
set(CPACK_DEBIAN_LIB_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_LIB_DESCRIPTION "surface reconstruction, shared library
 The library of Pointskin for C++, C and every language that calls C.")
file(WRITE ${PROJECT_BINARY_DIR}/packaging/shlibs "libpointskin 0 libpointskin0 (>= ${PROJECT_VERSION})\n")
file(WRITE ${PROJECT_BINARY_DIR}/packaging/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIB_PACKAGE_CONTROL_EXTRA
  ${PROJECT_BINARY_DIR}/packaging/shlibs ${PROJECT_BINARY_DIR}/packaging/triggers)

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libpointskin-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "libpointskin0 (= ${PROJECT_VERSION}) | libpointskin0-cuda (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "libtbb-dev, libpng-dev, zlib1g-dev")
set(CPACK_COMPONENT_DEV_DESCRIPTION "surface reconstruction, development files
 Headers of C++ and C, the archive, and files for CMake and pkg-config.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-pointskin)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "python3 (>= 3.9), python3-numpy, libpointskin0 (>= ${PROJECT_VERSION}) | libpointskin0-cuda (>= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "pointskin")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "surface reconstruction, for Python
 Arrays of numpy, torch, cupy and others in and out, on the CPU or on a GPU.")

foreach(name IN LISTS POINTSKIN_MPIS)
  string(TOUPPER ${name} component)
  set(launcher_openmpi openmpi-bin)
  set(launcher_mpich mpich)
  set(title_openmpi "Open MPI")
  set(title_mpich MPICH)
  set(CPACK_DEBIAN_${component}_PACKAGE_NAME pointskin-${name})
  set(CPACK_DEBIAN_${component}_PACKAGE_SECTION graphics)
  set(CPACK_DEBIAN_${component}_PACKAGE_DEPENDS "pointskin (= ${PROJECT_VERSION})")
  set(CPACK_DEBIAN_${component}_PACKAGE_RECOMMENDS ${launcher_${name}})
  set(CPACK_COMPONENT_${component}_DESCRIPTION "surface reconstruction by several hosts, with ${title_${name}}
 The module with which the program pointskin shares a reconstruction among the
 processes that a launcher of ${title_${name}} starts.")
endforeach()

# Compiled modules come and go with the package.
file(WRITE ${PROJECT_BINARY_DIR}/packaging/postinst
  "#!/bin/sh\nset -e\nif command -v py3compile >/dev/null; then py3compile -p python3-pointskin; fi\n")
file(WRITE ${PROJECT_BINARY_DIR}/packaging/prerm
  "#!/bin/sh\nset -e\nif command -v py3clean >/dev/null; then py3clean -p python3-pointskin; fi\n")
file(CHMOD ${PROJECT_BINARY_DIR}/packaging/postinst ${PROJECT_BINARY_DIR}/packaging/prerm
  PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  ${PROJECT_BINARY_DIR}/packaging/postinst ${PROJECT_BINARY_DIR}/packaging/prerm)

if(POINTSKIN_HAS_CUDA)
  foreach(part IN ITEMS PROGRAM:pointskin LIB:libpointskin0)
    string(REPLACE ":" ";" part ${part})
    list(GET part 0 component)
    list(GET part 1 name)
    foreach(relation IN ITEMS CONFLICTS REPLACES)
      set(CPACK_DEBIAN_${component}_PACKAGE_${relation} ${name})
    endforeach()
    set(CPACK_DEBIAN_${component}_PACKAGE_PROVIDES "${name} (= ${PROJECT_VERSION})")
  endforeach()
endif()
include(CPack)
