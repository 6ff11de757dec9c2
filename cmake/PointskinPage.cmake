# The page of the studio: a bundle of files that becomes a part of the program.
#
# As a script, cmake -DFOLDER=... -DOUTPUT=... -P PointskinPage.cmake writes a C++ file that holds all files of a folder,
# for apps/studio/page.hpp. The assembler takes the bytes as they are; their hash is the file's ETag, and makes that file
# another one when they change.
if(CMAKE_SCRIPT_MODE_FILE)
  set(type_html "text/html; charset=utf-8")
  set(type_js "text/javascript; charset=utf-8")
  set(type_css "text/css; charset=utf-8")
  set(type_svg "image/svg+xml")
  set(type_png "image/png")
  set(type_wasm "application/wasm")
  set(type_json "application/json")
  set(type_txt "text/plain; charset=utf-8")
  file(GLOB names LIST_DIRECTORIES false RELATIVE ${FOLDER} ${FOLDER}/*)
  set(blobs)
  set(symbols)
  set(rows)
  set(number 0)
  foreach(name IN LISTS names)
    string(REGEX REPLACE "^.*\\." "" extension ${name})
    if(NOT DEFINED type_${extension})
      message(FATAL_ERROR "${FOLDER}/${name}: say in cmake/PointskinPage.cmake what type a .${extension} has")
    endif()
    file(SHA256 ${FOLDER}/${name} hash)
    string(SUBSTRING ${hash} 0 32 hash)
    set(symbol pointskin_page_${number})
    string(APPEND blobs
      "    .balign 16\n${symbol}:\n    .incbin \"${FOLDER}/${name}\"\n${symbol}_end:\n    .byte 0\n")
    string(APPEND symbols "extern \"C\" __attribute__((visibility(\"hidden\"))) const std::byte ${symbol}[], ${symbol}_end[];\n")
    string(APPEND rows "    {\"${name}\", ${symbol}, ${symbol}_end, \"${type_${extension}}\", \"\\\"${hash}\\\"\"},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  if(number EQUAL 0)
    message(FATAL_ERROR "${FOLDER} holds no files: the bundler made none")
  endif()
  file(WRITE ${OUTPUT} "// Made by cmake/PointskinPage.cmake.
#include \"studio/page.hpp\"

asm(R\"asm(
    .pushsection .rodata
${blobs}    .popsection
)asm\");
${symbols}
namespace pointskin::studio {
namespace {

struct Row {
  std::string_view name;
  const std::byte *begin, *end;
  const char *type, *etag;
};

const Row kRows[] = {
${rows}};

}  // namespace

std::optional<server::Asset> page_file(std::string_view name) {
  for (const Row& row : kRows)
    if (row.name == name) return server::Asset{{row.begin, row.end}, row.type, row.etag};
  return std::nullopt;
}

}  // namespace pointskin::studio
")
  return()
endif()

# Fills node_modules as the lock file says, unless it is so already; works without a network then.
# Sets `result` to what went wrong, or to nothing.
function(pointskin_install_page_packages folder result)
  set(${result} "" PARENT_SCOPE)
  if(NOT EXISTS ${folder}/package-lock.json)
    set(${result} "${folder} holds no page" PARENT_SCOPE)
    return()
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/package-lock.json)
  file(SHA256 ${folder}/package-lock.json wanted)
  set(stamp ${folder}/node_modules/.pointskin-lock)
  set(present)
  if(EXISTS ${stamp})
    file(READ ${stamp} present)
  endif()
  if(present STREQUAL wanted)
    return()
  endif()
  execute_process(COMMAND ${POINTSKIN_NPM} ls --all --prefix ${folder} RESULT_VARIABLE differs OUTPUT_QUIET ERROR_QUIET)
  if(differs)
    message(STATUS "Installing the npm packages of the studio's page in ${folder}/node_modules")
    execute_process(COMMAND ${POINTSKIN_NPM} ci --prefix ${folder} --no-audit --no-fund
      RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(failed)
      string(REGEX MATCH "npm ERR![^\n]*|npm error[^\n]*" line "${output}")
      set(${result} "`npm ci` failed in ${folder}, which needs the network once (${line})" PARENT_SCOPE)
      return()
    endif()
  endif()
  file(WRITE ${stamp} ${wanted})
endfunction()

# pointskin_add_page(<target> <folder>): a library with page_file() of apps/studio/page.hpp.
function(pointskin_add_page target folder)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/src/*)
  set(bundle ${CMAKE_CURRENT_BINARY_DIR}/bundle)
  set(bundling COMMAND ${CMAKE_COMMAND} -E rm -rf ${bundle} COMMAND ${POINTSKIN_NODE} ${folder}/build.mjs ${bundle})
  set(made_of ${sources} ${folder}/build.mjs ${folder}/package.json ${folder}/node_modules/.pointskin-lock)
  if(POINTSKIN_PAGE)
    set(bundle ${POINTSKIN_PAGE})
    set(bundling)
    file(GLOB made_of CONFIGURE_DEPENDS ${POINTSKIN_PAGE}/*)
  endif()
  set(output ${CMAKE_CURRENT_BINARY_DIR}/page.cpp)
  set(script ${PROJECT_SOURCE_DIR}/cmake/PointskinPage.cmake)
  add_custom_command(OUTPUT ${output}
    ${bundling}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${bundle} -DOUTPUT=${output} -P ${script}
    DEPENDS ${made_of} ${script}
    COMMENT "Bundling the page of the studio" VERBATIM)
  add_library(${target} STATIC ${output})
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/apps)
  target_link_libraries(${target} PUBLIC pointskin_flags)
endfunction()
