# Configures the project SOURCE in FOLDER with no tool: no source of any is
# compiled, and nothing is looked for that only they need.
file(REMOVE_RECURSE ${FOLDER})
set(options "")
foreach(tool STEREO IMPORT EVALUATION PLANE_EXPORT REPORT)
  list(APPEND options -DTSAR_TOOL_${tool}=OFF)
endforeach()
# The result and the output of a configuration in the folder.
macro(configure)
  execute_process(COMMAND ${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}
    -B ${FOLDER} -DTSAR_CUDA=OFF -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
    "-DCMAKE_PREFIX_PATH=${PREFIX_PATH}" ${ARGN}
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
endmacro()

configure(-DTSAR_TESTS=ON ${options})
if(NOT code EQUAL 0)
  message(FATAL_ERROR "without tools: exit code ${code}\n${output}")
endif()
file(READ ${FOLDER}/compile_commands.json commands)
file(READ ${FOLDER}/CMakeCache.txt cache)
foreach(text IN ITEMS colmap_tsar/run/refine_workspace.cc
    colmap_tsar/cli/refine_command.cc tests/run/)
  if(NOT commands MATCHES ${text})
    message(FATAL_ERROR "without tools: ${text} is not compiled")
  endif()
endforeach()
if(commands MATCHES "(colmap_tsar|tests)/tools/[a-z_/]+\\.cc|cli/tsar_[a-z]+\\.cc|\
(stereo|import|report)_command\\.cc")
  message(FATAL_ERROR "without tools: ${CMAKE_MATCH_0} is compiled")
endif()
if(cache MATCHES "TSAR_(FLANN|LZ4)[A-Z_]*")
  message(FATAL_ERROR "without tools: ${CMAKE_MATCH_0} is looked for")
endif()

configure(-DTSAR_PYTHON=ON)
if(code EQUAL 0 OR NOT output MATCHES
   "TSAR_PYTHON=ON needs TSAR_TOOL_STEREO=ON")
  message(FATAL_ERROR "the Python module without what it offers: ${code}\n${output}")
endif()
