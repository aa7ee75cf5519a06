# Tests of the project as a whole, beside those of its code.

add_test(NAME Architecture.RoomsIncludeOnlyWhatTheyMay COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-includes)
include(KerfDocuments)
include(KerfOlderCpp)
include(KerfRefusedTypes)
include(KerfProgramSize)

# An installed copy, found and used as a stranger would.
function(kerf_test_package name)
  add_test(
    NAME ${name}
    COMMAND
      ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DWORK_DIR=${PROJECT_BINARY_DIR}/package/${name}
      -DCXX=${CMAKE_CXX_COMPILER} -DCXX_FLAGS=${CMAKE_CXX_FLAGS} -DBUILD_TYPE=${CMAKE_BUILD_TYPE}
      -DGENERATOR=${CMAKE_GENERATOR} ${ARGN} -P ${PROJECT_SOURCE_DIR}/cmake/TestInstalledPackage.cmake)
  set_tests_properties(${name} PROPERTIES TIMEOUT 900)
endfunction()

# Which threads the library has is one question, and static or shared another: two builds answer both. The one that
# begins anew compiles for the fallback alone, in half the time.
if(KERF_TEST_PACKAGE)
  if(NOT BUILD_SHARED_LIBS)
    kerf_test_package(Package.StaticLibraryIsFoundAndUsed -DBINARY_DIR=${PROJECT_BINARY_DIR})
  endif()
  kerf_test_package(Package.SharedLibraryWithoutThreadsIsFoundAndUsed
                    "-DOPTIONS=-DKERF_THREADS=serial -DKERF_LEAVE_OUT=AVX3,AVX2,SSE4")
  if(KERF_TEST_PACKAGE STREQUAL "ALL")
    kerf_test_package(Package.SharedLibraryIsFoundAndUsed)
    kerf_test_package(Package.LibraryWithoutOneTbbIsFoundAndUsed
                      "-DOPTIONS=-DKERF_THREADS=std -DBUILD_SHARED_LIBS=OFF")
  endif()
endif()

# What someone meets who sets kerf up for the first time.
function(kerf_setup_test name case)
  add_test(NAME Setup.${name} COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/tests/setup/setup_test.py ${case}
                                      ${PROJECT_SOURCE_DIR})
endfunction()

if(KERF_TEST_PACKAGE)
  kerf_setup_test(AFailedTryDoesNotSpoilTheNext a_failed_try_does_not_spoil_the_next)
  kerf_setup_test(ACopiedOrMovedCheckoutIsSetUpAgain a_copied_or_moved_checkout_is_set_up_again)
  kerf_setup_test(FilesAreEmbeddedWhateverThePath files_are_embedded_whatever_the_path)
  kerf_setup_test(WhatAScriptNeedsIsSwitchedOnAgain what_a_script_needs_is_switched_on_again)
  kerf_setup_test(AFolderOfAnotherGeneratorIsSetUpAgain a_folder_of_another_generator_is_set_up_again)
  kerf_setup_test(WithoutTheirPackagesTestsAreLeftOutWithAWord without_their_packages_tests_are_left_out_with_a_word)
  kerf_setup_test(TheLibraryAloneNeedsNoPackageOfTheTool the_library_alone_needs_no_package_of_the_tool)
  kerf_setup_test(WithoutABuildTypeItIsRelease without_a_build_type_it_is_release)
  kerf_setup_test(KernelsAreOptimisedInAProjectOfAnyBuildType kernels_are_optimised_in_a_project_of_any_build_type)
  kerf_setup_test(ASubdirectoryServesProgramsOfAllLanguages a_subdirectory_serves_programs_of_all_languages)
  kerf_setup_test(FetchContentServesProgramsOfAllLanguages fetch_content_serves_programs_of_all_languages)
endif()
kerf_setup_test(Cxx17IsOneErrorThatNamesTheRemedy cxx17_is_one_error_that_names_the_remedy)
kerf_setup_test(DocumentsAreCheckedWhereThereIsNoGit documents_are_checked_where_there_is_no_git)
kerf_setup_test(DocumentsOfInstalledPackagesAreNoneOfTheProjects documents_of_installed_packages_are_none_of_the_projects)
kerf_setup_test(EveryOptionStandsInTheTable every_option_stands_in_the_table)
