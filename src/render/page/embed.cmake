# Writes the header OUT with the page as one text: PAGE/page.html with the script and the shader, SHADER in WebGL's language.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${SPIRV_CROSS} ${SHADER} --es --version 300 OUTPUT_VARIABLE shader COMMAND_ERROR_IS_FATAL ANY)
file(READ ${PAGE}/page.html page)
file(READ ${PAGE}/page.js script)
string(STRIP "${shader}" shader)
string(STRIP "${script}" script)
string(REPLACE "@shader@" "${shader}" page "${page}")
string(REPLACE "@script@" "${script}" page "${page}")
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
// Made by CMake from src/render/page.
#pragma once

#include <string_view>

namespace raymap {

inline constexpr std::string_view kPageText = R"page(@page@)page";

}  // namespace raymap
]])
