#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "io/3mf/zip_parts.h"

namespace raymap {

/// Name of an XML element: its namespace and the name without a prefix.
struct XmlName {
  std::string_view space, local;
};

/// Attributes of an XML element.
class XmlAttributes {
 public:
  explicit XmlAttributes(const char* const* list) : list_(list) {}
  /// Returns the value of an attribute; of one without a prefix unless a namespace is given.
  std::optional<std::string_view> find(std::string_view name, std::string_view space = {}) const;

 private:
  const char* const* list_;  ///< Names and values in turn, then null.
};

/// Receives the elements of a part from parseXml, with the line of each.
class XmlHandler {
 public:
  virtual ~XmlHandler() = default;
  virtual void start(const XmlName& name, const XmlAttributes& attributes) = 0;
  virtual void end() = 0;

  /// Namespaces by the prefixes that the elements so far have declared.
  std::map<std::string, std::string> namespaces;
  /// Returns the number of the line that is being read, counted from 1.
  std::function<uint64_t()> line;
};

/// Whether prefixes of names stand for namespaces, which must be declared then.
enum class XmlPrefixes : uint8_t { Namespaces, Plain };

/// Reads a part as XML and tells the handler of each element. Fails with the part and the line if the XML is
/// damaged or has a DOCTYPE, which 3MF forbids (entities are declared there).
void parseXml(ZipParts& parts, const std::string& part, XmlHandler& handler,
              XmlPrefixes prefixes = XmlPrefixes::Namespaces);

}  // namespace raymap
