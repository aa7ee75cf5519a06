# The warnings that every target of this project is compiled with, and without any of which CI lets it pass
# (it sets CXXFLAGS=-Werror).
add_library(kerf_warnings INTERFACE)
target_compile_options(kerf_warnings INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic;-Wconversion>")
