# The warnings that every target of this project is compiled with, and without any of which CI lets it pass.
option(KERF_WARNINGS_AS_ERRORS "Stop at the first warning" OFF)

add_library(kerf_warnings INTERFACE)
target_compile_options(kerf_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion
                                               $<$<BOOL:${KERF_WARNINGS_AS_ERRORS}>:-Werror>)
