# Copies the README and the documents for users to a folder, with links that hold in an installed tree:
#
#     cmake -D SOURCE=folder -D OUTPUT=folder -D SAMPLES=path -P documents.cmake
#
# SAMPLES: the path from the installed README to the samples, which links to assets become. Other folders of the
# sources are not installed: a link into one of them becomes its text, and a row of a table for one is left out.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${OUTPUT})
file(COPY ${SOURCE}/README.md DESTINATION ${OUTPUT})
file(COPY ${SOURCE}/docs/manual ${SOURCE}/docs/images ${SOURCE}/docs/glossary.md DESTINATION ${OUTPUT}/docs)

set(up "(\\.\\./)*")
set(absent "\\(${up}(CONTRIBUTING\\.md|(docs/)?(architecture\\.md|recipes\\.md|decisions/)|(core|hwsim|tests)/)[^)]*\\)")
file(GLOB_RECURSE pages ${OUTPUT}/*.md)
foreach(page ${pages})
  file(READ ${page} text)
  string(REGEX REPLACE "\n\\| \\[[^]\n]*\\]${absent}[^\n]*" "" text "${text}")
  string(REGEX REPLACE "\\[([^]]*)\\]${absent}" "\\1" text "${text}")
  string(REGEX REPLACE "\\]\\((${up})assets/" "](\\1${SAMPLES}/" text "${text}")
  file(WRITE ${page} "${text}")
endforeach()
