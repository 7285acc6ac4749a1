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

/// Returns a DAE file: the square of `dae` with texture coordinates and colours of corners, in two nodes with
/// a material each, and without any of this in a third one, which mirrors it and has no name.
inline std::string attributedDae() {
  const auto source = [](const std::string& id, int stride, const std::string& names,
                         const std::string& numbers) {
    std::string params;
    for (const char name : names) params += std::string(R"(<param name=")") + name + R"(" type="float"/>)";
    return "<source id=\"" + id + "\"><float_array id=\"" + id + "a\" count=\"" + std::to_string(4 * stride) +
           "\">" + numbers + "</float_array><technique_common><accessor source=\"#" + id +
           "a\" count=\"4\" stride=\"" + std::to_string(stride) + "\">" + params +
           "</accessor></technique_common></source>";
  };
  const auto effect = [](const std::string& id, const std::string& colour, const std::string& more) {
    return "<effect id=\"" + id + R"("><profile_COMMON><technique sid="common"><lambert><diffuse>)" + colour +
           "</diffuse>" + more + "</lambert></technique></profile_COMMON></effect>";
  };
  const auto node = [](const std::string& name, const std::string& place, const std::string& material) {
    return R"(<node id="id of )" + name + R"(" name=")" + name + "\">" + place +
           R"(<instance_geometry url="#h"><bind_material><technique_common><instance_material symbol="m" target="#)" +
           material + R"("/></technique_common></bind_material></instance_geometry></node>)";
  };
  std::string text = dae(node("left", "", "red") + node("right", "<translate>0 0 5</translate>", "glass") +
                         R"(<node><scale>-1 1 1</scale><instance_geometry url="#g"/></node>)");
  text.insert(text.find("<library_geometries>"),
              "<library_effects>" + effect("re", "<color>1 0.5 0 1</color>", "") +
                  effect("ge", "<color>0 0 1 1</color>",
                         R"(<transparent opaque="A_ONE"><color>0 0 0 0.25</color></transparent>)") +
                  R"(</library_effects><library_materials><material id="red" name="red paint">)"
                  R"(<instance_effect url="#re"/></material><material id="glass" name="glass">)"
                  R"(<instance_effect url="#ge"/></material></library_materials>)");
  text.insert(text.find("</library_geometries>"),
              R"(<geometry id="h"><mesh>)" + source("hp", 3, "XYZ", "0 0 0 1 0 0 1 1 0 0 1 0") +
                  source("ht", 2, "ST", "0 0 1 0 1 1 0 0.25") +
                  source("hc", 3, "RGB", "1 0 0 0 1 0 0 0 1 0.5 0.25 1") +
                  R"(<vertices id="hv"><input semantic="POSITION" source="#hp"/></vertices>)"
                  R"(<polylist count="1" material="m"><input semantic="VERTEX" source="#hv" offset="0"/>)"
                  R"(<input semantic="TEXCOORD" source="#ht" offset="1" set="0"/>)"
                  R"(<input semantic="COLOR" source="#hc" offset="2"/><vcount>4</vcount>)"
                  R"(<p>0 0 0 1 1 1 2 2 2 3 3 3</p></polylist></mesh></geometry>)");
  return text;
}

inline std::string fbx() {
  return "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}\n"
         "Objects:  {\n\tGeometry: 10, \"Geometry::\", \"Mesh\" {\n\t\tVertices: *12 {\n\t\t\ta: "
         "0,0,0,1,0,0,1,1,0,0,1,0\n\t\t}\n\t\tPolygonVertexIndex: *4 {\n\t\t\ta: 0,1,2,-4\n\t\t}\n\t}\n"
         "\tModel: 20, \"Model::square\", \"Mesh\" {\n\t\tVersion: 232\n\t}\n}\n"
         "Connections:  {\n\tC: \"OO\",10,20\n\tC: \"OO\",20,0\n}\n";
}

}  // namespace raymap::samples
