#pragma once

// Small 3MF files made on the spot.

#include "zip_file.h"

namespace raymap::samples {

using Parts = std::vector<std::pair<std::string, std::string>>;

/// Returns the square of mesh_samples.h as an object's element. `attributes` begin with a blank.
inline std::string square3mf(int id, const std::string& attributes = "") {
  return "<object id=\"" + std::to_string(id) + "\"" + attributes +
         R"(><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>)"
         R"(<vertex x="1" y="1" z="0"/><vertex x="0" y="1" z="0"/></vertices><triangles>)"
         R"(<triangle v1="0" v2="1" v3="2"/><triangle v1="0" v2="2" v3="3"/></triangles></mesh></object>)";
}

/// Returns an object of components. Each is the attributes of one element.
inline std::string joined3mf(int id, const std::vector<std::string>& components) {
  std::string xml = "<object id=\"" + std::to_string(id) + "\"><components>";
  for (const std::string& component : components) xml += "<component " + component + "/>";
  return xml + "</components></object>";
}

/// Returns a model part; `items` are the attributes of the build's elements.
inline std::string model3mf(const std::string& objects, const std::vector<std::string>& items,
                            const std::string& attributes = R"( unit="millimeter")") {
  std::string xml = R"(<?xml version="1.0" encoding="UTF-8"?>)"
                    "\n<model" +
                    attributes +
                    R"( xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02")"
                    R"( xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">)"
                    "\n<resources>" +
                    objects + "</resources><build>";
  for (const std::string& item : items) xml += "<item " + item + "/>";
  return xml + "</build></model>";
}

/// Returns a 3MF file of these parts, which begin with the model "3D/3dmodel.model".
inline std::string package3mf(const Parts& models, Zip kind = Zip::Deflated) {
  const std::string xml = R"(<?xml version="1.0" encoding="UTF-8"?>)";
  Parts parts{
      {"[Content_Types].xml",
       xml +
           R"(<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" )"
           R"(ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" )"
           R"(ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)"},
      {"_rels/.rels",
       xml +
           R"(<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship )"
           R"(Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>)"
           R"(</Relationships>)"}};
  parts.insert(parts.end(), models.begin(), models.end());
  return zipFile(parts, kind);
}

/// Returns a 3MF file of one model.
inline std::string threeMf(const std::string& model) {
  return package3mf({{"3D/3dmodel.model", model}});
}
/// Returns the square as a 3MF file.
inline std::string threeMf() {
  return threeMf(model3mf(square3mf(1), {R"(objectid="1")"}));
}

}  // namespace raymap::samples
