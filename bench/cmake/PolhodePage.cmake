# The report's page: its style, its code and, if it is there, plotly go into the binary.
# bench/install fetches plotly from the npm registry into report/page/node_modules; an installed one serves as well.
find_file(POLHODE_PLOTLY plotly-gl3d.min.js
          DOC "plotly.js-gl3d-dist-min: without it reports come without their interactive part"
          PATHS ${PROJECT_SOURCE_DIR}/report/page/node_modules /usr/local/lib/node_modules /usr/lib/node_modules
                /usr/share/nodejs
          PATH_SUFFIXES plotly.js-gl3d-dist-min
          NO_DEFAULT_PATH)
set(plotly "")
if(POLHODE_PLOTLY)
  set(plotly ${POLHODE_PLOTLY})
else()
  message(STATUS "plotly was not found (bench/install page report fetches it): reports come without their interactive part")
endif()

set(page_folder ${PROJECT_SOURCE_DIR}/report/page)
# In the order in which they use each other.
set(page_code "")
foreach(module IN ITEMS records plots panel pictures tables page)
  list(APPEND page_code ${page_folder}/${module}.js)
endforeach()
set(page_assets ${PROJECT_BINARY_DIR}/page_assets.cpp)
add_custom_command(OUTPUT ${page_assets} VERBATIM
  COMMAND ${CMAKE_COMMAND} -D style=${page_folder}/page.css -D "code=${page_code}" -D plotly=${plotly}
          -D output=${page_assets} -P ${CMAKE_CURRENT_LIST_DIR}/EmbedPage.cmake
  DEPENDS ${page_folder}/page.css ${page_code} ${plotly} ${CMAKE_CURRENT_LIST_DIR}/EmbedPage.cmake)
target_sources(polhode_report PRIVATE ${page_assets})
set_source_files_properties(${page_assets} PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
