# Writes what the report's page is made of into a C++ file.
#   cmake -D style=FILE -D "code=FILE;..." -D plotly=FILE-OR-EMPTY -D output=FILE -P EmbedPage.cmake
# The modules become one: their imports of each other and the word export go.
file(READ "${style}" style_text)
set(code_text "")
foreach(module IN LISTS code)
  file(READ "${module}" text)
  string(REGEX REPLACE "(^|\n)import [^\n]*" "\\1" text "${text}")
  string(REGEX REPLACE "(^|\n)export " "\\1" text "${text}")
  string(APPEND code_text "${text}")
endforeach()
set(plotly_text "")
if(plotly)
  file(READ "${plotly}" plotly_text)
  # Its head names the licence; the text of it goes with every copy.
  cmake_path(REPLACE_FILENAME plotly LICENSE OUTPUT_VARIABLE licence)
  if(EXISTS "${licence}")
    file(READ "${licence}" licence_text)
    string(PREPEND plotly_text "/*!\n${licence_text}*/\n")
  endif()
endif()
set(literals "")
foreach(part IN ITEMS style code plotly)
  if("${${part}_text}" MATCHES "</[sS][cC][rR][iI][pP][tT]|</[sS][tT][yY][lL][eE]|\\)polhode_page\"")
    message(FATAL_ERROR "The page's ${part} holds what would end it: </script>, </style> or the end of a literal")
  endif()
  string(APPEND literals "      .${part} = R\"polhode_page(${${part}_text})polhode_page\",\n")
endforeach()
file(WRITE "${output}" "// Written by bench/cmake/EmbedPage.cmake.\n#include \"report/render/page.hpp\"\n
namespace polhode::report {\n
PageAssets page_assets() {\n  return {\n${literals}  };\n}\n
}  // namespace polhode::report\n")
