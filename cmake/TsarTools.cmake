# The tools: folders of colmap_tsar/tools that nothing below the commands needs,
# in the order in which they may include each other. With
# -DTSAR_TOOL_<NAME>=OFF a tool is left out, and with it its commands and tests.
# TSAR_TOOLS_LEFT_OUT lists those, TSAR_TOOL_DEFINITIONS tells C++ of all.
set(TSAR_TOOLS stereo import evaluation plane_export report)
set(TSAR_TOOLS_LEFT_OUT "")
set(TSAR_TOOL_DEFINITIONS "")
foreach(tool IN LISTS TSAR_TOOLS)
  string(TOUPPER TSAR_TOOL_${tool} option)
  option(${option} "Build colmap_tsar/tools/${tool} and its command" ON)
  list(APPEND TSAR_TOOL_DEFINITIONS "${option}=$<BOOL:${${option}}>")
  if(NOT ${option})
    list(APPEND TSAR_TOOLS_LEFT_OUT ${tool})
  endif()
endforeach()

# tsar_require_tools(WHAT TOOL...): an error where WHAT is ON and one of the tools
# is left out.
function(tsar_require_tools what)
  foreach(tool IN LISTS ARGN)
    if(${what} AND tool IN_LIST TSAR_TOOLS_LEFT_OUT)
      string(TOUPPER TSAR_TOOL_${tool} option)
      message(FATAL_ERROR "${what}=ON needs ${option}=ON")
    endif()
  endforeach()
endfunction()

# The filter of imported maps is that of stereo.
tsar_require_tools(TSAR_TOOL_IMPORT stereo)
tsar_require_tools(TSAR_PYTHON ${TSAR_TOOLS})
tsar_require_tools(TSAR_BENCHMARKS ${TSAR_TOOLS})
