#pragma once

// The square of mesh_samples.h as DAE and FBX.

#include <string>

namespace raymap::samples {

/// Returns a DAE file: one polygon with four corners, under `nodes`.
inline std::string dae(const std::string& nodes = R"(<node><instance_geometry url="#g"/></node>)") {
  return R"(<?xml version="1.0" encoding="utf-8"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">)"
         R"(<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>)"
         R"(<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array><technique_common>)"
         R"(<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>)"
         R"(<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input )"
         R"(semantic="POSITION" source="#p"/></vertices><polylist count="1"><input semantic="VERTEX" source="#v" )"
         R"(offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist></mesh></geometry></library_geometries>)"
         R"(<library_visual_scenes><visual_scene id="s">)" +
         nodes +
         R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

inline std::string fbx() {
  return "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}\n"
         "Objects:  {\n\tGeometry: 10, \"Geometry::\", \"Mesh\" {\n\t\tVertices: *12 {\n\t\t\ta: "
         "0,0,0,1,0,0,1,1,0,0,1,0\n\t\t}\n\t\tPolygonVertexIndex: *4 {\n\t\t\ta: 0,1,2,-4\n\t\t}\n\t}\n"
         "\tModel: 20, \"Model::square\", \"Mesh\" {\n\t\tVersion: 232\n\t}\n}\n"
         "Connections:  {\n\tC: \"OO\",10,20\n\tC: \"OO\",20,0\n}\n";
}

}  // namespace raymap::samples
