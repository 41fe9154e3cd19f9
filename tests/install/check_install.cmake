# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Installs, then configures, builds and runs the consumer beside this file for several choices of components and flags.
# LAUNCHER: of the compilers; ccache keeps what they made of the same installed headers.

include(${CMAKE_CURRENT_LIST_DIR}/documented_projects.cmake)

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGV}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# One folder serves all configurations of a compiler, since looking for the compiler takes most of the time.
function(configure_consumer compiler prefix components)
  get_filename_component(name ${compiler} NAME)
  set(build_dir ${SCRATCH_DIR}/consumer_${name})
  set(build_dir ${build_dir} PARENT_SCOPE)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_DIR} -B ${build_dir} -U palpate_DIR -DCMAKE_BUILD_TYPE=Release
            -DCMAKE_CXX_COMPILER=${compiler} "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" -DCMAKE_PREFIX_PATH=${prefix}
            "-DCOMPONENTS=${components}" "-DVERTICES_FLAGS=${ARGN}"
            # Whoever asks for these would not find them:
            -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON -DCMAKE_DISABLE_FIND_PACKAGE_PCL=ON
            -DCMAKE_DISABLE_FIND_PACKAGE_assimp=ON -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON
            -DCMAKE_DISABLE_FIND_PACKAGE_SQLite3=ON -DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(status ${status} PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH_DIR})

# 1. Only core and geometry are installed: it is enough for a user of geometry, whose flags change how Eigen aligns and allocates
# matrices; they are exchanged all the same.
set(prefix ${SCRATCH_DIR}/geometry_only)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix} --component core)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix} --component geometry)
set(flags -march=native)
set(compilers ${CXX})
if(NOT CXX_FLAGS MATCHES "fsanitize")  # sanitizers of two compilers do not mix
  list(PREPEND compilers ${CLANG})
endif()
foreach(compiler IN LISTS compilers)
  if(compiler STREQUAL "${CXX}")
    list(APPEND flags -fsanitize=address)
  endif()
  configure_consumer(${compiler} ${prefix} geometry ${flags})
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the consumer of geometry does not configure with ${compiler}:\n${output}")
  endif()
  run(${CMAKE_COMMAND} --build ${build_dir})
  run(${build_dir}/consumer)
  if(NOT output MATCHES "12 triangles, 1.000 mm away")
    message(FATAL_ERROR "the consumer of ${compiler} printed: ${output}")
  endif()
  run(ldd ${build_dir}/consumer)
  if(output MATCHES "lib(ipopt|vtk|sqlite3|opencv)[^ ]*")
    message(FATAL_ERROR "a user of geometry needs ${CMAKE_MATCH_0} at run time:\n${output}")
  endif()
  foreach(flag IN LISTS flags)
    string(MAKE_C_IDENTIFIER vertices${flag} vertices)
    foreach(ending IN ITEMS ply glb)  # the latter by a module
      run(${build_dir}/${vertices} ${build_dir}/grid.${ending})
      if(NOT output MATCHES "every vertex came back")
        message(FATAL_ERROR "a program of ${compiler} with '${flag}' printed: ${output}")
      endif()
    endforeach()
  endforeach()
  # Without the target's definitions the headers refuse what would crash.
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${build_dir} --target without_definitions
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(status EQUAL 0 OR NOT output MATCHES "-DEIGEN_MAX_ALIGN_BYTES=16")
    message(FATAL_ERROR "a program with another alignment of matrices is not refused:\n${output}")
  endif()
endforeach()

