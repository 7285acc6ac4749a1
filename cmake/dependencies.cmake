find_program(CCACHE ccache)
if(CCACHE AND PROJECT_IS_TOP_LEVEL)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(glm REQUIRED)
find_package(hwy REQUIRED)
find_package(PNG REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(ZLIB REQUIRED)
find_package(assimp REQUIRED)
find_package(Imath REQUIRED)  # half floats in OpenVDB's headers
# Debian's packages of the first and the last have no CMake configuration; all are linked by name.
find_path(MINIZIP_INCLUDE minizip/unzip.h REQUIRED)
find_path(PUGIXML_INCLUDE pugixml.hpp REQUIRED)
find_path(OPENVDB_INCLUDE openvdb/openvdb.h REQUIRED)
