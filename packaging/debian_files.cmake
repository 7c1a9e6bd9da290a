# Run by cpack before it packs a .deb: gives the installed tree what Debian's
# policy asks for. Each package has its copyright and changelogs; zsh's
# completions have a folder of their own.
if(NOT CPACK_GENERATOR STREQUAL "DEB")
  return()
endif()

set(source ${CMAKE_CURRENT_LIST_DIR}/..)
file(READ ${source}/LICENSE license)
string(REGEX MATCH "Copyright \\(c\\) ([^\n]*[^\n.])" owner "${license}")
set(owner "${CMAKE_MATCH_1}")
string(REGEX REPLACE "^.*Redistribution and use" "Redistribution and use"
  terms "${license}")
string(STRIP "${terms}" terms)
string(REPLACE "\n\n" "\n.\n" terms "${terms}")
string(REPLACE "\n" "\n " terms "${terms}")

# Both follow SOURCE_DATE_EPOCH where it is set.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(version ${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

foreach(pair runtime:colmap-tsar development:libcolmap-tsar-dev)
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 component)
  list(GET pair 1 package)
  set(usr ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component}/usr)
  set(doc ${usr}/share/doc/${package})
  file(WRITE ${doc}/copyright "\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: TSAR for COLMAP

Files: *
Copyright: ${owner}
License: BSD-3-Clause

License: BSD-3-Clause
 ${terms}
")
  file(WRITE ${doc}/changelog.Debian "\
colmap-tsar (${version}) unstable; urgency=medium

  * Built by cpack; changelog.gz tells what is new.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}
")
  configure_file(${source}/CHANGELOG.md ${doc}/changelog COPYONLY)
  execute_process(COMMAND gzip -9 -n ${doc}/changelog ${doc}/changelog.Debian
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()

set(usr ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/runtime/usr)
file(REMOVE ${usr}/share/doc/colmap-tsar/LICENSE)
file(RENAME ${usr}/share/zsh/site-functions ${usr}/share/zsh/vendor-completions)

# Whatever the umask is.
execute_process(
  COMMAND chmod -R u=rwX,go=rX ${CPACK_TEMPORARY_INSTALL_DIRECTORY}
  COMMAND_ERROR_IS_FATAL ANY)
