#!/usr/bin/env python3
"""How kerf is set up by someone who meets it: whatever state a folder is in, and whatever is missing.

usage: setup_test.py CASE SOURCE     CASE is a function below; SOURCE the checkout, of which each case takes a copy
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

QUICK = ["-DKERF_TEST_PACKAGE=OFF", "-DKERF_BINDINGS_CUDA=OFF"]
USER = """cmake_minimum_required(VERSION 3.22)
project(user LANGUAGES CXX)
add_subdirectory(kerf)
add_executable(user main.cpp)
target_link_libraries(user PRIVATE kerf::kerf)
"""


def run(*command, folder, fails=False, environment=None):
    """What a command prints. It must succeed, or fail if that is asked."""
    result = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, env=environment)
    output = result.stdout + result.stderr
    if (result.returncode != 0) != fails:
        sys.exit(f"{command}: exit status {result.returncode}\n{output}")
    return output


def expect(holds, *what):
    if not holds:
        sys.exit("\n".join(map(str, what)))


def copy(source, place):
    skipped = shutil.ignore_patterns("build", "out", ".git", ".claude", "shared", "node_modules", "*.so")
    return Path(shutil.copytree(source, place, ignore=skipped))


def in_one_line(text):
    return " ".join(text.split())


def a_failed_try_does_not_spoil_the_next(source, room):
    here = copy(source, room / "kerf")
    output = in_one_line(run("cmake", "--preset", "release", "-DCMAKE_DISABLE_FIND_PACKAGE_hwy=ON", folder=here, fails=True))
    for part in ("Highway 1.0", "scripts/setup library", "apt install libhwy-dev"):
        expect(part in output, f"no {part} in", output)
    output = run("scripts/configure", "release", *QUICK, folder=here)
    expect("begun anew: it was never set up to the end" in output, output)
    expect((here / "build/release/build.ninja").exists(), output)


def a_copied_or_moved_checkout_is_set_up_again(source, room):
    """In folders whose names have what shells read as more than a letter."""
    here = copy(source, room / "it's here")
    run("scripts/configure", "library", folder=here)
    there = room / "and $now there"
    here.rename(there)
    output = run("scripts/configure", "library", folder=there)
    expect(f"begun anew: it is that of {here}" in output, output)
    output = run("scripts/configure", "library", "-DKERF_DEBUG=ON", folder=there)
    expect("anew" not in output, "a folder that is whole is gone on with:", output)


def files_are_embedded_whatever_the_path(source, room):
    here = copy(source, room / "it's here")
    run("scripts/configure", "release", *QUICK, "-DKERF_BUILD_TESTS=OFF", folder=here)
    run("cmake", "--build", "--preset", "release", "--target", "workbench_embedded", folder=here)


def what_a_script_needs_is_switched_on_again(source, room):
    here = copy(source, room / "kerf")
    run("cmake", "--preset", "release", *QUICK, "-DKERF_BUILD_TOOL=OFF", "-DKERF_BUILD_TESTS=OFF", folder=here)
    for script in ("demo", "test", "performance"):
        text = (here / "scripts" / script).read_text()
        expect("configure" in text and "-DKERF_BUILD_TOOL=ON" in text, f"scripts/{script} does not ask for the tool")
    run("scripts/configure", "release", "-DKERF_BUILD_TOOL=ON", folder=here)
    output = run("ninja", "-C", "build/release", "-t", "targets", "all", folder=here)
    expect("\nkerf_tool: " in output, "there is no target kerf_tool")


def a_folder_of_another_generator_is_set_up_again(source, room):
    here = copy(source, room / "kerf")
    run("cmake", "-B", "build/library", "-G", "Unix Makefiles", "-DKERF_BUILD_TOOL=OFF", "-DKERF_BUILD_TESTS=OFF",
        "-DKERF_BUILD_BENCHMARKS=OFF", folder=here)
    output = run("scripts/configure", "library", folder=here)
    expect("begun anew" in output and (here / "build/library/build.ninja").exists(), output)


def without_their_packages_tests_are_left_out_with_a_word(source, room):
    here = copy(source, room / "kerf")
    missing = ["-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_benchmark=ON"]
    output = in_one_line(run("cmake", "--preset", "release", *QUICK, *missing, folder=here))
    expect("tests are left out for want of libgtest-dev; scripts/setup test" in output, output)
    expect("benchmarks are left out for want of libbenchmark-dev" in output, output)
    output = in_one_line(run("cmake", "--preset", "release", *QUICK, *missing, "-DKERF_BUILD_TESTS=ON", folder=here, fails=True))
    expect("apt install libgtest-dev" in output, "asked for, they are not left out:", output)


def the_library_alone_needs_no_package_of_the_tool(source, room):
    here = copy(source, room / "kerf")
    names = ["CLI11", "fmt", "nlohmann_json", "PNG", "ZLIB", "meshoptimizer", "GTest", "rapidcheck", "Boost", "embree"]
    run("cmake", "--preset", "library", *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in names), folder=here)
    packages = run("scripts/setup", "--list", "library", folder=here).split()
    expect(len(packages) == 6, "the library needs six packages:", packages)
    for package in packages:
        expect(f" {package}" in (here / "docs/install.md").read_text(), f"docs/install.md does not name {package}")


def without_a_build_type_it_is_release(source, room):
    here = copy(source, room / "kerf")
    output = run("cmake", "-B", "build", *QUICK, "-DKERF_BUILD_TOOL=OFF", "-DKERF_BUILD_TESTS=OFF",
                 "-DKERF_BUILD_BENCHMARKS=OFF", folder=here)
    expect("no build type was given, so it is Release" in output, output)
    expect("CMAKE_BUILD_TYPE:STRING=Release" in (here / "build/CMakeCache.txt").read_text(), output)


def kernels_are_optimised_in_a_project_of_any_build_type(source, room):
    copy(source, room / "kerf")
    (room / "CMakeLists.txt").write_text(USER)
    shutil.copy(source / "examples/minimal/main.cpp", room / "main.cpp")

    def commands(*options):
        output = run("cmake", "-G", "Ninja", "-B", "build", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", *options, folder=room)
        entries = json.loads((room / "build/compile_commands.json").read_text())
        return output, [entry["command"] for entry in entries if "/src/" in entry["file"]]

    for build_type in ("", "Debug", "MinSizeRel"):
        output, kernels = commands(f"-DCMAKE_BUILD_TYPE={build_type}")
        expect(kernels and all(" -O3" in command for command in kernels), f"not optimised in '{build_type}'")
        expect("the library is compiled with -O3" in output, output)
    output, kernels = commands("-DCMAKE_BUILD_TYPE=Debug", "-DKERF_DEBUG=ON")
    expect(not any(" -O" in command for command in kernels), "KERF_DEBUG leaves it to the build type")


def programs_of_all_languages(source, room, *ways):
    """They are built and run without optimisation and for the fallback alone: how kerf comes in is the question."""
    options = ["-DCMAKE_BUILD_TYPE=", "-DKERF_DEBUG=ON", "-DKERF_LEAVE_OUT=AVX3,AVX2,SSE4"]
    if shutil.which("ccache"):
        options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
    run("cmake", "-G", "Ninja", "-B", room / "build", *options, *ways, folder=source / "tests/package")
    # The room has another name each time; what was compiled in the last one is not compiled again.
    run("cmake", "--build", room / "build", folder=room, environment={**os.environ, "CCACHE_BASEDIR": str(room)})
    run("ctest", "--no-tests=error", "--output-on-failure", folder=room / "build")


def a_subdirectory_serves_programs_of_all_languages(source, room):
    here = copy(source, room / "kerf")
    programs_of_all_languages(here, room, "-DKERF_FROM=add_subdirectory", f"-DKERF_SOURCE={here}")


def fetch_content_serves_programs_of_all_languages(source, room):
    here = copy(source, room / "kerf")
    author = ["-c", "user.name=nobody", "-c", "user.email=nobody"]
    run("git", "init", "-q", folder=here)
    run("git", "add", "-A", folder=here)
    run("git", *author, "commit", "-q", "-m", "as it is", folder=here)
    commit = run("git", "rev-parse", "HEAD", folder=here).strip()
    ways = ["-DKERF_FROM=FetchContent", f"-DKERF_SOURCE={here}", f"-DKERF_COMMIT={commit}", "-DBUILD_SHARED_LIBS=ON"]
    programs_of_all_languages(here, room, *ways)


def cxx17_is_one_error_that_names_the_remedy(source, room):
    (room / "main.cpp").write_text("#include <kerf/kerf.hpp>\nint main() {}\n")
    command = ["c++", "-std=c++17", "-fsyntax-only", f"-I{source}/include", "main.cpp"]
    output = run(*command, folder=room, fails=True)
    expect(output.count("error: ") == 1 and "-std=c++20" in output, output)


def documents_are_checked_where_there_is_no_git(source, room):
    here = copy(source, room / "kerf")
    run(sys.executable, here / "scripts/check-docs", folder=room, environment={**os.environ, "PATH": str(room)})


def documents_of_installed_packages_are_none_of_the_projects(source, room):
    """Those that pip and npm lay into a clone, by the commands of the READMEs; with git and without."""
    here = copy(source, room / "kerf")
    for folder in ("environment/lib", "node_modules/kerf-bvh"):
        (here / folder).mkdir(parents=True)
        (here / folder / "README.md").write_text("[nowhere](nowhere.md)\n")
    run(sys.executable, here / "scripts/check-docs", folder=room, environment={**os.environ, "PATH": str(room)})
    run("git", "init", "-q", folder=here)
    run(sys.executable, here / "scripts/check-docs", folder=room)


def every_option_stands_in_the_table(source, _):
    text = (source / "docs/install.md").read_text()
    cmake = [source / "CMakeLists.txt", source / "cmake/KerfEmbree.cmake"]
    lines = "\n".join(file.read_text() for file in cmake).splitlines()
    options = [line.split("(")[1].split()[0] for line in lines if line.startswith(("option(KERF_", "set(KERF_BUILD_", "set(KERF_LEAVE_OUT "))]
    expect(len(options) > 7, options)
    for option in options:
        expect(f"| `{option}` |" in text, f"docs/install.md does not explain {option}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        globals()[sys.argv[1]](Path(sys.argv[2]), Path(os.path.realpath(folder)))
