#pragma once

#include <string_view>

#include "io/mesh/text_scanner.h"

namespace raymap {

/// Words that begin a statement of a text STL.
enum class StlWord { Solid, EndSolid, Facet, EndFacet, Outer, EndLoop, Vertex, Color, Other };

/// Reads a word. Upper case is read as lower, `end solid` as `endsolid`, and a name may follow `solid` and
/// `endsolid` without a space.
StlWord readStlWord(TextScanner& text);

bool equalsIgnoringCase(std::string_view word, std::string_view lower);

}  // namespace raymap
