# Installs the build tree BUILD of this project into FOLDER and builds two
# projects against it and nothing else of it: the example, and one that includes
# every installed header and takes over the commands as C++14.

function(run expected_code)
  execute_process(COMMAND ${ARGN}
    RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL expected_code)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: exit code ${code}\n${out}${err}")
  endif()
  set(output "${out}${err}" PARENT_SCOPE)
endfunction()

function(expect text)
  string(FIND "${output}" "${text}" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "no '${text}' in: ${output}")
  endif()
endfunction()

set(prefix ${FOLDER}/prefix)
file(REMOVE_RECURSE ${FOLDER})
run(0 ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
file(GLOB_RECURSE license ${prefix}/share/doc/*/LICENSE)
if(NOT license)
  message(FATAL_ERROR "the license was not installed")
endif()
run(0 ${prefix}/bin/colmap_tsar --version)
expect("colmap_tsar ")

# The sanitizers' run time must be linked where the library was built with it.
set(flags "")
if(SANITIZE)
  set(flags "-fsanitize=address,undefined")
endif()
# What this project's dependencies were found by, they are found by again.
set(prefix_path ${prefix} ${PREFIX_PATH})
list(JOIN prefix_path "\\;" prefix_path)
set(options "")
if(CUDA_BIN_DIR)
  cmake_path(GET CUDA_BIN_DIR PARENT_PATH root)
  list(APPEND options -DCUDAToolkit_ROOT=${root})
endif()
function(build project)
  cmake_path(GET project FILENAME name)
  run(0 ${CMAKE_COMMAND} -G ${GENERATOR} -S ${project} -B ${FOLDER}/${name}
    "-DCMAKE_PREFIX_PATH=${prefix_path}" -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
    -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_CXX_FLAGS=${flags}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} ${options})
  run(0 ${CMAKE_COMMAND} --build ${FOLDER}/${name})
endfunction()

build(${SOURCE}/examples/refine_workspace)
run(1 ${FOLDER}/refine_workspace/refine_workspace
  ${FOLDER}/nowhere ${FOLDER}/output)
expect("ERROR: ${FOLDER}/nowhere")

build(${SOURCE}/tests/install/other_project)
run(0 ${FOLDER}/other_project/list_commands)
expect("tsar_refine")
expect("tsar_evaluate")
