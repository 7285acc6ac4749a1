#include "options.h"

#include <raymap/names.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <utility>

#include "mesh_units.h"
#include "query_arrays.h"
#include "terminal.h"
#include "text.h"

namespace raymap {

namespace {

template <class Enum>
std::vector<std::string> namesOf() {
  const std::span<const std::string_view> accepted = names<Enum>();
  return {accepted.begin(), accepted.end()};
}

std::vector<std::string> axes() {
  return {"x", "y", "z"};
}

std::vector<std::string> queryArrayNames() {
  std::vector<std::string> all;
  for (const AskedArray& array : kQueryArrays) all.emplace_back(array.name);
  all.emplace_back("gradient");
  return all;
}

using enum Takes;

constexpr OptionRow kRows[] = {
    {"-o,--output", "--out", "Files", File, "FILE", "",
     "File to write"},  // Each command says more; see addOutput.
    {"--format", "", "Files", Text, "FORMAT", "",
     "Format of a file whose name does not end in it, such as -: of the output, or else of the inputs. "
     "Without it, an input is recognised by its first bytes"},
    {"--grid-name", "", "Files", Text, "NAME", "that of the array",
     "Name of the grid in a .vdb or .nvdb to write: Houdini looks for surface"},
    {"--grid", "", "Files", Text, "NAME", "the first level set",
     "Name of the grid to read from a .vdb or .nvdb, or from both of two"},
    {"--half", "", "Files", Nothing, "", "",
     "Store the numbers in 16 bits, at half the size: in a .vdb, .npy or .npz to a thousandth of themselves, "
     "in a .nvdb to 1/65535 of the band's width or the largest distance"},
    {"--overwrite", "-f,--force", "Files", Nothing, "", "", "Allow an output to replace an input"},
    {"--triangle-ids", "", "Files", File, "FILE", "",
     "Also write the index of each sample's closest triangle"},
    {"--winding", "", "Files", File, "FILE", "", "Also write the winding number"},
    {"--confidence", "", "Files", File, "FILE", "", "Also write the confidence in the sign, 0 to 1"},
    {"--stats", "", "Files", File, "FILE", "", "Also write all figures, as .json"},
    {"--json", "", "Files", Nothing, "", "", "Print all figures as JSON on stdout, instead of text"},
    {"--report", "", "Files", File, "FILE", "",
     "Also write the mesh's defects and the uncertain signs, as .json"},
    {"--report-picture", "", "Files", File, "FILE", "",
     "Also draw the mesh with its defects in colour, as .png"},
    {"--picture", "", "Files", File, "FILE", "",
     "Also draw the mesh as .png: edges with one face red, with more than two violet; faces that cross "
     "others orange, flipped faces blue, duplicates yellow, double-sided ones green. A field is drawn as "
     "its surface"},

    {"--frames", "", "Frames", Text, "FIRST:LAST[:STEP]", "",
     "Make one result for each of these frames, LAST included, on one grid. The input is an animated .gltf "
     "or .glb, or numbered files. The names of results, and of such files, hold the frame's number as %04d, "
     "$F4 or ####"},
    {"--fps", "", "Frames", AboveZero, "N", "24", "Frames per second: frame K shows the time K / N"},
    {"--start-frame", "", "Frames", Count, "K", "0", "Frame of an animation that shows the time 0"},
    {"--clip", "", "Frames", Text, "CLIP", "the first",
     "Animation to show: its name, or its number in the file, from 0 on"},

    {"--unit", "--units", "Units", Choice, "UNIT", "",
     "Unit of all lengths, these options included: um, mm, cm, m, in or ft. A 3MF, glTF or DAE is "
     "converted to it. Other formats have no unit: their numbers are assumed to be in UNIT unless --from "
     "is given. A .3mf records UNIT",
     unitNames},
    {"--from", "", "Units", Choice, "UNIT", "the one that the file's format has",
     "Unit of the numbers in the input", unitNames},
    {"--to", "", "Units", Choice, "UNIT", "that of the file",
     "Unit to convert the input to, and of all lengths, these options included", unitNames},
    {"--scale", "", "Units", AboveZero, "FACTOR", "1", "Multiply the input by this factor"},
    {"--rotate", "", "Units", Vector, "X Y Z", "",
     "Rotate the mesh by these degrees about x, then y, then z"},
    {"--translate", "", "Units", Vector, "X Y Z", "", "Move the input by these lengths, after all else"},
    {"--up", "", "Units", Direction, "DIRECTION", "",
     "Direction that is up in the input: x, y, z, -x, -y, -z or three numbers. A mesh to write is rotated "
     "to z up, a .glb to y up; without this option it is not rotated. A picture shows it upright; without "
     "this option z is up in a .stl or .3mf, y in all else"},
    {"--recenter", "--recentre,--center,--centre", "Units", Nothing, "", "",
     "Move the mesh to about (0, 0, 0) in the file, for formats that lose digits far from it; the offset "
     "is printed, and noted in the file"},

    {"--resolution", "-r,--res", "Grid", Natural, "N",
     "128; 256 in render; in repair chosen by the thinnest part", "Samples along the longest side"},
    {"--voxel-size", "--voxel,--spacing", "Grid", AboveZero, "LENGTH", "",
     "Distance between samples, instead of --resolution"},
    {"--shape", "--dims", "Grid", Triple, "NX NY NZ", "",
     "Number of samples along x, y and z, instead of --resolution, for fields that can be stacked. Cells are "
     "the smallest that cover the box; with --voxel-size they have that size, about the box's centre"},
    {"--align", "", "Grid", Nothing, "", "",
     "Begin the grid at multiples of 8 times the distance between samples, so that level sets of one "
     "--voxel-size can be combined"},
    {"--bounds", "--bbox,--box", "Grid", Corners, "X0 Y0 Z0 X1 Y1 Z1", "the mesh's bounds, padded",
     "Box to cover"},
    {"--padding", "--pad,--margin", "Grid", FromZero, "SHARE", "0.1",
     "Padding of the mesh's bounds on every side, as a share of their longest side"},

    {"--distance", "", "Method", Choice, "MODE", "exact",
     "Distance to the closest triangle: exact, or a faster approximation, neighbours, cell or raster",
     namesOf<DistanceMode>},
    {"--sign", "", "Method", Choice, "MODE", "harmonic",
     "Method that decides inside and outside: harmonic, exact, paths, evolution, rays, ray or none",
     namesOf<SignMode>},
    {"--orientation", "", "Method", Choice, "MODE", "auto",
     "Reverse faces that point the wrong way: auto, if the field then fits clearly better; keep, never; "
     "repair, whenever it fits no worse",
     namesOf<Orientation>},
    {"--passes", "", "Method", Natural, "N", "5", "Passes of --sign paths, steps of --sign evolution"},
    {"--sampling", "", "Method", Choice, "MODE", "raymap",
     "Sampling of --sign paths and evolution: raymap, or paper, the paper's own", namesOf<Sampling>},
    {"--offsets", "", "Method", File, "FILE", "",
     "Text file of offset points for --sign paths and evolution, a line x y z each, in samples"},
    {"--threshold", "", "Method", AboveZero, "W", "0.5",
     "A point is inside if |winding number| exceeds this"},
    {"--full-inside", "", "Method", Nothing, "", "",
     "With --band: keep all distances inside, and clamp those outside, in a .vdb or .nvdb"},
    {"--band", "", "Method", FromZero, "SAMPLES", "0",
     "Clamp distances to this many samples; 0 does not clamp"},
    {"--close-holes", "!--no-close-holes,--fill-holes,!--no-fill-holes", "Method", Nothing, "",
     "yes in mesh and repair, no in generate and view",
     "Also measure distances to the surface that is missing in holes. Without it, a mesh is closed there in "
     "steps as large as samples"},
    {"--thickness", "", "Method", AboveZero, "LENGTH", "",
     "Make a solid of this thickness around the surface instead of a sign: for sheets"},
    {"--invert", "", "Method", Nothing, "", "", "Make inside positive and outside negative"},
    {"--allow-empty", "", "Method", Nothing, "", "",
     "Accept a mesh without triangles, in the box of --bounds. Its field is far everywhere: at --band, or at "
     "the largest float"},
    {"--unsigned", "", "Method", Nothing, "", "",
     "Compute no sign, which is faster: for surfaces without an inside"},
    {"--iso", "", "Method", Number, "LENGTH", "0", "Distance at which the surface lies"},

    {"--tolerance", "", "Shape", FromZero, "LENGTH",
     "what --triangles needs, or else in mesh and repair a tenth of the distance between samples",
     "Largest deviation from the mesh or isosurface that is simplified, to write fewer triangles; 0: all of "
     "them"},
    {"--triangles", "--max-triangles,--max-faces", "Shape", Natural, "N", "",
     "Write at most so many triangles, with the least deviation that reaches it; --tolerance is then a limit "
     "of the "
     "deviation"},
    {"--offset", "", "Shape", Number, "LENGTH", "0",
     "Distance to move the surface outwards; negative: inwards"},
    {"--shell", "--hollow,--wall", "Shape", AboveZero, "LENGTH", "",
     "Hollow the solid out, leaving walls this thick"},
    {"--min-thickness", "", "Shape", FromZero, "LENGTH", "what the grid needs to lose none of them",
     "Make walls, fins and sheets that are thinner this thick, at least two samples; 0: lose what the "
     "samples miss"},
    {"--drain-hole", "", "Shape", AboveZero, "LENGTH", "",
     "Drill a hole of this diameter straight down from the lowest point of each hollow; hollows too small "
     "for it stay solid"},
    {"--drain-holes", "", "Shape", Natural, "N", "1",
     "Number of holes of each hollow: the second is a vent up from the highest point, more go down from "
     "level floors"},
    {"--down", "", "Shape", Direction, "DIRECTION", "-z; with --up in a .glb, -y", "Direction of down"},
    {"--drop-smaller", "", "Parts", FromZero, "VOLUME", "a thousandth of the largest part's volume",
     "Drop parts that enclose less than this volume, in the mesh's units cubed; 0 keeps all"},
    {"--base", "--floor", "Shape", Number, "Z", "",
     "Join the rim of an open surface, such as a terrain, by walls to a flat base at this height, below all "
     "of "
     "it"},
    {"--keep-cavities", "", "Parts", Nothing, "", "", "Do not fill sealed cavities"},
    {"--remesh", "", "Parts", Nothing, "", "",
     "Make all faces from the field, even if those of the mesh could be kept"},

    {"--arrays", "", "Results", List, "NAME,...", "distance",
     "Arrays to compute. A field has distance and gradient", queryArrayNames},
    {"--max-distance", "", "Results", AboveZero, "LENGTH", "",
     "Farther points get this distance and no closest point"},
    {"--colour", "--color", "Results", Nothing, "", "",
     "Colour the points of a .ply by distance, as slices are"},
    {"-n,--count", "", "Points", Whole, "N", "500000", "Number of points"},
    {"--near", "", "Points", Number, "SHARE", "0.94",
     "Share of the points that are near the surface, 0 to 1"},
    {"--sigma", "", "Points", List, "SHARE,...", "0.0025,0.00025",
     "Standard deviations of their offsets, as shares of the bounding sphere's radius; each gets as many "
     "points"},
    {"--surface", "", "Points", Number, "SHARE", "0",
     "Share of the points that are on the surface, 0 to 1; the rest lies in the bounding sphere"},
    {"--seed", "", "Points", Whole, "N", "0", "Another whole number gives other points"},
    {"--normalize", "--normalise", "Points", Nothing, "", "",
     "Move and scale all so that the bounding sphere is the unit sphere about 0"},

    {"--size", "", "Picture", Pair, "WIDTH HEIGHT", "1024 768", "Size of the picture in pixels"},
    {"--direction", "", "Picture", Direction, "DIRECTION", "-0.6 -0.45 -1; where z is up, -0.6 1 -0.45",
     "Direction in which the camera looks"},
    {"--cut", "", "Picture", Nothing, "", "", "Cut the shape open and show half of it"},
    {"--eye", "", "Picture", Vector, "X Y Z", "where the shape fills the picture", "Place of the camera"},
    {"--frame", "", "Picture", Takes::Corners, "X0 Y0 Z0 X1 Y1 Z1", "the shape",
     "Box that fills the picture and decides the floor and the step of lines, so that pictures are alike"},
    {"--cut-plane", "", "Picture", Takes::Plane, "NX NY NZ D", "",
     "Cut the shape open at this plane instead of its middle: what lies on the side of the normal is "
     "removed. "
     "D is the product of the normal and a point of the plane"},
    {"--slice-plane", "", "Picture", Takes::Plane, "NX NY NZ D", "",
     "Also show the distances on this plane, with lines as --slice draws them"},
    {"--slice", "", "Picture", Choice, "AXIS", "",
     "Draw a map of the slice across this axis, x, y or z, instead of the surface", axes},
    {"--index", "", "Picture", Count, "N", "the middle one", "Index of the slice, in samples"},
    {"--as", "", "Picture", Choice, "ARRAY", "the array that the file names; distances for floats in a .npy",
     "Array to show: distance, winding, confidence or triangle", namesOf<FieldArray>},
    {"--range", "", "Picture", AboveZero, "LENGTH", "the spacing",
     "Least difference of two shapes that has the deepest colour"},

    {"--max-size", "", "Picture", Natural, "N", "256",
     "Most samples along a side of a page; larger fields are shown on a coarser grid"},

    {"--fast", "", "Method", Nothing, "", "",
     "Do not count crossing pairs of faces, nor measure the thickness: takes less than half of the time"},
    {"--holes", "", "Method", Nothing, "", "", "Tear holes into the mesh"},
    {"--fine", "", "Method", Nothing, "", "", "Write 1.6 million triangles, without steps at edges"},
    {"--test", "", "Method", Text, "[vulkan:K]", "",
     "Test this GPU, or every one: compare every stage and whole fields with the CPU"},

    {"--table", "", "Results", Nothing, "", "", "Print all options over all commands, as a Markdown table"},

    {"--device", "", "Machine", Text, "DEVICE", "auto",
     "Device that computes: cpu, vulkan, vulkan:K (see raymap devices), or auto, a GPU if there is one, "
     "else the CPU"},
    {"--threads", "-j,--jobs", "Machine", Count, "N", "0",
     "Number of CPU threads; 0 takes RAYMAP_THREADS, or else all"},
    {"--memory-limit", "--memory", "Machine", Bytes, "SIZE", "all that is available",
     "Most memory to use, e.g. 2GB"},
    {"-q,--quiet", "", "Text", Nothing, "", "", "Print no text but warnings and errors"},
    {"-v,--verbose", "", "Text", Nothing, "", "",
     "Print each stage on stderr as it begins, with the seconds so far, and in the end figures for experts"},
    {"--progress", "", "Text", Choice, "STYLE", "a moving line on a terminal, else a line a minute",
     "Progress on stderr: plain, a line a minute; json, an object a line; or off", progressStyleNames},
};

/// Other spellings of choices.
constexpr std::array<std::pair<std::string_view, std::string_view>, 22> kSpellings{
    {{"neighbors", "neighbours"},
     {"micron", "um"},
     {"microns", "um"},
     {"millimetre", "mm"},
     {"millimetres", "mm"},
     {"millimeter", "mm"},
     {"millimeters", "mm"},
     {"centimetre", "cm"},
     {"centimetres", "cm"},
     {"centimeter", "cm"},
     {"centimeters", "cm"},
     {"metre", "m"},
     {"metres", "m"},
     {"meter", "m"},
     {"meters", "m"},
     {"inch", "in"},
     {"inches", "in"},
     {"\"", "in"},
     {"foot", "ft"},
     {"feet", "ft"},
     {"'", "ft"},
     {"triangles", "triangle"}}};

/// Returns whether a list with commas has this spelling. Allocates nothing: each start asks for all options.
bool hasSpelling(std::string_view list, std::string_view spelling) {
  for (size_t start = 0; start < list.size();) {
    const size_t end = std::min(list.find(',', start), list.size());
    std::string_view each = list.substr(start, end - start);
    if (each.starts_with('!')) each.remove_prefix(1);
    if (each == spelling) return true;
    start = end + 1;
  }
  return false;
}

}  // namespace

std::span<const OptionRow> optionRows() {
  return kRows;
}

const OptionRow* findRow(std::string_view spelling) {
  const auto* row = std::ranges::find_if(kRows, [&](const OptionRow& each) {
    return hasSpelling(each.name, spelling) || hasSpelling(each.others, spelling);
  });
  return row == std::end(kRows) ? nullptr : row;
}

int valueCount(Takes takes) {
  switch (takes) {
    case Nothing:
      return 0;
    case Pair:
      return 2;
    case Triple:
    case Vector:
    case Direction:
      return 3;
    case Takes::Plane:
      return 4;
    case Takes::Corners:
      return 6;
    default:
      return 1;
  }
}

std::string longName(const OptionRow& row) {
  return split(row.name, ',').back();
}

std::string shownNames(const OptionRow& row) {
  std::string shown = row.name;
  for (const std::string& other : split(row.others, ','))
    if (other.starts_with('!') && shown.find("--no-") == std::string::npos) shown += "," + other.substr(1);
  return replaced(shown, ",", ", ");
}

std::string allSpellings(const OptionRow& row) {
  std::vector<std::string> spellings =
      split(replaced(std::string(row.name) + "," + row.others, "!", ""), ',');
  std::erase(spellings, "");
  std::stable_partition(spellings.begin(), spellings.end(),
                        [](const std::string& each) { return !each.starts_with("--"); });
  return joined(spellings, ", ");
}

std::string helpOf(const OptionRow& row) {
  return std::string(row.help) +
         (row.fallback[0] == '\0' ? "" : std::string(" (default ") + row.fallback + ")");
}

std::string canonical(std::string_view choice) {
  std::string name = lower(choice);
  for (const auto& [other, known] : kSpellings)
    if (name == other) return std::string(known);
  return name;
}

}  // namespace raymap
