#pragma once

#include <nanovdb/NanoVDB.h>

namespace raymap {

/// Gives the inner nodes without active values their places. NanoVDB's statistics overwrite these with an
/// empty box, and its conversion to OpenVDB takes them for the places. Nodes are reached by offsets that must
/// be valid.
template <class Build>
void placeEmptyNodes(nanovdb::NanoGrid<Build>& grid) {
  const auto place = [](auto& node, const nanovdb::Coord& origin) {
    if (node.data()->mBBox.empty()) node.data()->mBBox[0] = origin;
  };
  auto* root = grid.tree().root().data();
  for (uint32_t t = 0; t < root->mTableSize; ++t) {
    auto* tile = root->tile(t);
    if (!tile->isChild()) continue;
    auto& upper = *root->getChild(tile);
    place(upper, tile->origin());
    for (auto child = upper.data()->mChildMask.beginOn(); child; ++child)
      place(*upper.data()->getChild(*child), upper.offsetToGlobalCoord(*child));
  }
}

}  // namespace raymap
