#pragma once

// The square of mesh_samples.h as 3MF, DAE and FBX.

#include "zip_file.h"

namespace raymap::samples {

/// Returns a 3MF file. `resources` are further objects beside object 1, the square; `build` places objects.
inline std::string threeMf(const std::string& resources, const std::string& build) {
  const std::string square =
      R"(<object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>)"
      R"(<vertex x="1" y="1" z="0"/><vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/>)"
      R"(<triangle v1="0" v2="2" v3="3"/></triangles></mesh></object>)";
  const std::string xml = R"(<?xml version="1.0" encoding="UTF-8"?>)";
  return zipFile(
      {{"[Content_Types].xml",
        xml +
            R"(<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" )"
            R"(ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" )"
            R"(ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)"},
       {"_rels/.rels",
        xml +
            R"(<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship )"
            R"(Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>)"
            R"(</Relationships>)"},
       {"3D/3dmodel.model",
        xml +
            R"(<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>)" +
            square + resources + "</resources><build>" + build + "</build></model>"}});
}
inline std::string threeMf() {
  return threeMf("", R"(<item objectid="1"/>)");
}

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
