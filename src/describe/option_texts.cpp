// Texts of all options. scripts/options.py writes this file from raymap/named_options.h.

#include <raymap/named_options.h>

#include <array>

namespace raymap {

// clang-format off
constexpr std::array<OptionText, 68> kTexts{{
    {"align",
     "Whether sample (0, 0, 0) lies on multiples of 8 spacings, as OpenVDB's leaves do. Samples of all "
     "such grids of one spacing then coincide, and their level sets can be combined. Excludes `shape`."},
    {"allow_empty",
     "Whether to accept a mesh without triangles. All samples are then outside and as far as numbers go: "
     "at the `band`, or at the largest float without one. They have no triangle, winding number 0 and "
     "confidence 1."},
    {"array",
     "Array that colours the slice and the cut face, and that of confidences the surface too. The field "
     "must have it; triangles have no such colours."},
    {"band",
     "Distances are clamped to this many samples; 0 = not clamped."},
    {"base",
     "Height against `down` of a flat base that walls join the rim of the mesh to, as for a terrain. The "
     "mesh must not reach below it. By default there is none."},
    {"bounds",
     "Box to cover, in the mesh's units; by default the padded bounds."},
    {"close_holes",
     "Whether to measure distances to the surface that is missing in holes, too. Without it, holes are "
     "closed in steps as large as samples."},
    {"compact",
     "Whether to take 68 to 74 bytes per triangle less. The results are the same. Scattered points then "
     "take up to half more time, and narrow bands up to a tenth."},
    {"confidence",
     "Whether to compute the confidence in the sign. Needs a sign."},
    {"count",
     "Number of all points."},
    {"cut",
     "Whether to remove the half before the middle plane, as in the paper's figure 1. The cut face shows "
     "the distance inside."},
    {"cut_plane",
     "Plane of a cut: what lies on the side of its normal is removed."},
    {"device",
     "Device that computes: `cpu`; `vulkan:K`, the Kth Vulkan device; `vulkan`, the best of them, which "
     "may be a software rasterizer; `auto`, a real GPU if one is usable, else the CPU."},
    {"direction",
     "Direction from the camera to the centre of the shape."},
    {"distance",
     "Distance to the closest triangle: `exact`, or the faster approximations `neighbours`, `cell` and "
     "`raster`."},
    {"down",
     "Direction of the drain holes and of the walls to a base; any length but 0."},
    {"drain_hole",
     "Diameter of the drain holes; 0 = none."},
    {"drain_holes",
     "Number of drain holes of each hollow: down from its lowest point, then as a vent up from its "
     "highest one, then down from level floors as far from the others as there are."},
    {"drop_smaller",
     "Volume in the mesh's units cubed. Parts of the result that enclose less are dropped. Unset: a "
     "thousandth of what the largest part encloses. A small part is kept if no other part covers that "
     "piece of the mesh."},
    {"eye",
     "Place of the camera, in the mesh's units, instead of one from which the shape fills the picture."},
    {"field_of_view",
     "Angle from the bottom to the top of the picture, in degrees."},
    {"frame",
     "Box that the camera frames instead of the shape, in the mesh's units. Pictures of a moving shape "
     "share one, so that the camera stands still. The ball around it cuts off what reaches farther."},
    {"height",
     "Height of the picture, in pixels."},
    {"in_cube",
     "Whether to choose the points all around from a cube instead of a ball."},
    {"inside",
     "Width of the band inside, in samples; infinite for the whole interior."},
    {"invert",
     "Whether to make inside positive and outside negative."},
    {"iso",
     "Distance at which the surface lies, in the mesh's units."},
    {"keep_cavities",
     "Whether to keep sealed cavities; else they are filled, with all parts in them."},
    {"max_distance",
     "Farther points get this distance, with their sign, and no closest point, triangle or direction."},
    {"max_size",
     "Most samples along a side. Larger fields are resampled on a coarser grid."},
    {"max_thickness",
     "Largest thickness to find. Thicker parts are taken as infinitely thick. The smaller, the faster."},
    {"measure",
     "Whether to measure both meshes and how far they deviate; takes longer. Without, nothing in the "
     "report is set that compares the meshes or tells what is wrong with them."},
    {"memory_limit",
     "Most bytes that the call and its result may hold; 0 = what is available."},
    {"min_thickness",
     "Least thickness of walls, fins and sheets: what is thinner in the mesh becomes a plate this thick. "
     "At least two samples, or 0 = none: what samples miss is lost. Unset: 1.75 samples, the thinnest "
     "wall that the grid cannot miss. Material removed by a negative offset is not restored."},
    {"near_share",
     "Share of the points that are near the surface, 0 to 1."},
    {"normalize",
     "Whether to move and scale all so that the bounding sphere becomes the unit sphere about 0."},
    {"offset",
     "Distance to move the surface outwards, in the mesh's units; negative: inwards."},
    {"offsets",
     "Offset points of `paths` and `evolution` in samples, used in turn, in place of those of "
     "`sampling`."},
    {"orientation",
     "Whether faces that point the wrong way are reversed: `auto`, if the field then fits clearly "
     "better; `keep`, never; `repair`, whenever it fits no worse."},
    {"other_title",
     "Name of the second field; empty: \"Other field\"."},
    {"outside",
     "Width of the band outside of the surface, in samples."},
    {"padding",
     "Padding of the bounds on every side, as a share of their longest side; ignored with `bounds`."},
    {"passes",
     "Number of passes of the sign `paths`, or of steps of `evolution`."},
    {"radius",
     "Radius of that ball, half a side of that cube; 0 = the bounding sphere's radius."},
    {"range",
     "Least difference in the deepest colour, in the mesh's units; 0 = the spacing."},
    {"remesh",
     "Whether to make all faces from the field even if some could be kept."},
    {"resolution",
     "Samples along the longest side of the box; ignored with `voxel_size` or `shape`. By default 128; "
     "for a repair at least 256, chosen by the thinnest part."},
    {"sampling",
     "Offset points of the signs `paths` and `evolution`: `spread` over a box around the sample, or "
     "`paper` for those of the paper."},
    {"seed",
     "Another seed gives other points."},
    {"shape",
     "Number of samples (nx, ny, nz), for fields of one shape; by default the box decides. Cells about "
     "the centre of the box are as small as hold it. With `voxel_size` they have that size, and may cut "
     "the box."},
    {"shell",
     "Thickness of the walls of a hollow solid, in the mesh's units; 0 = not hollow."},
    {"sigmas",
     "Standard deviations of the offsets of points near the surface, as shares of the bounding sphere's "
     "radius. Each gets as many points."},
    {"sign",
     "Method that decides inside and outside: `harmonic`, by one ray and the edges of holes, or by the "
     "smoothest field that fits all rays; `exact`, `paths`, `evolution`, `rays`, `ray`, or `none` for "
     "distances without a sign."},
    {"slice_plane",
     "Plane on which distances are drawn in the colours and with the lines of `render_slice`."},
    {"step",
     "Distance between these points; 0 = ten times the tolerance, or a quarter of the mean edge of "
     "`triangles`, at least the mesh's own mean edge. It is enlarged until all points are at most about "
     "a million, and 32 for each face."},
    {"surface_share",
     "Share of the points that are on the surface, 0 to 1."},
    {"thickness",
     "Thickness of a wall around the surface, in the mesh's units; 0 = none. The solid is everything "
     "within half of it from the surface, whatever `sign` says: for sheets that enclose nothing. "
     "Excludes `winding`, `confidence` and `close_holes`, which need a sign. The grid grows by half of "
     "it."},
    {"threads",
     "Number of CPU threads; 0 = `default_threads`."},
    {"threshold",
     "A point is inside if |winding number| exceeds this."},
    {"title",
     "Heading; empty: the name of the file, or \"Field\"."},
    {"tolerance",
     "Largest deviation of the result from the isosurface, in the mesh's units, to have fewer faces; 0 = "
     "all faces. By default a tenth of the distance between samples, or what `triangles` needs. Faces "
     "that could be kept are simplified only if it is given."},
    {"triangle",
     "Whether to compute closest triangles; not with the distance `raster`."},
    {"triangles",
     "Most triangles of the result, 0 = no limit. The tolerance is then the least that was found to "
     "reach this number, and `tolerance` limits it. Faces that could be kept are simplified, too."},
    {"unit",
     "Length of the mesh that becomes 1, about the centre of its bounds, in place of the bounding "
     "sphere's radius; 0 = as `normalize` says."},
    {"up",
     "Direction up in the picture; the floor is perpendicular to it."},
    {"voxel_size",
     "Distance between samples, in the mesh's units; 0 = from the resolution or `shape`."},
    {"width",
     "Width of the picture, in pixels."},
    {"winding",
     "Whether to compute winding numbers. Needs a sign."},
}};
// clang-format on

std::span<const OptionText> optionTexts() {
  return kTexts;
}

}  // namespace raymap
