# Has TOOL write its manual page and completions to FOLDER.
file(MAKE_DIRECTORY ${FOLDER})
foreach(page kerf.1=manual kerf=completion,bash _kerf=completion,zsh kerf.fish=completion,fish)
  string(REGEX MATCH "(.*)=(.*)" ignored ${page})
  string(REPLACE "," ";" arguments ${CMAKE_MATCH_2})
  execute_process(COMMAND ${TOOL} ${arguments} OUTPUT_FILE ${FOLDER}/${CMAKE_MATCH_1} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
