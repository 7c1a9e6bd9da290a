# Run by cpack before it packs an archive: adds a text that tells what is in it
# and which shared libraries the program needs, by package where dpkg knows.
if(NOT CPACK_GENERATOR STREQUAL "TGZ")
  return()
endif()

set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
execute_process(COMMAND ldd ${root}/bin/colmap_tsar
  OUTPUT_VARIABLE resolved COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND objdump -p ${root}/bin/colmap_tsar
  OUTPUT_VARIABLE headers COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "NEEDED +[^\n]+" needed "${headers}")
list(TRANSFORM needed REPLACE "NEEDED +" "")

find_program(dpkg_query dpkg-query)
set(packages "")
foreach(library IN LISTS needed)
  string(REGEX REPLACE "([.+])" "\\\\\\1" pattern ${library})
  string(REGEX MATCH "${pattern} => ([^ ]+)" found "${resolved}")
  file(REAL_PATH "${CMAKE_MATCH_1}" path)
  set(owner "")
  if(dpkg_query AND found)
    execute_process(COMMAND ${dpkg_query} --search ${path}
      OUTPUT_VARIABLE owner ERROR_QUIET)
  endif()
  if(owner MATCHES "^([^:\n]+):")
    list(APPEND packages ${CMAKE_MATCH_1})
  endif()
endforeach()
list(SORT needed)
list(SORT packages)
list(REMOVE_DUPLICATES packages)
list(JOIN needed "\n    " needed)
list(JOIN packages " " packages)

set(system "another system")
if(EXISTS /etc/os-release)
  file(STRINGS /etc/os-release name REGEX "^PRETTY_NAME=")
  string(REGEX REPLACE "^PRETTY_NAME=\"?([^\"]*)\"?$" "\\1" system "${name}")
endif()

file(WRITE ${root}/README "\
TSAR for COLMAP ${CPACK_PACKAGE_VERSION}, built on ${system}

This folder can lie anywhere: bin/colmap_tsar is the program, share/man its
manual (man -M share/man colmap_tsar), share/ also has completions for bash, zsh
and fish, and lib/ and include/ are for programs that use the library (give
CMake this folder as CMAKE_PREFIX_PATH).

The program needs these shared libraries, in these versions:

    ${needed}

On the system it was built on they are those of its C library and of

    apt-get install ${packages}

Where they are missing, build the program from source. NVIDIA's driver is used
where it is there and the program was built with CUDA; CUDA's toolkit is not
needed to run it.
")

# Whatever the umask is.
execute_process(COMMAND chmod -R u=rwX,go=rX ${root}
  COMMAND_ERROR_IS_FATAL ANY)
