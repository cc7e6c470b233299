# Open CASCADE, which reads STEP and IGES files. Sets FEELER_HAS_OPENCASCADE, FEELER_OPENCASCADE_VERSION and the target
# OpenCASCADE. Not by its own configuration file, which wants every one of its development packages.
set(FEELER_OPENCASCADE AUTO CACHE STRING "Read STEP and IGES files with Open CASCADE: AUTO, ON or OFF")
set_property(CACHE FEELER_OPENCASCADE PROPERTY STRINGS AUTO ON OFF)
set(FEELER_HAS_OPENCASCADE OFF)
if(FEELER_OPENCASCADE STREQUAL "OFF" OR WIN32)
  return()
endif()

find_path(OPENCASCADE_INCLUDE Standard_Version.hxx PATH_SUFFIXES opencascade)
set(libraries "")
set(missing "")
foreach(toolkit TKXDESTEP TKXDEIGES TKSTEP TKSTEPBase TKIGES TKXSBase TKXCAF TKLCAF TKCAF TKCDF TKMesh TKShHealing TKTopAlgo
    TKGeomAlgo TKGeomBase TKBRep TKG3d TKG2d TKMath TKernel)
  find_library(OPENCASCADE_${toolkit} ${toolkit})
  mark_as_advanced(OPENCASCADE_${toolkit})
  list(APPEND libraries ${OPENCASCADE_${toolkit}})
  if(NOT OPENCASCADE_${toolkit})
    list(APPEND missing ${toolkit})
  endif()
endforeach()
mark_as_advanced(OPENCASCADE_INCLUDE)
# The packages of the libraries have headers of their own.
foreach(header STEPCAFControl_Reader.hxx IGESCAFControl_Reader.hxx XCAFDoc_ShapeTool.hxx BRepMesh_IncrementalMesh.hxx)
  if(OPENCASCADE_INCLUDE AND NOT EXISTS ${OPENCASCADE_INCLUDE}/${header})
    list(APPEND missing ${header})
  endif()
endforeach()

if(OPENCASCADE_INCLUDE AND NOT missing)
  file(STRINGS ${OPENCASCADE_INCLUDE}/Standard_Version.hxx FEELER_OPENCASCADE_VERSION
    REGEX "^#define OCC_VERSION_COMPLETE")
  string(REGEX REPLACE ".*\"([0-9.]+)\".*" "\\1" FEELER_OPENCASCADE_VERSION "${FEELER_OPENCASCADE_VERSION}")
  add_library(OpenCASCADE INTERFACE)
  target_include_directories(OpenCASCADE SYSTEM INTERFACE ${OPENCASCADE_INCLUDE})
  target_link_libraries(OpenCASCADE INTERFACE ${libraries})
  set(FEELER_HAS_OPENCASCADE ON)
elseif(FEELER_OPENCASCADE STREQUAL "ON")
  message(FATAL_ERROR "FEELER_OPENCASCADE is ON, but these parts of Open CASCADE are missing: ${missing}. "
    "Install the packages of .ci/packages/cad.txt.")
else()
  message(STATUS "Without Open CASCADE: STEP and IGES files cannot be read")
endif()
