#include "options.h"

#include <raymap/names.h>
#include <raymap/render.h>

#include <algorithm>
#include <utility>

#include "library_options.h"
#include "mesh_units.h"
#include "query_arrays.h"
#include "terminal.h"
#include "text.h"

namespace raymap {

namespace {

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

// Rows that end early are those of the library's options; raymap/named_options.h has the rest.
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
    {"--split", "", "Files", Nothing, "", "",
     "Write each part of a mesh that is apart, with the cavities in it, into a file of its own: NAME_1.stl "
     "and so on"},
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
    {"--height", "", "Units", AboveZero, "LENGTH", "",
     "Scale a mesh to this height, in place of --scale. The height is along z, or along y in a .glb, of the "
     "mesh that is written; in info and render along --up"},
    {"--fit", "", "Units", Lengths, "X Y Z", "",
     "Scale a mesh to be as large as fits into a box of these sides, in place of --scale"},
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
    {"--voxel-size", "--voxel,--spacing", "Grid", AboveZero},
    {"--shape", "--dims", "Grid"},
    {"--align", "", "Grid"},
    {"--bounds", "--bbox,--box", "Grid", Library, nullptr, "the mesh's bounds, padded"},
    {"--padding", "--pad,--margin", "Grid"},

    {"--distance", "", "Method"},
    {"--sign", "", "Method"},
    {"--orientation", "", "Method"},
    {"--passes", "", "Method"},
    {"--sampling", "", "Method"},
    {"--offsets", "", "Method", File, "FILE", "",
     "Text file of offset points for --sign paths and evolution, a line x y z each, in samples"},
    {"--threshold", "", "Method", AboveZero},
    {"--full-inside", "", "Method", Nothing, "", "",
     "With --band: keep all distances inside, and clamp those outside, in a .vdb or .nvdb"},
    {"--band", "", "Method"},
    {"--close-holes", "!--no-close-holes,--fill-holes,!--no-fill-holes", "Method", Library, nullptr,
     "yes in mesh and repair, no in generate and view"},
    {"--thickness", "", "Method", AboveZero},
    {"--invert", "", "Method"},
    {"--allow-empty", "", "Method"},
    {"--unsigned", "", "Method", Nothing, "", "",
     "Compute no sign, which is faster: for surfaces without an inside"},
    {"--iso", "", "Method"},

    {"--tolerance", "", "Shape", FromZero, "LENGTH",
     "what --triangles needs, or else in mesh and repair a tenth of the distance between samples",
     "Largest deviation from the mesh or isosurface that is simplified, to write fewer triangles; 0: all of "
     "them"},
    {"--triangles", "--max-triangles,--max-faces", "Shape", Natural, "N", "",
     "Write at most so many triangles, with the least deviation that reaches it; --tolerance is then a limit "
     "of the deviation"},
    {"--offset", "", "Shape"},
    {"--shell", "--hollow,--wall", "Shape", AboveZero},
    {"--min-thickness", "", "Shape", Library, nullptr, "what the grid needs to lose none of them"},
    {"--drain-hole", "", "Shape", AboveZero},
    {"--drain-holes", "", "Shape"},
    {"--down", "", "Shape", Library, nullptr, "-z; -y where y is up: in a .gltf, .glb, .dae or .fbx"},
    {"--drop-smaller", "", "Parts"},
    {"--base", "--floor", "Shape"},
    {"--keep-cavities", "", "Parts"},
    {"--remesh", "", "Parts"},

    {"--arrays", "", "Results", List, "NAME,...", "distance",
     "Arrays to compute. A field has distance and gradient", queryArrayNames},
    {"--max-distance", "", "Results"},
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
    {"--seed", "", "Points"},
    {"--normalize", "--normalise", "Points"},

    {"--size", "", "Picture", Pair, "WIDTH HEIGHT", "1024 768", "Size of the picture in pixels"},
    {"--direction", "", "Picture", Library, nullptr, "-0.6 -0.45 -1; where z is up, -0.6 1 -0.45"},
    {"--cut", "", "Picture"},
    {"--eye", "", "Picture"},
    {"--frame", "", "Picture"},
    {"--cut-plane", "", "Shape", Library, nullptr, "none; with --cut the middle one"},
    {"--slice-plane", "", "Picture"},
    {"--slice", "", "Picture", Choice, "AXIS", "",
     "Draw a map of the slice across this axis, x, y or z, instead of the surface", axes},
    {"--index", "", "Picture", Count, "N", "the middle one", "Index of the slice, in samples"},
    {"--as", "", "Picture", Choice, "ARRAY", "the array that the file names; distances for floats in a .npy",
     "Array to show: distance, winding, confidence or triangle", namesOf<FieldArray>},
    {"--range", "", "Picture", AboveZero, nullptr, "the spacing"},

    {"--max-size", "", "Picture"},

    {"--fast", "", "Method", Nothing, "", "",
     "Do not count crossing pairs of faces, nor measure the thickness: takes less than half of the time"},
    {"--holes", "", "Method", Nothing, "", "", "Tear holes into the mesh"},
    {"--fine", "", "Method", Nothing, "", "", "Write 1.6 million triangles, without steps at edges"},
    {"--test", "", "Method", Text, "[vulkan:K]", "",
     "Test this GPU, or every one: compare every stage and whole fields with the CPU"},

    {"--table", "", "Results", Nothing, "", "", "Print all options over all commands, as a Markdown table"},

    {"--device", "", "Machine"},
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
constexpr std::pair<const char*, const char*> kSpellings[] = {
    {"neighbors", "neighbours"},
    {"triangles", "triangle"},
    {"micron,microns", "um"},
    {"millimetre,millimetres,millimeter,millimeters", "mm"},
    {"centimetre,centimetres,centimeter,centimeters", "cm"},
    {"metre,metres,meter,meters", "m"},
    {"inch,inches,\"", "in"},
    {"foot,feet,'", "ft"}};

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
  static const std::vector<OptionRow> kCompleted = completed(kRows);
  return kCompleted;
}

const OptionRow* findRow(std::string_view spelling) {
  const auto row = std::ranges::find_if(optionRows(), [&](const OptionRow& each) {
    return hasSpelling(each.name, spelling) || hasSpelling(each.others, spelling);
  });
  return row == optionRows().end() ? nullptr : &*row;
}

int valueCount(Takes takes) {
  switch (takes) {
    case Nothing:
      return 0;
    case Pair:
      return 2;
    case Triple:
    case Vector:
    case Lengths:
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
  for (const auto& [others, known] : kSpellings)
    if (hasSpelling(others, name)) return known;
  return name;
}

}  // namespace raymap
