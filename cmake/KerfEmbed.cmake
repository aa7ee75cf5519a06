# kerf_embed(target HEADER NAME FILE...): the bytes of files, compiled into a target.
#
# For `kerf_embed(tool pages.hpp style style.css)` the target's sources may include "pages.hpp", which declares
# `std::string_view embedded::style()`. Pairs of a name and a file may be repeated.
set(KERF_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/KerfEmbedFile.cmake)

function(kerf_embed target header)
  set(directory ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  set(declarations "#pragma once\n\n#include <string_view>\n\nnamespace embedded {\n")
  # A target of its own: a command that makes a source waits for all that its target links, and everything that
  # links the target waits for the command.
  add_library(${target}_embedded OBJECT)
  set(pairs ${ARGN})
  while(pairs)
    list(POP_FRONT pairs name file)
    cmake_path(ABSOLUTE_PATH file NORMALIZE)
    set(source ${directory}/${name}.cpp)
    add_custom_command(
      OUTPUT ${source}
      COMMAND ${CMAKE_COMMAND} -DNAME=${name} -DFILE=${file} -DSOURCE=${source} -P ${KERF_EMBED_SCRIPT}
      DEPENDS ${file} ${KERF_EMBED_SCRIPT}
      COMMENT "Embedding ${file}"
      VERBATIM)
    target_sources(${target}_embedded PRIVATE ${source})
    string(APPEND declarations "std::string_view ${name}();\n")
  endwhile()
  file(CONFIGURE OUTPUT ${directory}/${header} CONTENT "${declarations}}\n" @ONLY)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_embedded>)
  target_include_directories(${target} PRIVATE ${directory})
endfunction()
