#pragma once

#include <cstddef>
#include <string>

namespace raymap {

/// Kinds of warnings.
enum class WarningCode {
  FileContent,  ///< A file has something odd that was left out or converted: `file`.
  Rounding,  ///< The single precision of a format moves vertices, by up to `length`, which is `share` of the
             ///< mesh's size: `file`.
  DeviceRefused,      ///< The device "auto" is the CPU, because the GPU did not pass its test: `device`.
  DeviceFailed,       ///< The device "auto" is the CPU, because the GPU failed at the work: `device`.
  OrientationMisfit,  ///< No directions of the faces fit the crossings, so signs may be wrong. `share` is the
                      ///< misfit (`Stats::misfit`), which may exceed 1.
  PartsInsideOut,     ///< `count` parts are inside out and cross others. The sign reverses them.
  BoxReached,         ///< The solid reaches the grid's box, and was closed there.
  SolidLost,    ///< `share` of the mesh's area is lost, and most of it bounds parts of the solid. `voxelSize`
                ///< keeps them, or most of them; 0 = none does.
  SurfaceLost,  ///< `share` of the mesh's area is lost, and most of it is sheets or dropped parts.
  PartsDropped,  ///< `count` small parts were dropped, the largest of `volume`, nearly as large as one that
                 ///< stays.
  PartsKept,  ///< `count` parts stay that are small, the largest of `volume`: nothing is wrong with the mesh.
  PartsBuried,        ///< Sealed cavities were filled that held `count` parts, the largest of `volume`.
  CavitiesFilled,     ///< `count` sealed cavities were filled, the largest of `volume`.
  HollowsFilled,      ///< `count` hollows stay solid, because the drain hole does not fit into them.
  NoHollow,           ///< The solid is nowhere thick enough for a hollow.
  DrainHolesMissing,  ///< `count` drain holes are missing, because the floors have no place for them.
  TrianglesMissed,    ///< `count` triangles are left, which is more than were asked for.
  NothingInside,   ///< No sample is inside, though the mesh lies in the grid. `voxelSize` is fine enough for
                   ///< the mesh; if it is 0, the mesh encloses nothing, and `length` is a thickness for a
                   ///< solid.
  Sheet,           ///< The mesh is a sheet. `length` is a thickness for it.
  BoundsLeft,      ///< The result reaches beyond the mesh's bounds, by `length`.
  PartsThickened,  ///< `share` of the mesh's area is on walls that are more than twice as thick now,
                   ///< `length`. `voxelSize` keeps them; 0 = none with a reasonable number of samples does.
  LooseBodies,     ///< `count` bodies lie loose in a hollow.
  FarVertices,     ///< `count` vertices lie at least 10^9 sizes of the mesh away, the farthest by `length`:
                   ///< `file`.
  AttributesLost,  ///< A file lacks names, materials, colours or texture coordinates of the given one:
                   ///< `file`.
  PartFile  ///< An earlier run left a part of `file`, which this one goes on with or drops, or this one
            ///< leaves a part.
};

/// Values that a warning names. Its code says which it has; the others are empty or 0.
struct WarningFields {
  std::string file = {};    ///< Path of the file that was read or written.
  std::string device = {};  ///< Device that was not used, such as "vulkan:0".
  size_t count = 0;         ///< Number of parts, cavities, hollows or holes.
  double share = 0.0;       ///< Share of the whole, 0 to 1, or a misfit (`Stats::misfit`).
  double length = 0.0;      ///< Length in the mesh's units.
  double volume = 0.0;      ///< Volume in the mesh's units cubed.
  double voxelSize = 0.0;   ///< Distance between samples that helps, in the mesh's units.
};

/// Something odd that does not stop a call.
struct Warning {
  WarningCode code = WarningCode::FileContent;  ///< Kind of the warning.
  std::string message = {};                     ///< One sentence: what is odd, where, and what helps.
  WarningFields fields = {};                    ///< Values that the message names.
};

}  // namespace raymap
