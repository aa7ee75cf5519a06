# Tests of the documents: their rules, and the code and the commands that they show.

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
kerf_document_code(Move docs/guide/move.md)
kerf_document_code(Save docs/guide/save.md)
kerf_document_code(Scene docs/guide/scene.md)
kerf_document_code(Inspect docs/guide/inspect.md)
kerf_document_code(Cookbook docs/guide/cookbook.md)

if(TARGET kerf_tool)
  add_test(NAME Documents.CommandsOfToolRunAsPrinted COMMAND Python3::Interpreter scripts/guide-code commands
                                                              docs/guide/tool.md $<TARGET_FILE_DIR:kerf_tool>
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
endif()

# Examples, run in folders of their own, since they write pictures; each must say what it is known to say.
function(kerf_example_test name example said)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/examples/run/${example})
  add_test(NAME Examples.${name} COMMAND example_${example}
           WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/examples/run/${example})
  set_tests_properties(Examples.${name} PROPERTIES PASS_REGULAR_EXPRESSION "${said}")
endfunction()

if(KERF_BUILD_EXAMPLES)
  kerf_example_test(MinimalHitsItsTriangle minimal "hit triangle 0 of mesh 0 at t = 2, u = 0.5, v = 0.25")
  kerf_example_test(LidarScanSeesPosts lidar_scan "I       I       I")
  kerf_example_test(FirstPictureHasSunAndShade first_picture "[0-9][0-9]+ pixels in the sun, [0-9][0-9]+ in the shade")
  kerf_example_test(AmbientOcclusionIsDarkestInside ambient_occlusion "see 0.8. of the sky, the darkest 0.5")
  kerf_example_test(VoxelsFillTheRing voxels "75[0-9]* of 258048 voxels are inside")
  kerf_example_test(SignedDistanceIsNegativeInside signed_distance "the deepest point lies 0.2. below")
  kerf_example_test(ThicknessGoesInAndOut thickness "beams with an odd number of walls: 0")
  kerf_example_test(CollisionFindsTheStep collision "they touch at step 132, x = 2.68")
  kerf_example_test(DropToGroundIsNearerAside drop_to_ground "1.292 above ground, 1.282 from the nearest hill")
  kerf_example_test(ChainsHangInTheSun chains "frame 2, 144 rings: [0-9][0-9]+ pixels in the sun, [0-9][0-9]+ in the shade")
  kerf_example_test(DominoesFallBesideAWheelThatBends dominoes "frame 3: 11 of 16 dominoes touch; wheel refitted")
  kerf_example_test(OwnPoolTracesAsMany own_pool "75000 of 100000 rays hit the floor")
  kerf_example_test(SaveAndMapRefusesHalfAFile save_and_map "refused: ring.kerf: the file has")
endif()