# The headers that convert to CGAL and PCL, with the users' own copies of these libraries.
set(build_dir ${SCRATCH_DIR}/converters)
# Not by `run`, which would split the list of the launcher.
execute_process(
  COMMAND ${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/converters -B ${build_dir} -DCMAKE_BUILD_TYPE=Release
          -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
          -DCMAKE_PREFIX_PATH=${prefix} -DEXAMPLES_DIR=${CMAKE_CURRENT_LIST_DIR}/../../apps/examples
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the users of the converters do not configure:\n${output}")
endif()
run(${CMAKE_COMMAND} --build ${build_dir})
set(hand ${CMAKE_CURRENT_LIST_DIR}/../../meshes/hand.ply)
run(${build_dir}/register_with_pcl ${hand})
if(NOT output MATCHES "points moved by [67]\\.[0-9]+ mm")
  message(FATAL_ERROR "the installed converters for PCL printed: ${output}")
endif()
if(EXISTS ${build_dir}/measure_with_cgal)
  run(${build_dir}/measure_with_cgal ${hand})
  if(NOT output MATCHES "vertices at most 0\\.[0-9]+ mm")
    message(FATAL_ERROR "the installed converters for CGAL printed: ${output}")
  endif()
endif()

# 2. A component that is not installed, or does not exist, is named.
configure_consumer(${CXX} ${prefix} "geometry;probing")
if(status EQUAL 0 OR NOT output MATCHES "'probing' is not.installed")
  message(FATAL_ERROR "a component that is not installed is not named:\n${output}")
endif()
configure_consumer(${CXX} ${prefix} "")
if(NOT status EQUAL 0)
  message(FATAL_ERROR "a project that names no component does not get those that are installed:\n${output}")
endif()
configure_consumer(${CXX} ${prefix} "geometri")
if(status EQUAL 0 OR NOT output MATCHES "no component 'geometri'" OR NOT output MATCHES "geometry;documents;sensing;devices;probing;acquisition;haptics")
  message(FATAL_ERROR "a misspelt component is not named:\n${output}")
endif()

# 3. Everything is installed: every component is found.
set(prefix ${SCRATCH_DIR}/all)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
configure_consumer(${CXX} ${prefix} "geometry;documents;sensing;devices;probing;acquisition;haptics")
if(NOT status EQUAL 0)
  message(FATAL_ERROR "not every component is found after a full install:\n${output}")
endif()

# What the pages tell users to write into their projects configures.
set(number 0)
foreach(page IN ITEMS README.md docs/linking.md docs/c-interface.md)
  set(project ${SCRATCH_DIR}/documented_${number})
  write_documented_project(${project} ${page} 0)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -G Ninja -S ${project} -B ${project}/build -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${prefix}
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the project of ${page} does not configure:\n${output}")
  endif()
  math(EXPR number "${number} + 1")
endforeach()

# Each library exports what is in namespace palpate, or in palpate.h, and nothing of the libraries it contains.
file(GLOB libraries ${prefix}/lib*/libpalpate_*.so ${prefix}/lib/*/libpalpate_*.so)
list(FILTER libraries EXCLUDE REGEX "-[0-9.]+so$")  # modules, whose symbols nobody else sees
foreach(library IN LISTS libraries)
  run(nm -D --defined-only --format=just-symbols ${library})
  string(REGEX REPLACE "\n$" "" symbols "${output}")
  string(REPLACE "\n" ";" symbols "${symbols}")
  list(FILTER symbols EXCLUDE REGEX "palpate")
  # Marks of the linker itself.
  list(FILTER symbols EXCLUDE REGEX "^(_init|_fini|_end|_edata|_etext|__bss_start)$")
  if(symbols)
    list(LENGTH symbols count)
    list(GET symbols 0 first)
    message(FATAL_ERROR "${library} exports ${count} symbols of others, such as ${first}")
  endif()
endforeach()
list(LENGTH libraries count)
if(count LESS 5)
  message(FATAL_ERROR "only ${count} libraries were found in ${prefix}")
endif()

# pkg-config serves those who do not use CMake, and the licences of this build are told.
file(GLOB pkgconfig ${prefix}/lib*/pkgconfig ${prefix}/lib/*/pkgconfig)
run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pkgconfig} pkg-config --cflags --libs palpate_geometry)
separate_arguments(flags UNIX_COMMAND "${CXX_FLAGS} ${output}")
run(${LAUNCHER} ${CXX} -std=c++20 -c ${CONSUMER_DIR}/consumer.cpp -o ${SCRATCH_DIR}/by_pkgconfig.o ${flags})
run(${CXX} ${SCRATCH_DIR}/by_pkgconfig.o -o ${SCRATCH_DIR}/by_pkgconfig ${flags})
get_filename_component(library_dir ${pkgconfig} DIRECTORY)
run(${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${library_dir} ${SCRATCH_DIR}/by_pkgconfig)
if(NOT output MATCHES "12 triangles, 1.000 mm away")
  message(FATAL_ERROR "the consumer built by pkg-config printed: ${output}")
endif()
foreach(name IN ITEMS documents sensing devices probing acquisition haptics c)
  run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pkgconfig} pkg-config --cflags --libs palpate_${name})
endforeach()
file(READ ${prefix}/share/doc/palpate/NOTICE notice)
file(STRINGS ${library_dir}/cmake/palpate/palpateConfig.cmake with_cgal REGEX "set\\(palpate_WITH_CGAL")
if((with_cgal MATCHES "ON" AND NOT notice MATCHES "CGAL") OR (with_cgal MATCHES "OFF" AND notice MATCHES "CGAL"))
  message(FATAL_ERROR "${with_cgal} and the installed NOTICE contradict each other:\n${notice}")
endif()

# 4. What reads videos and images by OpenCV, cameras, PCL, assimp and what draws pictures are loaded when they are needed, from
# where the libraries lie now.
run(ldd ${prefix}/bin/palpate)
if(output MATCHES "libopencv_(imgcodecs|videoio)|libaravis|libglfw|libvtk|libassimp|libpcl")
  message(FATAL_ERROR "palpate loads ${CMAKE_MATCH_0} at each start:\n${output}")
endif()
set(video ${SCRATCH_DIR}/broken.avi)
file(WRITE ${video} "no video")
function(decode_video)
  set(demo ${prefix}/share/palpate/demo)
  execute_process(
    COMMAND ${prefix}/bin/palpate decode ${video} --rig ${demo}/rig.yaml --pattern ${demo}/pattern.yaml -o ${SCRATCH_DIR}/range
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(status ${status} PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()
run(${prefix}/bin/palpate compare ${hand} ${hand} --align --method point_to_plane)
run(${prefix}/bin/palpate compare ${prefix}/share/palpate/demo/truth/plane.tiff ${prefix}/share/palpate/demo/truth/plane.tiff
    --picture ${SCRATCH_DIR}/differences.png)
if(NOT EXISTS ${SCRATCH_DIR}/differences.png)
  message(FATAL_ERROR "the installed palpate draws no picture:\n${output}")
endif()
execute_process(COMMAND ${prefix}/share/palpate/cluster/submit.sh RESULT_VARIABLE status ERROR_VARIABLE output)
if(NOT status EQUAL 2 OR NOT output MATCHES "SHARDS COMMAND" OR NOT EXISTS ${prefix}/share/palpate/cluster/slurm.sh)
  message(FATAL_ERROR "the scripts for clusters are not installed (${status}):\n${output}")
endif()
decode_video()
if(NOT status EQUAL 2 OR NOT output MATCHES "broken.avi: cannot be opened as a video")
  message(FATAL_ERROR "the installed palpate cannot open videos (${status}):\n${output}")
endif()
file(GLOB_RECURSE module ${prefix}/libpalpate_video_capture*)
file(REMOVE ${module})
decode_video()
if(NOT status EQUAL 1 OR NOT output MATCHES "libpalpate_video_capture.*cannot be loaded.*beside libpalpate_core")
  message(FATAL_ERROR "a module that is missing is not named (${status}):\n${output}")
endif()

# 5. Python finds the module, its version, its type hints and the page.
if(PYTHON)
  set(check "import importlib.metadata, pathlib, palpate
folder = pathlib.Path(palpate.__file__).parent
assert str(folder).startswith('${prefix}'), folder
assert all((folder / name).exists() for name in ('py.typed', '_palpate.pyi', 'page.html'))
mesh = palpate.TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
print(importlib.metadata.version('palpate'), palpate.__version__, palpate.SurfaceQuery(mesh).closest_points([[0, 0, 2]]).distances)")
  run(${CMAKE_COMMAND} -E env PYTHONPATH=${prefix}/${PYTHON_DIR} ${PYTHON} -B -c "${check}")
  if(NOT output MATCHES "^${VERSION} ${VERSION} \\[2[.]\\]")
    message(FATAL_ERROR "the installed Python module printed: ${output}")
  endif()
endif()

# 6. Without Assimp, only the formats that need it ask for it.
file(GLOB_RECURSE module ${prefix}/libpalpate_assimp*)
file(REMOVE ${module})
function(expect_refused name words)
  file(WRITE ${SCRATCH_DIR}/${name} "glTF, or something else")
  execute_process(COMMAND ${prefix}/bin/palpate info ${SCRATCH_DIR}/${name} RESULT_VARIABLE status ERROR_VARIABLE output)
  if(status EQUAL 0 OR NOT output MATCHES "${words}" OR NOT output MATCHES "${name}: ")
    message(FATAL_ERROR "without Assimp, palpate says of ${name} (${status}):\n${output}")
  endif()
endfunction()
expect_refused(body.dae "this format needs Assimp [(]package libassimp5")
expect_refused(body.step "hold solids with curved faces")
if(PYTHON)
  set(check "import palpate
try:
    palpate.read_mesh('${SCRATCH_DIR}/body.dae')
except palpate.Unavailable as error:
    print(error)")
  run(${CMAKE_COMMAND} -E env PYTHONPATH=${prefix}/${PYTHON_DIR} ${PYTHON} -B -c "${check}")
  if(NOT output MATCHES "this format needs Assimp")
    message(FATAL_ERROR "without Assimp, the Python module printed: ${output}")
  endif()
endif()
