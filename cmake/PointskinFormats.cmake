# Libraries that single file formats need. What uses one lies in the folder src/io/with_<library>, which is left out of the
# build where the library is missing; the header io/libraries.hpp, made here, tells the table of formats.
set(POINTSKIN_FORMATS AUTO CACHE STRING
  "File formats: AUTO (those whose libraries are found) or ALL (an error if one is missing)")
set_property(CACHE POINTSKIN_FORMATS PROPERTY STRINGS AUTO ALL)

set(pointskin_format_targets)       # to link
set(pointskin_format_dependencies)  # CMake packages that define them, for cmake/pointskin-config.cmake.in
set(pointskin_format_constants)     # lines of io/libraries.hpp
set(pointskin_formats_left_out)     # folders of src/io
set(missing)                        # Debian packages

# A library: the CMake package and the folder's name, its constant in io/libraries.hpp, its target, its Debian package.
macro(pointskin_format_library package constant target debian)
  find_package(${package} QUIET GLOBAL)
  if(${package}_FOUND)
    list(APPEND pointskin_format_targets ${target})
    list(APPEND pointskin_format_dependencies ${package})
    string(APPEND pointskin_format_constants "inline constexpr bool ${constant} = true;\n")
  else()
    list(APPEND pointskin_formats_left_out with_${package})
    list(APPEND missing ${debian})
    string(APPEND pointskin_format_constants "inline constexpr bool ${constant} = false;\n")
  endif()
endmacro()

pointskin_format_library(pugixml kHasPugixml pugixml::pugixml libpugixml-dev)
pointskin_format_library(ZLIB kHasZlib ZLIB::ZLIB zlib1g-dev)
pointskin_format_library(liblzf kHasLzf liblzf::liblzf liblzf-dev)
pointskin_format_library(minizip kHasMinizip minizip::minizip libminizip-dev)
pointskin_format_library(meshoptimizer kHasMeshoptimizer meshoptimizer::meshoptimizer libmeshoptimizer-dev)
# Headers alone: who links the archive needs nothing of it.
find_package(nlohmann_json QUIET)
if(nlohmann_json_FOUND)
  list(APPEND pointskin_format_targets $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
  string(APPEND pointskin_format_constants "inline constexpr bool kHasJson = true;\n")
else()
  list(APPEND pointskin_formats_left_out with_nlohmann_json)
  list(APPEND missing nlohmann-json3-dev)
  string(APPEND pointskin_format_constants "inline constexpr bool kHasJson = false;\n")
endif()

if(missing)
  list(JOIN missing " " missing)
  if(POINTSKIN_FORMATS STREQUAL "ALL")
    message(FATAL_ERROR "POINTSKIN_FORMATS is ALL, but these Debian packages are missing: ${missing}")
  endif()
  message(STATUS "Some file formats are left out: they need these Debian packages: ${missing}")
endif()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/io/libraries.hpp CONTENT
"// Made by cmake/PointskinFormats.cmake: which libraries of file formats this build has.
#pragma once

namespace pointskin::io {

${pointskin_format_constants}
}  // namespace pointskin::io
" @ONLY)
