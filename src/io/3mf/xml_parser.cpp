#include "io/3mf/xml_parser.h"

#include <expat.h>

#include <exception>
#include <memory>

namespace raymap {

namespace {

constexpr char kSeparator = '\n';  // Between a namespace and a name: no attribute's value can hold it.

XmlName split(std::string_view name) {
  const size_t at = name.rfind(kSeparator);
  if (at == name.npos) return {{}, name};
  return {name.substr(0, at), name.substr(at + 1)};
}

/// One run of expat. Exceptions must not cross its C code, so `problem` keeps the first one.
struct Run {
  XML_Parser parser;
  XmlHandler& handler;
  bool hasDoctype = false;
  std::exception_ptr problem;

  template <class Work>
  void guarded(Work&& work) noexcept {
    if (problem) return;
    try {
      work();
    } catch (...) {
      problem = std::current_exception();
      XML_StopParser(parser, XML_FALSE);
    }
  }
};

Run& runOf(void* data) {
  return *static_cast<Run*>(data);
}

void onStart(void* data, const XML_Char* name, const XML_Char** attributes) {
  Run& run = runOf(data);
  run.guarded([&] { run.handler.start(split(name), XmlAttributes(attributes)); });
}

void onEnd(void* data, const XML_Char*) {
  Run& run = runOf(data);
  run.guarded([&] { run.handler.end(); });
}

void onNamespace(void* data, const XML_Char* prefix, const XML_Char* space) {
  Run& run = runOf(data);
  run.guarded([&] { run.handler.namespaces.insert_or_assign(prefix ? prefix : "", space ? space : ""); });
}

void onDoctype(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
  Run& run = runOf(data);
  run.hasDoctype = true;
  XML_StopParser(run.parser, XML_FALSE);
}

std::string placeIn(const std::string& part, uint64_t line) {
  return part + ", line " + std::to_string(line) + ": ";
}

/// Reads the next bytes of a part, or its end if there are none.
void feed(Run& run, const MeshFile& file, const std::string& part, std::string_view piece) {
  const XML_Status status =
      XML_Parse(run.parser, piece.data(), static_cast<int>(piece.size()), piece.empty() ? 1 : 0);
  if (run.problem) std::rethrow_exception(run.problem);
  if (run.hasDoctype) file.fail(placeIn(part, run.handler.line()) + "it has a DOCTYPE, which 3MF forbids");
  if (status != XML_STATUS_OK)
    file.fail(placeIn(part, run.handler.line()) + XML_ErrorString(XML_GetErrorCode(run.parser)));
}

}  // namespace

std::optional<std::string_view> XmlAttributes::find(std::string_view name, std::string_view space) const {
  for (const char* const* at = list_; *at; at += 2) {
    const std::string_view key = *at;
    if (!key.ends_with(name)) continue;
    const XmlName found = split(key);
    if (found.local == name && found.space == space) return at[1];
  }
  return std::nullopt;
}

void parseXml(ZipParts& parts, const std::string& part, XmlHandler& handler, XmlPrefixes prefixes) {
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
      prefixes == XmlPrefixes::Plain ? XML_ParserCreate(nullptr) : XML_ParserCreateNS(nullptr, kSeparator),
      &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  Run run{parser.get(), handler};
  handler.line = [&] { return static_cast<uint64_t>(XML_GetCurrentLineNumber(parser.get())); };
  XML_SetUserData(parser.get(), &run);
  XML_SetElementHandler(parser.get(), onStart, onEnd);
  XML_SetStartNamespaceDeclHandler(parser.get(), onNamespace);
  XML_SetStartDoctypeDeclHandler(parser.get(), onDoctype);

  // expat keeps an unfinished tag, and older versions read it again with each piece.
  constexpr uint64_t kLongestTag = 1 << 20;
  uint64_t fed = 0;
  parts.read(part, [&](std::string_view piece) {
    feed(run, parts.file(), part, piece);
    fed += piece.size();
    const auto reached = static_cast<uint64_t>(std::max<XML_Index>(XML_GetCurrentByteIndex(parser.get()), 0));
    if (fed > reached + kLongestTag)
      parts.file().fail(placeIn(part, handler.line()) + "a tag or comment is longer than 1 MiB");
  });
  feed(run, parts.file(), part, {});
}

}  // namespace raymap
