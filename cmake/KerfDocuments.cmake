# Tests of the documents: their rules, and the code and the commands that they show.

find_package(Python3 REQUIRED COMPONENTS Interpreter)

add_test(NAME Documents.LinesLinksAndNumbersHold COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check-docs)

# The ```cpp blocks of a document, as one program; what it prints is compared with the ```text blocks.
function(kerf_document_code page document)
  string(TOLOWER ${page} name)
  set(source ${PROJECT_BINARY_DIR}/documents/${name}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/documents
    COMMAND Python3::Interpreter scripts/guide-code program ${document} ${source}
    DEPENDS ${PROJECT_SOURCE_DIR}/${document} ${PROJECT_SOURCE_DIR}/scripts/guide-code
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Reading the code of ${document}"
    VERBATIM)
  add_executable(document_${name} ${source})
  target_link_libraries(document_${name} PRIVATE kerf::kerf kerf_warnings)
  add_test(NAME Documents.CodeOf${page}RunsAsPrinted COMMAND Python3::Interpreter scripts/guide-code run ${document}
                                                              $<TARGET_FILE:document_${name}>
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
endfunction()

kerf_document_code(Readme README.md)
kerf_document_code(Build docs/guide/build.md)
kerf_document_code(Trace docs/guide/trace.md)
kerf_document_code(Query docs/guide/query.md)
kerf_document_code(Save docs/guide/save.md)
kerf_document_code(Inspect docs/guide/inspect.md)

if(TARGET kerf_tool)
  add_test(NAME Documents.CommandsOfToolRunAsPrinted COMMAND Python3::Interpreter scripts/guide-code commands
                                                              docs/guide/tool.md $<TARGET_FILE_DIR:kerf_tool>
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
endif()

if(KERF_BUILD_EXAMPLES)
  add_test(NAME Examples.MinimalHitsItsTriangle COMMAND example_minimal)
  set_tests_properties(Examples.MinimalHitsItsTriangle PROPERTIES PASS_REGULAR_EXPRESSION
                                                                  "hit triangle 0 of mesh 0 at t = 2, u = 0.5, v = 0.25")
  add_test(NAME Examples.LidarScanSeesPosts COMMAND example_lidar_scan)
  set_tests_properties(Examples.LidarScanSeesPosts PROPERTIES PASS_REGULAR_EXPRESSION "I       I       I")
endif()
