#pragma once

namespace raymap {

__extension__ using Int128 = __int128;

}  // namespace raymap
