# Makes the script of the 3D view a C++ source: cmake -D SOURCE=folder -D WORK=folder -D NPM=npm -D
# OUTPUT=file.cpp -P bundle.cmake. If npm or the packages are missing, the script is empty and
# reports have pictures only; the build continues.
cmake_minimum_required(VERSION 3.25)

# A build without a network must not hang: npm does not retry, and is killed after two minutes.
function(bundle result)
  set(${result} "" PARENT_SCOPE)
  if(NOT NPM)
    message("reports without a 3D view: npm not found")
    return()
  endif()
  file(GLOB sources ${SOURCE}/*.js ${SOURCE}/package.json ${SOURCE}/package-lock.json)
  file(COPY ${sources} DESTINATION ${WORK})
  execute_process(
    COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline
            --fetch-retries=0 --fetch-timeout=20000
    WORKING_DIRECTORY ${WORK} TIMEOUT 120
    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(failed)
    message("reports without a 3D view: npm could not get three.js and esbuild")
    return()
  endif()
  execute_process(
    COMMAND ${NPM} exec --offline -- esbuild view.js --bundle --minify --format=iife
            --target=es2020 --legal-comments=inline --charset=ascii --outfile=bundle.js
    WORKING_DIRECTORY ${WORK} TIMEOUT 60
    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE said)
  if(failed)
    message("reports without a 3D view: esbuild failed: ${said}")
    return()
  endif()
  file(READ ${WORK}/bundle.js text)
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

bundle(text)
file(WRITE ${OUTPUT} "#include \"app/report/html/html_page.h\"

namespace app {

std::string_view view_bundle() {
    return R\"feeler(${text})feeler\";
}

} // namespace app
")
